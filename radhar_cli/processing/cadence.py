"""Cadence-velocity diagrams: how often each Doppler of a Doppler-time map comes back.

Source: M. Otero, "Application of a continuous wave radar for human gait recognition", Proc. SPIE
5809, 2005; S. Bjorklund, H. Petersson, G. Hendeby, "Features for micro-Doppler based activity
classification", IET Radar, Sonar & Navigation 9(9), 2015.
"""

import numpy as np
import scipy.fft

from radhar_cli.errors import RadharError
from radhar_cli.processing.map_kind import MIN_CADENCE_WINDOWS
from radhar_cli.processing.power_map import Axis, PowerMap

PADDING = 4  # cadences a cell of the unpadded transform, so that peaks are seen where they are
BLOCK_COEFFICIENTS = 2**20


def cadence_map(doppler_time: PowerMap, highest_hz: float) -> PowerMap:
    """Make the cadence-velocity diagram of a Doppler-time map P[v, l].

    C[v, c] = |2/sum(w) sum_l w[l] (a[v, l] - m[v]) exp(-j 2 pi c t_l)|^2 with the amplitude
    a = sqrt(P), its mean m under a Hann window w over the whole recording: an amplitude that swings
    by +-A at the cadence c reads A^2 there, and what does not change reads 0.

    Args:
        doppler_time: Map of one column a window; windows may be missing, which then count nothing.
        highest_hz: Highest cadence of the diagram, Hz; half the windows a second bound it.

    Returns:
        The diagram [Doppler, cadence] from cadence 0 on.

    Raises:
        RadharError: the map has fewer than MIN_CADENCE_WINDOWS columns.
    """
    power, times = doppler_time.power, doppler_time.columns.values
    if times.size < MIN_CADENCE_WINDOWS:
        raise RadharError(
            f"a cadence needs a Doppler-time map of at least {MIN_CADENCE_WINDOWS} windows; it has "
            f"{times.size} (duration_s, processing.window_s, processing.overlap_fraction)"
        )
    step = float(np.median(np.diff(times)))
    places = np.rint((times - times[0]) / step).astype(int)
    count = int(places[-1]) + 1
    window = np.hanning(count + 2)[1:-1][places]
    bins = PADDING * count
    cadences = min(max(int(highest_hz * bins * step + 1e-9) + 1, 2), bins // 2 + 1)
    diagram = np.empty((len(power), cadences))
    block = max(1, BLOCK_COEFFICIENTS // bins)
    for first in range(0, len(power), block):
        rows = slice(first, first + block)
        amplitude = np.sqrt(power[rows])
        amplitude -= (amplitude @ window / window.sum())[:, None]
        weighted = np.zeros((len(amplitude), count))
        weighted[:, places] = amplitude * window
        spectrum = scipy.fft.rfft(weighted, bins, axis=1)[:, :cadences] * (2 / window.sum())
        diagram[rows] = spectrum.real**2 + spectrum.imag**2
    cadence = np.arange(cadences) / (bins * step)
    return PowerMap(diagram, doppler_time.rows, Axis("cadence", "Hz", cadence))
