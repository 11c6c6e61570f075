"""A recording as the thirteen joints of a person of 1 m: scaled, upright, on the floor, smooth."""

from dataclasses import dataclass
from math import atan, ceil, floor, pi, sqrt, tan
from typing import Literal

import numpy as np

from radhar_cli.motion.recorded.gaps import BRIDGED_S
from radhar_cli.motion.recorded.image_landmarks import (
    describe_growth,
    refuse_landmarks,
    refuse_landmarks_in_depth,
)
from radhar_cli.motion.recorded.joint_frames import LostSection, read_frames
from radhar_cli.motion.recorded.joint_order import arrange_joints
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.jumps import find_jumps
from radhar_cli.motion.recorded.keypoints import Keypoints
from radhar_cli.motion.recorded.names import JointMean, JointNames, joint_means
from radhar_cli.motion.recorded.plain_names import canonical_name, own_names
from radhar_cli.motion.recorded.proportions import refuse_impossible_body
from radhar_cli.motion.recorded.recording import MotionRecording, motion_file_error
from radhar_cli.motion.recorded.travel import travel_by_feet
from radhar_cli.motion.recorded.up_axis import UPRIGHT, check_up_axis, documented_up_axis
from radhar_cli.motion.skeleton import ANKLE_HEIGHT, JOINTS, stature_of_leg
from radhar_cli.numerics.arrays import Float

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}  # a decade apart: one at most makes a person
STATURES = (0.9, 2.3)  # m, of people
STAYS = 0.03  # most that hips move in the plane which stay where they are, over the stature
SLIPS = 0.1  # least speed of a foot that is not at rest, statures per second
BENT = 0.01  # least distance of knees before the line from hip to ankle, over the stature
ONLY_NOSE = "of its head it has a nose only: the head is there, some 11 cm ahead of its middle"
NO_HEAD = "it has no head: taken on the line of the trunk, above the shoulders"
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
    positions: Float  # [frames, 15, 3], over the stature; z is up, lowest ankle ANKLE_HEIGHT
    rate: float  # frames per second
    hip_joints: bool  # whether the file has them; else they are at the hip
    stature: float  # of the recorded person by the legs, m
    up: str = "z"  # axis of the file that points up
    unit: float = 1.0  # length of a unit of the file, m
    usable: tuple[float, float] | None = None  # s; None: from the first to the last frame
    lost: tuple[LostSection, ...] = ()
    bridged: str = ""  # what is bridged, in words
    marches: bool = False  # the feet step while the hips stay where they are
    remarks: tuple[str, ...] = ()  # what else there is to say of the file, in words

    @property
    def seconds(self) -> float:
        """Duration from the first to the last frame, s."""
        return (len(self.positions) - 1) / self.rate


def require_complete(clip: Clip, begin: float, end: float) -> None:
    """Refuse seconds of a clip in which a joint is lost for longer than gaps are bridged, or jumps.

    Raises:
        MotionFileError: Names the joint, when it is lost, and the seconds that are usable.
    """
    first, last = clip.usable or (0.0, clip.seconds)
    lost = [section for section in clip.lost if section.begin < end and begin < section.end]
    if not lost and first - 1e-9 <= begin < last:
        return
    usable, start = list[tuple[float, float]](), first
    for section in clip.lost:
        usable.append((start, section.begin))
        start = max(start, section.end)
    usable.append((start, last))
    # Seconds are shown in whole hundredths, rounded inwards.
    usable = [(ceil(100 * a - 1e-6) / 100, floor(100 * b + 1e-6) / 100) for a, b in usable]
    usable = [(a, b) for a, b in usable if a < b]
    place, problem = clip.where, f"a joint is lost before {first:.2f} s"
    if lost:
        place = lost[0].place or clip.where
        problem = f"{lost[0].joint} is lost from {lost[0].begin:.2f} to {lost[0].end:.2f} s"
        problem = lost[0].jump or problem
    longest = sorted(usable, key=lambda edges: edges[0] - edges[1])[:5]
    listed = " and ".join(f"{a:.2f} to {b:.2f} s" for a, b in sorted(longest)) or "no seconds"
    command = "".join(
        f": section_s: [{a:.2f}, {b:.2f}] of its class (--section {a:.2f},{b:.2f})"
        for a, b in longest[:1]
    )
    raise motion_file_error(
        place, f"{problem}; gaps of up to {BRIDGED_S:g} s are bridged; usable are {listed}{command}"
    )


