"""Points are never samples: tables and arrays of them are refused, with what is read of points."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.command_line import radhar
from scipy.io import savemat

ROWS_A_FRAME, FRAMES = 12, 10
SET = ("--set", "carrier_hz=77e9", "--set", "prf_hz=10")


def cloud() -> np.ndarray:
    """Points of somebody who approaches: frame, count, x, y, z, Doppler, intensity."""
    rng = np.random.default_rng(0)
    frame = np.repeat(np.arange(FRAMES), ROWS_A_FRAME)
    x, z = rng.normal(0.1, 0.3, frame.size), rng.normal(0, 0.5, frame.size)
    y = 4 - 0.1 * frame + rng.normal(0, 0.1, frame.size)
    doppler = -np.abs(rng.normal(1.0, 0.3, frame.size))
    intensity = np.abs(rng.normal(20, 5, frame.size))
    return np.column_stack([frame, np.full(frame.size, ROWS_A_FRAME), x, y, z, doppler, intensity])


def refused(path: Path, *sets: str) -> str:
    done = radhar("import", path, *SET, *sets, "-o", path.with_name("out.h5"))
    assert done.returncode == 2, done.stdout
    assert done.stderr.count("\n") == 1
    assert not path.with_name("out.h5").exists()
    return done.stderr


NAMES = [
    "Frame #,# Obj,X,Y,Z,Doppler,Intensity",
    "frame;count;x [m];y [m];z [m];velocity;snr",
    "frame\tn\tpos_x\tpos_y\tpos_z\tv\tpeak",
    "frame,n,range,azimuth,elevation,doppler,snr",
]


@pytest.mark.parametrize("names", NAMES)
def test_a_table_of_points_is_told_by_its_names(tmp_path: Path, names: str) -> None:
    delimiter = next(mark for mark in ";\t," if mark in names)
    path = tmp_path / "points.csv"
    np.savetxt(path, cloud(), "%.4f", delimiter, header=names, comments="")
    column = names.split(delimiter)[5]
    for sets in ((), ("--set", f"dataset={column}"), ("--set", "times=none")):
        told = refused(path, *sets)
        assert "are columns of points, not samples" in told
        assert "pointCloud" in told


def as_npy(path: Path, rows: np.ndarray) -> Path:
    np.save(path.with_suffix(".npy"), rows)
    return path.with_suffix(".npy")


def as_mat(path: Path, rows: np.ndarray) -> Path:
    savemat(path.with_suffix(".mat"), {"points": rows})
    return path.with_suffix(".mat")


def as_mat73(path: Path, rows: np.ndarray) -> Path:
    with h5py.File(path.with_suffix(".mat"), "w", userblock_size=512) as file:
        file["points"] = rows.T
    data = bytearray(path.with_suffix(".mat").read_bytes())
    data[:19] = b"MATLAB 7.3 MAT-file"
    path.with_suffix(".mat").write_bytes(bytes(data))
    return path.with_suffix(".mat")


def as_text(path: Path, rows: np.ndarray) -> Path:
    np.savetxt(path.with_suffix(".txt"), rows, "%.4f")
    return path.with_suffix(".txt")


def as_float64(path: Path, rows: np.ndarray) -> Path:
    rows[:, -5:].astype("<f8").tofile(path.with_suffix(".bin"))
    return path.with_suffix(".bin")


@pytest.mark.parametrize("columns", [5, 6, 7])
@pytest.mark.parametrize("write", [as_npy, as_mat, as_mat73, as_text, as_float64])
def test_an_array_of_points_is_told_by_its_numbers(tmp_path: Path, write, columns: int) -> None:
    rows = np.delete(cloud(), 1, axis=1)[:, -columns:] if columns < 7 else cloud()
    path = write(tmp_path / "points", rows)
    for axes in ("[pulse,receiver]", "[pulse,sample]"):
        assert "points, by their signs" in refused(path, "--set", f"axes={axes}")
    if write is as_float64:
        told = refused(path, "--set", "dtype=float64", "--set", "axes=[pulse]")
        assert "rows of five float64" in told


def test_feature_maps_of_points_are_refused(tmp_path: Path) -> None:
    rows = cloud()[:64, 2:]
    path = as_npy(tmp_path / "featuremap_train", np.tile(rows.reshape(1, 8, 8, 5), (3, 1, 1, 1)))
    assert "[3, 8, 8, 5]" in refused(path, "--set", "axes=[frame,pulse,receiver,sample]")


def test_a_table_becomes_what_is_read(tmp_path: Path) -> None:
    """As the message has it."""
    frames = [
        {"frameData": {"frameNum": n, "pointCloud": rows[:, 2:].tolist()}}
        for n, rows in enumerate(cloud().reshape(FRAMES, ROWS_A_FRAME, -1))
    ]
    (tmp_path / "points.json").write_text(json.dumps({"data": frames}))
    done = radhar(
        "import", tmp_path / "points.json", "--set", "frame_s=0.1", "-o", tmp_path / "o.h5"
    )
    assert done.returncode == 0, done.stderr
    assert f"{FRAMES} frames every 100 ms: {FRAMES * ROWS_A_FRAME} points" in done.stdout


@pytest.mark.parametrize("kind", ["noise", "offset", "frame numbers"])
def test_signals_of_five_and_more_receivers_are_no_points(tmp_path: Path, kind: str) -> None:
    rng = np.random.default_rng(1)
    signals = rng.standard_normal((2000, 6)) + (10 if kind == "offset" else 0)
    if kind == "frame numbers":
        signals[:, 0] = np.arange(2000) // 20
    path = as_npy(tmp_path / "signals", signals)
    done = radhar("import", path, *SET, "--set", "axes=[pulse,receiver]", "-o", tmp_path / "out.h5")
    assert done.returncode == 0, done.stderr


def test_i_and_q_beside_places_are_samples(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    rows = np.random.default_rng(0).standard_normal((50, 5))
    np.savetxt(path, rows, delimiter=",", header="I,Q,x,y,z", comments="")
    done = radhar("import", path, *SET, "-o", tmp_path / "out.h5")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("shape", [(100, 64, 3), (100, 64, 4), (100, 5, 64)])
def test_a_question_on_arrays_that_may_be_points_says_that_these_are_no_samples(
    tmp_path: Path, shape: tuple[int, ...]
) -> None:
    path = tmp_path / "array.npy"
    np.save(path, np.random.default_rng(0).standard_normal(shape))
    assert "points (x, y, z, Doppler, ...) are not samples" in refused(path)
