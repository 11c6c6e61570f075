"""Transforms of windowed frames by FFTW and by scipy."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import permutations

import numpy as np
import pytest

from radhar_cli.numerics.accelerators import installed
from radhar_cli.processing import fourier
from radhar_cli.processing.fourier import COEFFICIENTS, fill_in_spectra

needs_fftw = pytest.mark.skipif(installed("pyfftw") is None, reason="needs radhar[fast]")


@pytest.fixture(params=["scipy", "pyfftw"])
def library(request, monkeypatch):
    if request.param == "scipy":
        monkeypatch.setattr(fourier, "installed", lambda library: None)
    elif installed("pyfftw") is None:
        pytest.skip("needs radhar[fast]")
    forget()
    yield request.param
    forget()


def forget():
    fourier._planned.cache_clear()


def frames_of(count: int, length: int, dtype=np.complex128) -> np.ndarray:
    rng = np.random.default_rng(count * length)
    return rng.standard_normal((count, length, 2)).view(complex)[..., 0].astype(dtype)


def spectra(frames: np.ndarray, size: int) -> np.ndarray:
    found = np.empty((len(frames), size), frames.dtype)
    fill_in_spectra(found, frames, np.hanning(frames.shape[1]) + 0.1)
    return found


@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
@pytest.mark.parametrize(
    ("count", "length", "size"),
    [(1, 1, 1), (1, 8, 8), (7, 9, 9), (5, 16, 21), (5, 15, 64), (1, 2 * COEFFICIENTS, None)],
)
def test_is_the_transform_of_windowed_frames(library, dtype, count, length, size):
    frames, size = frames_of(count, length, dtype), size or length
    padded = np.zeros((count, size), complex)
    padded[:, :length] = frames * (np.hanning(length) + 0.1)
    right = np.fft.fft(np.roll(padded, -(length // 2), axis=1), axis=1)
    error = np.linalg.norm(spectra(frames, size) - right)
    assert error < 8 * np.finfo(dtype).eps * np.linalg.norm(right)


def test_frames_are_taken_in_chunks_of_any_kind(library):
    """The last chunk is smaller, and padding stays zero in between."""
    size = COEFFICIENTS // 8
    frames = frames_of(19, 100)
    for some in (frames, frames[3:], frames[:9]):
        right = np.concatenate([spectra(one[None], size) for one in some])
        assert np.abs(spectra(some, size) - right).max() < 1e-13 * np.abs(right).max()


def test_magnitudes(library):
    frames, found = frames_of(5, 16), np.empty((5, 20))
    fill_in_spectra(found, frames, np.hanning(16) + 0.1)
    assert np.array_equal(found, np.abs(spectra(frames, 20)))


def test_threads_do_not_share_arrays(library):
    frames = [frames_of(300, 128 + k % 3) for k in range(24)]
    right = [spectra(one, 256) for one in frames]
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda one: spectra(one, 256), frames))
    assert all(map(np.array_equal, found, right))


@needs_fftw
def test_bytes_depend_on_nothing_that_was_transformed_before():
    """Not on the order of shapes, on where memory lies, nor on plans that were measured."""
    import pyfftw

    shapes = [(5, 96, 96), (8, 96, 96), (3, 100, 800)]
    frames = {shape: frames_of(*shape[:2], np.complex64) for shape in shapes}
    found: dict[tuple[int, ...], set[bytes]] = {shape: set() for shape in shapes}
    kept = []
    for order in permutations(shapes):
        forget()
        for shape in order:
            kept.append(bytearray(len(kept) * 8 + 1))
            found[shape].add(spectra(frames[shape], shape[2]).tobytes())
        for count, _, size in shapes:  # which leaves FFTW knowledge of how to do these
            arrays = (pyfftw.empty_aligned((count, size), np.complex64) for _ in range(2))
            pyfftw.FFTW(*arrays, axes=(1,), flags=("FFTW_MEASURE",))
    assert [len(of_shape) for of_shape in found.values()] == [1, 1, 1]


@needs_fftw
def test_dask_is_not_imported():
    """pyfftw would: that takes as long as thirty of the paper's samples."""
    program = """
import sys
from radhar_cli.numerics.accelerators import load
load("pyfftw").FFTW
assert "dask" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", program], check=True)


@needs_fftw
def test_long_frames_are_planned_one_by_one(monkeypatch):
    """Each of them fills the cache; more would only be thrown away."""
    planned, counts = fourier._planned, []

    def noted(count: int, *of):
        counts.append(count)
        return planned(count, *of)

    monkeypatch.setattr(fourier, "_planned", noted)
    spectra(frames_of(3, 100), COEFFICIENTS)
    assert counts == [1, 1, 1]
