"""What comes of .cfg files that boards are given: products, families, refusals."""

from math import ceil
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.slow import slow_but

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.errors import ConfigError
from radhar_cli.radar.ti_family import Family
from radhar_cli.scene.single.scene_file import write_scene
from radhar_cli.scene.single.simulate import simulate

CFG = Path(__file__).parents[2] / "radar/cfg"
YAML = """
radar: {{device: {device}, cfg: {cfg}}}
activities: [walking]
motion: {{range_m: 4}}
duration_s: {seconds}
samples_per_class: 1
maps: [{maps}]
image: {{size_px: 16}}
"""


class Outcome(NamedTuple):
    """What a file must give."""

    device: str
    family: Family
    chain: str
    period_s: float
    cube: tuple[int, ...]  # of a frame
    range_doppler: tuple[int, ...]  # of a frame


WORKS = {
    "people_isk_bpm": Outcome(
        *("IWR6843ISK", Family.PEOPLE_3D, "people_tracking", 0.055, (48, 12, 96), (128, 64))
    ),
    "chirp_range": Outcome(*("IWR1443BOOST", Family.ANY, "best", 0.05, (192, 4, 256), (256, 256))),
    "two_profiles": Outcome("IWR1443BOOST", Family.ANY, "best", 0.04, (60, 8, 220), (256, 64)),
    "advframe": Outcome("IWR1443BOOST", Family.ANY, "best", 0.1, (64, 4, 256), (256, 64)),
    "iwr1642_pc": Outcome(
        *("IWR1642BOOST", Family.PEOPLE, "people_counting", 0.05, (128, 8, 128), (128, 128))
    ),
    "level_1tx1rx": Outcome("IWR1443BOOST", Family.ANY, "best", 0.5, (1, 1, 1024), (1024, 1)),
}


def config_of(
    folder: Path, name: str, device: str, maps: str = "range_doppler", seconds: float = 1.0
) -> Config:
    """Config that names a copy of a file beside it."""
    (folder / f"{name}.cfg").write_text((CFG / f"{name}.cfg").read_text())
    text = YAML.format(device=device, cfg=f"{name}.cfg", maps=maps, seconds=seconds)
    (folder / "config.yaml").write_text(text)
    return load_config(folder / "config.yaml")


@pytest.mark.parametrize("name", slow_but(WORKS, ("iwr1642_pc", "advframe")))
def test_a_file_gives_the_cube_and_the_maps_of_its_board(name: str, tmp_path: Path) -> None:
    outcome = WORKS[name]
    seconds = max(0.11, 2 * outcome.period_s)
    config = config_of(tmp_path, name, outcome.device, seconds=seconds)
    radar: Any = config.radar
    assert radar.header.family is outcome.family
    assert radar.timing.period_s == pytest.approx(outcome.period_s)
    assert config.cloud.chain == outcome.chain
    command = ("simulate", tmp_path / "config.yaml", "-o", tmp_path / "out", "--raw")
    result = ok(*command, "--maps", "range_doppler,points")
    chains = [line for line in result.stderr.splitlines() if "cloud.chain: " in line]
    assert len(chains) == 1
    assert f"cloud.chain: {outcome.chain}, " in chains[0]
    frames = int(seconds / outcome.period_s + 1e-9)
    with h5py.File(tmp_path / "out/scene.h5") as file:
        ends = ("", "_sf1") if name == "advframe" else ("",)
        for end in ends:
            assert file[f"cube{end}"].shape == (frames, *outcome.cube)
            power = file[f"range_doppler{end}"]
            assert power.shape == (frames, *outcome.range_doppler)
            assert np.isfinite(power[:]).all()
            assert power[:].any()
            periods = np.diff(file.attrs[f"frame_times{end}"])
            assert periods == pytest.approx(outcome.period_s)


def test_people_files_set_the_pose_and_the_removal_of_the_mean(tmp_path: Path) -> None:
    tracking = config_of(tmp_path, "people_isk_bpm", "IWR6843ISK")
    assert tracking.radar.position_m == (0, 0, 1)
    counting = config_of(tmp_path, "iwr1642_pc", "IWR1642BOOST")
    assert counting.processing.clutter == "mean"


