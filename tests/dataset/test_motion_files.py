"""A data set with two of the twelve and two user-defined classes, from files and from the model."""

import shutil
from collections import OrderedDict

import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.listener import Listener
from helpers.recorded import frames, write_amc, write_bvh, write_npz
from helpers.small import fingerprint

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.motion_files import set_motion_folder
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.split import split_rows, split_warnings
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import FolderError, MotionFileError
from radhar_cli.scene import motion_files

CONFIG = """
seed: 5
samples_per_class: 6
duration_s: 1.5
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
motion: {model: human, range_m: {uniform: [4, 5]}, angle_deg: 180}
activities: [walking, kicking, wave, rise]
classes:
  rise: {files: [rise.amc], section_s: [0.2, 2.5], past_end: rest}
  walking: [walks/*.bvh]
  wave: {files: [wave.npz], up: z}
maps: [stft]
image: {size_px: 32}
split: {train: 0.67, validation: 0.33}
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """The config, its files, and the data set `out` built from them."""
    folder = tmp_path_factory.mktemp("files")
    walk = frames("walking", 2.5, 60.0)
    for number in range(3):
        write_bvh(folder / f"walks/{number}.bvh", walk[5 * number :], 60.0)
    write_npz(folder / "wave.npz", frames("punching", 2.5, 60.0), 60.0)
    write_amc(folder / "rise.amc", frames("standing_up", 2.0))
    (folder / "set.yaml").write_text(CONFIG)
    build(load_config(folder / "set.yaml"), folder / "out", 1, Listener())
    return folder


def test_labels_columns_and_folders_follow(place):
    with open_dataset(place / "out") as data:
        assert [data.class_slugs[label] for label in data.label[::6]] == [
            *("walking", "kicking", "wave", "rise")
        ]
        assert data.label[::6].tolist() == [0, 1, 2, 3]
        files = data.scene["walking_file"][:]
        assert set(files[:6]) <= {0, 1, 2}
        assert np.isnan(files[6:]).all()
        assert np.isnan(data.scene["kick"][12:]).all()
        assert data.maps["stft"][:].std(axis=(1, 2)).min() > 5
    assert sorted(p.name for p in (place / "out/png/stft/train").iterdir() if p.is_dir()) == [
        *("kicking", "rise", "walking", "wave")
    ]


def test_bytes_depend_on_the_files_and_not_on_where_they_lie(place, tmp_path, monkeypatch):
    shutil.copytree(place, tmp_path / "moved", ignore=shutil.ignore_patterns("out"))
    moved = load_config(tmp_path / "moved/set.yaml")
    build(moved, tmp_path / "again", 2, Listener(), batch_size=5)
    assert fingerprint(tmp_path / "again") == fingerprint(place / "out")
    walk = tmp_path / "moved/walks/1.bvh"
    walk.write_text(walk.read_text().replace("Frames", " Frames"))
    with pytest.raises(FolderError, match=r"differs in\n.*classes\.walking\.files\.walks/1\.bvh"):
        build(load_config(tmp_path / "moved/set.yaml"), tmp_path / "again", 1, Listener())
    monkeypatch.setattr(motion_files, "_clips", OrderedDict())  # as in a process that begins
    with pytest.raises(MotionFileError, match="is not the file it was"):
        build(moved.model_copy(update={"seed": 6}), tmp_path / "third", 1, Listener())


def test_persons_that_share_files_are_warned_of(place):
    config = load_config(place / "set.yaml", ["split.by=subject", "split.subjects=3"])
    assert split_warnings(config, split_rows(config)) == [
        f"classes.{slug}: 1 files for split.subjects = 3: "
        "persons of training and validation share them"
        for slug in ("wave", "rise")
    ]


def test_verify_opens_no_file_that_a_data_set_names(place):
    report = verify(place / "out", 24)
    assert (report.problems, report.resynthesised, report.unmade) == ([], 6, 18)
    report = verify(place / "out", 24, place)
    assert (report.problems, report.resynthesised, report.unmade) == ([], 24, 0)
    done = radhar("verify", place / "out", "--samples", 4)
    assert "--motion FOLDER checks them" in done.stdout


def test_a_written_scene_is_the_same_recording(place, tmp_path):
    import h5py

    common = ["--no-figures", "--maps", "stft", "-o"]
    first = radhar(
        *("simulate", place / "set.yaml", "--activity", "walking", "--index", 4, *common),
        tmp_path / "a",
    )
    assert "motion: walks/" in first.stdout
    radhar("simulate", tmp_path / "a/scene.yaml", "--index", 4, *common, tmp_path / "b")
    with h5py.File(tmp_path / "a/scene.h5") as a, h5py.File(tmp_path / "b/scene.h5") as b:
        assert np.array_equal(a["slow_time/raw"], b["slow_time/raw"])
        assert a["truth/positions"].shape == (750, 13, 3)
        assert a["truth/hip_joints"].shape == (750, 2, 3)
    with open_dataset(place / "out") as data:
        file = int(data.scene["walking_file"][4])
    assert f"walks/{file}.bvh" in (tmp_path / "a/scene.yaml").read_text()
    ok("inspect", tmp_path / "a")


def test_a_short_file_is_warned_of(place, tmp_path):
    config = load_config(
        place / "set.yaml",
        ["duration_s=3", "activities=[walking]", "samples_per_class=2", "output.png=false"],
    )
    listener = Listener()
    build(config, tmp_path / "long", 1, listener)
    assert any("2 of 2 recordings: the motion file ends" in line for line in listener.messages)


def test_two_user_defined_classes_alone(place, tmp_path):
    """With `motion.model: file` the classes are those of the files, two of them here."""
    config = load_config(
        place / "set.yaml",
        [
            *(
                "motion.model=file",
                "activities=all",
                "classes={a: [walks/*.bvh], b: {files: [wave.npz], up: z}}",
            ),
            "samples_per_class=3",
        ],
    )
    build(config, tmp_path / "two", 1, Listener())
    assert verify(tmp_path / "two", 6, place).problems == []
    pytest.importorskip("torch")
    ok("train", tmp_path / "two", "-o", tmp_path / "run", "--model", "smallnet",
                 "--set", "epochs=1", "--set", "batch_size=4")  # fmt: skip
    assert radhar("eval", tmp_path / "run", tmp_path / "two").returncode == 0


@pytest.mark.parametrize("path", ["/etc/walk.bvh", "../elsewhere/walk.bvh", "a/../../walk.bvh"])
def test_motion_file_paths_cannot_leave_the_given_folder(path, tmp_path):
    config = Config(classes={"wave": {"files": {path: "0" * 64}}}, activities=("wave",))
    with pytest.raises(FolderError, match=r"names .* which lies outside"):
        set_motion_folder(config, tmp_path)
