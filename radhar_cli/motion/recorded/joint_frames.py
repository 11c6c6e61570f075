"""The thirteen joints and the hip joints over the frames of a file, in its own units and axes."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.motion.recorded.gaps import BRIDGED_S, true_runs
from radhar_cli.motion.recorded.keypoints import NO_RATE, Keypoints
from radhar_cli.motion.recorded.names import JointMean
from radhar_cli.motion.recorded.recording import RATES, MotionRecording, motion_file_error
from radhar_cli.numerics.arrays import Bool, Float

MIN_FRAMES = 12  # frames


@dataclass(frozen=True)
class LostSection:
    """Seconds of a file in which a joint is lost for too long to be bridged, or jumps."""

    joint: str  # name in the file
    begin: float  # s, last frame before it
    end: float  # s, first frame after it
    jump: str = ""  # what it does, in words, where it jumps
    place: str = ""  # file and frame, or file and line, of the jump


@dataclass(frozen=True)
class JointFrames:
    """The fifteen joints at an even rate, in units and axes of the file."""

    positions: Float  # [frames, 15, 3]; what is lost for long lies on a curve across it
    rate: float
    usable: tuple[float, float] | None = None
    lost: tuple[LostSection, ...] = ()
    bridged: str = ""


def read_frames(file: MotionRecording, blends: list[JointMean], rate: float | None) -> JointFrames:
    """Read the fifteen joints of a file at an even rate.

    Raises:
        MotionFileError: There are too few frames, or nothing says their rate.
    """
    if isinstance(file, Keypoints):
        return _bridge_frames(file, blends, rate)
    numbers = list(dict.fromkeys(number for mean in blends for number in mean.numbers))
    p = blend(file.positions(numbers), numbers, blends)
    _require_frames(file, len(p))
    rate = rate or file.rate
    if rate is None or not RATES[0] <= rate <= RATES[1]:
        raise motion_file_error(file.where, NO_RATE)
    return JointFrames(p, rate)


def _bridge_frames(file: Keypoints, blends: list[JointMean], rate: float | None) -> JointFrames:
    """Read the fifteen joints of poses, of which some may be lost in some frames."""
    numbers = list(dict.fromkeys(number for mean in blends for number in mean.numbers))
    _require_frames(file, len(file.values))
    bridged = file.bridged(numbers, rate)
    rate = rate or file.rate
    assert rate is not None
    known: Bool = np.asarray(np.isfinite(bridged.positions).all(axis=2))
    complete: Bool = np.asarray(known.all(axis=1))
    for column, number in enumerate(numbers):
        if not known[:, column].any():
            raise motion_file_error(
                file.where, f"{file.label(number)} is lost (NaN or 0, 0, 0) in every frame"
            )
    if complete.sum() < MIN_FRAMES:
        raise motion_file_error(
            file.where,
            f"has {int(complete.sum())} frames in which no joint is lost; should have "
            f"{MIN_FRAMES} or more",
        )
    first, last = (int(n) for n in np.flatnonzero(complete)[[0, -1]])
    lost = tuple(
        LostSection(file.label(numbers[int(np.argmin(known[a]))]), (a - 1) / rate, (b + 1) / rate)
        for a, b in true_runs(~complete)
        if first < a and b < last
    )
    is_whole = (first, last) == (0, len(complete) - 1)
    p = bridged.positions
    if not complete.all():
        p = _fill(p, known)
    return JointFrames(
        blend(p, numbers, blends),
        rate,
        None if is_whole else (first / rate, last / rate),
        lost,
        _describe_gaps(file, numbers, bridged.missing.tolist(), bridged.gaps.tolist(), rate),
    )


def _require_frames(file: MotionRecording, frames: int) -> None:
    """Refuse a recording of too few frames."""
    if frames < MIN_FRAMES:
        raise motion_file_error(
            file.where, f"has {frames} frames; should have {MIN_FRAMES} or more"
        )


def blend(p: Float, numbers: list[int], blends: list[JointMean]) -> Float:
    """Weighted means [frames, 15, 3] of positions [frames, joints, 3] of joints by number."""
    columns = {number: column for column, number in enumerate(numbers)}
    if all(mean.weights == (1.0,) for mean in blends):
        chosen: Float = p[:, [columns[mean.numbers[0]] for mean in blends]]
        return chosen
    weights = np.zeros((len(blends), len(numbers)))
    for row, mean in enumerate(blends):
        for number, weight in zip(mean.numbers, mean.weights, strict=True):
            weights[row, columns[number]] += weight
    blended: Float = np.einsum("jc,fca->fja", weights, p)
    return blended


def _fill(p: Float, known: Bool) -> Float:
    """Positions [frames, joints, 3] with straight lines where a joint is not known."""
    frames, filled = np.arange(len(p)), p.copy()
    for joint in range(p.shape[1]):
        rows = known[:, joint]
        for axis in range(3):
            filled[:, joint, axis] = np.interp(frames, frames[rows], p[rows, joint, axis])
    return filled


def _describe_gaps(
    file: Keypoints, numbers: list[int], missing: list[int], gaps: list[int], rate: float
) -> str:
    """Describe the gaps that are bridged, their frames and joints; "" without any."""
    lost = [
        (file.label(number), n, count)
        for number, n, count in zip(numbers, missing, gaps, strict=True)
        if n
    ]
    if not lost:
        return ""
    frames, runs = sum(n for _, n, _ in lost), sum(count for *_, count in lost)
    names = ", ".join(name for name, *_ in lost[:5]) + ", ..." * (len(lost) > 5)
    return (
        f"{runs} gap{'s' * (runs != 1)} of up to {BRIDGED_S:g} s, {frames} frames of "
        f"{1 / rate:.3g} s in all, bridged: {names}"
    )
