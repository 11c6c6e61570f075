"""Report of the limits of a config: limits.md, limits.json, and its lines on the terminal."""

from collections.abc import Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from radhar_cli.figures.report.parts import ReportTable, Sentences
from radhar_cli.figures.report.report import Report
from radhar_cli.files.table_text import markdown_table
from radhar_cli.study.limits.keys import NumberKey
from radhar_cli.study.limits.limit import (
    AS_FAR,
    KEY_ENDS,
    NOTED,
    Consequence,
    Limit,
    Origin,
    RangeSide,
    number_text,
)
from radhar_cli.study.limits.margins import Margin
from radhar_cli.study.limits.study import SLOW, Study

FILES = TEXT, JSON = "limits.md", "limits.json"
MOST_LISTED = 20  # keys in a sentence
COLUMNS = "key", "now", "from", "to", "below", "beyond"
HEAD = markdown_table(COLUMNS, ())
MARGINS = "what is drawn", "at most", "ends at", "beyond", "what ends"


def write_report(folder: Path, title: str, command: str, study: Study) -> list[Path]:
    """Write limits.md and limits.json; return their paths.

    Raises:
        FolderError: a file cannot be written.
    """
    numbers = {"command": command, **limits_numbers(study)}
    report = Report(numbers, f"How far {title} may go", f"`{command}`", "limits", ("md",))
    margins = [
        (margin.name, *_ends(margin), margin.beyond, margin.source) for margin in study.margins
    ]
    report.add(Sentences([_introduction(study)]), ReportTable(MARGINS, margins))
    for slug, reason in study.troubled.items():
        report.add(Sentences([f"`{slug}` is left out: no scene can be drawn: {reason}."]))
    for section in dict.fromkeys(number.section for number in study.keys):
        report.section(section)
        rows = [_row(study, number) for number in study.keys if number.section == section]
        report.add(ReportTable(COLUMNS, rows))
    for line in unfinished_lines(study):
        report.add(Sentences([f"{line[0].upper()}{line[1:]}."]))
    return report.write(folder)


def limits_numbers(study: Study) -> dict[str, Any]:
    """Plain values of what was found."""
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
    """Yield lines for the terminal: margins, then a line a key, sections apart."""
    for margin in study.margins:
        drawn, limit = _ends(margin)
        yield f"{margin.name}: {drawn}, ends at {limit} ({margin.beyond})"
    for slug, reason in study.troubled.items():
        yield f"{slug}: no scene can be drawn, and it is left out: {reason}"
    section = ""
    for number in study.keys:
        limits = [limit for limit in study.limits_of(number) if limit is not None]
        if not limits:
            continue
        if number.section != section:
            section = number.section
            yield ""
        yield f"{number.key} {_now(number)}: {_sentence(limits)}"


def _sentence(limits: list[Limit]) -> str:
    """Limits of a number on both sides in words; in few where the key alone ends them."""
    is_plain = all(one.beyond == KEY_ENDS and (one.times or 1) < NOTED for one in limits)
    values = [number_text(limit.value) for limit in limits if limit.value is not None]
    if is_plain and len(values) == 2:
        return f"from {values[0]} to {values[1]} ({AS_FAR}: refused)"
    return "; ".join(limit.sentence for limit in limits)


def unfinished_lines(study: Study) -> Iterator[str]:
    """Yield lines that name what there was no time for."""
    if unfinished := dict.fromkeys(key for key, _ in study.unfinished):
        yield f"not finished: {_listed(unfinished)} (--minutes, --key)"
    if waiting := dict.fromkeys(key for key, _ in study.not_simulated):
        yield f"no sample was simulated at a limit of {_listed(waiting)} (--minutes, --key)"


def _listed(keys: Mapping[str, None]) -> str:
    """Keys in a sentence, the first of many."""
    more = len(keys) - MOST_LISTED
    names = ", ".join([*keys][:MOST_LISTED])
    return f"{names} and {more} more ({JSON})" if more > 0 else names


def _introduction(study: Study) -> str:
    sample = "" if study.sample_s is None else f", {1e3 * study.sample_s:.3g} ms here"
    return (
        "Every number that has an effect with this config, put in place of what is drawn there: "
        "from which to which one scenes are drawn, nothing new is warned of, a sample is "
        f"simulated by the fast engine, and its work is at most {SLOW:.0f} times that of a sample "
        f"of the config{sample}. In brackets: what ends there."
    )


def _row(study: Study, number: NumberKey) -> tuple[str, ...]:
    """Row of a number: its limits on both sides, and what happens beyond."""
    limits = study.limits_of(number)
    unit = f" {number.unit}" if number.unit else ""
    ends = (
        "?" if one is None else "none" if one.value is None else number_text(one.value)
        for one in limits
    )
    return f"`{number.key}`", f"{_now(number)}{unit}", *ends, *map(_beyond, limits)


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
    return text


def _now(number: NumberKey) -> str:
    low, high = number.range
    return number_text(low) if low == high else f"{number_text(low)} to {number_text(high)}"


def _ends(margin: Margin) -> tuple[str, str]:
    """What is drawn and its limit, with their unit."""
    drawn, limit = (f"{x:.3g} {margin.unit}".rstrip() for x in (margin.drawn, margin.limit))
    return drawn, limit
