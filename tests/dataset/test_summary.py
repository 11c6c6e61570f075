"""`inspect` tells what a data set, a half-built folder or a scene holds."""

import shutil

import pytest
from helpers.small import full_disk_after, small_config

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.summary import summarise
from radhar_cli.errors import FolderError
from radhar_cli.scene.single.scene_file import write_all
from radhar_cli.scene.single.simulate import simulate


@pytest.mark.parametrize("name", ["", "dataset.h5"])
def test_data_set(small_set, name):
    found = summarise(small_set / name)
    assert found["kind"] == "data set"
    assert found["samples"] == 9
    assert found["classes"]["walking"] == {"train": 2, "validation": 1, "test": 0}
    assert found["maps"]["rtm"] == [48, 48]
    assert found["seed"] == 7
    assert found["drawn"]["height"]["samples"] == 9
    assert "carrier" not in found["drawn"], "a fixed number is not drawn"
    assert found["entropy_bits"]["stft"]["walking"]["mean"] > 0


def test_inspect_of_an_unfinished_build_shows_its_progress(tmp_path):
    config = load_config(small_config(tmp_path))
    with full_disk_after(4):
        build(config, tmp_path / "set", 1, BarProgress(), batch_size=2)
    found = summarise(tmp_path / "set")
    assert (found["kind"], found["finished"], found["samples"]) == ("unfinished data set", 4, 9)
    with pytest.raises(FolderError, match="unfinished"):
        open_dataset(tmp_path / "set")


def test_scene(tmp_path):
    simulation = simulate(load_config(small_config(tmp_path)), "S12", maps=("stft",))
    write_all(simulation, tmp_path)
    for path in (tmp_path, tmp_path / "scene.h5"):
        found = summarise(path)
        assert found["kind"] == "scene"
        assert found["activity"]["slug"] == "walking_to_falling"


def test_foreign_files_are_refused(small_set, tmp_path):
    import h5py

    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    (tmp_path / "text.h5").write_text("hello")
    shutil.copy(small_set / "dataset.h5", tmp_path / "cut.h5")
    with (tmp_path / "cut.h5").open("r+b") as cut:
        cut.truncate(4000)
    for name in ("other.h5", "text.h5", "cut.h5", "none.h5", ""):
        with pytest.raises(FolderError):
            summarise(tmp_path / name)


def test_dataset_reads_lazily_and_suggests_maps(small_set):
    with open_dataset(small_set) as data:
        assert data.maps["stft"][0].shape == (48, 48)
        assert data.map_name(None) == "rtm"
        with pytest.raises(FolderError, match="did you mean 'stft'"):
            data.map_name("sttf")