def make_clip(  # noqa: PLR0913 - what a file does not say is what a class of a config says
    file: MotionRecording,
    joints: JointNames | None = None,
    up: str | None = None,
    unit: float | None = None,
    rate: float | None = None,
    low_pass: float | None = 8.0,
    travel: Literal["file", "feet"] = "file",
    left_handed: bool = False,
) -> Clip:
    """Read the frames of a recording and bring them into our form.

    Args:
        file: Recording.
        joints: {our name: the file's, or a list of them} where names alone do not tell, or the key
            of the joint set in whose order the joints are.
        up: Axis of the file that points up, such as "y" or "-y"; None is that of its format.
        unit: Length of a unit of the file, m; None is that of its format, else m, cm or mm.
        rate: Frames per second, instead of the file's.
        low_pass: Frequency at which a Butterworth filter, run both ways, is 3 dB down, Hz; None
            leaves the frames as they are, and so do fewer than 2.5 frames a period of it.
        travel: Whether the hips go as the file says, or as the foot on the floor tells.
        left_handed: Whether the axes are left-handed, or a camera mirrors, so that left is right.

    Raises:
        MotionFileError: Joints or the rate are missing, the person has no human size, nothing says
            which axis points up, or knees bend backwards.
    """
    if isinstance(file, Keypoints):
        file = _arrange(file, joints, unit)
    means = joint_means(file, joints or {})
    remarks = file.remarks if isinstance(file, Keypoints) else ()
    remarks += _head_remarks(file, joints, means[_HEAD])
    has_hip_joints = None not in means
    blends = [mean for mean in (mean or means[_HIP] for mean in means) if mean is not None]
    frames = read_frames(file, blends, rate)
    refuse_impossible_body(frames.positions, file.where)
    leg = _leg_in_units(frames.positions, has_hip_joints)
    unit_m = _find_unit(leg, unit or file.unit, file.where)
    stature, p = stature_of_leg(leg * unit_m), frames.positions
    jumps = find_jumps(file, p, frames.rate, unit_m)
    up = up or check_up_axis(documented_up_axis(file, joints or {}), p, file.where)
    if isinstance(file, Keypoints):
        remarks += _look_for_pictures(file, p, stature / unit_m, up, unit)
    p = np.stack([sign * p[..., axis] for axis, sign in _AXES[up]], axis=-1)
    p = _smooth(p, frames.rate, low_pass) * (unit_m / stature)
    if travel == "feet":
        p += travel_by_feet(p[:, _ANKLES], frames.rate)[:, None]
    p[..., 2] += ANKLE_HEIGHT - p[:, _ANKLES, 2].min()
    p[..., 1] *= -1 if left_handed else 1
    _refuse_mirror_image(p, left_handed, file.where)
    return Clip(
        file.where,
        p,
        frames.rate,
        has_hip_joints,
        stature,
        up,
        unit_m,
        frames.usable,
        tuple(sorted((*frames.lost, *jumps), key=lambda section: section.begin)),
        frames.bridged,
        _marches(p, frames.rate),
        remarks,
    )


def _arrange(file: Keypoints, joints: JointNames | None, unit: float | None) -> Keypoints:
    """Arrange joints as they make a body; refuse landmarks of a picture."""
    if unit is None:
        refuse_landmarks(file.values, file.where)
    arranged = arrange_joints(file, joints)
    if unit is None and arranged is not file:
        refuse_landmarks(arranged.values, file.where)
    return arranged


def _look_for_pictures(
    file: Keypoints, p: Float, units: float, up: str, unit: float | None
) -> tuple[str, ...]:
    """Refuse positions [frames, 15, 3] of a picture, y down; say where somebody grows."""
    if unit is None and up == "-y":
        refuse_landmarks_in_depth(p, units, file.where)
    return describe_growth(p)


