"""A summary as tables on the terminal."""

from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from radhar_cli.untrusted import shown

BARS, ASCII_BARS = " ▁▂▃▄▅▆▇█", " .:-=+*%#"
MAX_SIZES = 5


def print_summary(summary: dict[str, Any]) -> None:
    """Print what `dataset.summary.summarise` found."""
    console = Console(highlight=False, markup=False, emoji=False)
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
    console.print(f"seed {s['seed']}   config {s['config_hash'][:12]}   " + _versions(s))
    samples = _table("samples", "class")
    for part in ("train", "validation", "test"):
        samples.add_column(part, justify="right")
    for slug, parts in s["classes"].items():
        samples.add_row(slug, *map(str, parts.values()))
    console.print(samples)
    for number, (name, shape) in enumerate(s["maps"].items(), 1):
        console.print(f"map {number}   {name}, {shape[0]} x {shape[1]} px")
    entropy = _table("mean entropy of the power maps (bit)", "class")
    for number in range(1, 1 + len(s["maps"])):
        entropy.add_column(f"{number}", justify="right", no_wrap=True)
    for slug in s["classes"]:
        means = (f"{values[slug]['mean']:.1f}" for values in s["entropy_bits"].values())
        entropy.add_row(slug, *means)
    console.print(entropy)
    if s["drawn"]:
        drawn = _table("drawn parameters", "parameter", "unit")
        for column in ("min", "mean", "max", "samples", "histogram"):
            drawn.add_column(column, justify="right", no_wrap=True)
        for name, h in s["drawn"].items():
            numbers = [f"{h[key]:.4g}" for key in ("min", "mean", "max")]
            drawn.add_row(
                name,
                h["unit"],
                *numbers,
                str(h["samples"]),
                _bars(h["counts"], _bar_signs(console)),
            )
        console.print(drawn)
    for warning in s["warnings"]:
        console.print(Text("warning", "yellow"), warning["message"])


def _recording(console: Console, s: dict[str, Any]) -> None:
    console.print(
        Text(s["path"], "bold"),
        f" {s['duration_s']:.4g} s in {s['segments']} stretch{'es' * (s['segments'] > 1)}, "
        f"{s['bytes'] / 2**20:.1f} MiB",
    )
    table = _table("recording", "key")
    table.add_column("value", justify="right")
    for key, value in s.items():
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            table.add_row(key, f"{value:.6g}" if isinstance(value, float) else str(value))
    console.print(table)
    for one in s["labels"]:
        console.print(f"label {one['label']}, person {one['person'] or 'not given'}")
    for line in s["source"]["found"]:
        console.print(Text("found", "yellow"), line)


def _table(title: str, *names: str) -> Table:
    """An empty table that nine maps and long names leave narrower than 80 characters."""
    table = Table(title=title, box=box.SIMPLE_HEAD, pad_edge=False)
    for name in names:
        table.add_column(name, overflow="fold")
    return table


def _tree(console: Console, s: dict[str, Any]) -> None:
    console.print(
        Text(s["path"], "bold"),
        f" {s['samples']} images of {len(s['classes'])} classes, {s['bytes'] / 2**20:.1f} MiB",
    )
    sizes = [f"{one['images']} of {one['size'][0]} x {one['size'][1]} px" for one in s["sizes"]]
    more = f", and {len(sizes) - MAX_SIZES} more sizes" if len(sizes) > MAX_SIZES else ""
    console.print(f"sizes {', '.join(sizes[:MAX_SIZES])}{more}")
    table = _table("images by class", "class")
    for part in next(iter(s["classes"].values())):
        table.add_column(part, justify="right")
    for name, counts in s["classes"].items():
        table.add_row(Text(name), *map(str, counts.values()))
    console.print(table)


def _versions(s: dict[str, Any]) -> str:
    return ", ".join(f"{library} {version}" for library, version in s["versions"].items())


def _bar_signs(console: Console) -> str:
    return BARS if console.encoding.startswith("utf") else ASCII_BARS


def _bars(counts: list[int], signs: str) -> str:
    largest = max(counts)
    return "".join(signs[-(-count * (len(signs) - 1) // largest)] for count in counts)


def _unfinished(console: Console, s: dict[str, Any]) -> None:
    share = s["finished"] / s["samples"]
    console.print(
        Text(s["path"], "bold"), f" unfinished: {s['finished']} of {s['samples']} samples"
    )
    progress = _progress(share, _bar_signs(console))
    console.print(f"{progress} {share:.0%}   seed {s['seed']}   config {s['config_hash'][:12]}")
    console.print("the same `radhar generate` command resumes")


def _progress(share: float, signs: str, width: int = 40) -> str:
    return (signs[-1] * int(share * width)).ljust(width, signs[1])


def _scene(console: Console, s: dict[str, Any]) -> None:
    joint = f", {s['joint']} alone" if s["joint"] else ""
    console.print(
        Text(s["path"], "bold"),
        f" {s['activity']['label']} {s['activity']['slug']}"
        f"{joint}, {s['engine']} engine, seed {s['seed']}",
    )
    table = _table("maps", "map")
    for column in ("size", "entropy (bit)"):
        table.add_column(column, justify="right")
    for name, shape in s["maps"].items():
        table.add_row(name, f"{shape[0]} x {shape[1]}", f"{s['entropy_bits'][name]:.2f}")
    console.print(table)
    parameters = _table("parameters", "key")
    parameters.add_column("value", justify="right")
    for key, value in {**s["parameters"], **s["derived"]}.items():
        parameters.add_row(key, f"{value:.6g}")
    console.print(parameters)
    for warning in s["warnings"]:
        console.print(Text("warning", "yellow"), warning)
