"""The radars that radhar comes with: valid by TI's rules, and clouds that hold a person."""

import re
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import ok, radhar

from radhar_cli.config import Config, load_config
from radhar_cli.config.built_in_radars import BuiltInRadar, read_radars
from radhar_cli.config.documents import RADARS, WRITTEN_RADARS, name_of_radar, name_of_written
from radhar_cli.config.reading import load_radars
from radhar_cli.config.starting_file import of_board
from radhar_cli.errors import ConfigError
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.ti_family import Family
from radhar_cli.readers.ti.ti_commands import split_lines
from radhar_cli.scene.single.simulate import simulate

BUILT_IN = {radar.name: radar for radar in read_radars()}
each = pytest.mark.parametrize("radar", BUILT_IN.values(), ids=BUILT_IN)
# Bytes for the radar cube and the detection matrix (L3), by TI's data sheets, where they are known.
L3_BYTES = {"IWR1443": 256 * 1024, "IWR1642": 768 * 1024, "IWR1843": 2**20, "IWR6843": 768 * 1024}
BANDS_GHZ = {"6843": (60, 64), "L6432": (57, 64), "L6844": (57, 64)}  # 76 to 81 of the others


@each
def test_its_ramp_is_within_the_band_and_its_cube_within_memory(radar: BuiltInRadar) -> None:
    header, timing = radar.header, radar.header.timing
    low, high = next((b for n, b in BANDS_GHZ.items() if n in radar.device), (76, 81))
    lines = split_lines(RADARS[radar.name].read_text(), radar.name)
    ramps = {"profileCfg": "rampEndTime", "chirpComnCfg": "chirpRampEndTime"}
    ramp_s = max(line.numbers[ramps[line.name]] for line in lines if line.name in ramps) * 1e-6
    assert low <= timing.start_hz / 1e9
    assert timing.start_hz / 1e9 + timing.slope_hz * ramp_s / 1e9 <= high
    size = timing.n_bins * (4 * timing.loops * timing.channels + 2 * timing.n_doppler)
    assert size <= L3_BYTES.get(radar.device[:7], 2**20)
    assert timing.loops * timing.loop_s < timing.period_s / 2  # time for the firmware
    assert not header.unknown
    not_simulated = {"IWRL": ("sigProcChainCfg", "cfarCfg"), "AWR2": ("cfarCfg",)}
    assert header.not_simulated == not_simulated.get(radar.device[:4], ())


@each
def test_its_comment_says_what_it_is(radar: BuiltInRadar) -> None:
    text = " ".join(RADARS[radar.name].read_text().replace("%", " ").split())
    assert radar.device in text
    assert f"{radar.frames_per_s:.3g} frames a second" in text
    timing = radar.header.timing
    assert f"to {timing.farthest_m:.1f} m" in text or (
        f"to {timing.farthest_m:.3g} m in steps of {100 * timing.range_step_m:.2g} cm" in text
    )
    assert timing.farthest_m > 6.5  # somebody at 6 m is within


def test_each_board_has_clouds_and_tracking_where_there_is_such_firmware() -> None:
    for name, device in DEVICES.items():
        if name.startswith(("AWR1", "AWR2243")):  # the same as an IWR, or without firmware
            continue
        assert BUILT_IN[name_of_radar(f"{name}_clouds") or ""].device == name
        tracking = {Family.PEOPLE, Family.PEOPLE_3D} & {*device.families}
        assert (name_of_radar(f"{name}_people") is not None) is bool(tracking)
    chains = {radar.chain for name, radar in BUILT_IN.items() if name.endswith("_people")}
    assert chains == {"people_tracking", "people_counting"}


@pytest.mark.parametrize(
    ("word", "name"),
    [
        *((name, name) for name in RADARS),
        ("IWR6843ISK-People", "iwr6843isk_people"),
        ("iwr6843ods_people", "iwr6843isk-ods_people"),
        ("iwr1443", "iwr1443boost"),
        ("iwr1443boost_clouds", "iwr1443boost"),
        ("AWR1642BOOST", "iwr1642boost_clouds"),
        ("iwrl6432", "iwrl6432boost_clouds"),
        ("awr2944evm", "awr2944evm_clouds"),
        ("iwr6843isk", "iwr6843isk"),
        ("iwr6843", None),
        ("iwr1443_people", None),
        ("boards/iwr6843isk.cfg", None),
    ],
)
def test_it_has_the_names_that_one_guesses(word: str, name: str | None) -> None:
    assert name_of_radar(word) == name


