"""Beat samples of moving points by mmwrt, run by a Python that has it, for bench_peers.py.

    python mmwrt_beat.py GIVEN.npz MADE.npz

GIVEN holds `radar` (carrier, slope, chirp, ADC rate, PRF, speed of light), `start` and `speed`
[point, axis, chirp], `count` of chirps, `tx` and `rx`; MADE `beat` [sample, chirp] and `seconds`.
"""

import sys
from collections.abc import Callable
from time import process_time

import numpy as np


def coordinate(start: np.ndarray, speed: np.ndarray, prf: float) -> Callable[..., np.ndarray]:
    """One coordinate of a point that moves evenly within each chirp, as a function of time."""

    def at(t: np.ndarray) -> np.ndarray:
        t = np.asarray(t, float)
        chirp = np.minimum((t * prf + 1e-6).astype(int), start.size - 1)
        return start[chirp] + speed[chirp] * (t - chirp / prf)

    return at


def main(given_path: str, made_path: str) -> None:
    from mmWrt.Raytracing import rt_points
    from mmWrt.Scene import Antenna, Medium, Radar, Receiver, Scatterer, Transmitter

    given = np.load(given_path)
    fc, slope, chirp, rate, prf, c = map(float, given["radar"])
    count = int(given["count"])
    scatterers = []
    for start, speed in zip(given["start"], given["speed"], strict=True):
        axes = (coordinate(*axis, prf) for axis in zip(start, speed, strict=True))
        scatterers.append(Scatterer(**dict(zip(("xt", "yt", "zt"), axes, strict=True))))
    tx, rx = (Antenna(*map(float, given[end])) for end in ("tx", "rx"))
    transmitter = Transmitter(
        chirp_start_freq=fc,
        chirp_slope=slope,
        chirp_end_time=chirp,
        antennas=[tx],
        chirp_period=1 / prf,
        chirp_count=count,
        frame_period=2 * count / prf,
    )
    samples = round(chirp * rate)
    receiver = Receiver(adc_sample_rate=rate, antennas=[rx], adc_sample_count=samples)
    medium = Medium()
    medium.v = c  # it insists on 3e8 when it is made
    radar = Radar(transmitter, receiver, medium)
    begun = process_time()
    cube = rt_points([radar], scatterers, radar, datatype=complex, compute=True)["adc_cube"]
    seconds = process_time() - begun
    np.savez(made_path, beat=cube[0, :, 0].T, seconds=seconds)


if __name__ == "__main__":
    main(*sys.argv[1:])
