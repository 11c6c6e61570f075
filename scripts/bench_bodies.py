"""What segments cost and change at each radar: `python scripts/bench_bodies.py [--rounds N]`.

A person of configs/human/free_space_77GHz.yaml, seen by radars of four carriers with 1 GHz each:
points of the segments (all, and of one segment at most), processor time of an image of the STFT
over that of the 13 points (shortest of each, interleaved), share of the cells from 0.2 to 4.5 m/s
towards the radar that are within 40 dB of the map's peak, and how far the images are from each
other (SSIM). Without noise.
"""

import argparse
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from radhar_cli.activity import activity_named
from radhar_cli.config import load_config
from radhar_cli.pipeline.bodies import segment_paths
from radhar_cli.pipeline.physics import antennas_of, motion_of, waveform_of
from radhar_cli.pipeline.run import record
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.scene import Scene, nominal_scene
from radhar_cli.tradeoff.measures import image_scores

CONFIG = Path(__file__).resolve().parents[1] / "configs" / "human" / "free_space_77GHz.yaml"
# GHz, pulses/s for at least +-7.7 m/s, and a window (s) of some 0.6 to 2 m/s in cells of Doppler.
RADARS = ((77, 8000, 0.06), (24, 2500, 0.1), (5.8, 700, 0.2), (2, 256, 0.6))
ACTIVITIES = ("walking", "punching")
BAND_MPS, DEPTH_DB = (0.2, 4.5), 40.0
WAY = ("snr_db=null", "motion.angle_deg=180", "motion.cross_range_m=0")


def scene_of(radar: tuple[float, int, float], activity: str, scatterers: str) -> Scene:
    """The person, facing the radar."""
    carrier, prf, window = radar
    more = (f"radar.carrier_hz={carrier}e9", f"radar.prf_hz={prf}", f"processing.window_s={window}")
    config = load_config(CONFIG, [*WAY, *more, f"body.scatterers={scatterers}"])
    return nominal_scene(config, activity_named(activity))


def point_counts(scene: Scene) -> list[int]:
    """Points of each segment."""
    antennas, waveform = antennas_of(scene.config), waveform_of(scene.config)
    paths = segment_paths(scene.people[0], motion_of(scene.people[0]), antennas, None, waveform)
    assert paths is not None
    return [points.share.size for points in paths.points]


def occupied(products: Any) -> float:
    """Share of the band's cells that a map fills."""
    power, doppler = products["stft"].power, products["stft"].rows.values
    speed = doppler * SPEED_OF_LIGHT / (2 * products["waveform"].f0)
    band = (speed >= BAND_MPS[0]) & (speed <= BAND_MPS[1])
    return float(np.mean(power[band] > power.max() * 10 ** (-DEPTH_DB / 10)))


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    print("| radar, window | activity | points, most of one | time | cells filled | SSIM |")
    print("|---|---|---|---|---|---|")
    for radar in RADARS:
        for activity in ACTIVITIES:
            both = [scene_of(radar, activity, kind) for kind in ("points", "segments")]
            made = [record(s, ["stft", "image:stft", "waveform"]).products for s in both]
            seconds: tuple[list[float], list[float]] = ([], [])
            for _ in range(rounds):
                for scene, spent in zip(both, seconds, strict=True):
                    start = process_time()
                    record(scene, ["image:stft"])
                    spent.append(process_time() - start)
            counts = point_counts(both[1])
            filled = " -> ".join(f"{100 * occupied(one):.0f} %" for one in made)
            ratio = min(seconds[1]) / min(seconds[0])
            one, other = (each["image:stft"].levels for each in made)
            print(
                f"| {radar[0]} GHz, {1e3 * radar[2]:g} ms | {activity} | {sum(counts)}, "
                f"{max(counts)} | x{ratio:.1f} | {filled} | "
                f"{image_scores(one, other)['ssim']:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