@pytest.mark.parametrize(
    ("word", "name"),
    [
        *((name, name) for name in WRITTEN_RADARS),
        ("K-LC6", "klc6"),
        ("EV-TINYRAD24G", "tinyrad24g"),
        ("XeThru X4M03", "x4m03"),
        ("uRAD CW", "urad_cw"),
        ("Ancortek 580AD", "ancortek580ad"),
        ("X4", "x4m03"),
        ("Infineon BGT60", "bgt60tr13c"),
        ("acconeer A121", "a121"),
        ("uRAD", "urad"),
        ("ancortek", None),
        ("bgt60utr11", None),
        ("iwr6843isk", None),
        ("", None),
    ],
)
def test_a_written_radar_has_the_names_that_one_guesses(word: str, name: str | None) -> None:
    assert name_of_written(word) == name


def test_they_are_listed_and_no_file_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lines = ok("config", "init", "--radar", "list").stdout.splitlines()
    assert [line.split()[0] for line in lines] == [*RADARS, *WRITTEN_RADARS]
    assert [*tmp_path.iterdir()] == []
    (klc6,) = (line for line in lines if line.startswith("klc6"))
    assert "2560 pulses a second" in klc6
    wrong = radhar("config", "init", "--radar", "iwr6843")
    assert wrong.returncode == 2
    assert all(name in wrong.stderr for name in RADARS)
    assert "any other radar is a short config by its data sheet" in wrong.stderr


@each
def test_a_file_without_a_device_gets_the_one_that_fits(
    tmp_path: Path, radar: BuiltInRadar
) -> None:
    """The same text under another name, as a user has it."""
    (tmp_path / "mine.cfg").write_text(RADARS[radar.name].read_text())
    (device,) = re.findall(r"device: ([^,]*),", of_board(str(tmp_path / "mine.cfg"), tmp_path))
    if radar.device.startswith("IWR6843") or radar.chain != "sdk1":
        assert device == radar.device
    else:
        assert device in ("IWR1443BOOST", "IWR1642BOOST")  # a demo that both boards have


def points_a_frame(name: str, range_m: float) -> float:
    radar = BUILT_IN[name]
    document = {
        "seed": 1,
        "radar": {"cfg": RADARS[name].read_text(), "device": radar.device},
        "activities": ["walking"],
        "duration_s": 1.5,
        "motion": {"range_m": range_m, "angle_deg": 180},
        "body": {"scatterers": "surfaces"},
        "cloud": {"chain": radar.chain},
        "maps": ["points"],
    }
    cloud = simulate(Config.model_validate(document), "walking", maps=("points",)).frames["cloud"]
    return float(np.diff(cloud.start)[10:].mean())


@pytest.mark.parametrize("device", ["iwr1843boost", "iwr6843aop", "iwr6843isk"])
def test_clouds_hold_many_times_the_points_of_grouped_peaks(device: str) -> None:
    assert points_a_frame(f"{device}_clouds", 4) > 8 * points_a_frame(device, 4)


def test_a_config_of_people_tracking_has_people_who_move(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(of_board("iwr6843isk_people", tmp_path))
    config = load_config(tmp_path / "mine.yaml")
    assert config.cloud.chain == "people_tracking"
    assert "walking" in config.activities


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("radar: bgt60tr13c", ["bgt60tr13c"]),
        ("radar: {preset: bgt60tr13c}", ["bgt60tr13c"]),
        ("radar: {base: bgt60tr13c}", ["bgt60tr13c"]),
        ("radar: {device: x4m03}", ["x4m03"]),
        ("radar: {cfg: x4m03}", ["x4m03"]),
        ("radars: [bgt60tr13c, x4m03]", ["bgt60tr13c", "x4m03"]),
        ("radars: {a: x4m03, b: {}}", ["x4m03"]),
        ("base: x4m03", ["x4m03"]),
        ("radar: {mode: fmcw}", []),  # no name, though fmcw24_1x4 begins so
    ],
)
def test_a_radar_named_in_a_config_is_told_how_to_copy(tmp_path, text, names):
    path = tmp_path / "c.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as error:
        load_radars(path)
    message = str(error.value)
    assert message.startswith(f"{path}:1: ")
    assert [f"config init FILE --radar {name}`" in message for name in names] == [True] * len(names)
    assert message.count("config init") == len(names)
