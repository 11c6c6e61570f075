"""limits.md and limits.json of a study, and its lines on the terminal."""

import json
from collections.abc import Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_result
from radhar_cli.limits.keys import NumberKey
from radhar_cli.limits.limit import (
    AS_FAR,
    KEY_ENDS,
    NOTED,
    Consequence,
    Limit,
    Origin,
    RangeSide,
    number_text,
)
from radhar_cli.limits.margins import Margin
from radhar_cli.limits.study import SLOW, Study

FILES = TEXT, JSON = "limits.md", "limits.json"
MOST_LISTED = 20  # keys in a sentence
HEAD = "| key | now | from | to | below | beyond |\n| --- | --- | --- | --- | --- | --- |"


def write_report(folder: Path, title: str, command: str, study: Study) -> list[Path]:
    """Write limits.md and limits.json; return their paths.

    Args:
        folder: folder of the files.
        title: name of the config.
        command: command line of the study.
        study: what was found.

    Raises:
        FolderError: a file cannot be written.
    """
    numbers = {"command": command, **limits_numbers(study)}
    files = {
        TEXT: markdown(title, command, study).encode(),
        JSON: (json.dumps(numbers, indent=2, allow_nan=False) + "\n").encode(),
    }
    for name, data in files.items():
        write_result(folder, folder / name, data)
    return [folder / name for name in files]


def limits_numbers(study: Study) -> dict[str, Any]:
    """What was found, in plain values."""
    return {
        "margins": [vars(margin) for margin in study.margins],
        "limits": [_numbers(limit) for limit in study.limits.values()],
        "sample_s": study.sample_s,
        "troubled": study.troubled,
        "unfinished": [f"{key} {side.value}" for key, side in study.unfinished],
        "not_simulated": [f"{key} {side.value}" for key, side in study.not_simulated],
    }


def _numbers(limit: Limit) -> dict[str, Any]:
    beyond, refusal = limit.beyond, limit.refusal
    assert beyond.effect is not None
    return {
        "key": limit.key,
        "side": limit.side.value,
        "value": limit.value,
        "effect": beyond.effect.value,
        "source": beyond.source.value,
        "reason": beyond.reason,
        "last_accepted": limit.last_accepted,
        "refusal": None if refusal is None else refusal.reason,
        "times": limit.times if limit.times is None or isfinite(limit.times) else None,
        "simulated": limit.simulated,
        "sentence": f"{limit.key}: {limit.sentence}",
    }


def terminal_lines(study: Study) -> Iterator[str]:
    """Lines for the terminal: margins, then a line a key, sections apart."""
    for margin in study.margins:
        yield f"{_margin_text(margin)}"
    for slug, reason in study.troubled.items():
        yield f"{slug}: no scene can be drawn, and it is left out: {reason}"
    section = ""
    for number in study.keys:
        limits = [study.limits.get((number.key, side)) for side in RangeSide]
        if not any(limits):
            continue
        if number.key.partition(".")[0] != section:
            section = number.key.partition(".")[0]
            yield ""
        yield f"{number.key} {_now(number)}: {_sentence(limits)}"


def _sentence(limits: list[Limit | None]) -> str:
    """Limits of a number on both sides in words; in few where the key alone ends them."""
    known = [limit for limit in limits if limit is not None]
    plain = [limit.beyond == KEY_ENDS and (limit.times or 1) < NOTED for limit in known]
    values = [number_text(limit.value) for limit in known if limit.value is not None]
    if all(plain) and len(values) == 2:
        return f"from {values[0]} to {values[1]} ({AS_FAR}: refused)"
    return "; ".join(limit.sentence for limit in known)


def unfinished_lines(study: Study) -> Iterator[str]:
    """Lines that name what there was no time for."""
    if unfinished := dict.fromkeys(key for key, _ in study.unfinished):
        yield f"not finished: {_listed(unfinished)} (--minutes, --key)"
    if waiting := dict.fromkeys(key for key, _ in study.not_simulated):
        yield f"no sample was simulated at a limit of {_listed(waiting)} (--minutes, --key)"


def _listed(keys: Mapping[str, None]) -> str:
    """Keys in a sentence, the first of many."""
    more = len(keys) - MOST_LISTED
    names = ", ".join([*keys][:MOST_LISTED])
    return f"{names} and {more} more ({JSON})" if more > 0 else names


def markdown(title: str, command: str, study: Study) -> str:
    """Text of limits.md."""
    lines = [f"# How far {title} may go", "", f"`{command}`", "", *_introduction(study), ""]
    lines += ["| what is drawn | at most | ends at | beyond | what ends |"]
    lines += ["| --- | --- | --- | --- | --- |"]
    for margin in study.margins:
        drawn, limit = (f"{x:.3g} {margin.unit}".rstrip() for x in (margin.drawn, margin.limit))
        lines.append(f"| {margin.name} | {drawn} | {limit} | {margin.beyond} | {margin.source} |")
    for slug, reason in study.troubled.items():
        lines += ["", f"`{slug}` is left out: no scene can be drawn: {reason}."]
    sections = dict.fromkeys(number.key.partition(".")[0] for number in study.keys)
    for section in sections:
        rows = [_row(study, one) for one in study.keys if one.key.partition(".")[0] == section]
        lines += ["", f"## {section}", "", HEAD, *rows]
    for line in unfinished_lines(study):
        lines += ["", line[0].upper() + line[1:] + "."]
    return "\n".join([*lines, ""])


def _introduction(study: Study) -> list[str]:
    sample = "" if study.sample_s is None else f", {1e3 * study.sample_s:.3g} ms here"
    return [
        "Every number that has an effect with this config, put in place of what is drawn there: "
        "from which to which one scenes are drawn, nothing new is warned of, a sample is "
        f"simulated by the fast engine, and its work is at most {SLOW:.0f} times that of a sample "
        f"of the config{sample}. In brackets: what ends there.",
    ]


def _row(study: Study, number: NumberKey) -> str:
    limits = [study.limits.get((number.key, side)) for side in RangeSide]
    ends = [_end(limit) for limit in limits]
    beyond = [_beyond(limit) for limit in limits]
    unit = f" {number.unit}" if number.unit else ""
    return f"| `{number.key}` | {_now(number)}{unit} | {' | '.join((*ends, *beyond))} |"


def _end(limit: Limit | None) -> str:
    if limit is None:
        return "?"
    return "none" if limit.value is None else number_text(limit.value)


def _beyond(limit: Limit | None) -> str:
    if limit is None:
        return "not finished"
    if limit.beyond.source is Origin.KEY and limit.beyond.effect is Consequence.REFUSED:
        text = "refused" if limit.beyond.reason == AS_FAR else limit.beyond.sentence
    else:
        text = f"{limit.beyond.sentence} [{limit.beyond.source.value}]"
    if limit.times is not None and limit.times >= NOTED:
        text += f"; there {limit.times:.2g} times as slow"
    if limit.refusal is not None and limit.last_accepted is not None:
        words = "beyond" if limit.side is RangeSide.HIGH else "below"
        text += f"; {words} {number_text(limit.last_accepted)} refused"
    return text.replace("|", "\\|")


def _now(number: NumberKey) -> str:
    low, high = number.range
    return number_text(low) if low == high else f"{number_text(low)} to {number_text(high)}"


def _margin_text(margin: Margin) -> str:
    drawn, limit = (f"{x:.3g} {margin.unit}".rstrip() for x in (margin.drawn, margin.limit))
    return f"{margin.name}: {drawn}, ends at {limit} ({margin.beyond})"
