"""Point clouds of a data set in the formats of others."""

import csv
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml
from helpers.boards import CFG, CLOUDS
from helpers.command_line import radhar
from helpers.listener import Listener

from radhar_cli.dataset.formats.clouds import (
    MARS_JOINTS,
    clouds_of,
    kinect_joints,
    write_mars,
)
from radhar_cli.dataset.formats.convert import convert
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import FolderError
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.readers.ti.ti_cfg import parse_ti_cfg


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


def read_csv(path):
    with path.open() as file:
        lines = list(csv.DictReader(file))
    return {key: np.array([float(line[key]) for line in lines]) for key in lines[0]}


def read_as_voxels_py(path):
    """{field: numbers} and each point's frame, found as RadHAR's voxels.py finds them: by words."""
    words = path.read_text().split()
    pairs = list(pairwise(words))
    frame = np.cumsum([value == "0" for word, value in pairs if word == "point_id:"]) - 1
    fields = ("x", "y", "z", "velocity", "intensity", "range", "doppler_bin", "bearing", "point_id")
    return {
        name: np.array([float(value) for word, value in pairs if word == f"{name}:"])
        for name in fields
    } | {"frame": frame}


def loaded_as_mars_model_py(folder):
    """{split: (features, labels)} by the names and shapes that MARS_model.py loads."""
    parts = {
        part: tuple(np.load(folder / f"{name}_{part}.npy") for name in ("featuremap", "labels"))
        for part in ("train", "validate", "test")
    }
    assert {features.shape[1:] for features, _ in parts.values()} == {(8, 8, 5)}
    assert {labels.shape[1:] for _, labels in parts.values()} == {(57,)}
    # 24066 frames of 8 x 8 x 5 are 61609088 bytes in the published files.
    assert {array.dtype for part in parts.values() for array in part} == {np.dtype("<f8")}
    return parts


def test_mars_has_every_frame_with_its_points_and_joints(place):
    parts = loaded_as_mars_model_py(place / "mars")
    for split, part in enumerate(("train", "validate", "test")):
        features, labels = parts[part]
        frames = np.load(place / "mars" / f"frames_{part}.npy")
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
            assert there[:, :3].tolist() == sorted(clouds.xyz[mine].tolist())
            assert sorted(there[:, 3]) == sorted(clouds.doppler[mine])
            # x of all 19, y of all, z of all; these are ours under the Kinect's places.
            x_y_z = np.array([label[0:19], label[19:38], label[38:57]]).T
            ours = [JOINTS.index(name) for name in OURS_IN_MARS.values()]
            np.testing.assert_array_equal(x_y_z[[*OURS_IN_MARS]], clouds.joints[frame][ours])


# Places in the order of the Kinect, without its hands, finger tips and thumbs.
OURS_IN_MARS = {
    **{0: "hip", 1: "torso", 3: "head"},
    **{4: "left_shoulder", 5: "left_elbow", 6: "left_hand"},
    **{7: "right_shoulder", 8: "right_elbow", 9: "right_hand"},
    **{11: "left_knee", 12: "left_ankle", 15: "right_knee", 16: "right_ankle"},
}


def test_joints_of_the_kinect_that_ours_lack():
    """Medians of MARS's first subject, who stands and faces the radar (kinect_data_test.csv)."""
    measured = {
        **{"SpineBase": [0.17, 1.96, -0.11], "SpineMid": [0.17, 1.97, 0.22]},
        **{"Neck": [0.16, 1.98, 0.54], "Head": [0.15, 1.99, 0.69]},
        **{"ShoulderLeft": [0.35, 1.96, 0.41], "ShoulderRight": [-0.03, 1.96, 0.38]},
        **{"HipLeft": [0.25, 1.91, -0.11], "HipRight": [0.08, 1.92, -0.11]},
        **{"KneeLeft": [0.30, 1.97, -0.47], "KneeRight": [0.03, 1.95, -0.48]},
        **{"AnkleLeft": [0.33, 1.99, -0.85], "AnkleRight": [-0.02, 1.98, -0.86]},
        **{"FootLeft": [0.34, 1.90, -0.94], "FootRight": [-0.04, 1.88, -0.94]},
        "SpineShoulder": [0.16, 1.98, 0.46],
    }
    of_kinect = {MARS_JOINTS[place]: name for place, name in OURS_IN_MARS.items()}
    joints = np.array(
        [
            measured.get(next(k for k, ours in of_kinect.items() if ours == name), [0, 0, 0])
            for name in JOINTS
        ]
    )
    computed = dict(zip(MARS_JOINTS, kinect_joints(joints), strict=True))
    for name, position in measured.items():
        np.testing.assert_allclose(computed[name], position, atol=0.08, err_msg=name)


