"""What frame rate, noise and low-pass of a motion file do to micro-Doppler: the table of its docs.

A known walk (`motion.model: human`, nominal, 1.2 m/s towards a radar of 77 GHz) is sampled as a
motion capture would, with white noise on every coordinate, and comes back through the reader:

    python scripts/measure_motion_files.py

Columns: rms error of the ankle's radial velocity; power of the map beyond the walk's own fastest
joint (and 0.3 m/s), below its largest pixel at that time, median over time and draws.
"""

import argparse
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from radhar_cli.activity import activity_named
from radhar_cli.arrays import Float
from radhar_cli.config import Config
from radhar_cli.motion.files.clip import clip_of
from radhar_cli.motion.files.motion import FileMotion
from radhar_cli.motion.files.names import WANTED
from radhar_cli.motion.files.npz import Npz
from radhar_cli.motion.protocol import Motion
from radhar_cli.pipeline.physics import motion_of
from radhar_cli.pipeline.run import record
from radhar_cli.scene import Scene, nominal_scene
from radhar_cli.simulation.motion_file import sampled

SECONDS, LEAD = 2.0, 0.5  # of the recording; of the file before and after it
HALF_WAVE = 299_792_458.0 / 77e9 / 2
CONFIG = {
    "duration_s": SECONDS,
    "radar": {"carrier_hz": 77e9, "bandwidth_hz": 1e9, "prf_hz": 8000},
    "subject": {"height_m": 1.75, "chest_m": 0, "heart_m": 0},
    "motion": {"range_m": 5, "angle_deg": 180, "speed_mps": 1.2},
    "snr_db": None,
    "processing": {"window_fraction": 0.03},
}
ANKLE = 10
RATES, NOISES, LOW_PASSES = (30.0, 60.0, 120.0), (0.0, 0.5, 1.0, 10.0), (None, 8.0, 6.0, 3.0)


class Linear(FileMotion):
    """Straight lines between frames, to see what splines are for."""

    @property
    def _spline(self):  # type: ignore[no-untyped-def]
        t, p = np.arange(len(self.clip.positions)) / self.clip.rate, self.clip.positions
        first, last = (p[min(round(at * self.clip.rate), len(p) - 1)] for at in (LEAD, LEAD + 2))
        return make_interp_spline(t, self._placed(p, first, last).reshape(len(p), -1), k=1)


@dataclass(frozen=True)
class Walk:
    """The known walk, seen from where it begins after LEAD seconds."""

    scene: Scene
    whole: Motion

    def radial_velocity(self, motion: Motion, lead: float) -> Float:
        """Of the ankle, m/s."""
        t = np.arange(0.1, SECONDS - 0.1, 1e-3) + lead
        p = motion.positions(t)[:, ANKLE]
        range_ = np.linalg.norm(p - np.array([[0.4], [0.0], [1.5]]), axis=0)
        velocity: Float = np.gradient(range_, 1e-3)
        return velocity


def walk() -> Walk:
    config = Config.model_validate(CONFIG)
    scene = nominal_scene(config, activity_named("walking"))
    return Walk(scene, motion_of(scene.people[0]))


def from_file(known: Walk, rate: float, noise_mm: float, low_pass: float | None, draw: int,
              kind: type[FileMotion] = FileMotion) -> FileMotion:  # fmt: skip
    """The walk as it comes back from a file: of the same size, at the same place."""
    t = np.arange(round((SECONDS + 2 * LEAD) * rate) + 1) / rate - LEAD
    p = sampled(known.whole, t)
    rng = np.random.default_rng(draw)
    p = p + 1e-3 * noise_mm * rng.standard_normal(p.shape)
    clip = clip_of(Npz("walk", WANTED, rate, p), low_pass=low_pass, up="z")
    true = known.whole.positions(np.zeros(1))[:, [10, 12], 0].mean(axis=1)
    return kind(
        clip, clip.stature, 80.0, (true[0], true[1]), np.pi, SECONDS, begin=LEAD, end=clip.seconds
    )


def beyond_db(known: Walk, motion: Motion) -> float:
    """Power beyond the walk's own fastest joint, dB below the largest of the column."""
    power_map = record(known.scene, ["stft"], motions=(motion,))["stft"]
    speed = -power_map.rows.values * HALF_WAVE  # receding
    t = power_map.columns.values
    step = 1e-4
    ranges = [
        np.linalg.norm(
            known.whole.positions(t + d) - np.array([0.4, 0, 1.5])[:, None, None], axis=0
        )
        for d in (-step, step)
    ]
    velocity = (ranges[1] - ranges[0]) / (2 * step)
    low, high = velocity.min(axis=0) - 0.3, velocity.max(axis=0) + 0.3
    outside = (speed[:, None] < low) | (speed[:, None] > high)
    largest = np.where(outside, power_map.power, 0).max(axis=0)
    return float(10 * np.log10(np.median(largest / power_map.power.max(axis=0))))


def row(known: Walk, rate: float, noise: float, low_pass: float | None, draws: int,
        kind: type[FileMotion] = FileMotion) -> tuple[float, float]:  # fmt: skip
    errors, powers = [], []
    right = known.radial_velocity(known.whole, 0.0)
    for draw in range(draws if noise else 1):
        motion = from_file(known, rate, noise, low_pass, draw, kind)
        errors.append(np.mean((known.radial_velocity(motion, 0.0) - right) ** 2))
        powers.append(beyond_db(known, motion))
    return float(np.sqrt(np.mean(errors))), float(np.median(powers))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--draws", type=int, default=3, help="Of the noise.")
    draws, known = parser.parse_args().draws, walk()
    print(f"| noise, mm | low-pass | {' | '.join(f'{rate:g} Hz' for rate in RATES)} |")
    print("| ---: | --- |" + " --- |" * len(RATES))
    for noise in NOISES:
        for low_pass in LOW_PASSES:
            cells = [row(known, rate, noise, low_pass, draws) for rate in RATES]
            name = "none" if low_pass is None else f"{low_pass:g} Hz"
            print(f"| {noise:g} | {name} | {' | '.join(f'{v:.3f}, {db:.0f}' for v, db in cells)} |")
    cells = [row(known, rate, 0.0, None, 1, Linear) for rate in RATES]
    print(f"| 0 | none, linear | {' | '.join(f'{v:.3f}, {db:.0f}' for v, db in cells)} |")
    itself = beyond_db(known, known.whole)
    print(f"\nthe walk itself: {itself:.0f} dB")


if __name__ == "__main__":
    main()
