"""Boards from a config to files: a scene, a data set, a recording, and the same of each."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.boards import CFG
from helpers.command_line import radhar

from radhar_cli.dataset.contact_sheet import over_bones
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.processing.frame_sheets import BONE

YAML = """
radar: {device: IWR1443BOOST, cfg: board.cfg, position_m: [0, 0, 1]}
activities: [punching, kicking]
motion: {range_m: 2.2}
duration_s: 0.5
samples_per_class: 2
split: {train: 0.5, validation: 0.5}
body: {scatterers: surfaces}
cloud: {chain: board}
maps: [stft, range_doppler, range_azimuth, points]
image: {size_px: 64}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("boards")
    (folder / "board.cfg").write_text(CFG)
    (folder / "config.yaml").write_text(YAML)
    return folder


def done(*words: object) -> None:
    made = radhar(*words)
    assert made.returncode == 0, made.stderr


@pytest.fixture(scope="module")
def data(folder: Path) -> Path:
    done("generate", folder / "config.yaml", "-o", folder / "data", "--jobs", "1", "-q")
    return folder / "data"


def test_a_data_set_holds_frames_points_and_skeletons(data: Path) -> None:
    with open_dataset(data) as found:
        assert tuple(found.maps) == ("stft", "range_doppler", "range_azimuth", "points")
        for row in range(4):
            assert found.products["range_doppler"][row].shape == (5, 128, 32)
            assert found.products["range_azimuth"][row].shape == (5, 128, 181)
            start = found.products["points_start"][row]
            points = found.products["points"][row]
            assert start.shape == (6,)
            assert points.shape == (start[-1], 8)
            assert len(found.products["points_person"][row]) == len(points)
            assert found.products["skeleton"][row].shape == (5, 1, 13, 3)
            assert found.maps["points"][row].any()
    with h5py.File(data / "dataset.h5") as file:
        columns = file["products/points"].attrs["columns"].tolist()
        assert columns[:6] == ["x", "y", "z", "doppler", "intensity", "snr_db"]
        assert len(file["products/skeleton"].attrs["joint_names"]) == 13


def test_people_beyond_the_boards_range_are_told_so(folder: Path, tmp_path: Path) -> None:
    far = ("--set", "motion.range_m=30", "--set", "on_invalid=error")
    made = radhar("generate", folder / "config.yaml", "-o", tmp_path / "far", "--jobs", "1", *far)
    assert made.returncode == 2
    assert "a smaller motion.range_m stays in the range that the board's .cfg sees" in made.stderr


def test_it_is_verified_and_its_bytes_do_not_depend_on_the_workers(
    data: Path, folder: Path
) -> None:
    done("verify", data)
    done("generate", folder / "config.yaml", "-o", folder / "again", "--jobs", "2", "-q")
    assert (folder / "again/dataset.h5").read_bytes() == (data / "dataset.h5").read_bytes()


@pytest.fixture(scope="module")
def scene(folder: Path) -> Path:
    """A simulated scene with its raw recording."""
    out = folder / "scene"
    done("simulate", folder / "config.yaml", "--activity", "punching", "-o", out, "--raw", "-q")
    return out