def test_a_chirp_that_ends_after_its_ramp_is_refused_in_its_line(tmp_path: Path) -> None:
    words = r"^xwrl6432\.cfg:3: chirpComnCfg numOfAdcSamples = 256: should be at most 100: .*25\.52"
    with pytest.raises(ConfigError, match=words):
        config_of(tmp_path, "xwrl6432", "IWRL6432BOOST")


@pytest.mark.parametrize(
    ("name", "device", "words"),
    [
        ("people_isk_bpm", "IWR1443BOOST", "radar.cfg is of 3D people tracking"),
        ("iwr1642_pc", "AWR2944EVM", "should be IWR1642BOOST or AWR1642BOOST or IWR6843ISK: radar"),
    ],
)
def test_a_device_that_does_not_fit_is_refused(
    name: str, device: str, words: str, tmp_path: Path
) -> None:
    with pytest.raises(ConfigError) as caught:
        config_of(tmp_path, name, device)
    assert words in str(caught.value)


def test_a_subframe_is_a_board_of_its_own(tmp_path: Path) -> None:
    config = config_of(tmp_path, "advframe", "IWR1443BOOST", "range_doppler, points", 0.2)
    simulation = simulate(config, raw=True)
    write_scene(simulation, tmp_path / "scene.h5")
    with h5py.File(tmp_path / "scene.h5") as file:
        for name in ("cube", "range_doppler", "points", "points_start", "points_person"):
            assert file[name].dtype == file[f"{name}_sf1"].dtype
        assert file["cube_sf1"].shape == file["cube"].shape == (2, 64, 4, 256)
        assert file["range_doppler_sf1"].shape == file["range_doppler"].shape == (2, 256, 64)
        steps = [np.diff(file[f"axes/range_doppler{end}/range"])[0] for end in ("", "_sf1")]
        assert steps == pytest.approx([0.0435720, 0.1016679], rel=1e-5)
        begins = file.attrs["frame_times_sf1"] - file.attrs["frame_times"]
        assert begins == pytest.approx([0.05 + 32 * 7e-6] * 2, abs=1e-9)
        other = file["cube_sf1"][:]
    chosen = simulate(load_config(tmp_path / "config.yaml", ["radar.subframe=1"]), raw=True)
    np.testing.assert_array_equal(other, chosen.frames["cube"].astype(np.complex64))
    assert [*chosen.subframes] == ["_sf0"]
    write_scene(chosen, tmp_path / "chosen.h5")  # has the products by the same names
    with h5py.File(tmp_path / "chosen.h5") as file, h5py.File(tmp_path / "scene.h5") as first:
        for end in ("", "_sf1"):
            np.testing.assert_array_equal(file[f"cube{end}"], first[f"cube{end}"])
            np.testing.assert_array_equal(file[f"points{end}"], first[f"points{end}"])
            same = file.attrs[f"frame_times{end}"] == first.attrs[f"frame_times{end}"]
            assert same.all()
    quiet = simulate(
        load_config(tmp_path / "config.yaml", ["receiver.noise_figure_db=null"]), raw=True
    )
    noise = [
        (simulation.frames["cube"] - quiet.frames["cube"]).ravel(),
        (other - quiet.subframes["_sf1"].frames["cube"]).ravel(),
    ]
    assert abs(np.vdot(*noise)) < 0.05 * np.linalg.norm(noise[0]) * np.linalg.norm(noise[1])


def test_a_data_set_holds_the_frames_of_every_subframe(tmp_path: Path) -> None:
    config_of(tmp_path, "advframe", "IWR1443BOOST", "range_doppler, points", 0.1)
    command = ("generate", tmp_path / "config.yaml", "-o", tmp_path / "set", "--jobs", "1", "-q")
    result = radhar(*command)
    assert result.returncode == 0, result.stderr
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        products = file["products"]
        steps = 0.0435720, 0.1016679  # of the cells that lie within the ranges of images, 0 to 6 m
        for end, step in zip(("", "_sf1"), steps, strict=True):
            bins = ceil(6 / step + 0.5)
            assert products[f"range_doppler{end}"].shape[1:] == (bins, 64)
        assert [*products["points_sf1"].attrs["columns"]] == [*products["points"].attrs["columns"]]
        assert products["skeleton_sf1"].shape == products["skeleton"].shape
    assert "/products/range_doppler_sf1" in (tmp_path / "set/README.md").read_text()


