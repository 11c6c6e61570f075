"""Features of a Doppler-time map that a radar engineer looks at, in numbers."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation, find_objects, label, median_filter, uniform_filter

from radhar_cli.numerics.arrays import Bool, Float

TALL = 0.04  # of all rows: a piece apart from the zero line that is as tall belongs to the body
JOINED = 2  # cells between two pieces that are one
SHORT = 0.02  # of the energy: rows may lack so much below the floor, where it is not white
SLOW = 1.8  # times the torso: limbs are faster
EIGHT = np.ones((3, 3), bool)  # neighbours of a cell


class Statistic(NamedTuple):
    """Name and unit of a statistic."""

    words: str  # name for people
    unit: str  # "%", "dB", "" of a number, "rows" (the unit of rows), "columns" (of columns)
    of_power: bool = False  # whether it needs power, not a mask of the signal alone


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

    def noise(self, noise_above: float) -> Float:
        """Power [rows above `noise_above`, columns], where nobody is taken to be."""
        return self.power[np.abs(self.doppler) > noise_above]

    def threshold(self, noise_above: float) -> float:
        """Power above which a cell is no noise: its mean and 5 standard deviations."""
        noise = self.noise(noise_above)
        return float(max(2 * np.median(noise), noise.mean() + 5 * noise.std()))

    def signal_mask(self, noise_above: float) -> Bool:
        """Mask [rows, columns] of cells above the noise, in the mean of 3 x 3.

        Args:
            noise_above: magnitude of Doppler above which there is noise alone.
        """
        return np.asarray(uniform_filter(self.power, 3) > self.threshold(noise_above))


def power_statistics(
    doppler_map: DopplerMap, zero: float, noise_above: float, near: float, body: bool = True
) -> dict[str, float]:
    """Statistics of power, under the names of `STATISTICS`.

    They are those of the energy above the noise, the line at zero left out. The torso is where the
    mean of five rows is largest, smoothed, a limb the 75th percentile of the largest power of each
    column beyond 1.8 times its Doppler; ripple is 5 to 95 % of the torso's line. What noise leaves
    undefined is NaN: shares of an energy of which more than 2 % is missing in rows below the floor
    (after a canceller noise is weaker near zero), a limb that does not stand out.

    Args:
        doppler_map: power over Doppler.
        zero: half the width of the line of zero Doppler, in the unit of Doppler.
        noise_above: magnitude of Doppler above which there is noise alone.
        near: half the width of the torso's line.
        body: whether anybody moves; else the statistics of torso and limbs are NaN, not noise's.
    """
    doppler, noise = doppler_map.doppler[:, None], doppler_map.noise(noise_above)
    floor, at_zero = float(noise.mean()), np.abs(doppler) <= zero
    denoised = np.where(at_zero, 0, doppler_map.power - floor)  # noise adds up to 0
    moving = uniform_filter(np.where(at_zero, 0, doppler_map.power), (5, 1))
    torso = median_filter(doppler_map.doppler[moving.argmax(axis=0)], 9)
    is_limb = doppler * np.sign(torso) > SLOW * np.abs(torso)
    total, missing = denoised.sum(), -np.minimum(denoised.sum(axis=1), 0).sum()
    is_measurable = total > 0 and missing <= SHORT * total

    def share(cells: Float) -> float:
        return float(np.clip(100 * cells.sum() / total, 0, 100)) if is_measurable else np.nan

    limb = float(np.percentile(np.where(is_limb, denoised, 0).max(axis=0), 75))
    limb = limb if limb + floor > doppler_map.threshold(noise_above) else np.nan
    low, high = np.percentile(torso, [5, 95])
    values = {
        "limb_below_torso": decibel(float(np.median(denoised.max(axis=0))), limb),
        "fast_energy": share(denoised[is_limb]),
        "receding_energy": share(denoised[doppler_map.doppler < -zero]),
        "torso_energy": share(denoised[np.abs(doppler - torso) <= near]),
        "torso_ripple": float(high - low),
        "torso_median": float(np.median(torso)),
    }
    return (values if body else dict.fromkeys(values, np.nan)) | {
        "peak_over_floor": decibel(float(denoised.max()), floor),
        "noise_sd": float(np.std(10 * np.log10(np.maximum(noise, 1e-30)))),
    }


def decibel(above: float, below: float) -> float:
    """Ratio of two powers in dB, NaN where one is not above 0."""
    return 10 * float(np.log10(above / below)) if min(above, below) > 0 else np.nan


def select_body_cells(is_signal: Bool, at_zero: Bool) -> Bool:
    """Mask [rows, columns] of the body: pieces of signal that touch zero Doppler or are tall.

    The other pieces are stray: lines of interference, single cells of noise.

    Args:
        is_signal: [rows, columns].
        at_zero: [rows] whether a row lies on the line at zero.
    """
    pieces, _ = label(binary_dilation(is_signal, EIGHT, iterations=JOINED), EIGHT)
    is_body = np.zeros(pieces.max(initial=0) + 1, bool)
    is_body[pieces[at_zero]] = True
    for number, extent in enumerate(find_objects(pieces), 1):
        is_body[number] |= extent[0].stop - extent[0].start - 2 * JOINED >= TALL * len(is_signal)
    is_body[0] = False
    return np.asarray(is_body[pieces] & is_signal)


def mask_statistics(
    is_signal: Bool, doppler: Float, seconds: float, zero: float
) -> dict[str, float]:
    """Statistics of the mask of a map's signal, under the names of `STATISTICS`.

    They are those of the body (`select_body_cells`) beyond `zero` of zero Doppler; NaN where there
    is nothing to measure. A column is active where it has any such cell.

    Args:
        is_signal: [rows, columns].
        doppler: [rows] Doppler, descending, Hz; or range, m; or numbers of rows.
        seconds: duration of the columns; or their number.
        zero: half the width of the line at zero, in the unit of `doppler`; below 0 for none.
    """
    rows, columns = is_signal.shape
    row_height, column_width = abs(doppler[0] - doppler[-1]) / max(1, rows - 1), seconds / columns
    at_zero = np.abs(doppler) <= zero
    body = select_body_cells(is_signal, at_zero)
    moving = body & ~at_zero[:, None]
    moving_cells, counts = max(1, (~at_zero).sum() * columns), moving.sum(axis=0)
    is_active = counts > 0
    has_zero_line: Bool = np.asarray(body[np.abs(doppler) <= zero / 2].any(axis=0))
    quiet_columns = body[:, has_zero_line & ~is_active]
    values = {key: np.nan for key, statistic in STATISTICS.items() if not statistic.of_power} | {
        "occupied": 100 * float(moving.sum() / moving_cells),
        "stray": 100 * float((is_signal & ~body).sum() / moving_cells),
        "active": float(is_active.sum() * column_width),
        "start_height": float(body[:, 0].sum() * row_height),
        "zero_line": 100 * float(has_zero_line.mean()),
    }
    if quiet_columns.size:
        values["zero_line_offset"] = float((doppler @ quiet_columns).sum() / quiet_columns.sum())
    if not is_active.any():
        return values
    cell_doppler = np.repeat(doppler, moving.sum(axis=1))
    low, high = np.percentile(cell_doppler, [2.5, 97.5])
    active_columns = body[:, is_active]
    top, bottom = active_columns.argmax(axis=0), rows - 1 - active_columns[::-1].argmax(axis=0)
    sign = np.sign((doppler @ moving)[is_active])
    return values | {
        "receding": 100 * float((cell_doppler < 0).mean()),
        "width": float(high - low),
        "upper_envelope": float(np.percentile(doppler[top], 95)),
        "lower_envelope": float(np.percentile(doppler[bottom], 5)),
        "first": float(is_active.argmax() * column_width),
        "swings": float((np.diff(sign[sign != 0]) != 0).sum()),
    }
