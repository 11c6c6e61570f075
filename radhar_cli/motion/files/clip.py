"""A recording as the thirteen joints of a person of 1 m: scaled, upright, on the floor, smooth."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan, pi, sqrt, tan

import numpy as np

from radhar_cli.motion.files.names import HIP_JOINTS, joint_numbers
from radhar_cli.motion.files.recording import RATES, MotionRecording, motion_file_error
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float

LEG = 0.491  # thigh and shank over the stature (Winter, after Drillis and Contini)
ANKLE = 0.039  # height of the ankle over the stature
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inches": 0.0254, "CMU's 0.0564 m": 0.0254 / 0.45}
STATURES = (0.9, 2.3)  # m, of people
FASTEST = 30.0  # m/s, of any joint
MIN_FRAMES = 12  # frames
UPRIGHT = 0.8  # least cosine of the angle to the vertical that tells which way is up
MOST = 0.5  # least share of the frames in which the head is above the feet
BENT = 0.01  # least distance of knees before the line from hip to ankle, over the stature
# Two passes of an order of 2 are 3 dB down, each 1.5 dB, at 0.802 of the corner of one.
ORDER, TWO_PASSES = 2, (sqrt(2) - 1) ** 0.25

_HEAD, _ANKLES = JOINTS.index("head"), [JOINTS.index(f"{s}_ankle") for s in ("right", "left")]
_KNEES = [JOINTS.index(f"{s}_knee") for s in ("right", "left")]
_HIP = JOINTS.index("hip")
_RIGHT = [JOINTS.index("right_shoulder"), len(JOINTS)]
_LEFT = [JOINTS.index("left_shoulder"), len(JOINTS) + 1]
# Axes of a file, by which of them is up, that are ahead, to the left and up: all right-handed.
_AXES = {
    "x": ((1, 1), (2, 1), (0, 1)),
    "y": ((2, 1), (0, 1), (1, 1)),
    "z": ((0, 1), (1, 1), (2, 1)),
    "-x": ((1, 1), (2, -1), (0, -1)),
    "-y": ((2, 1), (0, -1), (1, -1)),
    "-z": ((0, 1), (1, -1), (2, -1)),
}


@dataclass(frozen=True)
class Clip:
    """The thirteen joints, then the right and left hip joint, over the frames of a file."""

    where: str  # name of the file in messages
    positions: Float  # [frames, 15, 3], over the stature; z is up, the lowest ankle at 0.039
    rate: float  # frames per second
    hip_joints: bool  # whether the file has them; else they are at the hip
    stature: float  # of the recorded person by the legs, m
    up: str = "z"  # axis of the file that points up
    mirrored: bool = False  # the file is a mirror image, or its axes are left-handed

    @property
    def seconds(self) -> float:
        """Duration from the first to the last frame, s."""
        return (len(self.positions) - 1) / self.rate


def make_clip(
    file: MotionRecording,
    joints: Mapping[str, str] | None = None,
    up: str | None = None,
    unit: float | None = None,
    rate: float | None = None,
    low_pass: float | None = 8.0,
) -> Clip:
    """Read the frames of a recording and bring them into our form.

    Args:
        file: Recording.
        joints: {our name: the file's} where names alone do not tell.
        up: Axis of the file that points up, such as "y" or "-y"; None finds it.
        unit: Length of a unit of the file, m; None finds it.
        rate: Frames per second, instead of the file's.
        low_pass: Frequency at which a Butterworth filter, run both ways, is 3 dB down, Hz; None
            leaves the frames as they are, and so do fewer than 2.5 frames a period of it.

    Raises:
        MotionFileError: Joints or the rate are missing, the person has no human size, a joint
            jumps, or nothing tells which axis points up.
    """
    numbers = joint_numbers(file, joints or {})
    has_hip_joints = all(number is not None for number in numbers[-len(HIP_JOINTS) :])
    hip = numbers[_HIP]
    hips = numbers[len(JOINTS) :] if has_hip_joints else [hip] * len(HIP_JOINTS)
    chosen = [number for number in (*numbers[: len(JOINTS)], *hips) if number is not None]
    p = file.positions(chosen)
    if len(p) < MIN_FRAMES:
        raise motion_file_error(
            file.where, f"has {len(p)} frames; should have {MIN_FRAMES} or more"
        )
    rate = rate or file.rate
    if rate is None or not RATES[0] <= rate <= RATES[1]:
        raise motion_file_error(file.where, "should have a frame rate of 1 to 10000 Hz: rate_hz")
    legs = np.linalg.norm(p[:, len(JOINTS) :] - p[:, _KNEES], axis=2)
    legs += np.linalg.norm(p[:, _KNEES] - p[:, _ANKLES], axis=2)
    units = float(np.median(legs)) / LEG  # stature in units of the file
    stature = _stature(units, unit, file.unit, file.where)
    _refuse_jumps(file, p, rate, stature / units)
    up = up or _find_up_axis(file, chosen, p)
    p = np.stack([sign * p[..., axis] for axis, sign in _AXES[up]], axis=-1)
    p = _smooth(p, rate, low_pass) / units
    p[..., 2] += ANKLE - p[:, _ANKLES, 2].min()
    mirrored = _is_mirrored(p)
    if mirrored:
        p[..., 1] *= -1
    return Clip(file.where, p, rate, has_hip_joints, stature, up, mirrored)


def _stature(units: float, unit: float | None, unit_of_file: float | None, where: str) -> float:
    """Stature of the person, m, in the unit of the config, or else the first that makes a person.

    Args:
        units: Stature in units of the file.
        unit: Length of a unit by the config, m, or None.
        unit_of_file: Length of a unit by the file, m, or None.
        where: Name of the file in messages.
    """
    low, high = STATURES
    if not 1e-9 < units < 1e9:
        raise motion_file_error(where, f"has legs of {units * LEG:.3g} units")
    if unit is not None:
        stature = units * unit
        if not low <= stature <= high:
            kind = "giant" if stature > high else "dwarf"
            raise motion_file_error(
                where,
                f"has legs of {units * LEG:.4g} units of {unit:.4g} m, those of a {kind} of "
                f"{stature:.3g} m; should be {low} to {high} m: unit_m",
            )
        return stature
    for candidate in (*([unit_of_file] if unit_of_file else []), *UNITS.values()):
        if low <= units * candidate <= high:
            return units * candidate
    raise motion_file_error(
        where,
        f"has legs of {units * LEG:.4g} units, which make a person of {low} to {high} m in none of "
        f"{', '.join(UNITS)}; unit_m should say what a unit is",
    )


def _refuse_jumps(file: MotionRecording, p: Float, rate: float, metres: float) -> None:
    """Refuse positions [frames, 15, 3] in units of `metres` with a joint faster than people are."""
    fastest = np.zeros(len(p) - 1)
    for joint in range(len(JOINTS)):
        step = np.diff(p[:, joint], axis=0)
        np.maximum(fastest, np.sqrt(np.einsum("fa,fa->f", step, step)), out=fastest)
    fast = np.flatnonzero(fastest * metres * rate > FASTEST)
    if fast.size:
        frame = int(fast[0]) + 1
        steps = np.linalg.norm(p[frame, : len(JOINTS)] - p[frame - 1, : len(JOINTS)], axis=1)
        joint = int(steps.argmax())
        raise motion_file_error(
            file.place(frame),
            f"{JOINTS[joint]} jumps {steps[joint] * metres:.3g} m from one frame to the next "
            f"({steps[joint] * metres * rate:.3g} m/s); should move {FASTEST:g} m/s at most",
        )


def _find_up_axis(file: MotionRecording, chosen: list[int], p: Float) -> str:
    """Find the axis that points up: heads are above feet in most frames, or else in the rest pose.

    The rest pose comes second, for it need not stand: in games its root is turned by every frame.
    """
    from_frames = _axis_along(p[:, _HEAD] - p[:, _ANKLES].mean(axis=1))
    if from_frames is not None:
        return from_frames
    if file.rest is not None:
        rest = file.rest[chosen]
        from_rest = _axis_along((rest[_HEAD] - rest[_ANKLES].mean(axis=0))[None])
        if from_rest is not None:
            return from_rest
    raise motion_file_error(
        file.where,
        "does not tell which axis points up, for nobody stands in it; up: y of its class would say "
        "so (--up y)",
    )


def _axis_along(vectors: Float) -> str | None:
    """Axis along which most vectors [frames, 3] lie, with its sign, if there is one."""
    sizes = np.linalg.norm(vectors, axis=1)
    for axis, name in enumerate("xyz"):
        for sign in (1, -1):
            along = sign * vectors[:, axis] > UPRIGHT * sizes
            if along.mean() > MOST:
                return ("-" if sign < 0 else "") + name
    return None


def _is_mirrored(p: Float) -> bool:
    """Whether left and right are exchanged, as in left-handed axes: knees bend backwards.

    Positions [frames, 15, 3] over the stature, z up; people who lie tell nothing.
    """
    left = (p[:, _LEFT] - p[:, _RIGHT])[..., :2].sum(axis=1)
    ahead = np.stack([left[:, 1], -left[:, 0]], axis=1)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-9)
    legs = (p[:, len(JOINTS) :] + p[:, _ANKLES]) / 2
    bend = np.einsum("fka,fa->f", (p[:, _KNEES] - legs)[..., :2], ahead) / len(_KNEES)
    upright = p[:, _HEAD, 2] - p[:, _ANKLES, 2].mean(axis=1) > UPRIGHT / 2
    return bool(upright.any() and bend[upright].mean() < -BENT)


def _smooth(p: Float, rate: float, low_pass: float | None) -> Float:
    """Zero-phase Butterworth low-pass of positions [frames, joints, 3], joint by joint."""
    if low_pass is None or 2.5 * low_pass > rate:
        return p
    from scipy.signal import butter, sosfiltfilt

    corner = rate / pi * atan(tan(pi * low_pass / rate) / TWO_PASSES)  # bilinear transform
    sections = butter(ORDER, corner, fs=rate, output="sos")
    for joint in range(p.shape[1]):
        p[:, joint] = sosfiltfilt(sections, p[:, joint], axis=0)
    return p
