"""Arrays of a capture that are read in blocks: complex numbers in two parts, I and Q."""

from collections.abc import Callable, Sequence
from math import prod
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.readers.captures.named_parts import is_quadrature_first
from radhar_cli.readers.captures.parser_errors import parser_errors_as_capture_errors
from radhar_cli.readers.untrusted_hdf5 import NumberColumn


class StoredArray:
    """Array of a capture, read in blocks like `NumberColumn`.

    Args:
        where: file and array, for messages.
        load: function that maps the array, or returns it; pairs of equal numbers are I and Q.

    Raises:
        CaptureError: it cannot be read, or does not hold numbers.
    """

    def __init__(self, where: str, load: Callable[[], NDArray[Any]]) -> None:
        with parser_errors_as_capture_errors(where):
            values = load()
        self.where, self.load, self.shape = where, load, values.shape
        self.is_q_first, dtype = False, values.dtype
        self.number = values.real.dtype.newbyteorder("=")
        self.parts, self.chunk = 1 + (dtype.kind == "c"), (1,) * values.ndim
        if dtype.names is not None and len(dtype.names) == 2 and dtype[0] == dtype[1]:
            self.number, self.parts = dtype[0].newbyteorder("="), 2
            self.is_q_first = is_quadrature_first(dtype.names)
        is_pair = dtype.names is not None and dtype.itemsize == 2 * self.number.itemsize
        is_number = dtype.kind in "iufc" or (is_pair and self.number.kind in "iuf")
        if not is_number or self.number.itemsize > 8:
            raise CaptureError(f"{where}: is of the type {dtype}; should be numbers")
        if not values.ndim or not values.size:
            raise CaptureError(f"{where}: has the shape {values.shape}; should hold numbers")

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part]; files are mapped again for each, which releases memory."""
        block = np.ascontiguousarray(self.load()[key])
        native = block.astype(block.dtype.newbyteorder("="), copy=False)
        parts = native.view(self.number).reshape(*block.shape, self.parts)
        return parts[..., ::-1] if self.is_q_first else parts


class PairedArray(StoredArray):
    """Two arrays of one shape, I and Q, as one of complex numbers.

    Args:
        real: I.
        imaginary: Q.

    Raises:
        CaptureError: they differ, or are complex.
    """

    def __init__(self, real: "StoredArray | NumberColumn", imaginary: "StoredArray | NumberColumn"):
        if real.shape != imaginary.shape or real.parts + imaginary.parts != 2:
            raise CaptureError(
                f"{imaginary.where}: has the shape {[*imaginary.shape]}; should be real numbers of "
                f"the shape {[*real.shape]}, as I in {real.where}"
            )
        self.where, self.shape, self.chunk = real.where, real.shape, real.chunk
        self.halves, self.parts = (real, imaginary), 2
        self.number = np.result_type(real.number, imaginary.number)

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part] of both."""
        blocks = [half.read(key)[..., 0] for half in self.halves]
        return np.stack(blocks, axis=-1).astype(self.number, copy=False)


class SwappedPairs(StoredArray):
    """Array of pairs of which the first is Q.

    Args:
        array: the pairs.
    """

    def __init__(self, array: NumberColumn) -> None:
        self.array, self.where, self.shape = array, array.where, array.shape
        self.number, self.parts, self.chunk = array.number, array.parts, array.chunk

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part], I first."""
        return self.array.read(key)[..., ::-1]


class PointsOfArray(StoredArray):
    """Array of which a part of the last axis is read.

    Args:
        array: the numbers.
        points: entries of the last axis that are read.
    """

    def __init__(self, array: "StoredArray | NumberColumn", points: slice) -> None:
        self.array, self.where, self.first = array, array.where, points.start
        self.shape = (*array.shape[:-1], points.stop - points.start)
        self.number, self.parts, self.chunk = array.number, array.parts, array.chunk

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part]."""
        first, stop, _ = key[-1].indices(self.shape[-1])
        return self.array.read((*key[:-1], slice(self.first + first, self.first + stop)))


class FrameFiles(StoredArray):
    """Arrays of one shape, a frame each, as an array whose first axis numbers the frames.

    Args:
        arrays: the arrays, in order.

    Raises:
        CaptureError: they differ in shape or type.
    """

    def __init__(self, arrays: Sequence["StoredArray | NumberColumn"]) -> None:
        first = arrays[0]
        for array in arrays[1:]:
            same = array.shape == first.shape and array.number == first.number
            if not same or array.parts != first.parts:
                raise CaptureError(
                    f"{array.where}: has the shape {[*array.shape]} of {array.number}; should be "
                    f"{[*first.shape]} of {first.number}, as {first.where}: a file a frame"
                )
        self.arrays, self.where, self.parts = arrays, first.where, first.parts
        self.shape, self.number = (len(arrays), *first.shape), first.number
        self.chunk = (1,) * len(self.shape)

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [file, ..., part]."""
        return np.stack([array.read(key[1:]) for array in self.arrays[key[0]]])


class CutArray(StoredArray):
    """Array whose numbers follow one another along one axis, cut into several axes.

    Args:
        array: the numbers, of one axis, or of others that have one entry.
        shape: sizes of the axes, outermost first; numbers that are left over are left out.
    """

    def __init__(self, array: "StoredArray | NumberColumn", shape: tuple[int, ...]) -> None:
        self.array, self.where, self.shape = array, array.where, shape
        self.number, self.parts = array.number, array.parts
        inner = prod(shape[1:])
        self.chunk = (max(max(array.chunk) // inner, 1), *(1,) * (len(shape) - 1))

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part]."""
        first, stop, _ = key[0].indices(self.shape[0])
        inner, sizes = prod(self.shape[1:]), self.array.shape
        flat = slice(first * inner, stop * inner)
        place = tuple(flat if n == max(sizes) else slice(0, 1) for n in sizes)
        block = self.array.read(place).reshape(stop - first, *self.shape[1:], self.parts)
        return block[(slice(None), *key[1:])]


class SplitArray(StoredArray):
    """Array of real numbers of which one axis holds I and Q, as an array with an axis more.

    Args:
        array: the numbers.
        axis: axis that is split.
        is_by_turns: whether I and Q follow each other there by turns; else all I, then all Q. The
            new axis comes after that of the numbers by turns, else before it.
    """

    def __init__(self, array: "StoredArray | NumberColumn", axis: int, is_by_turns: bool) -> None:
        self.array, self.axis, self.is_by_turns = array, axis, is_by_turns
        half = array.shape[axis] // 2
        sizes = (half, 2) if is_by_turns else (2, half)
        self.where, self.number, self.parts = array.where, array.number, array.parts
        self.shape = (*array.shape[:axis], *sizes, *array.shape[axis + 1 :])
        self.chunk = (1,) * len(self.shape)

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part]."""
        before, after = key[: self.axis], key[self.axis + 2 :]
        pair = key[self.axis : self.axis + 2]
        numbers = pair[0] if self.is_by_turns else pair[1]
        half = self.array.shape[self.axis] // 2
        first, stop, _ = numbers.indices(half)
        if self.is_by_turns:
            block = self.array.read((*before, slice(2 * first, 2 * stop), *after))
            sizes = block.shape
            block = block.reshape(*sizes[: self.axis], -1, 2, *sizes[self.axis + 1 :])
            return block[(slice(None),) * (self.axis + 1) + (pair[1],)]
        spans = [slice(first, stop), slice(half + first, half + stop)][pair[0]]
        parts = [self.array.read((*before, span, *after)) for span in spans]
        return np.stack(parts, axis=self.axis)


Samples: TypeAlias = StoredArray | NumberColumn
