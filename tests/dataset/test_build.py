"""A build gives the same bytes for any batches, workers and interruptions; what it refuses."""

import json
import os
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.listener import Listener
from helpers.small import SMALL, fingerprint, full_disk_after, small_config
from joblib.externals.loky import get_reusable_executor
from PIL import Image

from radhar_cli.config import Config, load_config
from radhar_cli.config.identity import resolved
from radhar_cli.dataset import batch as batch_module
from radhar_cli.dataset import build as build_module
from radhar_cli.dataset import folder as folder_module
from radhar_cli.dataset.build import build, choose_batch_size
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.shards import list_shards
from radhar_cli.dataset.verify import verify
from radhar_cli.dataset.workers import run_tasks
from radhar_cli.errors import FolderError, SceneError


def make(config, folder, **options):
    return build(config, folder, options.pop("jobs", 1), Listener(), **options)


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    return load_config(small_config(tmp_path_factory.mktemp("config")))


@pytest.mark.parametrize(("jobs", "batch_size"), [(1, 1), (1, 9), (2, 2), (4, 1)])
def test_jobs_and_batch_size_change_no_byte(config, small_set, tmp_path, jobs, batch_size):
    make(config, tmp_path / "set", jobs=jobs, batch_size=batch_size)
    assert fingerprint(tmp_path / "set") == fingerprint(small_set)


def test_no_more_processes_than_batches_are_started(config, small_set, tmp_path, monkeypatch):
    asked: list[int] = []

    def here(function, tasks, jobs):
        asked.append(jobs)
        return run_tasks(function, tasks, 1)

    monkeypatch.setattr(build_module, "run_tasks", here)
    build(config, tmp_path / "set", 3000, Listener(), batch_size=2)
    assert asked == [5]
    assert fingerprint(tmp_path / "set") == fingerprint(small_set)


def test_batch_size_by_number_of_rows():
    def size(left, jobs, one=10**4):
        return choose_batch_size(left, jobs, one)

    assert [size(left, 2) for left in (1, 9, 100, 3600)] == [1, 2, 13, 32]
    assert [size(10**5, jobs) for jobs in (1, 16, 64)] == [1024, 97, 32]
    assert size(10**7, 16) == 1024
    assert size(10**7, 16, one=2**22) == 64
    assert size(10**7, 16, one=2**30) == 1


def test_a_relative_folder_is_built_whatever_the_working_directory_of_the_workers(
    config, small_set, tmp_path, monkeypatch
):
    here, elsewhere = tmp_path / "here", tmp_path / "elsewhere"
    here.mkdir()
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    get_reusable_executor(max_workers=2, kill_workers=True).shutdown(kill_workers=True)
    list(run_tasks(os.getcwd, [()] * 8, 2))
    monkeypatch.chdir(here)
    assert set(run_tasks(os.getcwd, [()] * 8, 2)) == {str(elsewhere)}
    make(config, Path("set"), jobs=2, batch_size=2)
    assert fingerprint(here / "set") == fingerprint(small_set)
    assert not list(elsewhere.iterdir())


def test_an_unfinished_build_resumes_with_another_batch_size(config, small_set, tmp_path):
    folder = tmp_path / "set"
    with full_disk_after(5):
        make(config, folder, batch_size=2)
    assert [(s.start, s.stop) for s in list_shards(folder)] == [(0, 2), (2, 4)]
    outcome = make(config, folder, batch_size=3)
    assert outcome.new_samples == 5, "the four finished samples are not made again"
    assert fingerprint(folder) == fingerprint(small_set)


def test_a_complete_folder_is_not_changed(config, small_set):
    before = (small_set / "dataset.h5").stat().st_mtime_ns
    assert make(config, small_set).already_complete
    assert (small_set / "dataset.h5").stat().st_mtime_ns == before


def test_other_config_is_refused_and_the_keys_named(config, small_set):
    other = config.model_copy(update={"seed": 8, "snr_db": 5.0})
    with pytest.raises(FolderError, match=r"(?s)seed: 7 there, 8 here.*snr_db"):
        make(other, small_set)


