"""Published sets, written by their layouts, become data sets by a command."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from capture.recipes.published_files import (
    ASKED,
    SETTINGS,
    SWEEPS,
    WRITERS,
    write_mmfi,
    write_unimmhar,
)
from helpers.command_line import Done, ok, radhar

from radhar_cli.capture.point_recording import PointRecording
from radhar_cli.capture.recording import Recording
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.motion.skeleton import JOINTS


def prepare(name: str, folder: Path, out: Path, *settings: str, jobs: int = 1) -> Done:
    words = [word for key in (*SETTINGS.get(name, ()), *settings) for word in ("--set", key)]
    return radhar("prepare", name, folder, "-o", out, "--jobs", jobs, *words)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Every set as it is downloaded, and the data set that is made of it."""
    root = tmp_path_factory.mktemp("published")
    for name, write in WRITERS.items():
        write(root / name)
        done = prepare(name, root / name, root / f"{name}_set")
        assert done.returncode == 0, done.stderr
        (root / f"{name}.txt").write_text(done.stdout + done.stderr)
    return root


def manifest(made: Path, name: str) -> list[dict[str, str]]:
    with (made / f"{name}_set/recordings/manifest.csv").open() as file:
        return [*csv.DictReader(file)]


@pytest.mark.every(3)
@pytest.mark.parametrize("name", WRITERS)
def test_other_commands_take_what_was_prepared(made: Path, name: str) -> None:
    ok("verify", made / f"{name}_set")
    ok("inspect", made / f"{name}_set")
    with open_dataset(made / f"{name}_set") as data:
        assert data.config.recordings.source
    card = (made / f"{name}_set/README.md").read_text()
    assert f"Recordings: {data.config.recordings.source}" in card
    assert "`radhar prepare`" in card


def test_files_of_glasgow_say_activity_and_person(made: Path) -> None:
    said = (made / "glasgow.txt").read_text()
    assert "6 of the 1754 recordings of glasgow are there" in said
    assert "6 recordings, 6 new, 2 left out" in said
    assert "names activity 4 and activity 5" in said
    assert "should be a complex number a line" in said
    rows = manifest(made, "glasgow")
    assert {(row["label"], row["person"]) for row in rows} == {
        ("walking", "P36"),
        ("sitting_down", "P07"),
        ("falling", "P08"),
    }
    of_campaigns = [row["file"] for row in rows if row["person"] == "P36"]
    assert len(of_campaigns) == 2, "the same name in two campaigns is two recordings"
    with open_dataset(made / "glasgow_set") as data:
        assert data.config.maps == ("rtm", "stft")
        rows_of_map = data.maps["stft"][0].astype(int).sum(axis=1)
        towards = len(rows_of_map) // 2 - rows_of_map.argmax()
        # 1 m/s is 38.7 Hz of +-500 Hz, 10 rows, on which a mask is broad; row 0 approaches fastest.
        assert towards == pytest.approx(38.7 / 1000 * len(rows_of_map), abs=8)


def test_a_cut_file_of_glasgow_loses_its_last_sweep(made: Path) -> None:
    folder = made / "glasgow_set/recordings/1_December_2017_Dataset"
    with Recording(folder / "1P36A01R01.h5") as whole, Recording(folder / "6P08A06R02.h5") as cut:
        assert whole.info.pulses == SWEEPS
        pulses = cut.info.pulses
        assert SWEEPS - 20 < pulses < SWEEPS
        assert np.array_equal(cut.beat(0, pulses), whole.beat(0, pulses))


def test_movements_of_mars_have_joints_and_the_authors_split(made: Path) -> None:
    rows = manifest(made, "mars")
    assert [row["label"] for row in rows[:2]] == [
        "left_upper_limb_extension",
        "right_upper_limb_extension",
    ]
    assert {row["split"] for row in rows} == {"train", "validation", "test"}
    with PointRecording(made / "mars_set/recordings/subject1_train.h5") as recording:
        assert recording.info.lost_frames == 1
        assert recording.joints is not None
        found = any("joints of 53" in text for text in recording.info.source.findings)
        assert found
        cloud = recording.window(0, 0.1)
        # ahead, left, up, approaching, of right, ahead, up, receding
        assert np.allclose(cloud.points[1, :5], [2, -0.25, 0.5, 0.356, 11])
        head = recording.joints[0, JOINTS.index("head")]
        assert np.allclose(head, [2.001, -0.03, 0.3])
        assert np.isnan(recording.joints[-1]).all()
    with open_dataset(made / "mars_set") as data:
        skeleton = data.products["skeleton"]
        assert skeleton.shape[1:] == (1, len(JOINTS), 3)
        lost = np.flatnonzero(np.isnan(skeleton[0][:, 0, 0, 0]))
        assert lost.size <= 1


