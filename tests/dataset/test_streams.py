"""Data sets of streams: labels in time, whoever makes them."""

import csv
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

from radhar_cli.cli import program
from radhar_cli.config import Config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.stream_files import segments_text
from radhar_cli.processes.progress import NO_PROGRESS
from radhar_cli.scene.products.segments import SEGMENT_COLUMNS, column_times

VALUES: dict[str, Any] = {
    "activities": ("walking", "grabbing", "stationary"),
    "duration_s": 12.0,
    "stream": {"count": 3, "bout_s": {"uniform": [1.5, 3]}, "pause_s": 0.5},
    "radar": {
        "carrier_hz": 5.8e9,
        "bandwidth_hz": 250e6,
        "prf_hz": 400.0,
        "chirp_s": 1e-3,
        "adc_rate_hz": 2e5,
    },
    "processing": {"window_s": 0.25},
    "image": {"size_px": 32},
    "maps": ("rtm", "stft"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("streams") / "set"
    build(Config(**VALUES), path, 1, NO_PROGRESS)
    return path


def test_every_column_has_the_label_of_its_segment(folder: Path) -> None:
    with open_dataset(folder) as data:
        assert data.classes == ("stream",)
        assert data.frame_classes == ("walking", "grabbing", "stationary", "pause", "transition")
        for name in ("rtm", "stft"):
            assert data.maps[name].shape == (3, 32, 120)
            for row in range(3):
                labels = data.frame_label[name][row : row + 1][0, 0]
                t = column_times(data.extents(name)[row].tolist(), 120)
                for start, stop, label, person in data.products["segments"][row]:
                    assert person == 0
                    assert (labels[(t >= start) & (t < stop)] == label).all()
                assert (labels >= 0).mean() > 0.95


def test_the_table_beside_the_images_says_the_same(folder: Path) -> None:
    with open_dataset(folder) as data:
        lines = [*csv.DictReader((folder / "segments.csv").read_text().splitlines())]
        assert len(lines) == sum(data.products["segments"].counts)
        for line in lines:
            row, first, past = (
                int(line[key]) for key in ("index", "stft_first_column", "stft_past_column")
            )
            labels = data.frame_label["stft"][row : row + 1][0, 0]
            assert {data.frame_classes[n] for n in labels[first:past]} <= {line["class"]}
        assert segments_text(data) == (folder / "segments.csv").read_text()
    with h5py.File(folder / "dataset.h5") as file:
        assert file["products/segments"].attrs["columns"].tolist() == [*SEGMENT_COLUMNS]


def test_the_bytes_do_not_depend_on_who_makes_them(folder: Path, tmp_path: Path) -> None:
    build(Config(**VALUES), tmp_path / "set", 2, NO_PROGRESS, batch_size=1)
    for name in ("dataset.h5", "segments.csv", "scenes.csv"):
        assert (tmp_path / "set" / name).read_bytes() == (folder / name).read_bytes(), name


def test_a_table_that_was_lost_is_written_again(folder: Path) -> None:
    text = (folder / "segments.csv").read_text()
    (folder / "segments.csv").unlink()
    build(Config(**VALUES), folder, 1, NO_PROGRESS)
    assert (folder / "segments.csv").read_text() == text


def test_commands_read_them(folder: Path) -> None:
    for words in (["verify"], ["inspect"], ["preview", "--per-class", "2"]):
        result = CliRunner().invoke(program(), [words[0], str(folder), *words[1:]])
        assert result.exit_code == 0, result.output
    assert np.frombuffer((folder / "preview_rtm.png").read_bytes()[:4], np.uint8)[1] == ord("P")