def _leg_in_units(p: Float, has_hip_joints: bool) -> float:
    """Length of thigh and shank together in positions [frames, 15, 3], in their unit.

    Without hip joints a thigh counts as long as its shank.
    """
    links = np.linalg.norm(p[:, _KNEES] - p[:, _ANKLES], axis=2)
    thighs = np.linalg.norm(p[:, len(JOINTS) :] - p[:, _KNEES], axis=2) if has_hip_joints else links
    return float(np.median(links + thighs))


def _head_remarks(
    file: MotionRecording, joints: JointNames | None, head: JointMean | None
) -> tuple[str, ...]:
    """Remark on a head that follows from the trunk, or is a nose alone."""
    if head is None:
        return ()
    if head.is_of_trunk:
        return (NO_HEAD,)
    names = JOINT_SETS[joints].names if isinstance(joints, str) else own_names(file.names)
    is_one = isinstance(file, Keypoints) and len(head.numbers) == 1
    is_nose = is_one and canonical_name(names[head.numbers[0]].split("|")[0]) == "nose"
    return (ONLY_NOSE,) if is_nose else ()


def _marches(p: Float, rate: float) -> bool:
    """Whether the feet step while the hips stay where they are, as in poses about the hips.

    A walker has a foot at rest nearly always. Poses [frames, 15, 3] over the stature, z up, whose
    hips are the origin have both feet moving ahead or back most of the time.
    """
    if np.ptp(p[:, _HIP, :2], axis=0).max() > STAYS:
        return False
    ahead = _ahead(p)
    velocity = np.diff(p[:, _ANKLES, :2], axis=0) * rate
    speeds = np.abs(np.einsum("fka,fa->fk", velocity, ahead[1:])).min(axis=1)
    return bool((speeds > SLIPS).mean() > 0.5)


def _ahead(p: Float) -> Float:
    """Unit vectors [frames, 2] ahead of the body in the plane; p [frames, 15, 3], z up."""
    left = (p[:, _LEFT] - p[:, _RIGHT])[..., :2].sum(axis=1)
    ahead = np.stack([left[:, 1], -left[:, 0]], axis=1)
    unit: Float = ahead / np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-9)
    return unit


def _find_unit(leg: float, unit: float | None, where: str) -> float:
    """Length of a unit, m: what is said, else that of m, cm and mm which makes a person.

    Args:
        leg: Length of a leg in units of the file.
        unit: Length of a unit by the config or the file, m, or None.
        where: Name of the file in messages.
    """
    (low, high), units = STATURES, UNITS if unit is None else {f"{unit:.4g} m": unit}
    statures = {name: stature_of_leg(leg * size) for name, size in units.items()}
    for name, stature in statures.items():
        if low <= stature <= high:
            return units[name]
    sizes = " or ".join(f"of {stature:.3g} m in {name}" for name, stature in statures.items())
    raise motion_file_error(
        where,
        f"has legs of {leg:.4g} units, those of a person {sizes}; should be {low} to {high} m: "
        "unit_m of its class says how many metres a unit is (--unit M; inches: 0.0254, CMU's BVH: "
        "0.0564)",
    )


def _refuse_mirror_image(p: Float, left_handed: bool, where: str) -> None:
    """Refuse knees that bend backwards: left and right are exchanged, as in left-handed axes.

    Positions [frames, 15, 3] over the stature, z up; people who lie tell nothing.
    """
    ahead = _ahead(p)
    legs = (p[:, len(JOINTS) :] + p[:, _ANKLES]) / 2
    bend = np.einsum("fka,fa->f", (p[:, _KNEES] - legs)[..., :2], ahead) / len(_KNEES)
    upright = p[:, _HEAD, 2] - p[:, _ANKLES, 2].mean(axis=1) > UPRIGHT / 2
    if upright.any() and bend[upright].mean() < -BENT:
        other = "false" if left_handed else "true"
        raise motion_file_error(
            where,
            "has knees that bend backwards, as in left-handed axes or a mirror image; left_handed: "
            f"{other} of its class would say so ({'without ' * left_handed}--left-handed)",
        )


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
