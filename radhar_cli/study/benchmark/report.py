"""Table of a benchmark: benchmark.json, .csv and .md, and lines for the terminal."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from radhar_cli.dataset.build_version import build_version
from radhar_cli.figures.report.parts import ReportTable, Sentences
from radhar_cli.figures.report.report import Report
from radhar_cli.learning.intervals import ends_in_words, interval_in_words
from radhar_cli.study.benchmark.engine import RowResult
from radhar_cli.study.benchmark.protocols import PERSONS, Protocol
from radhar_cli.study.benchmark.study import BenchmarkOptions, ProtocolResult

STEM = "benchmark"
COLUMNS = (
    *("protocol", "simulated", "row", "learned_from", "score", "value", "low_95", "high_95"),
    *("lowest_seed", "highest_seed", "seeds", "tested", "over", "groups", "why_not"),
)
ABOUT = (
    "Networks that learned from the rows' data, tested on the same measured samples. Values are "
    "means over the seeds, with the lowest and highest seed; intervals of 95 % are of other "
    "persons or recordings where these are known (bootstrap), else Wilson's of other samples."
)


def result_lines(result: ProtocolResult) -> list[str]:
    """Lines of a protocol for the terminal."""
    if result.why_not:
        return [f"{result.name}: not done: {result.why_not}"]
    return [
        f"{result.name}: {describe_protocol(result)}",
        *(
            f"  {row.learned_from:<34} {_value_in_words(row, result.protocol)}"
            for row in result.rows
        ),
    ]


def describe_protocol(result: ProtocolResult) -> str:
    """Data sets, target and split of a protocol, in words."""
    protocol = result.protocol
    target = "joints" if protocol.find_joints else f"{len(result.classes)} classes"
    left_out = f" ({len(result.left_out)} left out)" if result.left_out else ""
    split = "persons in turn" if protocol.split == PERSONS else "the authors' test part"
    return f"{protocol.map} to {target}{left_out}, {split}; simulated: {result.simulator}"


def _value_in_words(row: RowResult, protocol: Protocol) -> str:
    """Value of a row, its interval and seeds, in words; or why there is none."""
    if row.value is None:
        return f"not done: {row.why_not}"
    ends, lowest, highest = row.interval_95, min(row.by_seed), max(row.by_seed)
    if protocol.find_joints:
        words, interval = f"{row.value:.2f} cm", ends_in_words(ends, "cm", row.over)
        seeds = f"{lowest:.2f} to {highest:.2f}"
        words += f", {row.more['root_relative_cm']:.2f} cm about the hip"
    else:
        words, interval = f"{100 * row.value:.2f} %", interval_in_words(ends, row.over)
        seeds = f"{100 * lowest:.2f} to {100 * highest:.2f}"
    count = len(row.by_seed)
    return f"{words} {interval} of {row.tested}" + (f", {count} seeds {seeds}" if count > 1 else "")


def benchmark_report(options: BenchmarkOptions, results: Sequence[ProtocolResult]) -> Report:
    """Report of a benchmark."""
    numbers: dict[str, Any] = {
        "radhar": build_version(),
        "seeds": options.seeds,
        "epochs": options.epochs,
        "per_class": options.per_class,
        "protocols": {result.name: _numbers(result) for result in results},
    }
    about = f"radhar benchmark {build_version()}. {ABOUT}"
    report = Report(numbers, "Benchmark of simulators", about, STEM, ("md",), lists_files=True)
    cells = [line for result in results for line in _csv_rows(result)]
    report.add(ReportTable(COLUMNS, cells, file=f"{STEM}.csv", is_shown=False))
    for result in results:
        report.section(result.name)
        if result.why_not:
            report.add(Sentences([f"Not done: {result.why_not}"]))
            continue
        about_simulation = f"What tuned the simulation: {_tuned_on(result) or 'its makers know'}."
        report.add(Sentences([describe_protocol(result), about_simulation], is_list=True))
        rows = [[row.learned_from, _value_in_words(row, result.protocol)] for row in result.rows]
        report.add(ReportTable(("trained on", _score_of(result.protocol)), rows))
    return report


def _tuned_on(result: ProtocolResult) -> str | None:
    """Measured data that tuned the simulation; None of another simulator's."""
    return result.protocol.tuned_on if result.simulated is None else None


def _score_of(protocol: Protocol) -> str:
    """Key of the main score of a protocol."""
    return "mpjpe_cm" if protocol.find_joints else "accuracy"


def _numbers(result: ProtocolResult) -> dict[str, Any]:
    """Numbers of a protocol for programs."""
    return {
        "simulated": result.simulator,
        "tuned_on": _tuned_on(result),
        "split": result.protocol.split,
        "score": _score_of(result.protocol),
        "classes": list(result.classes),
        "left_out": list(result.left_out),
        "rows": {row.row: asdict(row) for row in result.rows},
        "why_not": result.why_not,
    }


def _csv_rows(result: ProtocolResult) -> list[list[object]]:
    """Rows of the CSV file of a protocol."""
    return [
        [
            result.name,
            result.simulator,
            row.row,
            row.learned_from,
            _score_of(result.protocol),
            row.value,
            *(row.interval_95 or (None, None)),
            min(row.by_seed, default=None),
            max(row.by_seed, default=None),
            len(row.by_seed),
            row.tested,
            row.over.get("kind"),
            row.over.get("count"),
            row.why_not,
        ]
        for row in result.rows
    ]
