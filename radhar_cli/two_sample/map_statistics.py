"""What a radar engineer looks at in a Doppler-time map, in numbers."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation, find_objects, label, median_filter, uniform_filter

from radhar_cli.arrays import Bool, Float

TALL = 0.04  # of all rows: a piece apart from the zero line that is as tall belongs to the body
JOINED = 2  # cells between two pieces that are one
SHORT = 0.02  # of the energy: rows may lack so much below the floor, where it is not white
SLOW = 1.8  # times the torso: limbs are faster
EIGHT = np.ones((3, 3), bool)  # neighbours of a cell


class Statistic(NamedTuple):
    """What a statistic is called in tables."""

    words: str  # for people
    unit: str  # "%", "dB", "" of a number, "rows" (the unit of rows), "columns" (of columns)
    of_power: bool = False  # whether it needs power, not occupied cells alone


STATISTICS = {
    "occupied": Statistic("occupied cells", "%"),
    "receding": Statistic("cells that recede", "%"),
    "width": Statistic("width of 95 % of the cells", "rows"),
    "upper_envelope": Statistic("upper envelope, 95 %", "rows"),
    "lower_envelope": Statistic("lower envelope, 5 %", "rows"),
    "swings": Statistic("changes of direction", ""),
    "active": Statistic("time active", "columns"),
    "first": Statistic("quiet at the start", "columns"),
    "start_height": Statistic("height of the first column", "rows"),
    "zero_line": Statistic("columns with a zero line", "%"),
    "zero_line_offset": Statistic("middle of the zero line", "rows"),
    "stray": Statistic("stray cells", "%"),
    "peak_over_floor": Statistic("peak over floor", "dB", True),
    "noise_sd": Statistic("sd of the noise", "dB", True),
    "limb_below_torso": Statistic("limb below torso", "dB", True),
    "fast_energy": Statistic("energy above 1.8 x torso", "%", True),
    "receding_energy": Statistic("receding energy", "%", True),
    "torso_energy": Statistic("energy near the torso line", "%", True),
    "torso_ripple": Statistic("ripple of the torso line", "rows", True),
    "torso_median": Statistic("Doppler of the torso", "rows", True),
}


class DopplerMap(NamedTuple):
    """Power [rows, columns] over Doppler [rows], Hz or m/s, descending."""

    power: Float
    doppler: Float

    def noise(self, beyond: float) -> Float:
        """Cells [some rows, columns] faster than `beyond`, where nobody is taken to be."""
        return self.power[np.abs(self.doppler) > beyond]

    def threshold(self, beyond: float) -> float:
        """Power above the noise: its mean and 5 deviations."""
        noise = self.noise(beyond)
        return float(max(2 * np.median(noise), noise.mean() + 5 * noise.std()))

    def occupied(self, beyond: float) -> Bool:
        """Cells [rows, columns] above the noise, in the mean of 3 x 3."""
        return np.asarray(uniform_filter(self.power, 3) > self.threshold(beyond))


def power_statistics(
    one: DopplerMap, zero: float, beyond: float, near: float, body: bool = True
) -> dict[str, float]:
    """Statistics of power, under the names of `STATISTICS`.

    Of energy above the noise, the line at zero left out. The torso is where the mean of five rows
    is largest, smoothed, a limb the 75th percentile of the largest power of each column beyond 1.8
    times its Doppler; ripple is 5 to 95 % of the torso's line. What noise leaves undefined is
    NaN: shares of an energy of which more than 2 % is missing in rows below the floor (after a
    canceller noise is weaker near zero), a limb that does not stand out.

    Args:
        zero: half the width of the line of zero Doppler.
        beyond: above that Doppler there is noise alone.
        near: half the width of the torso's line.
        body: whether anybody moves; else what is said of torso and limbs is NaN, not noise's.
    """
    doppler, noise = one.doppler[:, None], one.noise(beyond)
    floor, still = float(noise.mean()), np.abs(doppler) <= zero
    clean = np.where(still, 0, one.power - floor)  # noise adds up to 0
    moving = uniform_filter(np.where(still, 0, one.power), (5, 1))
    torso = median_filter(one.doppler[moving.argmax(axis=0)], 9)
    fast = doppler * np.sign(torso) > SLOW * np.abs(torso)
    total, below = clean.sum(), -np.minimum(clean.sum(axis=1), 0).sum()
    known = total > 0 and below <= SHORT * total

    def share(cells: Float) -> float:
        return float(np.clip(100 * cells.sum() / total, 0, 100)) if known else np.nan

    limb = float(np.percentile(np.where(fast, clean, 0).max(axis=0), 75))
    limb = limb if limb + floor > one.threshold(beyond) else np.nan
    low, high = np.percentile(torso, [5, 95])
    values = {
        "limb_below_torso": decibel(float(np.median(clean.max(axis=0))), limb),
        "fast_energy": share(clean[fast]),
        "receding_energy": share(clean[one.doppler < -zero]),
        "torso_energy": share(clean[np.abs(doppler - torso) <= near]),
        "torso_ripple": float(high - low),
        "torso_median": float(np.median(torso)),
    }
    return (values if body else dict.fromkeys(values, np.nan)) | {
        "peak_over_floor": decibel(float(clean.max()), floor),
        "noise_sd": float(np.std(10 * np.log10(np.maximum(noise, 1e-30)))),
    }


def decibel(above: float, below: float) -> float:
    """10 lg of a ratio of powers, NaN where one is not above 0."""
    return 10 * float(np.log10(above / below)) if min(above, below) > 0 else np.nan


def select_body_cells(occupied: Bool, at_zero: Bool) -> Bool:
    """Cells [rows, columns] of who moves: pieces that touch the rows `at_zero` or are tall.

    The others are stray: lines of interference, single cells of noise.
    """
    pieces, _ = label(binary_dilation(occupied, EIGHT, iterations=JOINED), EIGHT)
    kept = np.zeros(pieces.max(initial=0) + 1, bool)
    kept[pieces[at_zero]] = True
    for number, place in enumerate(find_objects(pieces), 1):
        kept[number] |= place[0].stop - place[0].start - 2 * JOINED >= TALL * len(occupied)
    kept[0] = False
    return np.asarray(kept[pieces] & occupied)


def mask_statistics(
    occupied: Bool, doppler: Float, seconds: float, zero: float
) -> dict[str, float]:
    """Statistics of which cells of a map are occupied, under the names of `STATISTICS`.

    Of the body (`body_of`) beyond `zero` of zero Doppler; NaN where there is nothing to measure.
    A column is active where it has any such cell.

    Args:
        occupied: [rows, columns].
        doppler: of the rows, descending, Hz; or range, m; or in rows.
        seconds: that the columns last; or their number.
        zero: half the width of the line at zero, in the unit of `doppler`; below 0 for none.
    """
    rows, columns = occupied.shape
    row, column = abs(doppler[0] - doppler[-1]) / max(1, rows - 1), seconds / columns
    at_zero = np.abs(doppler) <= zero
    body = select_body_cells(occupied, at_zero)
    beyond = body & ~at_zero[:, None]
    cells, counts = max(1, (~at_zero).sum() * columns), beyond.sum(axis=0)
    active = counts > 0
    line: Bool = np.asarray(body[np.abs(doppler) <= zero / 2].any(axis=0))
    quiet = body[:, line & ~active]
    values = {key: np.nan for key, one in STATISTICS.items() if not one.of_power} | {
        "occupied": 100 * float(beyond.sum() / cells),
        "stray": 100 * float((occupied & ~body).sum() / cells),
        "active": float(active.sum() * column),
        "start_height": float(body[:, 0].sum() * row),
        "zero_line": 100 * float(line.mean()),
    }
    if quiet.size:
        values["zero_line_offset"] = float((doppler @ quiet).sum() / quiet.sum())
    if not active.any():
        return values
    whole = np.repeat(doppler, beyond.sum(axis=1))
    low, high = np.percentile(whole, [2.5, 97.5])
    shown = body[:, active]
    top, bottom = shown.argmax(axis=0), rows - 1 - shown[::-1].argmax(axis=0)
    sign = np.sign((doppler @ beyond)[active])
    return values | {
        "receding": 100 * float((whole < 0).mean()),
        "width": float(high - low),
        "upper_envelope": float(np.percentile(doppler[top], 95)),
        "lower_envelope": float(np.percentile(doppler[bottom], 5)),
        "first": float(active.argmax() * column),
        "swings": float((np.diff(sign[sign != 0]) != 0).sum()),
    }