def test_frames_of_radhar_keep_their_time(made: Path) -> None:
    rows = manifest(made, "radhar")
    assert [row["split"] for row in rows].count("validation") == 2
    assert {row["label"] for row in rows} == {"boxing", "walk"}
    path = made / "radhar_set/recordings/Test/boxing/_0_boxing.h5"
    with PointRecording(path) as recording:
        assert recording.info.frames == 150
        assert recording.info.lost_frames == pytest.approx(30, abs=1)
        assert np.allclose(recording.window(0, 0.03).points[0, :4], [2, 0.5, -0.25, -0.6])
    said = (made / "radhar.txt").read_text()
    assert "1 left out" in said
    cut = made / "radhar_set/recordings/Test/walk/_9_walk.h5"
    with PointRecording(cut) as recording:
        assert recording.info.points == 449
        assert "1 messages are cut and left out" in recording.info.source.findings[-1]


def test_a_repetition_of_mhomeges_begins_a_window(made: Path) -> None:
    with open_dataset(made / "mhomeges_set") as data:
        assert len(data) == 2 * 2 * 2, "persons, gestures, repetitions"
        assert data.classes == ("circle", "knock")
        starts = data.products["points_start"][0]
        assert np.flatnonzero(np.diff(starts)).tolist() == [*range(12)]
        persons = {part.person for part in data.config.recordings.parts}
    assert persons == {"804", "805"}


def test_frames_of_mmfi_without_a_file_are_lost(made: Path) -> None:
    rows = manifest(made, "mmfi")
    assert {(row["label"], row["person"]) for row in rows} == {
        ("vertical_chest_expansion", "S01"),
        ("vertical_chest_expansion", "S02"),
    }
    with PointRecording(made / "mmfi_set/recordings/E01_S01_A03.h5") as recording:
        assert recording.number[:4].tolist() == [0, 1, 3, 4]
        counts = np.diff(recording.start)[:4]
        assert counts.tolist() == [2, 2, 0, 2]
        assert np.allclose(recording.window(0, 0.1).points[0, :5], [2, -1, 3, -0.5, 9])
    said = (made / "mmfi.txt").read_text()
    assert "24 bytes; should be rows of five float64" in said


def test_mmfi_asks_which_way_its_axes_point(tmp_path: Path) -> None:
    write_mmfi(tmp_path / "mmfi")
    done = radhar("prepare", "mmfi", tmp_path / "mmfi", "-o", tmp_path / "set")
    assert done.returncode == 2
    assert "axes and doppler are missing (--set axes=[right,ahead,up]" in done.stderr
    assert not (tmp_path / "set").exists()


def test_clips_of_unimmhar_lose_what_fills_them_up(made: Path) -> None:
    with open_dataset(made / "unimmhar_set") as data:
        assert set(data.classes) == {"walk", "jump"}
        starts = data.products["points_start"][0]
        assert np.diff(starts).tolist() == [2] * 20 + [0] * 12
        assert set(data.split.tolist()) == {0, 2}


def test_two_protocols_of_unimmhar_are_not_mixed(tmp_path: Path) -> None:
    for protocol in ("CSub", "CSet"):
        write_unimmhar(tmp_path / "UniMM" / protocol)
    done = prepare("unimmhar", tmp_path / "UniMM", tmp_path / "set")
    assert done.returncode == 2
    assert "several protocols" in done.stderr
    write_unimmhar(tmp_path / "of_mmfi", origin=1)
    done = prepare("unimmhar", tmp_path / "of_mmfi", tmp_path / "set")
    assert "axes and doppler are missing" in done.stderr


TABLE = "Frame #;X [m];Y [m];Z [m];v_r;SNR;label\n"


