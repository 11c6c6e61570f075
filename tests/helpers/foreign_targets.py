"""Point targets in slow time, range profiles and beats, and a script, as others keep them."""

import numpy as np

C = 299792458.0
RATE = 1000.0  # of slow time, Hz


def tone(pulses=400, hz=161.0):
    """Slow time of somebody who approaches."""
    return np.exp(2j * np.pi * hz * np.arange(pulses) / RATE).astype(np.complex64)


def profiles(kind=complex, bins=182, pulses=640):
    """[pulse, bin] of one at rest at 2 m and one who comes from 4 m at 1 m/s, seen at 7.29 GHz."""
    ranges, rng = 0.3 + 0.05144 * np.arange(bins), np.random.default_rng(1)
    x = 0.003 * (rng.standard_normal((pulses, bins)) + 1j * rng.standard_normal((pulses, bins)))
    for n in range(pulses):
        for r, a in ((4 - n / 256, 1.0), (2.0, 3.0)):
            x[n] += a * np.exp(-((ranges - r) ** 2) / 0.01 - 4j * np.pi * 7.29e9 * r / C)
    return (x if kind is complex else x.real).astype("c8" if kind is complex else "f4")


def frame(index, range_m, samples=64, pulses=32):
    """A frame [sample, pulse] of TI's sign: one at rest at 2 m, another who approaches."""
    slope, n = 1.28e9 / (samples / 3e6), np.arange(samples)[:, None] / 3e6
    t = index * 0.1 + np.arange(pulses) / 5555.6
    x = 0.0
    for r, a in ((np.full(pulses, 2.0), 3.0), (range_m - t, 1.0)):
        x = x + a * np.exp(4j * np.pi / C * r * (77e9 + slope * n))
    return x.astype(np.complex64)


LUA = """
--[[ a comment
ar1.ProfileConfig(9) ]]
SAMPLES = 256
ar1.ChanNAdcConfig(1, 0, 0, 1, 1, 0, 0, 2, 1, 0)
ar1.LVDSLaneConfig(0, 1, 1, 0, 0, 1, 0, 0)
if (ar1.ProfileConfig(0, 77, 100, 6, 60, 0, 0, 0, 0, 0, 0, 29.982, 0, SAMPLES, 10000, 0, 0,
                      30) == 0) then
end
ar1.ChirpConfig(0, 0, 0, 0, 0, 0, 0, 1, 0, 0)
ar1.FrameConfig(0, 0, 4, 128, 40, 0, 0, 1)
"""
