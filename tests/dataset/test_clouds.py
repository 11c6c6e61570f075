"""Point clouds of a data set in the formats of others."""

import csv
from pathlib import Path

import numpy as np
import pytest
from command_line import radhar
from listener import Listener

from radhar_cli.config.ti_header import board_header
from radhar_cli.dataset.formats.clouds import clouds_of
from radhar_cli.dataset.formats.convert import convert
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import FolderError
from tests.boards import CFG, CLOUDS


@pytest.fixture(scope="module", params=["board", "best"])
def place(request, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("clouds")
    (folder / "board.cfg").write_text(CFG)
    (folder / "config.yaml").write_text(CLOUDS.replace("chain: board", f"chain: {request.param}"))
    made = radhar("generate", folder / "config.yaml", "-o", folder / "set", "--jobs", "1", "-q")
    assert made.returncode == 0, made.stderr
    for to in ("mars", "ros", "ti"):
        made = radhar("convert", folder / "set", "-o", folder / to, "--to", to, "-q")
        assert made.returncode == 0, made.stderr
    return folder


def samples(place, split):
    """(class slug, name, row, clouds) of every sample of a split."""
    with open_dataset(place / "set") as data:
        rows = Rows.of(data.config)
        for row in np.flatnonzero(data.split == split).tolist():
            yield data.class_slugs[data.label[row]], rows.name(row), row, clouds_of(data, row)


def read(place, to, part, slug, name):
    with (place / to / part / slug / f"{name}.csv").open() as file:
        lines = list(csv.DictReader(file))
    return {key: np.array([float(line[key]) for line in lines]) for key in lines[0]}


def test_mars_has_every_frame_with_its_points_and_joints(place):
    for split, part in enumerate(("train", "validation")):
        features, labels, frames = (
            np.load(place / "mars" / f"{name}_{part}.npy")
            for name in ("featuremap", "labels", "frames")
        )
        here = list(samples(place, split))
        assert len(features) == len(labels) == len(frames) == sum(len(c.joints) for *_, c in here)
        with open_dataset(place / "set") as data:
            keys = {tuple(data.sample_key[row]): clouds for *_, row, clouds in here}
        for feature, label, (number, index, frame) in zip(features, labels, frames, strict=True):
            clouds = keys[number, index]
            points = feature.reshape(64, 5)
            there = points[np.any(points != 0, axis=1)]
            mine = clouds.frame == frame
            assert len(there) == mine.sum()
            assert there[:, :3].tolist() == sorted(clouds.xyz[mine].astype(np.float32).tolist())
            assert sorted(there[:, 3]) == sorted(clouds.doppler[mine].astype(np.float32))
            np.testing.assert_array_equal(label.reshape(3, -1).T, clouds.joints[frame])


def test_axes_and_signs_of_the_formats(place):
    with open_dataset(place / "set") as data:
        loops = board_header(data.config.radar.cfg).loops
        products = {
            row: (data.products["points"][row], data.products["skeleton"][row][:, 0])
            for row in range(len(data))
        }
    for split, part in enumerate(("train", "validation")):
        for slug, name, row, clouds in samples(place, split):
            points, joints = products[row]
            ahead, left, up, doppler = points[:, :4].T
            ros, ti = (read(place, to, part, slug, name) for to in ("ros", "ti"))
            for axes in ((ros["x"], ros["y"], ros["z"]), (ti["y"], -ti["x"], ti["z"])):
                np.testing.assert_allclose(axes, [ahead, left, up], rtol=2e-5, atol=1e-6)
            np.testing.assert_allclose(ros["velocity"], -doppler, rtol=2e-5, atol=1e-6)
            np.testing.assert_allclose(ti["doppler"], -doppler, rtol=2e-5, atol=1e-6)
            np.testing.assert_allclose(ros["range"], np.linalg.norm(points[:, :3], axis=1), 2e-5)
            assert (np.sign(ros["bearing"]) == np.sign(left)).all()
            moving = np.abs(points[:, 7]) >= 1
            away = ros["doppler_bin"] > loops // 2
            assert (away[moving] == (doppler[moving] < 0)).all()
            np.testing.assert_allclose(ti["snr"], points[:, 5], rtol=2e-5, atol=1e-6)
            assert set(ti["track"]) <= {0, 255}
            assert (ros["frame"] == ti["frame"]).all()
            assert (np.diff(ros["frame"]) >= 0).all()
            first = np.diff(ros["frame"], prepend=-1) > 0
            assert ((ros["point_id"] == 0) == first).all()
            np.testing.assert_array_equal(clouds.joints[..., 0], -joints[..., 1])


@pytest.mark.parametrize("to", ["mars", "ros", "ti"])
def test_the_folder_says_which_axes_and_units(place, to):
    card = (place / to / "README.md").read_text()
    if to != "mars":
        assert "\nimport csv\n" in card
    for word in ("right" if to != "ros" else "left", "receding", "m/s"):
        assert word in card
    assert (place / to / "config.yaml").exists()


def test_images_alone_have_no_clouds(tmp_path, place):
    text = CLOUDS.replace(", points", "").replace("0.5", "0.2")
    (tmp_path / "board.cfg").write_text(CFG)
    (tmp_path / "config.yaml").write_text(text)
    made = radhar("generate", tmp_path / "config.yaml", "-o", tmp_path / "set", "-j", "1", "-q")
    assert made.returncode == 0, made.stderr
    with pytest.raises(FolderError, match="has no points; mars needs"):
        convert(tmp_path / "set", tmp_path / "out", "mars", Listener())
    assert not (tmp_path / "out").exists()


def test_clouds_without_a_point_are_stored_with_zero_rows(tmp_path):
    # No cell exceeds its neighbours by this threshold, the largest number of a .cfg.
    (tmp_path / "board.cfg").write_text(CFG.replace("3 0 1130", "3 0 32767"))
    few = CLOUDS.replace("samples_per_class: 5", "samples_per_class: 2").replace(
        "{train: 0.6, validation: 0.4}", "{train: 0.5, validation: 0.5}"
    )
    (tmp_path / "config.yaml").write_text(few)
    config, out = tmp_path / "config.yaml", tmp_path / "set"
    made = radhar("generate", config, "-o", out, "--jobs", "1", "-q")
    assert made.returncode == 0, made.stderr
    with open_dataset(out) as data:
        assert data.products["points"].shape == (0, 8)
        assert data.products["points_person"].shape[0] == 0
        for row in range(len(data)):
            clouds = clouds_of(data, row)
            assert len(clouds.xyz) == len(clouds.person) == 0
            assert len(clouds.joints) == len(data.products["points_start"][row]) - 1
    for arguments in (["verify", out], ["convert", out, "-o", tmp_path / "mars", "--to", "mars"]):
        made = radhar(*arguments, "-q")
        assert made.returncode == 0, made.stderr