def test_a_folder_without_samples_is_free(config, tmp_path):
    """As after a build whose scenes were refused: another config may have it."""
    far = {"motion": {"model": "paper", "range_m": 500.0}, "on_invalid": "error"}
    refused = Config.model_validate({**resolved(config), **far})
    with pytest.raises(SceneError):
        make(refused, tmp_path)
    with pytest.raises(FolderError, match="no sample is made yet; `radhar generate CONFIG -o"):
        verify(tmp_path, 1)
    make(config, tmp_path)
    assert verify(tmp_path, 1).problems == []


def test_other_versions_are_refused(config, small_set, monkeypatch):
    real = folder_module.identity(config)
    other = {**real, "versions": {**real["versions"], "numpy": "1.0"}}
    monkeypatch.setattr(folder_module, "identity", lambda _: other)
    with pytest.raises(FolderError, match=r"versions\.numpy"):
        make(config, small_set)


def test_pngs_can_be_added_later_and_lost_ones_are_rewritten(config, small_set, tmp_path):
    folder = tmp_path / "set"
    without = config.model_copy(update={"output": config.output.model_copy(update={"png": False})})
    make(without, folder)
    assert not (folder / "png").exists()
    outcome = make(config, folder)
    assert outcome.new_samples == 0
    assert outcome.pngs == 27
    with_pngs, right = fingerprint(folder), fingerprint(small_set)
    assert {k: v for k, v in with_pngs.items() if k.startswith("png")} == {
        k: v for k, v in right.items() if k.startswith("png")
    }
    lost = folder / next(k for k in right if k.endswith("walking/00001.png"))
    lost.unlink()
    for other in ("1.png", "0000\N{ARABIC-INDIC DIGIT ONE}.png", "00001.jpg", "99999.png"):
        (lost.parent / other).write_text("mine")
    assert make(config, folder).pngs == 3, "the row's images of all maps"
    assert fingerprint(folder).items() >= {k: right[k] for k in right if k[:3] == "png"}.items()


def test_overwrite_starts_again_and_keeps_foreign_files(config, small_set, tmp_path):
    folder = tmp_path / "set"
    make(config.model_copy(update={"seed": 99}), folder)
    (folder / "notes.txt").write_text("mine")
    make(config, folder, overwrite=True)
    assert (folder / "notes.txt").read_text() == "mine"
    (folder / "notes.txt").unlink()
    assert fingerprint(folder) == fingerprint(small_set)


def test_overwrite_refuses_folders_that_radhar_did_not_build(config, tmp_path):
    with h5py.File(tmp_path / "dataset.h5", "w") as file:
        file["mine"] = 1
    (tmp_path / "png").mkdir()
    (tmp_path / "png/mine.txt").write_text("mine")
    with pytest.raises(FolderError, match="not a data set of radhar"):
        make(config, tmp_path, overwrite=True)
    assert (tmp_path / "png/mine.txt").exists()
    assert (tmp_path / "dataset.h5").exists()


def test_overwrite_killed_midway_resumes(config, small_set, tmp_path, monkeypatch):
    """Whatever step of clearing is the last, the same command finishes the job."""
    for count in range(1, 7):
        folder = tmp_path / f"set{count}"
        make(config.model_copy(update={"seed": 99}), folder)
        (folder / "preview_stft.png").write_text("mine")
        left = [count]

        def dying(original, left=left):
            def step(*arguments, **options):
                left[0] -= 1
                if left[0] <= 0:
                    raise KeyboardInterrupt
                return original(*arguments, **options)

            return step

        with monkeypatch.context() as patch:
            patch.setattr(Path, "rename", dying(Path.rename))
            patch.setattr(Path, "unlink", dying(Path.unlink))
            patch.setattr(folder_module.shutil, "rmtree", dying(folder_module.shutil.rmtree))
            with pytest.raises(KeyboardInterrupt):
                make(config, folder, overwrite=True)
        make(config, folder, overwrite=True)
        (folder / "preview_stft.png").unlink()
        assert fingerprint(folder) == fingerprint(small_set)


