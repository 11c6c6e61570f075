"""Untrusted virtual data sets: samples come from the folder of the file, or from nowhere."""

import os
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from radhar_cli.dataset.untrusted_hdf5 import UntrustedFile
from radhar_cli.errors import FolderError

SHAPE = (4, 8, 8)
Layout = h5py.VirtualLayout
Source = h5py.VirtualSource
CASES: dict[str, tuple[Callable[[Path, Layout], None], str]] = {}


def case(
    message: str,
) -> Callable[[Callable[[Path, Layout], None]], Callable[[Path, Layout], None]]:
    def register(fill: Callable[[Path, Layout], None]) -> Callable[[Path, Layout], None]:
        CASES[fill.__name__] = fill, message
        return fill

    return register


def samples(path: Path, name: str = "maps/stft", rows: int = 4, dtype: str = "u1") -> Path:
    with h5py.File(path, "w") as file:
        pixels = np.full((rows, *SHAPE[1:]), 77, dtype)
        file.create_dataset(name, data=pixels, chunks=(1, *SHAPE[1:]), compression="gzip")
    return path


def from_file(name: str, message: str, rows: int = 4) -> None:
    """A data set whose second half comes from a file of that name."""

    def fill(place: Path, layout: Layout) -> None:
        layout[:2] = Source("good.h5", "maps/stft", (2, *SHAPE[1:]), "u1")
        layout[2:] = Source(name.format(place), "maps/stft", (2, *SHAPE[1:]), "u1")

    CASES[name] = fill, message


from_file("{}/good.h5", "lies in another file")
from_file("../secret.h5", "lies in another file")
from_file("parts/../../secret.h5", "lies in another file")
from_file("link.h5", "lies in another file")
from_file("linked/secret.h5", "lies in another file")
from_file("pipe.h5", "should be a regular file")
from_file(".", "should be a regular file")
from_file("gone.h5", "not an HDF5 file|[nN]o such file")
from_file("short.h5", r"has the shape \(1, 8, 8\); should have \(2, 8, 8\)")
from_file("floats.h5", "of the type float64")
from_file("virtual.h5", "lies in another file")
from_file("external.h5", "is a link")


@case("refers to another dataset")
def another_dataset(place: Path, layout: Layout) -> None:
    layout[:] = Source("good.h5", "label", SHAPE, "u1")


@case("refers to 2 samples; should be 4")
def rows_that_come_from_nowhere(place: Path, layout: Layout) -> None:
    layout[:2] = Source("good.h5", "maps/stft", (2, *SHAPE[1:]), "u1")


@case("refers to 0 samples; should be 4")
def no_rows(place: Path, layout: Layout) -> None:
    pass


@case("refers to rows from 2 on; should be from 0 on")
def rows_in_disorder(place: Path, layout: Layout) -> None:
    for start in (2, 0):
        layout[start : start + 2] = Source("good.h5", "maps/stft", (2, *SHAPE[1:]), "u1")


@case("refers to a piece")
def a_piece_of_a_file(place: Path, layout: Layout) -> None:
    layout[:] = Source("good.h5", "maps/stft", (9, *SHAPE[1:]), "u1")[2:6]


@case("refers to pieces of samples")
def halves_of_samples(place: Path, layout: Layout) -> None:
    layout[:, :4] = Source("good.h5", "maps/stft", (4, 4, 8), "u1")


@case("refers to 5 parts, more than samples")
def many_parts(place: Path, layout: Layout) -> None:
    for _ in range(5):
        layout[:1] = Source("good.h5", "maps/stft", (1, *SHAPE[1:]), "u1")


@pytest.mark.parametrize("name", CASES)
def test_refused(name: str, tmp_path: Path) -> None:
    place = tmp_path / "set"
    (place / "parts").mkdir(parents=True)
    samples(tmp_path / "secret.h5", rows=2)
    samples(place / "good.h5", rows=2)
    samples(place / "short.h5", rows=1)
    samples(place / "floats.h5", rows=2, dtype="f8")
    (place / "link.h5").symlink_to(tmp_path / "secret.h5")
    (place / "linked").symlink_to(tmp_path)
    os.mkfifo(place / "pipe.h5")
    for inner, made in (("virtual", virtual), ("external", external)):
        with h5py.File(place / f"{inner}.h5", "w") as file:
            made(file)
    fill, message = CASES[name]
    with h5py.File(place / "dataset.h5", "w") as file:
        layout = Layout(SHAPE, "u1")
        fill(place, layout)
        file.create_virtual_dataset("maps/stft", layout)
    with (
        UntrustedFile(place / "dataset.h5", virtual=True) as opened,
        pytest.raises(FolderError, match=message),
    ):
        opened.chunks("maps/stft", np.uint8, SHAPE)[:]
    with (
        UntrustedFile(place / "dataset.h5") as opened,
        pytest.raises(FolderError, match="lies in another file"),
    ):
        opened.chunks("maps/stft", np.uint8, SHAPE)


def virtual(file: h5py.File) -> None:
    layout = Layout((2, *SHAPE[1:]), "u1")
    layout[:] = Source("good.h5", "maps/stft", (2, *SHAPE[1:]), "u1")
    file.create_virtual_dataset("maps/stft", layout)


def external(file: h5py.File) -> None:
    file["maps/stft"] = h5py.ExternalLink("../secret.h5", "/maps/stft")
