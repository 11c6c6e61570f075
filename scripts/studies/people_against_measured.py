"""Compare how far people move, and how long, with measured maps of five activities.

    python scripts/studies/people_against_measured.py MASKS.npz [-n 24]
        [--set motion.walking.lane_m=3]

MASKS.npz: `masks` [K, 256, 32], bits of 256 x 256 Doppler-time masks, `label` into `classes`; from
"Radar signatures of human activities" (University of Glasgow, CC BY 4.0) as masked by
Hong-01/EE4675-Human-Activity-Classification-using-Radar: 5.8 GHz, 400 MHz, PRF 1 kHz, 5 s (walking
10 s), a high-pass along slow time, |STFT| (window 200, 800 bins) summed over 21 range bins, a
cell-averaging CFAR on the dB values. The same is done here with simulated people, facing the radar
at 2 to 5 m, with noise and slowly fluttering clutter.
"""

import argparse
from math import prod
from pathlib import Path

import numpy as np
from scipy.ndimage import binary_opening, uniform_filter
from scipy.signal import butter, sosfilt

from radhar_cli.activities.activity import activity_named
from radhar_cli.assembly.motion import motion_of
from radhar_cli.config import load_config
from radhar_cli.numerics.arrays import Bool, Complex
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.scene import Scene, draw_scene

ROOT = Path(__file__).resolve().parents[2]
CLASSES = {
    "walking": "walking",
    "sitting_down": "sitting_down",
    "standing_up": "standing_up",
    "picking_up": "grabbing",
    "falling": "walking_to_falling",
}
SCENES = (
    "radar={carrier_hz: 5.8e9, bandwidth_hz: 400e6, prf_hz: 1000, adc_rate_hz: 1e6, chirp_s: 1e-4}",
    "duration_s=5",
    "motion.walking.speed_mps={normal: [1.1, 0.15], min: 0.7, max: 1.5}",
    "motion.angle_deg={per_activity: {default: {uniform: [165, 195]}, S8: {choice: [0, 180]}}}",
    "motion.range_m={per_activity: {default: {uniform: [2, 4]}, S8: {uniform: [3.5, 5]}, "
    "S12: {uniform: [4.5, 6]}}}",
    "motion.cross_range_m=0",
    "motion.falling.direction=forward",
    "timing.walk_stop_s={uniform: [0.5, 1.5]}",
    "on_invalid=keep",
)
RADAR_M = np.array([0.4, 0.0, 1.0])[:, None, None]
FC, BANDWIDTH, PRF, SECONDS, BINS = 5.8e9, 400e6, 1e3, 5.0, 21
SPEEDS = (127.5 - np.arange(256)) * PRF / 256 * SPEED_OF_LIGHT / (2 * FC)
FAST, WIDE = 0.6, 0.2  # m/s: what counts as active; what is left out about zero
COLUMNS = ("active s", "width m/s", "receding", "approach m/s", "recede m/s")


def range_bins(scene: Scene, rng: np.random.Generator) -> Complex:
    """Slow time of 21 range bins about the person [21, M], with clutter and noise."""
    motion, t = motion_of(scene.people[0]), np.arange(0, SECONDS, 1 / PRF)
    p = motion.positions(t)
    r = np.sqrt(((p - RADAR_M) ** 2).sum(axis=0))
    a = np.sqrt(motion.cross_sections(t)) / r**2
    width = SPEED_OF_LIGHT / (2 * BANDWIDTH)
    at = width * (np.round(np.median(r) / width) + np.arange(BINS) - BINS // 2)
    echo = a * np.exp(-4j * np.pi * FC / SPEED_OF_LIGHT * r)
    x = sum(one * np.sinc((at[:, None] - way) / width) for one, way in zip(echo, r, strict=True))
    amplitude = np.sqrt((a * a).sum(axis=0).mean())
    noise, clutter = rng.standard_normal((2, 2, *x.shape))
    clutter = sosfilt(butter(2, (2 / PRF * 2, 2 / PRF * 6), "band", output="sos"), clutter)
    clutter *= amplitude * 10 ** (rng.uniform(-34, -22) / 20) / clutter.std()
    noise *= amplitude * 10 ** (-rng.uniform(12, 32) / 20) / 2**0.5
    result: Complex = x + (clutter + noise)[0] + 1j * (clutter + noise)[1]
    return result


def mask(x: Complex, floor_db: float) -> Bool:
    """Mask [256, 256] of range bins [21, M]: high-pass, |STFT|, CFAR on the dB values."""
    x = sosfilt(butter(4, 0.0075, "high", output="sos"), x)
    starts = np.arange(0, x.shape[1] - 199, 10)
    frames = x[:, starts[:, None] + np.arange(200)] * np.hamming(200)
    spectra = np.abs(np.fft.fft(frames, 800)).sum(axis=0).T
    db = 20 * np.log10(np.fft.fftshift(spectra, axes=0)[::-1])
    db += floor_db - np.median(db)
    inner, outer = (21, 5), (121, 25)
    total = uniform_filter(db, outer, mode="nearest") * prod(outer)
    total -= uniform_filter(db, inner, mode="nearest") * prod(inner)
    mean = total / (prod(outer) - prod(inner))
    rows, columns = (np.round(np.linspace(0, n - 1, 256)).astype(int) for n in db.shape)
    result: Bool = (db > 1.171 * mean)[rows][:, columns]
    return result


def figures(one: Bool) -> list[float]:
    """Active time, width (95 %), receding share, fastest approach and recession (97.5 %)."""
    one = binary_opening(one, np.ones((3, 3), bool)) & (np.abs(SPEEDS) < 4.5)[:, None]
    active = one[np.abs(SPEEDS) > FAST].any(axis=0).mean() * SECONDS
    cells = (one & (np.abs(SPEEDS) > WIDE)[:, None]).sum(axis=1)
    if not cells.sum():
        return [active, 0.0, 0.5, 0.0, 0.0]
    low, high = np.percentile(np.repeat(SPEEDS, cells), [2.5, 97.5])
    return [active, high - low, cells[SPEEDS < 0].sum() / cells.sum(), high, low]


def measured(path: Path) -> dict[str, list[Bool]]:
    """The masks of each class; of walking the first half, as long as the others."""
    with np.load(path, allow_pickle=False) as file:
        masks = np.unpackbits(file["masks"], axis=2).astype(bool)
        label, classes = file["label"], [str(name) for name in file["classes"]]
    result = {name: list(masks[label == classes.index(name)]) for name in CLASSES}
    result["walking"] = [np.repeat(one[:, :128], 2, axis=1) for one in result["walking"]]
    return result


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("masks", type=Path)
    parser.add_argument("-n", type=int, default=24, help="simulated recordings of each class")
    parser.add_argument("--set", action="append", default=[], dest="more")
    given = parser.parse_args()
    path = ROOT / "configs/human/free_space_77GHz.yaml"
    config = load_config(path, (*SCENES, *given.more))
    print(f"{'median':24s}", *(f"{name:>13s}" for name in COLUMNS))
    for name, maps in measured(given.masks).items():
        simulated = []
        for index in range(given.n):
            rng = np.random.default_rng([7, index])
            x = range_bins(draw_scene(config, activity_named(CLASSES[name]), index), rng)
            simulated.append(mask(x, rng.uniform(16, 24)))
        for kind, some in (("measured", maps), ("simulated", simulated)):
            middle = np.median([figures(one) for one in some], axis=0)
            print(f"{name:14s}{kind:10s}", *(f"{value:13.2f}" for value in middle))


if __name__ == "__main__":
    main()
