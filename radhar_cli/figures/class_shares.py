"""Shares of samples whose class is told without the movement: intervals beside chance."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from radhar_cli.figures.page import page, png_bytes

COLOURS = {  # of parts, told apart by the colour-blind, too (M. Okabe and K. Ito, 2008)
    "numbers": "#0072B2",
    "recordings": "#009E73",
    "margins": "#E69F00",
    "noise": "#CC79A7",
    "clouds": "#56B4E9",
}
WORDS = {
    "numbers": "numbers of scenes",
    "recordings": "recordings and tables",
    "margins": "margins of images",
    "noise": "noise of images",
    "clouds": "point clouds",
}
MOST_BARS = 40
MAX_NAME = 44  # characters


@dataclass(frozen=True)
class ShareBar:
    """A bar: part and name of the evidence, shares from 0 to 1."""

    part: str
    name: str
    share: float
    low: float
    high: float
    chance: float


def class_shares_png(bars: Sequence[ShareBar], title: str) -> bytes:
    """Draw a bar with its interval for each piece of evidence, and chance as a line across it.

    Args:
        bars: bars from top to bottom; those whose share is not known are left out, and so is what
            is beyond MOST_BARS, the lowest first.
        title: line above.

    Returns:
        The PNG file.
    """
    bars = _select(bars)
    figure = page(7.4, 1.5 + 0.24 * max(len(bars), 1))
    axes = figure.subplots()
    for place, bar in enumerate(bars):
        colour = COLOURS.get(bar.part, "0.5")
        axes.barh(place, 100 * bar.share, height=0.7, color=colour, alpha=0.75)
        ends = [[100 * max(0.0, bar.share - bar.low)], [100 * max(0.0, bar.high - bar.share)]]
        axes.errorbar(100 * bar.share, place, xerr=ends, color="0.15", capsize=2.5, lw=1)
        chance = 100 * bar.chance
        axes.plot([chance, chance], [place - 0.45, place + 0.45], color="black", lw=1.8)
        axes.text(101, place, f"{100 * bar.share:.1f}", va="center", clip_on=False)
    axes.set_yticks(range(len(bars)), [_shorten(bar.name) for bar in bars])
    axes.set(xlim=(0, 100), ylim=(max(len(bars), 1) - 0.4, -0.6))
    axes.set_xlabel("samples held out whose class is told, mean over classes (%)")
    axes.grid(axis="x", alpha=0.3)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_title(title, loc="left")
    parts = dict.fromkeys(bar.part for bar in bars)
    handles: list[Patch | Line2D] = [
        Patch(color=COLOURS.get(part, "0.5"), alpha=0.75, label=WORDS.get(part, part))
        for part in parts
    ]
    handles.append(Line2D([], [], color="black", lw=1.8, label="chance"))
    handles.append(Line2D([], [], color="0.15", lw=1, label="95 % interval"))
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    return png_bytes(figure)


def _select(bars: Sequence[ShareBar]) -> list[ShareBar]:
    """Bars that can be drawn, in their order; the lowest are left out where there are too many."""
    drawable = [bar for bar in bars if isfinite(bar.share)]
    highest = sorted(drawable, key=lambda bar: -bar.share)[:MOST_BARS]
    return [bar for bar in drawable if bar in highest]


def _shorten(name: str) -> str:
    """A name that fits beside the axis."""
    return name if len(name) <= MAX_NAME else f"{name[: MAX_NAME - 3]}..."