def test_mars_needs_the_joints_of_people(place, tmp_path, monkeypatch):
    """Recordings of 3 scatterers are no people."""
    with open_dataset(place / "set") as data:
        monkeypatch.setitem(data.products, "skeleton", np.empty((len(data), 5, 3, 3)))
        with pytest.raises(FolderError, match="3 joints; mars needs those of people, 13"):
            write_mars(data, tmp_path, Listener())


def test_axes_and_signs_of_the_formats(place):
    with open_dataset(place / "set") as data:
        loops = parse_ti_cfg(data.config.radar.cfg).timing.loops
        products = {
            row: (data.products["points"][row], data.products["skeleton"][row][:, 0])
            for row in range(len(data))
        }
    for split, (part, folder) in enumerate((("train", "Train"), ("validation", "Validation"))):
        for slug, name, row, clouds in samples(place, split):
            points, joints = products[row]
            ahead, left, up, doppler = points[:, :4].T
            ros = read_as_voxels_py(place / "ros" / folder / slug / f"{name}.txt")
            ti = read_csv(place / "ti" / part / slug / f"{name}.csv")
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
            # Frames without points leave no record: those of RadHAR are counted by `point_id: 0`.
            np.testing.assert_array_equal(
                ros["frame"], np.unique(ti["frame"], return_inverse=True)[1]
            )
            assert ((ros["point_id"] == 0) == (np.diff(ros["frame"], prepend=-1) > 0)).all()
            np.testing.assert_array_equal(clouds.joints[..., 0], -joints[..., 1])


def test_records_of_ros_are_yaml_with_the_fields_of_the_message(place):
    path = next((place / "ros" / "Train").rglob("*.txt"))
    *records, last = yaml.safe_load_all(path.read_text())
    assert last is None  # every record is closed
    fields = "header point_id x y z range velocity doppler_bin bearing intensity"
    assert [*records[0]] == fields.split()
    assert [record["header"]["seq"] for record in records] == [*range(len(records))]
    assert records[0]["header"]["frame_id"] == "ti_mmwave"
    stamps = [record["header"]["stamp"] for record in records]
    seconds = np.array([stamp["secs"] + 1e-9 * stamp["nsecs"] for stamp in stamps])
    with open_dataset(place / "set") as data:
        period = parse_ti_cfg(data.config.radar.cfg).timing.period_s
        frames = len(data.products["points_start"][0]) - 1
    np.testing.assert_allclose(seconds % period, 0, atol=1e-9)
    assert 0 <= seconds.min() <= seconds.max() <= (frames - 1) * period + 1e-9


@pytest.mark.parametrize(
    ("to", "words"),
    [
        ("mars", "no frames in test: MARS_model.py"),
        ("ros", "10 of 10 samples have fewer than 62 frames with points: RadHAR's voxels.py"),
    ],
)
def test_what_stops_the_published_scripts_is_warned_of(place, tmp_path, to, words):
    made = radhar("convert", place / "set", "-o", tmp_path / to, "--to", to, "-q")
    assert made.returncode == 0
    assert f"warning: {words}" in made.stderr


READER = {"mars": "numpy as np", "ros": "yaml", "ti": "csv"}


@pytest.mark.parametrize("to", ["mars", "ros", "ti"])
def test_the_folder_says_which_axes_and_units(place, to):
    card = (place / to / "README.md").read_text()
    assert f"\nimport {READER[to]}\n" in card
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
