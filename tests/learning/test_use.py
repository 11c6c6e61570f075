"""Networks that are used: called on arrays, and asked about clouds of anybody's files."""

import json
from pathlib import Path

import numpy as np
import pytest
from helpers.boards import CFG, CLOUDS
from helpers.command_line import ok, radhar
from numpy.typing import NDArray
from PIL import Image

import radhar_cli
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.sequences import cloud_frames

QUICK = [
    word
    for setting in ("device=cpu", "precision=float32", "threads=1", "epochs=1", "batch_size=4")
    for word in ("--set", setting)
]
SAID = ("--set", "axes=[right,ahead,up]", "--set", "doppler=receding", "--device", "cpu")


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set of clouds, with runs of joints and of classes of them, and of its pictures."""
    folder = tmp_path_factory.mktemp("use")
    (folder / "board.cfg").write_text(CFG)
    (folder / "board.yaml").write_text(CLOUDS)
    ok("generate", folder / "board.yaml", "-o", folder / "data", "--jobs", 1, "-q")
    for name, words in {
        "joints": ("--model", "cloudnet", "--target", "skeleton"),
        "classes": ("--model", "cloudnet"),
        "maps": ("--model", "smallnet", "--map", "range_doppler"),
        "gray": ("--model", "smallnet", "--map", "range_doppler", "--set", "input=gray"),
    }.items():
        ok("train", folder / "data", "-o", folder / name, *words, *QUICK)
    return folder


@pytest.fixture(scope="module")
def clouds(place: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points [n, 8] and starts [frames + 1] of the first sample."""
    with open_dataset(place / "data") as data:
        return data.products["points"][0].astype(float), data.products["points_start"][0]


@pytest.fixture(scope="module")
def table(place: Path, clouds: tuple[NDArray[np.float64], NDArray[np.int64]]) -> Path:
    """A table of these points in TI's axes, from frame 40 on."""
    points, start = clouds
    frame = 40 + np.repeat(np.arange(len(start) - 1), np.diff(start))
    x, y, z, doppler, intensity, snr = points.T[:6]
    path = place / "points.csv"
    rows = np.column_stack([frame, -y, x, z, -doppler, intensity, snr])
    np.savetxt(path, rows, "%.9g", ",", header="frame,x,y,z,doppler,intensity,snr", comments="")
    columns = ("frame", "x", "y", "z", "doppler", "intensity", "snr")
    np.savez(place / "points.npz", **dict(zip(columns, rows.T, strict=True)))
    return path


@pytest.mark.drawn
def test_joints_of_a_table_are_those_of_the_data_set(place: Path, table: Path) -> None:
    known = radhar_cli.load_run(place / "joints", "cpu").predict(place / "data")
    for file in (table, table.with_suffix(".npz")):
        found = place / "found.npz"
        ok("predict", place / "joints", file, "-o", found, "--overlay", place / "f.png", *SAID)
        with np.load(found) as arrays:
            np.testing.assert_allclose(arrays["joints"][0], known.joints[0], atol=1e-4)
            assert arrays["first_frame"].tolist() == [40]
    with Image.open(place / "f.png") as picture:
        colours = len(picture.convert("RGB").getcolors(2**24))
    assert colours > 100, "points are coloured by their speed"


def test_a_longer_table_is_read_from_end_to_end(place: Path, table: Path) -> None:
    lines = table.read_text().splitlines()
    frames = [int(float(line.split(",")[0])) for line in lines[1:]]
    length = max(frames) - min(frames) + 1
    later = [
        ",".join([str(frame + length + 1), *line.split(",")[1:]])
        for frame, line in zip(frames, lines[1:], strict=True)
    ]
    path = place / "long.csv"
    path.write_text("\n".join([*lines, *later, ""]))
    ok("predict", place / "joints", path, "-o", place / "long.json", *SAID)
    documents = json.loads((place / "long.json").read_text())
    assert [document["first_frame"] for document in documents] == [40, 40 + length, 40 + 2 * length]
    counts = [len(document["joints"]["head"]) for document in documents]
    assert counts == [length, length, 1], "the lost frame is one of them"


def test_a_recording_of_points_is_read(place: Path, table: Path) -> None:
    ok("prepare", "points", table, "-o", place / "own", "--jobs", 1, "-q", *SAID[:4],
       "--set", "frame_s=0.1", "--set", "label=walking", "--set", "recordings.window_s=0.2",
       "--set", "split={train: 1, validation: 0}")  # fmt: skip
    (recording,) = (place / "own/recordings").rglob("*.h5")
    known = radhar_cli.load_run(place / "joints", "cpu").predict(place / "data")
    found = radhar_cli.load_run(place / "joints", "cpu").predict(recording)
    np.testing.assert_allclose(found.joints[0], known.joints[0], atol=1e-4)
    with pytest.raises(ValueError, match="joints have no probabilities"):
        found.likeliest  # noqa: B018
    done = radhar("predict", place / "joints", recording, *SAID[:2])
    assert done.returncode == 2
    assert "says its axes itself" in done.stderr


def test_what_a_table_does_not_say_is_asked_for_in_a_line(place: Path, table: Path) -> None:
    strange = place / "strange.csv"
    strange.write_text("t,x,y,z,doppler\n1,2,3,4,5\n")
    far = place / "far.csv"
    step = "".join(f"{900 * n},0,2,0,0\n" for n in range(200))
    far.write_text(f"frame,x,y,z,doppler\n{step}")
    for words, said in (
        ((table,), "axes and doppler are missing (--set axes="),
        ((strange, *SAID[:4]), "none of which is plainly frame: --set columns.frame=NAME"),
        ((far, *SAID[:4]), "has 179101 frames; should have 1 to 100000"),
        ((place / "data", "--set", "doppler=receding"), "is no table of points"),
        ((place / "f.txt",), "no such file"),
        ((table, "--overlay", "x.jpg"), "--overlay x.jpg: should end in .png"),
    ):
        done = radhar("predict", place / "joints", *words)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
        assert said in done.stderr


def test_a_run_is_called_on_arrays_as_data_sets_have_them(
    place: Path, clouds: tuple[NDArray[np.float64], NDArray[np.int64]]
) -> None:
    points, start = clouds
    run = radhar_cli.load_run(place / "classes", device="cpu")
    assert (run.target, run.classes) == ("classes", ("punching", "walking"))
    assert run.input_shape == (len(start) - 1, 64, 6)
    assert "Doppler (m/s, approaching)" in run.units["inputs"]
    probabilities = run(cloud_frames(points, start, 64)[None])
    known = run.predict(place / "data")
    np.testing.assert_allclose(probabilities[0], known.probabilities[0], atol=1e-6)
    joints = radhar_cli.load_run(place / "joints", device="cpu")
    assert joints.units["outputs"] == "x ahead of the radar, y left, z up (m)"
    assert joints(cloud_frames(points, start, 64)[None]).shape == (1, len(start) - 1, 13, 3)
    with open_dataset(place / "data") as data:
        levels = data.maps["range_doppler"][:]
    for name, shape in (("maps", (32, 32, 3)), ("gray", (32, 32))):
        run = radhar_cli.load_run(place / name, device="cpu")
        assert run.input_shape == shape
        known = run.predict(place / "data")
        np.testing.assert_allclose(run(levels), known.probabilities, atol=1e-6)
        with pytest.raises(FolderError, match=r"float64 \[10, 32, 32\]: should be uint8 \[N, 32"):
            run(levels.astype(float))
