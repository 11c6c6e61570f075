"""The motion of a scene as a file."""

from pathlib import Path

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import as_config
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.recorded.motion import FileMotion
from radhar_cli.motion.recorded.recording import MAX_FRAMES
from radhar_cli.motion.recorded.writing import bvh_text
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.single.request import activity_of, scene_of

_HIP = JOINTS.index("hip")


def sample_joints(motion: Motion, t: Float) -> Float:
    """Sample positions of the thirteen joints and of the right and left hip joint.

    Args:
        motion: motion of the thirteen joints; where it knows no hip joints they are at the hip.
        t: times [frames], s.

    Returns:
        Positions [frames, 15, 3], m.

    Raises:
        ConfigError: the motion has other joints.
    """
    if motion.names != JOINTS:
        raise ConfigError("only motions of the thirteen joints can be written as BVH")
    p = motion.positions(t)
    hips = p[:, [_HIP, _HIP]]
    if isinstance(motion, (HumanMotion, FileMotion)):
        hips = motion.hip_joints(t)
    return np.concatenate([p, hips], axis=1).transpose(2, 1, 0)


def scene_bvh(
    config: Config | str | Path,
    activity: str | Activity | None,
    *,
    index: int = 0,
    nominal: bool = False,
    rate: float = 120.0,
) -> tuple[str, int]:
    """Write the motion of one scene's main person as BVH.

    Args:
        config: the config, or its path.
        activity: slug, label or Activity; None where the config has but one.
        index: number of the sample within its class.
        nominal: whether every number is at its middle instead of drawn.
        rate: frames per second.

    Returns:
        Text of the BVH file, and its number of frames.

    Raises:
        ConfigError: unknown activity, too many frames, or a motion of other joints.
        SceneError: no scene inside the model is drawn (`on_invalid: redraw`).
    """
    config = as_config(config)
    scene = scene_of(config, activity_of(activity, config), index, nominal)
    frames = round(scene.seconds * rate) + 1
    if frames > MAX_FRAMES:
        raise ConfigError(f"{frames} frames; should be at most {MAX_FRAMES}: --rate, duration_s")
    if scene.is_empty:
        raise ConfigError(f"{scene.name}: nobody is there whose motion could be written")
    joints = sample_joints(motion_of(scene.people[0]), np.arange(frames) / rate)
    return bvh_text(joints, rate), frames
