"""Report of the limits of a config: limits.md, limits.json, and its lines on the terminal."""

from collections.abc import Iterable, Iterator
from math import isfinite
from pathlib import Path
from typing import Any

from radhar_cli.figures.report.parts import ReportTable, Sentences
from radhar_cli.figures.report.report import Report
from radhar_cli.files.table_text import markdown_table
from radhar_cli.study.limits.keys import NumberKey
from radhar_cli.study.limits.margins import Margin
from radhar_cli.study.limits.study import (
    KEY_ENDS,
    NOTED,
    SLOW,
    Limit,
    LimitsStudy,
    RangeSide,
    number_text,
)

FILES = TEXT, JSON = "limits.md", "limits.json"
MOST_LISTED = 20  # keys in a sentence
COLUMNS = "key", "now", "from", "to", "below", "beyond"
HEAD = markdown_table(COLUMNS, ())
MARGINS = "what is drawn", "at most", "ends at", "beyond", "what ends"


def write_report(folder: Path, title: str, command: str, study: LimitsStudy) -> list[Path]:
    """Write limits.md and limits.json; return their paths.

    Raises:
        FolderError: a file cannot be written.
    """
    numbers = {"command": command, **limits_numbers(study)}
    report = Report(numbers, f"How far {title} may go", f"`{command}`", "limits", ("md",))
    margins = [(each.name, *_ends(each), each.beyond, each.source) for each in study.margins]
    sample = "" if study.sample_s is None else f", {1e3 * study.sample_s:.3g} ms here"
    about = (
        "Every number that has an effect with this config, put in place of what is drawn there: "
        "from which to which one scenes are drawn, nothing new is warned of, a sample is "
        f"simulated by the fast engine, and its work is at most {SLOW:.0f} times that of a sample "
        f"of the config{sample}. In brackets: what ends there."
    )
    report.add(Sentences([about]), ReportTable(MARGINS, margins))
    for slug, reason in study.trial.troubled.items():
        report.add(Sentences([f"`{slug}` is left out: no scene can be drawn: {reason}."]))
    for section in dict.fromkeys(number.section for number in study.numbers):
        report.section(section)
        rows = [_row(study, number) for number in study.numbers if number.section == section]
        report.add(ReportTable(COLUMNS, rows))
    for line in unfinished_lines(study):
        report.add(Sentences([f"{line[0].upper()}{line[1:]}."]))
    return report.write(folder)


def limits_numbers(study: LimitsStudy) -> dict[str, Any]:
    """Plain values of the findings."""
    return {
        "margins": [vars(margin) for margin in study.margins],
        "limits": [_numbers(limit) for limit in study.limits.values()],
        "sample_s": study.sample_s,
        "troubled": study.trial.troubled,
        "unfinished": [f"{key} {side}" for key, side in study.unfinished],
        "not_simulated": [f"{key} {side}" for key, side in study.not_simulated],
    }


def _numbers(limit: Limit) -> dict[str, Any]:
    """Plain values of a limit."""
    return {
        "key": limit.key,
        "side": limit.side,
        "value": limit.value,
        "effect": limit.beyond.effect,
        "source": limit.beyond.source,
        "reason": limit.beyond.reason,
        "last_accepted": limit.last_accepted,
        "refusal": None if limit.refusal is None else limit.refusal.reason,
        "times": limit.times if limit.times is None or isfinite(limit.times) else None,
        "simulated": limit.simulated,
        "sentence": f"{limit.key}: {limit.sentence}",
    }


def terminal_lines(study: LimitsStudy) -> Iterator[str]:
    """Yield lines for the terminal: margins, then a line a key, sections apart."""
    for margin in study.margins:
        drawn, limit = _ends(margin)
        yield f"{margin.name}: {drawn}, ends at {limit} ({margin.beyond})"
    for slug, reason in study.trial.troubled.items():
        yield f"{slug}: no scene can be drawn, and it is left out: {reason}"
    section = ""
    for number in study.numbers:
        limits = [limit for limit in _limits_of(study, number) if limit is not None]
        if limits and number.section != section:
            section = number.section
            yield ""
        ends = [number_text(limit.value) for limit in limits if limit.value is not None]
        is_plain = all(each.beyond == KEY_ENDS and (each.times or 1) < NOTED for each in limits)
        text = "; ".join(limit.sentence for limit in limits)
        if is_plain and len(ends) == 2:
            text = f"from {ends[0]} to {ends[1]} ({KEY_ENDS.sentence})"
        if limits:
            yield f"{number.key} {_now(number)}: {text}"


def unfinished_lines(study: LimitsStudy) -> Iterator[str]:
    """Yield lines that name the numbers for which there was no time."""
    if study.unfinished:
        yield f"not finished: {_name_keys(study.unfinished)} (--minutes, --key)"
    if study.not_simulated:
        keys = _name_keys(study.not_simulated)
        yield f"no sample was simulated at a limit of {keys} (--minutes, --key)"


def _name_keys(places: Iterable[tuple[str, RangeSide]]) -> str:
    """Keys in a sentence, the first of many."""
    keys = [*dict.fromkeys(key for key, _ in places)]
    names, more = ", ".join(keys[:MOST_LISTED]), len(keys) - MOST_LISTED
    return f"{names} and {more} more ({JSON})" if more > 0 else names


def _limits_of(study: LimitsStudy, number: NumberKey) -> list[Limit | None]:
    """Limits of a number below and above; None where there was no time."""
    return [study.limits.get((number.key, side)) for side in RangeSide]


def _row(study: LimitsStudy, number: NumberKey) -> tuple[str, ...]:
    """Row of a number: its limits on both sides, and what happens beyond."""
    ends, beyond = list[str](), list[str]()
    for limit in _limits_of(study, number):
        if limit is None:
            ends.append("?")
            beyond.append("not finished")
        else:
            ends.append("none" if limit.value is None else number_text(limit.value))
            beyond.append(limit.beyond_in_words(True).replace(f"{KEY_ENDS.reason}: ", ""))
    unit = f" {number.unit}" if number.unit else ""
    return f"`{number.key}`", f"{_now(number)}{unit}", *ends, *beyond


def _now(number: NumberKey) -> str:
    low, high = number.range
    return number_text(low) if low == high else f"{number_text(low)} to {number_text(high)}"


def _ends(margin: Margin) -> tuple[str, str]:
    """Return the extreme that is drawn and its limit, with their unit."""
    drawn, limit = (f"{x:.3g} {margin.unit}".rstrip() for x in (margin.drawn, margin.limit))
    return drawn, limit
