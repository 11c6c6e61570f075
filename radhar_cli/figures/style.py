"""The one style of all figures: letters, colours of people and labels, and rounded numbers."""

import colorsys
from collections.abc import Sequence
from math import floor, log10
from typing import TypeAlias

from matplotlib import colormaps, rcParams

Colour: TypeAlias = str | tuple[float, float, float]

# Letters in points. Figures are 9 to 13 inches wide, and a page shows them at about 10.
SMALL = 8
rcParams.update(
    {
        "text.parse_math": False,  # a class may be called $a$
        "font.size": 9,
        "axes.titlesize": 9.5,
        "axes.labelsize": 9,
        "xtick.labelsize": SMALL,
        "ytick.labelsize": SMALL,
        "legend.fontsize": SMALL,
        "figure.titlesize": 10.5,
        "grid.alpha": 0.3,
    }
)
SIGNED = "RdBu_r"  # colours of values that have a sign: zero is white
SPEEDS = "coolwarm"  # of approaching speeds: red comes nearer, blue goes away
# Sides of a body, told apart by the colour-blind, and neither red nor blue.
RIGHT, LEFT, MIDDLE = "#00875a", "#e08a00", "0.25"
RADAR = "#d62728"
_GREY = 7  # place of grey in Matplotlib's table of ten


def joint_colours(names: Sequence[str]) -> list[str]:
    """Colour of the bone that ends at each joint: right, left or middle, by the joint's name."""
    sides = {"right": RIGHT, "left": LEFT}
    return [sides.get(name.partition("_")[0], MIDDLE) for name in names]


def distinct_colours(count: int) -> list[Colour]:
    """Colours that are told apart, none of them grey: 18 of a table, then hues that are far apart.

    Args:
        count: Number of colours.
    """
    places = [n for n in range(10) if n != _GREY]
    table = [colormaps["tab20"](2 * n + light)[:3] for light in (0, 1) for n in places]
    golden = 0.618034
    hues = [colorsys.hsv_to_rgb(golden * n % 1, 0.85, 0.6) for n in range(count - len(table))]
    colours: list[Colour] = [*table, *hues]
    return colours[:count]


def write_rounded(value: float, digits: int = 3) -> str:
    """Write a number with so many significant digits, without an exponent."""
    return f"{float(f'{value:.{digits}g}') + 0.0:.10g}"


def decibels_in_words(value: float) -> str:
    """Write decibels that a law may have drawn: whole ones from 10 dB on, else tenths."""
    return f"{round(value, 0 if abs(value) >= 10 else 1) + 0.0:g} dB"


def describe_band(low_hz: float, high_hz: float) -> str:
    """Describe a band, as in `77.4 to 80.3 GHz`, with the decimals that tell its ends apart."""
    low, width = low_hz / 1e9, (high_hz - low_hz) / 1e9
    decimals = max(1, 1 - floor(log10(width)))
    return f"{low:.{decimals}f} to {low + width:.{decimals}f} GHz"
