"""`radhar benchmark` on files by the layouts of published sets, and other files as a simulator."""

import csv
import json
import shutil
from itertools import product
from pathlib import Path

import h5py
import numpy as np
import pytest
from capture.recipes.published_files import (
    glasgow_text,
    write_mars,
    write_radhar,
    write_unimmhar,
)
from helpers.command_line import Done, ok, radhar
from helpers.documents import ROOT

from radhar_cli.capture.recipes import glasgow, mars, unimmhar
from radhar_cli.config.documents import PRESETS
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.images.opening import open_inputs
from radhar_cli.study.benchmark import engine
from radhar_cli.study.benchmark.engine import draw_labelled, joint_errors, parse_rows
from radhar_cli.study.benchmark.protocols import PERSONS, PROTOCOLS
from radhar_cli.study.benchmark.sets import (
    find_measured_set,
    learning_set,
    open_both,
    simulation_config,
    training_part,
)
from radhar_cli.study.benchmark.study import BenchmarkOptions

PAGE = ROOT / "docs/guide/benchmark_simulators.md"
QUICK = ("--seeds", 1, "--epochs", 1, "--jobs", 1)


@pytest.fixture(scope="module")
def downloads(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """RadHAR, and MARS with three persons, as they are downloaded."""
    root = tmp_path_factory.mktemp("downloads")
    write_radhar(root / "RadHAR")
    write_mars(root / "MARS")
    persons = root / "MARS/synced_data/wooutlier"
    for number in (2, 3):
        shutil.copytree(persons / "Subject1", persons / f"Subject{number}")
    return root


@pytest.fixture(scope="module")
def theirs(downloads: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same files as data sets of another simulator, by recipe."""
    out = tmp_path_factory.mktemp("theirs")
    for recipe, name in (("radhar", "RadHAR"), ("mars", "MARS")):
        ok("prepare", recipe, downloads / name, "-o", out / recipe, "--jobs", 1, "--quiet")
    return out


@pytest.fixture(scope="module")
def of_classes(
    downloads: Path, theirs: Path, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Done]:
    """Benchmark of clouds to classes, and what it printed."""
    out = tmp_path_factory.mktemp("classes")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine, "MAX_SHOWN", 2)  # short epochs
        done = ok(*command(downloads, out, theirs / "radhar", "radhar"))
    return out, done


def command(
    downloads: Path, out: Path, simulated: Path, protocol: str, rows: str | None = None
) -> tuple[object, ...]:
    rows = rows or "simulation,adapted,1,999,measured,together"
    more = ("--protocols", protocol, "--rows", rows, "--simulated", simulated)
    return ("benchmark", downloads, "-o", out, *QUICK, *more)


def test_every_row_is_tested_on_the_same_measured_samples(of_classes: tuple[Path, Done]) -> None:
    out, done = of_classes
    of_protocol = json.loads((out / "benchmark.json").read_text())["protocols"]["radhar"]
    assert of_protocol["classes"] == ["boxing", "walk"]
    rows = of_protocol["rows"]
    assert [*rows] == ["simulation", "adapted", "1", "999", "measured", "together"]
    trained = [row for row in rows.values() if not row["why_not"]]
    assert {row["tested"] for row in trained} == {9}
    assert all(0 <= row["value"] <= 1 for row in trained)
    with (out / "benchmark.csv").open() as file:
        assert [line["row"] for line in csv.DictReader(file)] == [*rows]
    assert "the authors' test part" in done.stdout
    assert of_protocol["tuned_on"] is None, "another simulator's makers know"
    assert PROTOCOLS["radhar"].tuned_on not in (out / "benchmark.md").read_text()


def test_a_row_that_cannot_be_done_says_why(of_classes: tuple[Path, Done]) -> None:
    _, done = of_classes
    (line,) = (line for line in done.stdout.splitlines() if "999" in line)
    assert "not done: boxing has" in line
    assert "fewer than 999" in line


def test_what_is_done_is_not_trained_again(
    of_classes: tuple[Path, Done], downloads: Path, theirs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, first = of_classes

    def refuse(*_: object) -> None:
        raise AssertionError("is trained again")

    monkeypatch.setattr(engine, "train", refuse)
    monkeypatch.setattr(engine, "adapt", refuse)
    again = ok(*command(downloads, out, theirs / "radhar", "radhar"))
    assert again.stdout == first.stdout
    damaged = next((out / "runs/radhar").glob("measured_*/scores.json"))
    damaged.write_text('{"accuracy": [1')
    with pytest.raises(AssertionError, match="trained again"):
        radhar(*command(downloads, out, theirs / "radhar", "radhar", "measured"))


def test_joints_are_found_across_persons(downloads: Path, theirs: Path, tmp_path: Path) -> None:
    asked = command(downloads, tmp_path, theirs / "mars", "mars", "simulation,adapted,measured")
    done = ok(*asked)
    assert "persons in turn" in done.stdout
    numbers = json.loads((tmp_path / "benchmark.json").read_text())["protocols"]["mars"]
    rows = numbers["rows"]
    assert numbers["score"] == "mpjpe_cm"
    assert "is of classes" in rows["adapted"]["why_not"]
    assert rows["measured"]["tested"] == rows["simulation"]["tested"] == 18
    assert rows["measured"]["over"] == {"kind": "person", "count": 3}
    assert rows["measured"]["value"] > 0
    assert len([*(tmp_path / "runs/mars").glob("measured_*")]) == 3
    assert len([*(tmp_path / "runs/mars").glob("simulation_*")]) == 1


def test_nobody_who_is_tested_is_learned_from(theirs: Path) -> None:
    protocol, options = PROTOCOLS["mars"], BenchmarkOptions(theirs, theirs, (), 1)
    config = options.training(protocol)
    both = open_both(protocol, config, theirs / "mars", theirs / "mars")
    persons = both.measured.samples.person
    assert persons is not None
    assert len(both.folds) == 3
    for fold in both.folds:
        tested = {persons[row] for row in fold.tested}
        learned = learning_set(both, fold, config).samples.person
        assert learned is not None
        assert len(tested) == 1
        assert not tested & set(learned)
    every = np.sort(np.concatenate([fold.tested for fold in both.folds]))
    assert every.tolist() == list(range(len(both.measured)))


def test_an_snr_that_one_side_lacks_is_left_out_on_both(theirs: Path) -> None:
    """Else one column would tell the measured from the simulated."""
    protocol, options = PROTOCOLS["radhar"], BenchmarkOptions(theirs, theirs, (), 1)
    config, of_points = options.training(protocol), theirs / "radhar"
    both = open_both(protocol, config, of_points, of_points)
    assert not any("SNR" in note for note in both.measured.notes)
    without = open_both(protocol, config, strip_snr(of_points, theirs / "no_snr"), of_points)
    for images in (without.measured, without.simulated):
        assert not any(images.pixels.read(row)[..., 4].any() for row in range(len(images)))
        assert any("SNR" in note for note in images.notes)
    assert any(both.simulated.pixels.read(row)[..., 4].any() for row in range(9))


def strip_snr(data: Path, out: Path) -> Path:
    """Copy of a data set whose points have no SNR."""
    shutil.copytree(data, out)
    with h5py.File(out / "dataset.h5", "r+") as file:
        points = file["products/points"]
        for row in range(len(points)):
            values = points[row].reshape(-1, 8)
            values[:, 5] = np.nan
            points[row] = values.reshape(points[row].shape)
    return out


def test_a_file_is_no_folder_of_downloads(tmp_path: Path) -> None:
    (tmp_path / "downloads.zip").write_bytes(b"PK")
    done = radhar("benchmark", tmp_path / "downloads.zip", "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "is no folder; should be unpacked into one" in done.stderr


def test_fewer_labels_are_among_more(theirs: Path) -> None:
    protocol, options = PROTOCOLS["radhar"], BenchmarkOptions(theirs, theirs, (), 1)
    images = open_inputs(theirs / "radhar", "points", options.training(protocol))
    two, three = (draw_labelled(images, count, 1) for count in (2, 3))
    assert np.bincount(images.samples.label[two]).tolist() == [2, 2]
    assert set(two) < set(three) <= set(images.rows("train"))
    assert len(training_part(images)) == images.rows("train").size
    with pytest.raises(FolderError, match="fewer than 500"):
        draw_labelled(images, 500, 1)


def test_data_sets_that_are_prepared_are_taken_as_they_are(theirs: Path) -> None:
    source = find_measured_set(PROTOCOLS["mars"], theirs, theirs / "out")
    assert source is not None
    assert source.dataset == theirs / "mars"
    assert find_measured_set(PROTOCOLS["glasgow"], theirs, theirs / "out") is None


def test_what_a_benchmark_has_prepared_is_no_download(theirs: Path) -> None:
    assert find_measured_set(PROTOCOLS["mars"], theirs, theirs / "mars") is None


def test_a_shift_of_the_body_is_no_error_about_the_hip() -> None:
    rng = np.random.default_rng(0)
    true = rng.normal(size=(2, 4, 13, 3))
    true[0, 3] = np.nan  # a frame without joints
    true[1] = np.nan  # a sequence without any
    estimated = np.nan_to_num(true) + np.array([0.03, 0.04, 0])
    errors = joint_errors(estimated, true, 8)
    assert errors["mpjpe_cm"][0] == pytest.approx(5)
    assert errors["root_relative_cm"][0] == pytest.approx(0, abs=1e-9)
    assert np.isnan(errors["mpjpe_cm"][1])


def test_rows_are_in_the_order_of_the_table() -> None:
    assert parse_rows("measured,20,simulation,3") == ("simulation", "3", "20", "measured")
    for text in ("simulated", "0", "-1", "", "1,2x"):
        with pytest.raises(ConfigError, match="is no row"):
            parse_rows(text)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--rows", "all"), "--rows all: is no row"),
        (("--protocols", "mar"), "there is no such protocol; did you mean"),
        (("--simulated", "nowhere"), "nowhere: no such folder"),
        (("--protocols", "glasgow"), "holds no glasgow"),
    ],
)
def test_a_mistake_is_named(
    downloads: Path, tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    done = radhar("benchmark", downloads, "-o", tmp_path / "out", *words)
    assert done.returncode == 2
    assert said in done.stderr
    assert not (tmp_path / "out").exists()


def test_data_of_other_classes_say_so(downloads: Path, theirs: Path, tmp_path: Path) -> None:
    done = radhar(*command(downloads, tmp_path, theirs / "mars", "radhar", "simulation"))
    assert done.returncode == 2, "no protocol could be done"
    assert "should have some of boxing, walk" in done.stdout


def test_a_dry_run_writes_nothing(downloads: Path, theirs: Path, tmp_path: Path) -> None:
    asked = command(downloads, tmp_path / "out", theirs / "radhar", "radhar", "simulation,measured")
    done = ok(*asked, "--dry-run")
    assert "16 recordings will be prepared" in done.stdout
    assert "at most 2 trainings" in done.stdout
    assert not (tmp_path / "out").exists()


def test_the_page_has_every_protocol() -> None:
    lines = PAGE.read_text().splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if "|" in line]
    shown = {row[0].strip("`"): row for row in cells if row[0].strip("`") in PROTOCOLS}
    assert [*shown] == [*PROTOCOLS]
    for name, protocol in PROTOCOLS.items():
        _, measured, finds, tested, simulation, tuned_on = shown[name]
        assert measured.split(",")[0] == protocol.recipe
        assert protocol.part in measured
        assert simulation == f"`{protocol.simulation}`"
        assert tuned_on in (protocol.tuned_on, "the same")
        assert ("joints" in finds) == protocol.find_joints
        assert tested.startswith("persons" if protocol.split == PERSONS else "the authors'")
        assert (str(protocol.folds) in tested) == (protocol.split == PERSONS)
        assert protocol.simulation in PRESETS


MEASURED_CLASSES = {
    "glasgow": glasgow.ACTIVITIES,
    "radhar": ("boxing", "jack", "jump", "squats", "walk"),
    "unimmhar_csub": unimmhar.CLASSES,
    "unimmhar_cset": unimmhar.CLASSES,
    "mars": mars.MOVEMENTS,
}


@pytest.mark.parametrize("name", PROTOCOLS)
def test_a_simulation_has_classes_and_map_of_what_is_measured(name: str) -> None:
    protocol = PROTOCOLS[name]
    config = simulation_config(protocol, 2)
    classes = {protocol.names.get(a.slug, a.slug) for a in config.chosen_activities}
    assert classes <= set(MEASURED_CLASSES[name])
    assert protocol.map in config.maps
    (line,) = (row for row in PAGE.read_text().splitlines() if row.startswith(f"| `{name}` |"))
    assert protocol.find_joints or f"{len(classes)} " in line or "the same" in line
    frames = protocol.training.get("frames")
    if frames is not None:
        assert config.radar.timing.period_s * frames == pytest.approx(config.duration_s, rel=0.02)


def test_a_part_of_a_download_is_a_protocol(tmp_path: Path) -> None:
    for part in ("CSub", "CSet"):
        write_unimmhar(tmp_path / "UniMM-HAR" / part)
    for name in ("unimmhar_csub", "unimmhar_cset"):
        source = find_measured_set(PROTOCOLS[name], tmp_path, tmp_path / "out")
        assert source is not None
        assert source.preparation is not None
        assert source.preparation.folder.name == PROTOCOLS[name].part


def write_persons_of_glasgow(folder: Path) -> None:
    """Three persons, five activities each, of 5 s."""
    folder.mkdir()
    text = glasgow_text(5000)
    for person, activity in product((1, 2, 3), (1, 2, 3, 4, 6)):
        (folder / f"{activity}P{person:02d}A{activity:02d}R01.dat").write_text(text)


@pytest.mark.slow
def test_maps_are_told_apart_across_persons(tmp_path: Path) -> None:
    write_persons_of_glasgow(tmp_path / "glasgow")
    more = ("--per-class", 5, "--rows", "simulation,adapted,1,measured,together")
    ok("benchmark", tmp_path, "-o", tmp_path / "out", *QUICK, *more)
    results = json.loads((tmp_path / "out/benchmark.json").read_text())["protocols"]
    assert {name for name, result in results.items() if not result["why_not"]} == {"glasgow"}
    rows = results["glasgow"]["rows"]
    assert rows["simulation"]["over"] == {"kind": "person", "count": 3}
    # Ten images of two persons are too few to adapt to.
    assert {row for row, result in rows.items() if result["why_not"]} == {"adapted"}
    assert {result["tested"] for result in rows.values() if not result["why_not"]} == {15}


@pytest.mark.slow
def test_simulations_stand_beside_native_files(downloads: Path, tmp_path: Path) -> None:
    more = ("--per-class", 3, "--protocols", "radhar,mars", "--rows", "simulation")
    done = ok("benchmark", downloads, "-o", tmp_path, *QUICK, *more)
    assert "simulated: radhar" in done.stdout
    assert PROTOCOLS["radhar"].tuned_on in (tmp_path / "benchmark.md").read_text()
    assert "not done" not in done.stdout
