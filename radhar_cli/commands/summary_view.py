"""A summary as tables on the terminal."""

import os
from collections.abc import Iterable, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from radhar_cli.untrusted import shown

BARS, ASCII_BARS = " ▁▂▃▄▅▆▇█", " .:-=+*%#"
MAX_SIZES = 5
MAX_WIDTH = 1000  # columns where no terminal says how wide it is


def print_summary(summary: dict[str, Any]) -> None:
    """Print what `dataset.summary.summarise` found."""
    console = Console(highlight=False, markup=False, emoji=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = MAX_WIDTH
    {
        "data set": _data_set,
        "unfinished data set": _unfinished,
        "scene": _scene,
        "tree of images": _tree,
        "recording": _recording,
    }[summary["kind"]](console, _plain(summary))


def _plain(value: Any) -> Any:
    """The same values with the control characters of their texts escaped."""
    if isinstance(value, dict):
        return {_plain(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_plain(inner) for inner in value]
    return shown(value).replace("\n", "\\n") if isinstance(value, str) else value


def _data_set(console: Console, s: dict[str, Any]) -> None:
    console.print(Text(s["path"], "bold"), f" {s['samples']} samples, {s['bytes'] / 2**20:.1f} MiB")
    versions = ", ".join(f"{library} {version}" for library, version in s["versions"].items())
    console.print(f"seed {s['seed']}   config {s['config_hash'][:12]}   {versions}")
    samples = ((slug, *parts.values()) for slug, parts in s["classes"].items())
    _table(console, "samples", ["class"], ["train", "validation", "test"], samples)
    for number, (name, shape) in enumerate(s["maps"].items(), 1):
        console.print(f"map {number}   {name}, {shape[0]} x {shape[1]} px")
    maps = [f"{number}" for number in range(1, 1 + len(s["maps"]))]
    means = (
        (slug, *(f"{values[slug]['mean']:.1f}" for values in s["entropy_bits"].values()))
        for slug in s["classes"]
    )
    _table(console, "mean entropy of the power maps (bit)", ["class"], maps, means)
    if s["drawn"]:
        drawn = (
            (
                *(name, h["unit"], *(f"{h[key]:.4g}" for key in ("min", "mean", "max"))),
                *(h["samples"], _bars(h["counts"], _bar_signs(console))),
            )
            for name, h in s["drawn"].items()
        )
        numbers = ["min", "mean", "max", "samples", "histogram"]
        _table(console, "drawn parameters", ["parameter", "unit"], numbers, drawn)
    if s.get("labels"):
        shown = ", ".join(f"{slug} {count}" for slug, count in s["labels"].items())
        console.print(f"samples in which anybody, of several people, does it: {shown}")
    for warning in s["warnings"]:
        console.print(Text("warning", "yellow"), warning["message"])


def _recording(console: Console, s: dict[str, Any]) -> None:
    console.print(
        Text(s["path"], "bold"),
        f" {s['duration_s']:.4g} s in {s['segments']} stretch{'es' * (s['segments'] > 1)}, "
        f"{s['bytes'] / 2**20:.1f} MiB",
    )
    numbers = (
        (key, f"{value:.6g}" if isinstance(value, float) else value)
        for key, value in s.items()
        if isinstance(value, (int, float)) and not isinstance(value, bool)
    )
    _table(console, "recording", ["key"], ["value"], numbers)
    for one in s["labels"]:
        console.print(f"label {one['label']}, person {one['person'] or 'not given'}")
    for line in s["source"]["found"]:
        console.print(Text("found", "yellow"), line)


def _table(
    console: Console,
    title: str,
    names: Sequence[str],
    numbers: Sequence[str],
    rows: Iterable[Iterable[object]],
) -> None:
    """Print a table that nine maps and long names leave narrower than 80 characters."""
    table = Table(title=title, box=box.SIMPLE_HEAD, pad_edge=False)
    for name in names:
        table.add_column(name, overflow="fold")
    for name in numbers:
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*(Text(str(cell)) for cell in row))
    console.print(table)


def _tree(console: Console, s: dict[str, Any]) -> None:
    console.print(
        Text(s["path"], "bold"),
        f" {s['samples']} images of {len(s['classes'])} classes, {s['bytes'] / 2**20:.1f} MiB",
    )
    sizes = [f"{one['images']} of {one['size'][0]} x {one['size'][1]} px" for one in s["sizes"]]
    more = f", and {len(sizes) - MAX_SIZES} more sizes" if len(sizes) > MAX_SIZES else ""
    console.print(f"sizes {', '.join(sizes[:MAX_SIZES])}{more}")
    parts = list(next(iter(s["classes"].values())))
    rows = ((name, *counts.values()) for name, counts in s["classes"].items())
    _table(console, "images by class", ["class"], parts, rows)


def _bar_signs(console: Console) -> str:
    return BARS if console.encoding.startswith("utf") else ASCII_BARS


def _bars(counts: list[int], signs: str) -> str:
    largest = max(counts)
    return "".join(signs[-(-count * (len(signs) - 1) // largest)] for count in counts)


def _unfinished(console: Console, s: dict[str, Any]) -> None:
    share, signs = s["finished"] / s["samples"], _bar_signs(console)
    console.print(
        Text(s["path"], "bold"), f" unfinished: {s['finished']} of {s['samples']} samples"
    )
    progress = (signs[-1] * int(share * 40)).ljust(40, signs[1])
    console.print(f"{progress} {share:.0%}   seed {s['seed']}   config {s['config_hash'][:12]}")
    console.print("the same `radhar generate` command resumes")


def _scene(console: Console, s: dict[str, Any]) -> None:
    joint = f", {s['joint']} alone" if s["joint"] else ""
    console.print(
        Text(s["path"], "bold"),
        f" {s['activity']['label']} {s['activity']['slug']}"
        f"{joint}, {s['engine']} engine, seed {s['seed']}",
    )
    maps = (
        (name, f"{shape[0]} x {shape[1]}", f"{s['entropy_bits'][name]:.2f}")
        for name, shape in s["maps"].items()
    )
    _table(console, "maps", ["map"], ["size", "entropy (bit)"], maps)
    numbers = ((k, f"{v:.6g}") for k, v in {**s["parameters"], **s["derived"]}.items())
    _table(console, "parameters", ["key"], ["value"], numbers)
    for warning in s["warnings"]:
        console.print(Text("warning", "yellow"), warning)