def test_scenes_are_checked_by_the_workers(tmp_path):
    """The warnings of a resumed build count all its rows; of a new one they come first."""
    text = SMALL.replace("seed: 7", "seed: 7\nwall: {}\non_invalid: keep")
    config = load_config(small_config(tmp_path, text), ["motion.range_m={uniform: [1, 3]}"])
    first, again = Listener(), Listener()
    build(config, tmp_path / "whole", 1, first)
    with full_disk_after(4):
        make(config, tmp_path / "set", batch_size=2)
    build(config, tmp_path / "set", 3, again, batch_size=2)
    for notes in (first, again):
        assert len(notes.messages) == len(set(notes.messages))
        (said,) = [one for one in notes.messages if "passes through the wall" in one]
        with h5py.File(tmp_path / "set/dataset.h5") as file:
            assert said.removeprefix("warning: ") in file.attrs["warnings"]
    assert fingerprint(tmp_path / "whole") == fingerprint(tmp_path / "set")


def test_foreign_folder_file_and_live_folder_are_refused(config, tmp_path):
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(FolderError, match=r"thesis\.tex"):
        make(config, tmp_path)
    with pytest.raises(FolderError, match="is a file"):
        make(config, tmp_path / "thesis.tex")
    with (
        folder_lock(tmp_path / "live"),
        pytest.raises(FolderError, match="another run is writing here"),
    ):
        make(config, tmp_path / "live")


def test_a_path_that_cannot_be_made_is_one_clear_line(config, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(FolderError, match="file/set: cannot be made") as caught:
        make(config, tmp_path / "file" / "set")
    assert "\n" not in str(caught.value)


def test_scene_too_close_to_an_antenna_stops_before_any_echo(config, tmp_path, monkeypatch):
    def never(*_):
        raise AssertionError("an echo was computed")

    monkeypatch.setattr(batch_module, "synthesise", never)
    near = load_config(
        small_config(tmp_path),
        ["radar.tx_m=[1.5, 0, 1.5]", "motion={model: paper, range_m: 1.5, angle_deg: 0}"],
    )
    with pytest.raises(SceneError) as caught:
        make(near, tmp_path / "set")
    assert re.search(r"sample .*/\d+: .* comes to .* cm from the transmitter", str(caught.value))


def test_physical_warnings_are_given_once_with_a_count_and_stored(config, tmp_path):
    notes = Listener()
    far = load_config(small_config(tmp_path), ["motion.range_m=28", "activities=[walking, S1]"])
    build(far, tmp_path / "set", 1, notes)
    assert [m for m in notes.messages if "half-band" in m] == [
        "warning: 3 of 6 recordings: a scatterer leaves the range half-band and its echo the kept "
        "bins"
    ]
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        stored = json.loads(file.attrs["warnings"])
    assert {w["kind"]: w["recordings"] for w in stored if w["kind"] == "half_band"} == {
        "half_band": 3
    }


def test_fallbacks_to_the_cube_are_counted_across_resumed_runs(tmp_path, monkeypatch):
    """Double precision cannot promise -300 dB of anybody who moves."""
    engine = ["engine={tolerance_db: -300, fallback: cube}", "duration_s=1", "maps=[rtm, stft]"]
    config = load_config(small_config(tmp_path), [*engine, "activities=[punching, S1, S8]"])
    notes = Listener()
    build(config, tmp_path / "whole", 1, notes)
    assert "warning: 6 of 9 recordings: computed by the cube (engine.fallback)" in notes.messages
    with full_disk_after(4):
        make(config, tmp_path / "set", batch_size=1)
    make(config, tmp_path / "set", batch_size=2)
    assert fingerprint(tmp_path / "set") == fingerprint(tmp_path / "whole")
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        stored = json.loads(file.attrs["warnings"])
        assert np.isnan(file["scene/error_db"][:]).all(), "the cube errs by nothing, as does rest"
    assert [w["recordings"] for w in stored if w["kind"] == "fallback"] == [6]


def test_a_range_map_alone_never_falls_back(tmp_path):
    engine = ["engine={tolerance_db: -390, fallback: cube}", "duration_s=1", "maps=[rtm]"]
    outcome = make(load_config(small_config(tmp_path), engine), tmp_path / "set")
    assert "fallback" not in {warning["kind"] for warning in outcome.warnings}


def test_dataset_contract(config, small_set):
    with h5py.File(small_set / "dataset.h5") as file:
        assert set(file["maps"]) == set(config.maps)
        for name in config.maps:
            maps = file[f"maps/{name}"]
            assert maps.shape == (9, 48, 48)
            assert maps.dtype == np.uint8
            assert maps.chunks == (1, 48, 48)
            assert maps.compression == "gzip"
            assert maps.attrs["dynamic_range_db"] == 50
            assert maps.attrs["column_unit"] == "s"
            assert file[f"entropy/{name}"].dtype == np.float32
        assert file["maps/stft"].attrs["row_unit"] == "Hz"
        assert file["maps/stft"].attrs["row_top"] == pytest.approx(250, abs=2)
        assert file["maps/rtm"].attrs["row_unit"] == "m"
        assert file["label"][:].tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2]
        assert file["sample_key"][:].tolist()[3:5] == [[1, 0], [1, 1]]
        assert np.bincount(file["split"][:], minlength=3).tolist() == [6, 3, 0]
        assert file["scene/angle"].attrs["unit"] == "rad"
        assert np.abs(file["scene/angle"][:]).max() <= np.pi / 6
        assert np.isnan(file["scene/thigh"][:3]).all(), "punching does not swing the thighs"
        assert np.isfinite(file["scene/thigh"][3:]).all()
        assert file["scene/error_db"].attrs["unit"] == "dB"
        assert (file["scene/error_db"][:] <= config.engine.tolerance_db).all()
        names = ["punching", "walking", "walking_to_falling"]
        assert list(file.attrs["class_slugs"]) == list(file["label"].attrs["names"]) == names
        assert list(file.attrs["class_names"]) == ["S2", "S8", "S12"]
        assert file.attrs["seed"] == 7
        assert json.loads(file.attrs["config"])["samples_per_class"] == 3
        for key in ("config_hash", "schema_version", "radhar_version", "numpy_version"):
            assert key in file.attrs


