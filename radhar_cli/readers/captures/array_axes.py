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
from radhar_cli.readers.captures.settings import USUAL_AXES, AxisName, CaptureSettings
from radhar_cli.readers.captures.source import MissingKeysError, Parts, Source
from radhar_cli.readers.captures.stored_arrays import CutArray, Samples, SplitArray

MAX_RECEIVERS = 1024
MOST_GUESSED_RECEIVERS = 16  # of axes that nobody has named
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
    of_matlab = of_matlab and not isinstance(array, CutArray)
    axes = _axes(array, settings, of_matlab)
    sizes = dict(zip(axes, array.shape, strict=True))
    transmitters = sizes.get("transmitter", settings.transmitters)
    pulses = ArrayPulses(array, axes, transmitters)
    has_frames = "frame" in axes
    notes = [
        note
        for note in (
            _note_of_cycle(pulses.chirps % pulses.turns),
            None if settings.axes is not None else _note_of_axes(axes, sizes, of_matlab),
        )
        if note is not None
    ]
    guess = () if settings.axes else axes[::-1] if of_matlab else axes
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
        axes=guess if len(guess) > 1 else (),
        step=max(chunk * (pulses.per_frame if has_frames else 1) // pulses.turns, 1),
        settings={"frame_pulses": pulses.per_frame // pulses.turns} if has_frames else {},
        notes=tuple(notes),
    )


def _note_of_cycle(incomplete: int) -> str | None:
    """Words for chirps of an incomplete cycle of transmitters."""
    if not incomplete:
        return None
    return f"the last {incomplete} chirps (an incomplete transmitter cycle) are left out"


def _note_of_axes(
    axes: tuple[AxisName, ...], sizes: dict[AxisName, int], of_matlab: bool
) -> str | None:
    """Words for axes that were guessed, where another order is as likely."""
    if "iq" in axes:
        return "the last axis, of two real numbers, is I and Q (axes=[...] says otherwise)"
    if sizes.get("sample", 0) > sizes["pulse"]:
        names = ", ".join(axes[::-1] if of_matlab else axes)
        return f"axes are read as [{names}] (axes=[...] says otherwise)"
    return None


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
    """Names of the axes of an array, in the order of the file."""
    shape = array.shape[::-1] if of_matlab else array.shape
    axes = s.axes or _usual_axes(array.parts, shape, s)
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
    if s.axes is None and sizes.get("receiver", 1) > MOST_GUESSED_RECEIVERS:
        problems.append(f"receiver has {sizes['receiver']}, which may be frames")
    if s.axes is None and axes == ("sample", "pulse") and shape[0] == 2 and array.parts == 1:
        raise MissingKeysError(
            f"{array.where}: has the shape {[*shape]} of real numbers: are they I and Q "
            "(axes=[iq,pulse]), or two receivers (axes=[receiver,pulse])?",
            {"axes": "[iq,pulse]"},
        )
    if problems or len(axes) != len(shape):
        problem = f"; {problems[0]}" if problems else ""
        if s.axes is None and array.parts == 1 and set(shape) & {*range(3, 8)}:
            problem += f"; points (x, y, z, Doppler, ...) are not samples, of them {HOW}"
        likely_axes = ("frame", "receiver", "pulse", "sample")[-len(shape) :]
        raise MissingKeysError(
            f"{array.where}: has {len(shape)} axes, {list(shape)}, read as axes = {[*axes]}"
            f"{problem}; --set axes=[...] should name each, outermost first",
            {"axes": f"[{','.join(likely_axes)}]"},
        )
    if s.axes is None and axes[:2] == ("sample", "pulse"):
        _require_axes_of_matrix(array.where, shape, s, axes[2:])
    return axes[::-1] if of_matlab else axes


def _require_axes_of_matrix(
    where: str, shape: tuple[int, ...], s: CaptureSettings, iq: tuple[AxisName, ...]
) -> None:
    """Require that the two axes of a matrix have names where a guess may be the transposition.

    Args:
        where: file and array, for messages.
        shape: sizes of the axes, in the order of the program that wrote it.
        s: header of the capture, without axes.
        iq: the axis that follows the two; none of complex numbers.

    Raises:
        MissingKeysError: nothing tells samples from pulses, or from receivers.
    """
    rows, columns = shape[:2]
    has_beat_keys = s.bandwidth_hz is not None and s.adc_rate_hz is not None
    may_be_receivers = min(rows, columns) <= MOST_GUESSED_RECEIVERS and not (
        s.are_profiles or has_beat_keys
    )
    is_long = rows > columns or s.are_profiles
    if s.samples is not None or not (is_long or may_be_receivers):
        return
    by_pulse: tuple[AxisName, ...] = ("pulse", "sample", *iq)
    by_sample: tuple[AxisName, ...] = ("sample", "pulse", *iq)
    meanings = {
        by_pulse: _words_of_pulses(rows, columns, s),
        by_sample: _words_of_pulses(columns, rows, s),
    }
    likely = by_pulse
    if may_be_receivers:
        likely = ("pulse", "receiver", *iq) if rows > columns else ("receiver", "pulse", *iq)
        receivers = f"slow time of {min(rows, columns)} receivers, {max(rows, columns)} pulses"
        meanings = {likely: receivers, **meanings}
    choices = ", or ".join(f"axes=[{','.join(a)}]: {text}" for a, text in meanings.items())
    raise MissingKeysError(
        f"{where}: has the shape {[*shape]}, and axes should say what that is: {choices}",
        {"axes": f"[{','.join(likely)}]"},
    )


def _words_of_pulses(pulses: int, samples: int, s: CaptureSettings) -> str:
    """Words for a number of pulses of a number of samples, or profiles of bins to a range."""
    if not s.are_profiles:
        return f"{pulses} pulses of {samples} samples"
    if s.first_range_m is None or s.range_step_m is None:
        return f"{pulses} profiles of {samples} bins"
    last_m = s.first_range_m + (samples - 1) * s.range_step_m
    return f"{pulses} profiles of {samples} bins to {last_m:.2g} m"


def _usual_axes(parts: int, shape: tuple[int, ...], s: CaptureSettings) -> tuple[AxisName, ...]:
    """Names of axes that nobody has named; a last one of two real numbers is I and Q.

    Args:
        parts: 2 of complex numbers, 1 of real ones.
        shape: sizes of the axes.
        s: header of the capture.
    """
    is_tone = s.radar is not None and s.radar.get("waveform") == "cw" and s.transmitters == 1
    if is_tone and s.receivers and (axes := _axes_of_slow_time(parts, shape, s.receivers)):
        return axes
    others = USUAL_AXES.get(len(shape) - 1)
    is_pair = parts == 1 and len(shape) > 1 and shape[-1] == 2 and shape[0] > 2
    if is_pair and others is not None and s.receivers != 2 and s.complex:
        return (*others, "iq")
    return USUAL_AXES.get(len(shape), ())


def _axes_of_slow_time(parts: int, shape: tuple[int, ...], receivers: int) -> tuple[AxisName, ...]:
    """Names of the axes of slow time of several receivers; () where none is as long as these."""
    iq: tuple[AxisName, ...] = ("iq",) if parts == 1 and shape[-1] == 2 else ()
    sides = shape[: len(shape) - len(iq)]
    is_complex = parts == 2 or iq
    if not is_complex or len(sides) != 2 or receivers not in sides or receivers == 1:
        return ()
    first_is_receiver = sides[0] == receivers
    return ("receiver", "pulse", *iq) if first_is_receiver else ("pulse", "receiver", *iq)


def settings_with_frames(
    array: Samples, settings: CaptureSettings, of_matlab: bool
) -> CaptureSettings:
    """Settings whose axes begin with that of the frames, a file or a cell each; end, of MATLAB.

    Raises:
        CaptureError: axes are not named, and not the usual ones of a frame.
    """
    usual: dict[int, tuple[AxisName, ...]] = {3: ("frame", "sample", "pulse")}
    axes = settings.axes or usual.get(len(array.shape)) or USUAL_AXES.get(len(array.shape), ())
    if settings.axes is not None and "frame" not in axes:
        axes = ("frame", *axes)
    if of_matlab and axes[:1] == ("frame",):
        axes = (*axes[1:], "frame")
    return settings.model_copy(update={"axes": axes})
