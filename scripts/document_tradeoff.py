"""Put results of `radhar tradeoff` into docs/results/tradeoff.md, and draw docs/images/tradeoff.

    python scripts/document_tradeoff.py OUT [OUT ...]

Each OUT is a folder that the command wrote; its part of the page is the one between the markers
`<!-- begin NAME -->` and `<!-- end NAME -->`, NAME being the title of its tradeoff.md. The figure
has time against error of every setting of the engine, and what is missed without the physics that
is off by default.
"""

import argparse
import json
import re
from math import log2
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt

from radhar_cli.tradeoff.report import TEXT

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = DOCS / "results/tradeoff.md"


def part(out: Path) -> tuple[str, str]:
    """Name of a result, and its text one heading lower, with the figure under its first line."""
    text = (out / TEXT).read_text().replace(str(out.parent), "out")
    heading, _, rest = text.partition("\n")
    name = heading.rpartition(": ")[2]
    picture = f"\n![time against error](../images/tradeoff/{name}.png)\n"
    return name, re.sub(r"^#", "##", f"{heading}\n{picture}{rest}", flags=re.MULTILINE)


def draw(settings: list[dict[str, Any]], title: str, path: Path) -> None:
    """Write the figure of one result."""
    figure, (engine, missed) = plt.subplots(1, 2, figsize=(12, 4.6), layout="constrained")
    tried = [one for one in settings if one["group"] != "switch"]
    exact = min(one["signal_error_db"] for one in tried if not one["exact"]) - 15
    named: dict[tuple[int, int], list[str]] = {}  # settings by error, and octave of time
    right: dict[tuple[int, int], float] = {}
    for one in sorted(tried, key=lambda one: float(one["time_ratio"])):
        place = one["time_ratio"], exact if one["exact"] else one["signal_error_db"]
        engine.plot(*place, "C3D" if one["default"] else "C0o")
        near = round(place[1]), round(log2(place[0]))
        names = named.setdefault(near, [])
        names.append(one["setting"] + ", exact" * one["exact"])
        right[near] = place[0]
    for near, names in named.items():
        place = right[near], near[0]
        engine.annotate("; ".join(names), place, (-3, 7), textcoords="offset points", fontsize=8)
    engine.margins(y=0.12)
    engine.set(xscale="log", xlabel="time of a sample, relative to the default")
    engine.set(ylabel="error of the slow-time signal (dB), worst scene")
    engine.set_xticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
    engine.set_xlim(0.8, 120)
    engine.minorticks_off()
    engine.grid(alpha=0.3)
    engine.invert_yaxis()
    seen = [one for one in settings if one["group"] == "switch" and _missed(one)]
    for row, one in enumerate(seen):
        most = one["signal_error_median_db"]
        missed.barh(row, most + 100, left=-100, color="C1")
        missed.text(
            -98,
            row,
            f"{most:.0f} dB, {one['time_ratio']:.3g} times {one['time_over']}",
            va="center",
            fontsize=8,
        )
    missed.set_yticks(range(len(seen)), [one["setting"] for one in seen], fontsize=8)
    missed.set(xlabel="what is missed without it (dB of the signal), median", xlim=(-100, 20))
    figure.suptitle(title)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def _missed(one: dict[str, Any]) -> bool:
    """Whether it changes the signal itself, and by more than the engine's own error."""
    error = one["signal_error_median_db"]
    return error is not None and error > -80


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("out", type=Path, nargs="+")
    matplotlib.use("Agg")
    page = PAGE.read_text()
    for out in parser.parse_args().out:
        name, text = part(out)
        begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
        head, _, rest = page.partition(begin)
        _, found, tail = rest.partition(end)
        if not found:
            parser.error(f"{PAGE}: has no markers for {name}")
        page = f"{head}{begin}\n\n{text}\n{end}{tail}"
        result = json.loads((out / "tradeoff.json").read_text())
        draw(result["settings"], name, DOCS / f"images/tradeoff/{name}.png")
    PAGE.write_text(page)


if __name__ == "__main__":
    main()