@pytest.mark.parametrize(("count", "last"), [(3, "00002"), (10**5, "99999"), (10**5 + 1, "100000")])
def test_png_names_sort_by_index_at_any_count(config, count, last):
    rows = Rows(config.chosen_activities[:2], (5, count))
    assert (rows.name(4), rows.name(4 + count)) == ("00004", last)
    assert rows.png_path("rtm", 0, 5).stem == "0".zfill(len(last))


def test_pngs_show_the_levels(config, small_set):
    table, rows = colour_table("viridis"), Rows.of(config)
    with h5py.File(small_set / "dataset.h5") as file:
        for row in range(len(rows)):
            path = small_set / rows.png_path("stft", file["split"][row], row)
            with Image.open(path) as picture:
                assert picture.mode == "P"
                assert np.array_equal(np.asarray(picture), file["maps/stft"][row])
                shown = np.asarray(picture.convert("RGB"))  # as ImageFolder does
                assert np.array_equal(shown, table[file["maps/stft"][row]])


def test_scenes_csv_has_the_numbers_of_the_file(small_set):
    lines = (small_set / "scenes.csv").read_text().splitlines()
    header, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
    with h5py.File(small_set / "dataset.h5") as file:
        column = header.index("motion.angle_deg")
        degrees = np.degrees(file["scene/angle"][:])
    assert np.allclose([float(row[column]) for row in rows], degrees, rtol=1e-12)
    assert rows[0][header.index("motion.paper.thigh_deg")] == ""


def test_resolved_config_builds_the_same_identity(config, small_set):
    assert load_config(small_set / "config.yaml") == config


def test_redrawn_scenes_are_valid_and_deterministic(tmp_path):
    text = SMALL.replace("seed: 7", "seed: 7\nwall: {}\non_invalid: redraw")
    config = load_config(
        small_config(tmp_path, text), ["motion.range_m={uniform: [1, 3]}", "activities=[S1, S2]"]
    )
    notes = Listener()
    build(config, tmp_path / "one", 1, notes)
    make(config, tmp_path / "two", jobs=2, batch_size=1)
    assert not [m for m in notes.messages if "wall" in m]
    assert fingerprint(tmp_path / "one") == fingerprint(tmp_path / "two")