def test_images_are_of_the_chosen_subframe_and_products_keep_their_names(tmp_path: Path) -> None:
    config_of(tmp_path, "advframe", "IWR1443BOOST", "range_doppler, points", 0.1)
    for number in (0, 1):
        out = tmp_path / f"set{number}"
        ok(
            *("generate", tmp_path / "config.yaml", "-o", out, "--jobs", "1", "-q"),
            *("--set", f"radar.subframe={number}", "--set", "output.products=[cube]"),
        )
    with (
        h5py.File(tmp_path / "set0/dataset.h5") as first,
        h5py.File(tmp_path / "set1/dataset.h5") as second,
    ):
        assert first["products"].keys() == second["products"].keys()
        for name in ("cube", "points", "points_sf1", "range_doppler", "range_doppler_sf1"):
            np.testing.assert_array_equal(first[f"products/{name}"], second[f"products/{name}"])
        assert (first["maps/range_doppler"][:] != second["maps/range_doppler"][:]).any()


def test_a_recording_of_each_subframe_gives_the_products_of_the_scene(tmp_path: Path) -> None:
    config_of(tmp_path, "advframe", "IWR1443BOOST", "range_doppler, points", 0.2)
    chosen = ("--maps", "range_doppler,points,cube", "--no-figures")
    ok("simulate", tmp_path / "config.yaml", "-o", tmp_path / "out", "--raw", *chosen)
    for end, number in (("", 0), ("_sf1", 1)):
        recording, maps = tmp_path / f"out/recording{end}.h5", tmp_path / f"maps{end}"
        ok(
            *("process", recording, "--config", tmp_path / "config.yaml", "-o", maps, *chosen),
            *("--set", f"radar.subframe={number}"),
        )
        with h5py.File(tmp_path / "out/scene.h5") as scene, h5py.File(maps / "maps.h5") as file:
            for name in ("cube", "range_doppler", "points", "points_start"):
                np.testing.assert_array_equal(file[name + end], scene[name + end])
            np.testing.assert_array_equal(
                file.attrs[f"frame_times{end}"], scene.attrs[f"frame_times{end}"]
            )


def test_a_subframe_that_is_not_there_is_refused(tmp_path: Path) -> None:
    config_of(tmp_path, "advframe", "IWR1443BOOST")
    with pytest.raises(ConfigError, match=r"radar\.subframe = 2: should be below 2"):
        load_config(tmp_path / "config.yaml", ["radar.subframe=2"])


WRONG = [
    ("advFrameCfg 2 0", "advFrameCfg 3 0", "subFrameCfg subFrameNum = 2 is missing; a line that"),
    ("advFrameCfg 2 0", "advFrameCfg 2 1", "12: advFrameCfg forceProfile = 1: should be 0"),
    ("64 50 0 1 1 50\nsub", "64 50 0 2 1 50\nsub", "13: subFrameCfg numOfBurst = 2: should be 1"),
    ("64 50 0 1 1 50\nsens", "64 50 0 1 1 2\nsens", "14: subFrameCfg subFramePeriodicity = 2: sho"),
    ("dfeDataOutputMode 3", "dfeDataOutputMode 1", "frameCfg is missing; a line that would do"),
    (
        "dfeDataOutputMode 3",
        "dfeDataOutputMode 2",
        "3: dfeDataOutputMode modeType = 2: should be 1",
    ),
    ("subFrameCfg 0 0 0 1", "subFrameCfg 0 0 0 2", "chirpCfg profileId = 1: should be 0: a frame"),
]


@pytest.mark.parametrize(("old", "new", "words"), WRONG)
def test_subframes_that_cannot_be_are_refused(
    old: str, new: str, words: str, tmp_path: Path
) -> None:
    config_of(tmp_path, "advframe", "IWR1443BOOST")
    text = (CFG / "advframe.cfg").read_text()
    assert old in text
    (tmp_path / "advframe.cfg").write_text(text.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        load_config(tmp_path / "config.yaml")
    assert str(caught.value).startswith("advframe.cfg")
    assert words in str(caught.value)
