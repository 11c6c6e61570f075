"""Axes of the array of a capture: their names, and pulses in the order of time."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import prod
from pathlib import Path

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.captures.point_tables import HOW
from radhar_cli.readers.captures.settings import AxisName, CaptureSettings
from radhar_cli.readers.captures.source import MissingKeysError, Parts, Source
from radhar_cli.readers.captures.stored_arrays import CutArray, FrameFiles, Samples, SplitArray

MAX_RECEIVERS = 1024
_ORDER: tuple[AxisName, ...] = ("transmitter", "receiver", "sample", "frame", "pulse", "iq")


@dataclass(frozen=True)
class ArrayPulses:
    """Pulses of an array whose axes have names; those of transmitters that take turns are sorted.

    Raises:
        CaptureError: the axes do not hold whole pulses.
    """

    array: Samples
    axes: tuple[AxisName, ...]  # of the array, outermost first
    transmitters: int

    def __post_init__(self) -> None:
        iq = self.sizes.get("iq")
        if iq is not None and (iq != 2 or self.array.parts == 2):
            raise CaptureError(
                f"{self.array.where}: the axis iq has {iq}; should have 2, real numbers"
            )
        if self.count == 0 or ("frame" in self.axes and self.per_frame % self.turns):
            raise CaptureError(
                f"{self.array.where}: the axis pulse has {self.per_frame} chirps; should have a "
                f"multiple of transmitters = {self.transmitters}"
            )

    @cached_property
    def sizes(self) -> dict[AxisName, int]:
        """Size of each axis."""
        return dict(zip(self.axes, self.array.shape, strict=True))

    @property
    def parts(self) -> int:
        """2 of complex samples, 1 of real ones."""
        return self.sizes.get("iq", self.array.parts)

    @property
    def turns(self) -> int:
        """Number of transmitters that take turns along the axis pulse."""
        return 1 if "transmitter" in self.axes else self.transmitters

    @property
    def per_frame(self) -> int:
        """Number of chirps along the axis pulse."""
        return self.sizes["pulse"]

    @property
    def chirps(self) -> int:
        """Number of chirps of all transmitters that take turns."""
        return self.per_frame * self.sizes.get("frame", 1)

    @property
    def count(self) -> int:
        """Number of pulses of each transmitter."""
        return self.chirps // self.turns

    def read(self, first: int, stop: int) -> Parts:
        """Read pulses [virtual receiver, sample, stop - first, part] from first to stop - 1."""
        pieces = _by_frame(first * self.turns, stop * self.turns, self.per_frame)
        blocks = [self._chirps(*frames_and_pulses) for frames_and_pulses in pieces]
        block = blocks[0] if len(blocks) == 1 else np.concatenate(blocks, axis=3)
        block = block.reshape(*block.shape[:3], -1, self.turns, self.parts)
        return np.moveaxis(block, 4, 0).reshape(-1, block.shape[2], stop - first, self.parts)

    def _chirps(self, frames: slice, pulses: slice) -> Parts:
        """Read chirps [transmitter, receiver, sample, chirp, part]: of frames, some pulses each."""
        chosen = {"frame": frames, "pulse": pulses}
        key = tuple(chosen.get(name, slice(0, self.sizes[name])) for name in self.axes)
        block = self.array.read(key)
        block = block[..., 0] if "iq" in self.axes else block
        present = [self.axes.index(name) for name in _ORDER if name in self.axes]
        block = block.transpose(*present, *range(len(self.axes), block.ndim))
        return block.reshape(*(self.sizes.get(name, 1) for name in _ORDER[:3]), -1, self.parts)


def as_source(
    path: Path,
    array: Samples,
    settings: CaptureSettings,
    times: Float | None = None,
    of_matlab: bool = False,
) -> Source:
    """Make a source of an array, whose axes are put in order.

    Args:
        path: the file.
        array: samples; a last axis `iq` or complex numbers have two parts.
        settings: header of the capture, and the names of the axes.
        times: times of the pulses [pulse], s, if the capture contains them.
        of_matlab: whether the axes are reversed, as MATLAB stores them in HDF5.

    Raises:
        CaptureError: the axes do not fit the header, or are to be named.
    """
    if not of_matlab or prod(array.shape) == max(array.shape):
        array = cut_axes(array, settings)
    axes = _axes(array, settings, of_matlab and not isinstance(array, CutArray))
    sizes = dict(zip(axes, array.shape, strict=True))
    transmitters = sizes.get("transmitter", settings.transmitters)
    pulses = ArrayPulses(array, axes, transmitters)
    has_frames = "frame" in axes
    incomplete = pulses.chirps % pulses.turns
    note = f"the last {incomplete} chirps (an incomplete transmitter cycle) are left out"
    chunk = array.chunk[axes.index("frame" if has_frames else "pulse")]
    return Source(
        (path,),
        transmitters * sizes.get("receiver", 1),
        sizes.get("sample"),
        pulses.count,
        array.number,
        pulses.parts,
        pulses.read,
        times=times,
        step=max(chunk * (pulses.per_frame if has_frames else 1) // pulses.turns, 1),
        settings={"frame_pulses": pulses.per_frame // pulses.turns} if has_frames else {},
        notes=(note,) if incomplete else (),
    )


def cut_axes(array: Samples, s: CaptureSettings) -> Samples:
    """Cut an array whose numbers follow one another into the axes that have names.

    Args:
        array: any array; one of several axes, each of more than one entry, stays as it is, unless
            `iq` is an axis more: it then splits the axis after it (all I, then all Q), or, named
            last, the one before it (I and Q by turns).
        s: header of the capture, with sizes of the axes but one.

    Raises:
        MissingKeysError: its numbers are real, and may be I and Q by turns.
        CaptureError: sizes of axes are missing, or are larger than the array.
    """
    count, axes_count = max(array.shape), len(array.shape)
    if s.axes is not None and "iq" in s.axes and len(s.axes) == axes_count + 1 > 2:
        place = s.axes.index("iq")
        is_by_turns = place == axes_count
        axis = place - 1 if is_by_turns else place
        if array.shape[axis] % 2 == 0 and array.parts == 1 and prod(array.shape) > count:
            return SplitArray(array, axis, is_by_turns)
    has_named_axes = s.axes is not None and len(s.axes) == axes_count > 1
    if prod(array.shape) > count or (has_named_axes and s.axes != ("pulse", "iq")):
        return array
    if s.axes is None or s.axes == ("pulse",):
        if s.axes is None and array.parts == 1:
            raise MissingKeysError(
                f"{array.where}: has {count} real numbers along one axis: are they samples of "
                "pulses (axes=[pulse]), or I and Q by turns (axes=[pulse,iq])?",
                {"axes": "[pulse,iq]"},
            )
        return array if axes_count == 1 else CutArray(array, (count,))
    sizes: dict[AxisName, int | None] = {
        "sample": s.samples,
        "receiver": s.receivers,
        "transmitter": s.transmitters,
        "iq": 2,
        "pulse": s.frame_pulses if "frame" in s.axes else None,
    }
    unknown = [name for name in s.axes if sizes.get(name) is None]
    if len(unknown) != 1:
        keys = {"sample": "samples", "receiver": "receivers", "pulse": "frame_pulses"}
        missing = [keys[name] for name in unknown if name in keys and name != unknown[0]]
        raise MissingKeysError(
            f"{array.where}: has {count} numbers along one axis: {' and '.join(missing)} should "
            f"say how axes=[{','.join(s.axes)}] divide them",
            dict.fromkeys(missing, "N"),
        )
    inner = prod(size for size in map(sizes.get, s.axes) if size is not None)
    if count < inner or (s.axes[0] != unknown[0] and count % inner):
        raise CaptureError(
            f"{array.where}: has {count} numbers; should have a multiple of {inner}, as "
            f"axes=[{','.join(s.axes)}] and their sizes say"
        )
    return CutArray(array, tuple(sizes.get(name) or count // inner for name in s.axes))


def _by_frame(low: int, high: int, per_frame: int) -> Iterator[tuple[slice, slice]]:
    """Yield (frames, pulses of each) that together are chirps low .. high - 1, and no others."""
    while low < high:
        frame, pulse = divmod(low, per_frame)
        whole_frames = (high - low) // per_frame if pulse == 0 else 0
        stop = per_frame if whole_frames else min(per_frame, pulse + high - low)
        yield slice(frame, frame + max(whole_frames, 1)), slice(pulse, stop)
        low += whole_frames * per_frame or stop - pulse


def _axes(array: Samples, s: CaptureSettings, of_matlab: bool) -> tuple[AxisName, ...]:
    """Names of the axes of an array, in the order of the file.

    Raises:
        MissingKeysError: axes have no names, or others than their sizes.
    """
    shape = array.shape[::-1] if of_matlab else array.shape
    axes = s.axes or (("pulse",) if len(shape) == 1 else ())
    sizes = dict(zip(axes, shape, strict=False))
    expected_sizes: dict[AxisName, int | None] = {
        "sample": s.samples,
        "receiver": s.receivers,
        "transmitter": s.transmitters if s.transmitters > 1 else None,
        "pulse": s.frame_pulses if "frame" in axes else None,
    }
    problems = [
        f"{n} should have {v}" for n, v in expected_sizes.items() if v and sizes.get(n, v) != v
    ]
    if sizes.get("sample") == 1:
        problems.append("sample should have 2 or more")
    if sizes.get("receiver", 1) > MAX_RECEIVERS:
        problems.append(f"receiver should have at most {MAX_RECEIVERS}")
    if problems or len(axes) != len(shape):
        read_as = f", read as axes = {[*axes]}" if axes else ""
        problem = f"; {problems[0]}" if problems else ""
        if s.axes is None and array.parts == 1 and set(shape) & {*range(3, 8)}:
            problem += f"; points (x, y, z, Doppler, ...) are not samples, of them {HOW}"
        likely = _likely_axes(shape, array)
        named = " x ".join(f"{n} {name}s" for n, name in zip(shape, likely, strict=True))
        raise MissingKeysError(
            f"{array.where}: has {len(shape)} axes, {[*shape]}{read_as}{problem}; --set axes=[...] "
            f"should name each, outermost first, of {', '.join(_ORDER)}, such as "
            f"[{','.join(likely)}] if they are {named}",
            {"axes": f"[{','.join(likely)}]"},
        )
    return axes[::-1] if of_matlab else axes


def _likely_axes(shape: tuple[int, ...], array: Samples) -> list[str]:
    """Names that axes may have, as an example: the longest is of pulses, two real ones are iq."""
    names = dict[int, str]()
    if isinstance(array, FrameFiles):
        names[0] = "frame"
    if array.parts == 1 and 2 in (shape[-1], shape[0]):
        names[len(shape) - 1 if shape[-1] == 2 else 0] = "iq"
    others = [axis for axis in range(len(shape)) if axis not in names]
    usual = ["pulse", "sample", "receiver", "frame", "transmitter", "axis"]
    for axis in sorted(others, key=lambda axis: -shape[axis]):
        names[axis] = next((name for name in usual if name not in names.values()), "axis")
    return [names[axis] for axis in range(len(shape))]


def settings_with_frames(settings: CaptureSettings, of_matlab: bool) -> CaptureSettings:
    """Settings whose axes begin with that of the frames, a file or a cell each; end, of MATLAB."""
    axes = settings.axes
    if axes is None:
        return settings
    if "frame" not in axes:
        axes = ("frame", *axes)
    if of_matlab and axes[:1] == ("frame",):
        axes = (*axes[1:], "frame")
    return settings.model_copy(update={"axes": axes})