def test_arrays_say_what_they_are_as_the_frames_of_a_scene_do(data: Path, scene: Path) -> None:
    """Labels of HDF5's own, units, and edges: half a cell beyond the first and the last value."""
    with h5py.File(data / "dataset.h5") as file, h5py.File(scene / "scene.h5") as one:
        for name, rows, columns in (
            ("range_doppler", "range", "radial speed"),
            ("range_azimuth", "range", "azimuth"),
        ):
            stored = file[f"products/{name}"]
            said = stored.attrs
            assert [axis.label for axis in stored.dims] == ["frame", rows, columns]
            assert said["axes"].tolist() == ["frame", rows, columns]
            for what, quantity, first, last in (
                ("row", rows, "bottom", "top"),
                ("column", columns, "left", "right"),
            ):
                values = one[f"axes/{name}/{quantity}"]
                step = values[1] - values[0]
                assert said[f"{what}_quantity"] == quantity
                assert said[f"{what}_unit"] == values.attrs["unit"]
                assert said[f"{what}_{first}"] == pytest.approx(values[0] - step / 2)
                assert said[f"{what}_{last}"] == pytest.approx(values[-1] + step / 2)
        points, joints = file["products/points"], file["products/skeleton_velocity"]
        assert points.attrs["units"].tolist() == one["points"].attrs["units"].tolist()
        assert [axis.label for axis in points.dims] == ["point", "column"]
        assert (joints.attrs["unit"], joints.dims[2].label) == ("m/s", "joint")
        assert [axis.label for axis in file["maps/stft"].dims] == [
            *("sample", "Doppler frequency", "time")
        ]


def test_arrays_of_the_ranges_that_images_show_have_the_edges_of_their_rows(
    folder: Path, tmp_path: Path
) -> None:
    """In whole cells of the axis."""
    limits = ("--set", "image.range_limits_m=[1, 3]", "--set", "maps=[range_doppler]", "-q")
    done("generate", folder / "config.yaml", "-o", tmp_path / "near", "--jobs", "1", *limits)
    with h5py.File(tmp_path / "near/dataset.h5") as file:
        said, rows = file["products/range_doppler"].attrs, file["products/range_doppler"].shape[1]
        whole = (said["row_top"] - said["row_bottom"]) / rows
        assert said["row_bottom"] <= 1 < said["row_bottom"] + whole
        assert said["row_top"] - whole < 3 <= said["row_top"]


def test_a_recording_gives_the_frames_of_its_scene(folder: Path, scene: Path) -> None:
    config, made = folder / "config.yaml", folder / "made"
    names = "stft,rtm,cube,range_doppler,range_azimuth,points"
    done("process", scene / "recording.h5", "--config", config, "-o", made, "--maps", names, "-q")
    with h5py.File(scene / "scene.h5") as one, h5py.File(made / "maps.h5") as other:
        for name in ("cube", "range_doppler", "range_azimuth", "points", "points_start"):
            np.testing.assert_array_equal(one[name], other[name])
        assert one["cube"].shape == (5, 32, 12, 80)
        assert one["truth/time"].shape == (5 * 32 * 3,)
        assert one.attrs["cfg"] == CFG
        assert one["points"].attrs["doppler_sign"] == "positive approaching"
    for name in ("maps.png", "stickman.gif", "frames.png", "cloud.gif"):
        assert (scene / name).stat().st_size > 1000
    assert (made / "frames.png").stat().st_size > 1000


def test_a_recording_of_another_board_is_refused(folder: Path, scene: Path) -> None:
    other, config = folder / "other.cfg", folder / "config.yaml"
    other.write_text(CFG.replace("1 80 2499", "1 64 2499"))
    options = ("--set", f"radar.cfg={other}", "--maps", "points", "-q")
    made = radhar(
        "process", scene / "recording.h5", "--config", config, "-o", folder / "x", *options
    )
    assert made.returncode == 2
    assert "samples = 80: should be 64, as radar.cfg has it" in made.stderr


def test_a_config_from_a_cfg_is_simulated(folder: Path) -> None:
    done("config", "init", folder / "mine.yaml", "--radar", folder / "board.cfg")
    options = ("--activity", "punching", "--set", "duration_s=0.4", "--no-figures", "-q")
    done("simulate", folder / "mine.yaml", *options, "-o", folder / "mine")
    with h5py.File(folder / "mine/scene.h5") as file:
        assert len(file["points"]) > 5


def test_a_line_of_the_cfg_that_nobody_knows_is_warned_of(folder: Path) -> None:
    (folder / "odd.cfg").write_text(CFG + "quantumCfg 1\n")
    made = radhar(
        *("simulate", folder / "config.yaml", "--activity", "punching", "-o", folder / "odd"),
        *("--set", f"radar.cfg={folder / 'odd.cfg'}", "--maps", "points", "--no-figures"),
    )
    assert made.returncode == 0
    assert "warning: radar.cfg: quantumCfg is not known and has no effect" in made.stderr


