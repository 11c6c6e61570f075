"""How well the torso is found in simulated recordings: the table of docs/measured.md.

    python scripts/track_errors.py [--seeds 2]

For each scenario, motion model, activity and SNR the raw echo is simulated, static returns
included, and the track that `radhar process` finds is compared with the true range of the torso
(delay times c/2, the wall's included). Printed as Markdown: rms error in range and, in brackets, in
radial velocity, the mean confidence, and in how many seeds no torso was found.
"""

import argparse
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.capture.tracking import track_torso, without_static
from radhar_cli.config import load_config
from radhar_cli.pipeline.motion_paths import point_delay
from radhar_cli.processing.pulse_times import PulseTimes
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.simulation.simulate import simulate

RADAR = ["radar.bandwidth_hz=1e9", "radar.adc_rate_hz=2.5e6", "engine.kind=cube", "duration_s=4"]
SCENARIOS = {
    "free space, 77 GHz": ("configs/paper/free_space.yaml", [*RADAR, "radar.prf_hz=2000"]),
    "wall, 10 GHz": ("configs/paper/through_wall.yaml", RADAR),
}
ACTIVITIES = ("walking", "walking_to_falling", "sitting_down", "grabbing", "punching", "stationary")
SNR_DB = (30, 10, 0, -10, -20)
SKIPPED_S = 0.1  # at both ends, where windows are not whole


def errors(config: str, overrides: list[str], activity: str, seed: int) -> Float:
    """(rms error of range, of velocity, mean confidence), NaN where no torso was found."""
    scene = simulate(load_config(config, overrides), activity, seed, maps=("stft",), raw=True)
    assert scene.beat is not None
    w = scene.waveform
    segments = PulseTimes(np.zeros(1), np.zeros(1, np.int64), w.n_pulses, w.prf)
    bins = range_compression(scene.beat, replace(w, centred=False))
    track = track_torso(without_static(bins[None]), segments, w)
    if track is None:
        return np.full(3, np.nan)
    t = np.arange(SKIPPED_S, w.duration - SKIPPED_S, 0.01)
    delay = point_delay(scene.motion.torso(t), scene.antennas, scene.wall)[0]
    off = track.ranges(t) - delay * SPEED_OF_LIGHT / 2
    speed = np.diff(off) / 0.01
    return np.array([np.sqrt(np.mean(off**2)), np.sqrt(np.mean(speed**2)), track.confidence.mean()])


def table(seeds: int) -> Iterator[str]:
    """Lines of Markdown."""
    yield "| scenario, motion | activity | " + " | ".join(f"{snr} dB" for snr in SNR_DB) + " |"
    yield "| --- " * (2 + len(SNR_DB)) + "|"
    for scenario, (config, radar) in SCENARIOS.items():
        for model in ("human", "paper"):
            for activity in ACTIVITIES:
                cells = []
                for snr in SNR_DB:
                    given = [*radar, f"motion.model={model}", f"snr_db={snr}"]
                    rows = np.array([errors(config, given, activity, s + 1) for s in range(seeds)])
                    cells.append(_cell(rows))
                yield f"| {scenario}, {model} | {activity} | " + " | ".join(cells) + " |"


def _cell(rows: Float) -> str:
    none = int(np.isnan(rows[:, 0]).sum())
    if none == len(rows):
        return "none found"
    far, fast, sure = np.nanmean(rows, axis=0)
    return f"{far:.2f} m ({fast:.2f} m/s), {sure:.2f}" + (f"; none in {none}" if none else "")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=2)
    for line in table(parser.parse_args().seeds):
        print(line, flush=True)


if __name__ == "__main__":
    main()