def test_a_table_of_ones_own_says_its_columns(tmp_path: Path) -> None:
    rows = [f"{n};0.5;2;0.25;-1;12;{'sit down' if n < 20 else 'walk'}" for n in range(40)]
    (tmp_path / "own").mkdir()
    (tmp_path / "own/anna.csv").write_text(TABLE + "\n".join([*rows, "40;0.5"]))
    done = prepare("points", tmp_path / "own", tmp_path / "set", *ASKED)
    assert "frame_s is missing" in done.stderr
    more = ("frame_s=0.1", "recordings.window_s=1", "recordings.hop_s=1")
    done = prepare("points", tmp_path / "own", tmp_path / "set", *ASKED, *more)
    assert "none of which is plainly doppler: --set columns.doppler=NAME" in done.stderr
    named = (
        *ASKED,
        *more,
        "columns.doppler=v_r",
        "person=Anna",
        "split={train: 0.5, validation: 0.5}",
    )
    done = prepare("points", tmp_path / "own", tmp_path / "set2", *named)
    assert done.returncode == 0, done.stderr
    with open_dataset(tmp_path / "set2") as data:
        assert set(data.classes) == {"sit_down", "walk"}
        assert len(data) == 4
        assert np.allclose(data.products["points"][0][0, [0, 1, 2, 3, 5]], [2, -0.5, 0.25, 1, 12])


def test_images_of_a_tree_a_part_of_the_split(tmp_path: Path) -> None:
    from PIL import Image

    for part in ("train", "test"):
        for name in ("walking", "falling"):
            (tmp_path / "tree" / part / name).mkdir(parents=True)
            Image.new("L", (16, 16), 99).save(tmp_path / "tree" / part / name / "0.png")
    keys = ("maps=[stft]", "recordings.rows=[-500,500]")
    done = prepare("images", tmp_path / "tree", tmp_path / "set", *keys)
    assert done.returncode == 0, done.stderr
    with open_dataset(tmp_path / "set") as data:
        assert sorted(data.split.tolist()) == [0, 0, 2, 2]
        assert (data.maps["stft"][0] == 99).all()


def test_images_in_parquet_of_hugging_face(tmp_path: Path) -> None:
    import io
    import json

    from PIL import Image

    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    cells = []
    for level in (10, 20, 30, 40):
        file = io.BytesIO()
        Image.new("L", (16, 8), level).save(file, "PNG")
        cells.append({"bytes": file.getvalue(), "path": None})
    table = pa.table({"image": cells, "label": [0, 1, 0, 1]})
    names = {"label": {"names": ["walking", "falling"], "_type": "ClassLabel"}}
    note = json.dumps({"info": {"features": names}}).encode()
    (tmp_path / "hub/data").mkdir(parents=True)
    for part in ("train", "test"):
        path = tmp_path / f"hub/data/{part}-00000-of-00001.parquet"
        pq.write_table(table.replace_schema_metadata({b"huggingface": note}), path)
    keys = ("maps=[stft]", "recordings.rows=[-500,500]")
    done = prepare("images", tmp_path / "hub", tmp_path / "set", *keys)
    assert done.returncode == 0, done.stderr
    with open_dataset(tmp_path / "set") as data:
        walking = np.flatnonzero(data.label == data.classes.index("walking"))
        assert [int(data.maps["stft"][row][0, 0]) for row in walking] == [10, 30, 10, 30]
        assert data.split[walking].tolist() == [2, 2, 0, 0]


@pytest.mark.parametrize("name", [*WRITERS, "points"])
def test_a_foreign_folder_is_refused_in_a_line(tmp_path: Path, name: str) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "other/holiday.jpeg").write_bytes(b"x")
    done = prepare(name, tmp_path / "other", tmp_path / "set")
    assert done.returncode == 2
    assert f"is not {name} as it is published: should hold" in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "set").exists()


def test_a_link_out_of_the_folder_is_refused(tmp_path: Path) -> None:
    write_mmfi(tmp_path / "mmfi")
    frame = tmp_path / "mmfi/E01/S01/A03/mmwave/frame001.bin"
    frame.replace(tmp_path / "elsewhere.bin")
    frame.symlink_to(tmp_path / "elsewhere.bin")
    done = prepare("mmfi", tmp_path / "mmfi", tmp_path / "set")
    assert done.returncode == 2
    assert "lies outside of" in done.stderr


