"""Motion files of known motions, written by tests: no real recording is kept with the project."""

from pathlib import Path

import numpy as np

from radhar_cli.activity import activity_named
from radhar_cli.arrays import Float
from radhar_cli.config import Config
from radhar_cli.motion.files.names import WANTED
from radhar_cli.motion.files.writing import bvh_text
from radhar_cli.pipeline.physics import motion_of
from radhar_cli.scene import nominal_scene
from radhar_cli.simulation.motion_file import sampled


def frames(activity: str = "walking", seconds: float = 3.0, rate: float = 120.0) -> Float:
    """Positions [frames, 15, 3] (m) of a nominal person of 1.75 m whose links are stiff."""
    config = Config.model_validate(
        {
            "duration_s": seconds,
            "subject": {"height_m": 1.75, "chest_m": 0, "heart_m": 0},
            "motion": {"range_m": 2, "angle_deg": 0},
        }
    )
    motion = motion_of(nominal_scene(config, activity_named(activity)).people[0])
    return sampled(motion, np.arange(round(seconds * rate) + 1) / rate)


def write_bvh(path: Path, positions: Float, rate: float = 120.0) -> Path:
    """Write a BVH file by our own writer."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(bvh_text(positions, rate))
    return path


def write_npz(path: Path, positions: Float, rate: float = 120.0, names: object = WANTED) -> Path:
    """Write positions as they are."""
    np.savez(path, names=np.array(names), positions=positions, rate=rate)
    return path
