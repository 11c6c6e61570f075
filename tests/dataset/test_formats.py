"""A data set as a folder and as Parquet, read with the libraries that they are made for."""

import csv
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
import torch
import yaml
from helpers.command_line import ROOT, radhar
from helpers.listener import Listener
from helpers.small import edited, fingerprint, small_config

from radhar_cli.config import load_config
from radhar_cli.dataset import layout
from radhar_cli.dataset.build import build
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.dataset.formats import parquet, webdataset
from radhar_cli.dataset.formats.convert import convert
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.table import number_names
from radhar_cli.errors import FolderError
from radhar_cli.learning.samples import Samples
from radhar_cli.learning.torch_dataset import torch_dataset

READER = Path(__file__).with_name("read_by_others.py")
CONFIG = """
seed: 3
samples_per_class: {per_activity: {default: 5, home: 7}}
classes: {home: {sequence: [grabbing, walking]}}
activities: [punching, home, kicking, grabbing]
duration_s: 3.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
motion: {range_m: 5}
snr_db: {choice: [30, 10]}
on_invalid: redraw
maps: [rtm, stft]
image: {size_px: [12, 16]}
split: {by: subject, subjects: 5, train: 0.6, validation: 0.2, test: 0.2}
output: {power: float16, slow_time: true, column_labels: true}
"""
SPLITS = ("train", "validation", "test")


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A data set with small folders, and Parquet of it in several small files."""
    place = tmp_path_factory.mktemp("formats")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(layout, "PNGS_A_FOLDER", 5)
        patch.setattr(parquet, "FILE_BYTES", 6 * 12 * 16)
        patch.setattr(parquet, "GROUP", 2)
        build(load_config(small_config(place, CONFIG)), place / "set", 1, Listener())
        assert convert(place / "set", place / "parquet", "parquet", Listener()) == 22
        patch.setattr(webdataset, "SHARD_SAMPLES", 4)
        assert convert(place / "set", place / "tars", "webdataset", Listener()) == 22
    return place


@pytest.fixture
def h5(place):
    with h5py.File(place / "set/dataset.h5") as file:
        yield file


def line(h5, row):
    """What every table should say of a row."""
    number, index = h5["sample_key"][row].tolist()
    names = number_names(load_config(Path(h5.filename).with_name("config.yaml")))
    scene = {name: h5["scene"][name][row].item() for name in names}
    expected = {name: None if value != value else value for name, value in scene.items()}
    assert number == h5["label"][row]
    return {
        "label": h5["label"].attrs["names"][number],
        "number": number,
        "index": index,
        **expected,
    }


def digest(levels):
    return hashlib.sha256(np.asarray(levels).tobytes()).hexdigest()


def rows_of(h5, split):
    """Rows of a split in the order of the tables: classes take turns."""
    key = h5["sample_key"][:]
    rows = np.flatnonzero(h5["split"][:] == SPLITS.index(split)).tolist()
    return sorted(rows, key=lambda row: (key[row, 1], row))


def test_each_folder_is_read_by_the_libraries_it_is_for(place, h5, tmp_path):
    done = subprocess.run(
        [sys.executable, READER, place],
        capture_output=True,
        text=True,
        env={
            **os.environ,
            "PYTHONPATH": str(ROOT),
            "HF_HOME": str(tmp_path),
            "HF_HUB_OFFLINE": "1",
        },
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    for name in ("rtm", "stft"):
        there = found["parquet"][name]
        assert there["labels"] == ["punching", "home", "kicking", "grabbing"]
        own = found["set"][name]
        assert own["labels"] == there["labels"]
        for split in SPLITS:
            named = ("label", "number", "index", "image")
            listed = sorted([row[key] for key in named] for row in there["parts"][split])
            assert sorted([row[key] for key in named] for row in own["parts"][split]) == listed
            right = [
                {"image": digest(h5[f"maps/{name}"][row]), **line(h5, row)}
                for row in rows_of(h5, split)
            ]
            assert there["parts"][split] == right
    train = place / "set/png/stft/train"
    files = sorted(path.relative_to(train) for path in train.rglob("*.png"))
    names = list(h5["label"].attrs["names"])
    assert sorted(found["tree"]) == [
        [str(path), path.parts[0], names.index(path.parts[0])] for path in files
    ]
    assert any("home/0001/" in path for path, *_ in found["tree"])
    for split in SPLITS:
        rows = rows_of(h5, split)
        lines = [line(h5, row) for row in rows]
        digests = [digest(h5["maps/stft"][row]) for row in rows]
        pairs = list(zip(lines, digests, strict=True))
        assert sorted(found["imagefolder"][split]) == sorted(
            [one["number"], one["label"], one["index"], image] for one, image in pairs
        )
        json_lines = [
            {
                **{key: value for key, value in one.items() if key not in ("label", "number")},
                **{"class": one["label"], "label": one["number"], "split": split},
                **{"key": f"{one['label']}_{one['index']:05d}", "cls": one["number"]},
                "image": image,
            }
            for one, image in pairs
        ]
        assert len(found["tars"][split]) == len(json_lines)
        for read, right in zip(found["tars"][split], json_lines, strict=True):
            assert read == right
    assert found["tars_by_hub"] == len(rows_of(h5, "train"))


def test_every_reader_of_ours_has_the_same_labels(place, h5):
    """0 to C - 1 in the config's order, which is neither the alphabet's nor the paper's."""
    stored, names = h5["label"][:].tolist(), ("punching", "home", "kicking", "grabbing")
    assert set(stored) == set(range(len(names)))
    with open_dataset(place / "set") as data:
        assert (data.classes, data.label.tolist()) == (names, stored)
        assert data.sample_key[:][:, 0].tolist() == stored
    samples = Samples(place / "small.yaml")
    assert (samples.classes, samples.label.tolist()) == (names, stored)
    assert samples[7]["label"] == stored[7]
    for path in (place / "set", place / "set/dataset.h5", place / "set/png/stft"):
        images = torch_dataset(path)
        samples = images.images.samples
        labels = dict(zip(samples.name, samples.label, strict=True))
        assert images.classes == names
        assert all(names[label] == name.split("/")[0] for name, label in labels.items())
        logits = torch.zeros(len(images), len(images.classes))
        found = torch.tensor([images[row][1] for row in range(len(images))])
        assert torch.nn.CrossEntropyLoss()(logits, found) > 0
    with (place / "set/scenes.csv").open() as file:
        assert [(int(row["label"]), row["slug"]) for row in csv.DictReader(file)] == [
            (label, names[label]) for label in stored
        ]
    assert (place / "tars/classes.txt").read_text().split() == list(names)