def test_pickles_are_refused_by_name(tmp_path: Path) -> None:
    done = radhar("prepare", "MiliPoint", tmp_path, "-o", tmp_path / "set")
    assert done.returncode == 2
    assert "pickles, which run code" in done.stderr
    done = radhar("prepare", "marz", tmp_path, "-o", tmp_path / "set")
    assert "did you mean 'mars'?" in done.stderr


def test_all_recipes_are_listed() -> None:
    listed = ok("prepare").stdout
    for name in (*WRITERS, "points", "images"):
        assert f"\n{name}: " in "\n" + listed
    assert listed.count("tested on") == len(WRITERS) + 2


def digests(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*.h5")
        if ".radhar" not in path.parts
    }


def test_workers_and_kills_change_no_byte(made: Path, tmp_path: Path) -> None:
    command = [
        *(sys.executable, "-m", "radhar_cli", "prepare", "radhar", str(made / "radhar")),
        *("-o", str(tmp_path / "set"), "--jobs", "2"),
    ]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as run:
        while run.poll() is None and not [*(tmp_path / "set").glob("recordings/*/*/*.h5")]:
            os.sched_yield()
        run.kill()
    done = prepare("radhar", made / "radhar", tmp_path / "set")
    assert done.returncode == 0, done.stderr
    assert digests(tmp_path / "set") == digests(made / "radhar_set")
    again = prepare("radhar", made / "radhar", tmp_path / "set")
    assert "is complete" in again.stdout
    other = prepare("mars", made / "mars", tmp_path / "set")
    assert other.returncode == 2
    assert "holds recordings of radhar" in other.stderr


RECIPE = """
from functools import partial

import numpy as np

from radhar_cli.capture.recipes.clouds import CloudClip, points_of, read_table, write_clips
from radhar_cli.capture.recipes.recipe import CLOUDS, SetRecipe, Take, find_files
from radhar_cli.capture.recipes.registry import RECIPES

RECIPES["ours"] = "our_set"


def list_takes(folder, settings):
    for file in find_files(folder, r"([a-z]+)_([a-z]+)\\.csv"):
        yield Take(file.inner, (file.path,), partial(write, file.path, *file.match.groups()))


def write(path, label, person, out):
    rows, _ = read_table(path, 5)
    points = points_of(rows[:, 1:4], rows[:, 4])
    clip = CloudClip(label, person, points, rows[:, 0].astype(int), int(rows[-1, 0]) + 1)
    write_clips(out, [clip], 0.1, [path])


RECIPE = SetRecipe("us", "mit", "two classes", "itself", "walking_anna.csv", CLOUDS, list_takes)
"""


def test_another_set_is_a_file_and_a_line(tmp_path: Path) -> None:
    (tmp_path / "our_set.py").write_text(RECIPE)
    (tmp_path / "data").mkdir()
    for label in ("walking", "falling"):
        rows = [f"{n},2,0,0,-1" for n in range(40)]
        (tmp_path / f"data/{label}_anna.csv").write_text("\n".join(["frame,x,y,z,v", *rows, ""]))
    command = (sys.executable, "-m", "radhar_cli", "prepare", "ours", "data", "-o", "set")
    paths = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", ""), *sys.path])
    environment = {**os.environ, "RADHAR_EXTENSIONS": "our_set", "PYTHONPATH": paths}
    done = subprocess.run(
        [*command, "--jobs", "1"], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    with open_dataset(tmp_path / "set") as data:
        assert set(data.classes) == {"walking", "falling"}
        assert len(data) == 4


def test_a_cell_that_is_no_number_is_named_with_its_row(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text(
        "frame,x,y,z,doppler,label\n1,0,2,0,1,walking\n2,a,2,0,1,walking\n"
    )
    keys = ("axes=[right,ahead,up]", "doppler=receding", "frame_s=0.1")
    sets = [word for key in keys for word in ("--set", key)]
    done = radhar("prepare", "points", tmp_path, "-o", tmp_path / "set", *sets)
    assert done.returncode == 2
    assert f"{tmp_path / 'p.csv'}: row 3: x = 'a': should be a number" in done.stderr
