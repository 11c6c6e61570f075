"""Poses of pose estimation, cameras and markers: positions of joints over frames, no bones."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.files.clocks import TIME_UNITS
from radhar_cli.motion.recorded.gaps import Bridged, bridge_gaps
from radhar_cli.motion.recorded.image_landmarks import refuse_images
from radhar_cli.motion.recorded.plain_names import canonical_name, own_names
from radhar_cli.motion.recorded.recording import (
    LONGEST_NAME,
    MAX_FRAMES,
    MAX_JOINTS,
    RATES,
    motion_file_error,
)
from radhar_cli.numerics.arrays import Float

NO_RATE = (
    f"should have a frame rate of {RATES[0]:g} to {RATES[1]:g} Hz: rate_hz of its class (--rate HZ)"
)
LARGEST = 1e9  # units of the file
SENTINELS = (-1.0, -999.0, -9999.0, 999.0, 9999.0, 99999.0, 1e6, -1e6)
ROOTS = frozenset({"hip", "hips", "pelvis", "root", "midhip", "spinebase", "basespine"})
ROOTS |= frozenset({"hipcenter", "hipscenter"})
USUAL_RATES = (8.0, 400.0)  # frames per second of cameras
TICKS_RATES = (10.0, 100.0)  # of those whose unit may be us or ticks of 100 ns


@dataclass(frozen=True)
class Keypoints:
    """A `MotionRecording` of positions, in which joints may be lost.

    Attributes:
        where: Name of the file in messages.
        names: Names of the J joints; numbers from 0 where the file has none.
        values: Positions [frames, J, 3] as the file has them.
        rate: Frames per second; None where the file does not say.
        times: Instants of the frames [frames], s, from 0; None at an even rate.
        is_named: Whether the names are the file's own.
        unit: Length of a unit, m; None where the file does not say.
        remarks: Remarks of the reader on the file, in words.
        are_columns: Whether the numbers of a frame are a row of columns, in an order of its maker.
        up: Axis that points up by the format, such as "y"; None where it says none.
    """

    where: str
    names: tuple[str, ...]
    values: NDArray[Any]
    rate: float | None
    times: Float | None = None
    is_named: bool = True
    unit: float | None = None
    remarks: tuple[str, ...] = field(default=())
    are_columns: bool = False
    up: str | None = None

    at_bone_ends = False

    @property
    def parents(self) -> tuple[int | None, ...]:
        """Parents of the joints: none, as there are no bones."""
        return (None,) * len(self.names)

    def positions(self, joints: Sequence[int]) -> Float:
        """Positions [frames, len(joints), 3] of some joints, as the file has them."""
        points: Float = self.values[:, list(joints)].astype(float)
        # Trackers also write -1, -1, -1 or another number thrice where a joint is lost.
        is_same = (points[..., :1] == points).all(axis=2, keepdims=True)
        points = np.where(is_same & np.isin(points, SENTINELS), np.nan, points)
        points[np.isinf(points)] = np.nan
        huge = np.argwhere(np.abs(points) >= LARGEST)
        if huge.size:
            frame, joint, axis = huge[0].tolist()
            value = points[frame, joint, axis]
            name = self.names[joints[joint]]
            raise motion_file_error(
                self.place(frame), f"{name} {'xyz'[axis]} is {value}; should be a number"
            )
        for column, joint in enumerate(joints):
            is_zero = (points[:, column] == 0).all(axis=1)
            if is_zero.any() and not (self._may_be_root(joint) and is_zero.mean() > 0.5):
                points[is_zero, column] = np.nan  # a tracker's way to say that a joint is lost
        return points

    def seen_shares(self) -> Float:
        """Shares [J] of the frames in which the joints are not lost."""
        is_seen = np.isfinite(self.values).all(axis=2) & (self.values != 0).any(axis=2)
        shares: Float = is_seen.mean(axis=0)
        for joint in np.flatnonzero(shares < 1):
            if self._may_be_root(int(joint)) and np.isfinite(self.values[:, joint]).all():
                shares[joint] = 1.0
        return shares

    @cached_property
    def _own_names(self) -> tuple[str, ...]:
        return own_names(self.names)

    def _may_be_root(self, joint: int) -> bool:
        """Whether a joint may be the origin of poses: a hip, or the first of nameless joints."""
        return canonical_name(self._own_names[joint]) in ROOTS or (not self.is_named and joint == 0)

    def bridged(self, joints: Sequence[int], rate: float | None) -> Bridged:
        """Positions of some joints at an even rate, with short gaps bridged.

        Args:
            joints: Numbers of the joints.
            rate: Frames per second that a config says, instead of the file's rate or times.

        Raises:
            MotionFileError: Nothing says the rate.
        """
        p = self.positions(joints)
        even = self.times is None or rate is not None
        rate = rate or self.rate
        if rate is None or not RATES[0] <= rate <= RATES[1]:
            said = "; ".join(self.remarks)
            raise motion_file_error(self.where, NO_RATE + (f" ({said})" if said else ""))
        times = np.arange(len(p)) / rate if even or self.times is None else self.times
        return bridge_gaps(p, times, rate)

    def label(self, joint: int) -> str:
        """Name of a joint in messages, or its number where there are no names."""
        return self.names[joint] if self.is_named else f"joint {joint}"

    def place(self, frame: int) -> str:
        """File and frame, counted from 1, as messages name them."""
        return f"{self.where}: frame {frame + 1}"


def make_keypoints(
    where: str,
    names: Sequence[str] | None,
    values: NDArray[Any],
    rate: float | None = None,
    times: Float | None = None,
    unit: float | None = None,
    remarks: Sequence[str] = (),
) -> Keypoints:
    """Make a recording of positions after checking their shape, names and rate.

    Args:
        where: Name of the file in messages.
        names: Names of the joints; None where the file has none.
        values: Positions [frames, J, 3], or [frames, J, 4] with a confidence, of which 0 is lost.
        rate: Frames per second, or None.
        times: Instants of the frames [frames] in any usual unit; None where the file has none.
        unit: Length of a unit, m, or None.
        remarks: Remarks on the file.

    Raises:
        MotionFileError: Names the file and what is missing or odd.
    """
    joints = "J" if names is None else str(len(names))
    is_positions = values.ndim == 3 and values.shape[2] in (3, 4) and values.dtype.kind in "iuf"
    if not is_positions or (names is not None and values.shape[1] != len(names)):
        raise motion_file_error(
            where,
            f"positions should be numbers [frames, {joints}, 3], not {describe_array(values)}",
        )
    if not 0 < values.shape[1] <= MAX_JOINTS:
        raise motion_file_error(
            where, f"has {values.shape[1]} joints; should have 1 to {MAX_JOINTS}"
        )
    if not 0 < len(values) <= MAX_FRAMES:
        raise motion_file_error(where, f"has {len(values)} frames; should have 1 to {MAX_FRAMES}")
    if names is not None and any(len(name) > LONGEST_NAME for name in names):
        raise motion_file_error(where, f"names should have at most {LONGEST_NAME} characters each")
    refuse_images(values[..., :3], where)
    if values.shape[2] == 4:
        values = np.where(values[..., 3:] == 0, np.nan, values[..., :3].astype(float))
    if times is not None and times.shape == (len(values),) and times.dtype.kind in "iuf":
        is_new = np.concatenate([[True], np.diff(times) != 0])
        if 0.5 < is_new.mean() < 1:
            times, values = times[is_new], values[is_new]
            remarks = [*remarks, f"{int((~is_new).sum())} frames at the time of another left out"]
    if times is not None:
        times, rate, problem = _check_times(times, len(values), where)
        remarks = [*remarks, *problem]
    labels = names if names is not None else [str(n) for n in range(values.shape[1])]
    clean = tuple("".join(c if c.isprintable() else "?" for c in name) for name in labels)
    return Keypoints(where, clean, values, rate, times, names is not None, unit, tuple(remarks))


def describe_array(array: NDArray[Any]) -> str:
    """Type and shape of an array, as messages show it."""
    return f"{array.dtype} {list(array.shape)}"


def _check_times(
    times: Float, frames: int, where: str
) -> tuple[Float | None, float | None, tuple[str, ...]]:
    """Instants of frames in seconds from 0, and their rate; or what is wrong with them in words.

    Raises:
        MotionFileError: They do not rise, or are not as many as the frames.
    """
    if times.shape != (frames,) or times.dtype.kind not in "iuf":
        raise motion_file_error(
            where, f"times should be {frames} numbers, one a frame, not {describe_array(times)}"
        )
    if not np.isfinite(times).all():
        raise motion_file_error(where, "times should be numbers")
    if (np.diff(times.astype(float) - float(times[0])) <= 0).any():
        frame = int(np.argmax(np.diff(times.astype(float) - float(times[0])) <= 0)) + 2
        raise motion_file_error(
            f"{where}: frame {frame}", "its time should be after that of the frame before"
        )
    seconds = seconds_of(times) if frames > 1 else None
    if seconds is None:
        return None, None, ("its times are no frames at a camera's rate in s, ms, us or ticks",)
    steps = np.diff(seconds)
    regular = steps[np.abs(steps / np.median(steps) - 1) < 0.5]  # but where frames are dropped
    rate = float(1 / regular.mean())
    if not seconds[-1] * rate < MAX_FRAMES:
        raise motion_file_error(where, f"lasts {seconds[-1]:.4g} s; too long at its rate")
    return seconds, rate, ()


def seconds_of(times: Float, unit: str | None = None) -> Float | None:
    """Instants in seconds, whose unit is known by its name or told by a camera's usual rate.

    Args:
        times: Instants [frames] in s, ms, us, ns or ticks of 100 ns.
        unit: Key of TIME_UNITS; None finds the one that makes a usual rate.

    Returns:
        Instants [frames], s; None where no unit, or more than one, makes a usual rate.
    """
    times = times.astype(float) - float(times[0])
    if unit is not None:
        return times * TIME_UNITS[unit]
    step = float(np.median(np.diff(times)))
    if not step > 0:
        return None
    fitting = []
    for name, seconds in TIME_UNITS.items():
        low, high = USUAL_RATES if name in ("s", "ms") else TICKS_RATES
        if low <= 1 / (step * seconds) <= high:
            fitting.append(name)
    return times * TIME_UNITS[fitting[0]] if len(fitting) == 1 else None