def test_a_data_set_says_how_many_samples_the_cube_made(folder: Path, tmp_path: Path) -> None:
    tight = ("--set", "engine.tolerance_db=-300", "--set", "duration_s=0.2", "--jobs", "1")
    cube = ("--set", "engine.fallback=cube")
    made = radhar("generate", folder / "config.yaml", "-o", tmp_path / "tight", *tight, *cube)
    assert made.returncode == 0
    assert "4 of 4 recordings: computed by the cube (engine.fallback)" in made.stderr
    refused = radhar("generate", folder / "config.yaml", "-o", tmp_path / "refused", *tight)
    assert refused.returncode == 2
    assert "engine.tolerance_db = -300: should be " in refused.stderr


def test_previews_show_skeletons_that_the_images_lack(data: Path) -> None:
    with open_dataset(data) as found:
        points = found.maps["points"][0]
        seen = over_bones(found, 0, points)
    assert not (points == BONE).any()
    assert (seen == BONE).any()
    np.testing.assert_array_equal(seen[points > 0], points[points > 0])


@pytest.mark.slow
def test_an_array_by_hand_and_bodies_of_segments_are_built_and_verified(
    folder: Path, tmp_path: Path
) -> None:
    more = (
        "radar.array={tx: [[0, 0], [2, 1], [4, 0]], rx: [[0, 0], [1, 0], [2, 0], [3, 0]]}",
        *("body.scatterers=segments", "duration_s=0.2", "motion.range_m=3"),
    )
    options = [word for one in more for word in ("--set", one)]
    out = tmp_path / "out"
    done("generate", folder / "config.yaml", "-o", out, "--jobs", "1", "-q", *options)
    done("verify", out)


def test_a_data_set_in_which_nobody_moves_is_black_and_says_so(
    folder: Path, tmp_path: Path
) -> None:
    more = (
        *("activities=[stationary]", "receiver.noise_figure_db=null", "body.scatterers=points"),
        "subject={sway_ahead_m: 0, sway_aside_m: 0, chest_m: 0, heart_m: 0}",
        *("motion={range_m: 2, idle: {fidget_hz: 0, shuffle_hz: 0}}", "duration_s=0.2"),
    )
    options = [word for one in more for word in ("--set", one)]
    out = tmp_path / "still"
    made = radhar("generate", folder / "config.yaml", "-o", out, "--jobs", "1", *options)
    assert made.returncode == 0, made.stderr
    assert "2 of 2 recordings: a map is black" in made.stderr
    with open_dataset(out) as found:
        assert not any(images[row].any() for images in found.maps.values() for row in range(2))


STEPS = """
radar:
  waveform: sfcw
  frame: {chirps: 16, period_s: 0.1}
  carrier_hz: 2e9
  bandwidth_hz: 1e9
  steps: 64
  dwell_s: 20e-6
  array: {tx: [[-2, 0], [2, 0]], rx: [[-1.5, 0], [-0.5, 0], [0.5, 0], [1.5, 0]]}
activities: [walking, sitting_down]
samples_per_class: 4
duration_s: 2
motion: {range_m: {per_activity: {default: 3, walking: 4}}}
maps: [range_doppler]
output: {products: [cube, skeleton]}
"""


def test_cubes_of_all_scenes_have_one_precision(tmp_path: Path) -> None:
    """Some of these scenes are made again in double precision, as single misses the tolerance."""
    config = tmp_path / "steps.yaml"
    config.write_text(STEPS)
    done("generate", config, "-o", tmp_path / "data")
    done("verify", tmp_path / "data")
    with h5py.File(tmp_path / "data/dataset.h5") as file:
        assert file["products/cube"].dtype == np.complex64