def test_tar_files_are_cut_and_have_the_same_bytes_again(place, tmp_path, monkeypatch):
    monkeypatch.setattr(webdataset, "SHARD_SAMPLES", 4)
    convert(place / "set", tmp_path / "again", "webdataset", Listener())
    assert fingerprint(place / "tars") == fingerprint(tmp_path / "again")
    names = sorted(path.name for path in (place / "tars/rtm").glob("train-*"))
    assert names == [f"train-{n:06d}.tar" for n in range(len(names))]
    assert len(names) > 1
    assert f"train-{{000000..{len(names) - 1:06d}}}.tar" in (place / "tars/README.md").read_text()


@pytest.mark.parametrize(
    ("version", "message"),
    [(2, "2: should be 3, in which labels"), (4, "4: is written by a newer radhar, .* update")],
)
def test_a_data_set_of_another_numbering_is_refused_in_a_line(version, message, place, tmp_path):
    other = tmp_path / "dataset.h5"
    with edited(place / "set/dataset.h5", other) as file:
        file.attrs["schema_version"] = version
    with pytest.raises(FolderError, match=f"schema_version = {message}") as refused:
        open_dataset(other)
    assert refused.value.status == 2


def test_files_are_cut_and_groups_are_small(place, h5):
    count = int((h5["split"][:] == 0).sum())
    names = sorted(path.name for path in (place / "parquet/stft").glob("train-*"))
    files = -(-count // 6)
    assert names == [f"train-{n:05d}-of-{files:05d}.parquet" for n in range(files)]
    held = [pq.ParquetFile(place / "parquet/stft" / name) for name in names]
    assert [one.metadata.num_rows for one in held] == [6] * (count // 6) + [count % 6] * (
        count % 6 > 0
    )
    assert held[0].metadata.row_group(0).num_rows == 2


def test_parquet_holds_the_png_files(place, h5):
    for path in sorted((place / "parquet/rtm").iterdir()):
        for one in pq.read_table(path).to_pylist():
            image, split = one["image"], path.name.split("-")[0].replace("validation", "val")
            assert image["bytes"] == (place / "set/png/rtm" / split / image["path"]).read_bytes()


def test_it_has_a_card_and_the_same_bytes_again(place, tmp_path):
    convert(place / "set/dataset.h5", tmp_path / "a", "parquet", Listener())
    convert(place / "set", tmp_path / "deep/b", "parquet", Listener())
    assert fingerprint(tmp_path / "a") == fingerprint(tmp_path / "deep/b")
    assert {path.name for path in tmp_path.iterdir()} == {"a", "deep"}
    card = (tmp_path / "a/README.md").read_text()
    front = yaml.safe_load(card.split("---\n")[1])
    assert "22 samples of 4 classes" in card
    for one in front.get("configs", []):
        for part in one["data_files"]:
            assert [*(tmp_path / "a").glob(part["path"])]


def test_what_a_killed_run_left_is_cleared_and_a_run_at_work_is_not(place, tmp_path):
    left = tmp_path / ".parquet.unfinished"
    (left / "set").mkdir(parents=True)
    (left / "set/half.parquet").write_bytes(b"half")
    with folder_lock(left), pytest.raises(FolderError, match="another run is writing here"):
        convert(place / "set", tmp_path / "parquet", "parquet", Listener())
    assert (left / "set/half.parquet").exists()
    convert(place / "set", tmp_path / "parquet", "parquet", Listener())
    assert [path.name for path in tmp_path.iterdir()] == ["parquet"]
    assert not (tmp_path / "parquet/half.parquet").exists()
    (tmp_path / ".other.unfinished").symlink_to(tmp_path / "parquet")
    with pytest.raises(FolderError, match="is a symbolic link"):
        convert(place / "set", tmp_path / "other", "parquet", Listener())


def test_damaged_data_sets_are_not_converted(place, tmp_path):
    damaged = tmp_path / "dataset.h5"
    with edited(place / "set/dataset.h5", damaged) as file:
        file["maps/stft"][7, 3, 3] ^= 1
    done = radhar("convert", damaged, "-o", tmp_path / "out", "--to", "parquet")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].endswith("/maps/stft[7]: does not match its checksum")
    assert [path.name for path in tmp_path.iterdir()] == ["dataset.h5"], "nothing half written"


def test_a_label_of_another_row_is_refused(place, tmp_path):
    damaged = tmp_path / "dataset.h5"
    with edited(place / "set/dataset.h5", damaged) as file:
        file["label"][0] = 3
    done = radhar("convert", damaged, "-o", tmp_path / "out", "--to", "parquet")
    assert done.returncode == 2
    assert "/label[0]: is 3; should be 0, punching" in done.stderr
