"""Radars with frames in YAML: their header, their board, and what of them does not fit together."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from helpers.boards import channels
from helpers.known import A, P, V
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.config.identity import as_yaml
from radhar_cli.config.radar import BoardRadar, ChirpFramesRadar, FmcwRadar, StepFramesRadar
from radhar_cli.config.reading import load_config
from radhar_cli.echo.board_cube import exact_cube, fast_cube
from radhar_cli.errors import ConfigError
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, range_doppler
from radhar_cli.radar.board import Board
from radhar_cli.radar.materials import permittivity
from radhar_cli.scene.checks.warnings import warnings_of_signal
from radhar_cli.scene.products.run import record
from radhar_cli.scene.radar import antennas_of, board_of
from radhar_cli.scene.scene import nominal_scene

BGT60: dict[str, Any] = {
    "frame": {"chirps": 64, "interval_s": 500e-6, "period_s": 0.1},
    "carrier_hz": 58.5e9,
    "bandwidth_hz": 1e9,
    "adc_rate_hz": 2e6,
    "chirp_s": 64e-6,
    "array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [1, 1]]},
    "output": "real",
}
AS_CFG = """
channelCfg 7 1 0
adcCfg 2 0
profileCfg 0 58.5 436 0 64 0 0 15.625 1 128 2000 0 0 30
chirpCfg 0 0 0 0 0 0 0 1
frameCfg 0 0 64 0 100 1 0
"""
LAYERS = [
    {"thickness_m": 0.0125, "material": "plasterboard"},
    {"thickness_m": 0.07, "eps_r": 1},
    {"thickness_m": {"uniform": [0.01, 0.015]}, "material": "plasterboard"},
]
TWO_BY_TWO = {"tx": [[0, 0], [3, 0]], "rx": [[0, 0], [1, 0]]}
PAIR = "tx_m: [0, 0, 1], rx_m: [0, 0, 1]"
ALL = ["range_doppler", "range_azimuth", "range_elevation", "points"]


def frames_radar(**changes: Any) -> ChirpFramesRadar:
    return ChirpFramesRadar.model_validate(BGT60 | changes)


def config_of(radar: dict[str, Any], **keys: Any) -> Config:
    usual = {"maps": ["range_doppler"], "duration_s": 0.4, "motion": {"range_m": 2}}
    return Config.model_validate({"radar": radar} | usual | keys)


def refusal(folder: Path, radar: str, rest: str = "maps: [range_doppler]") -> str:
    path = folder / "radar.yaml"
    path.write_text(f"radar: {radar}\n{rest}\nduration_s: 0.5\nmotion: {{range_m: 2}}\n")
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    return str(caught.value)


def test_a_cfg_and_yaml_of_the_same_radar_are_the_same_board() -> None:
    array = {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [1, 1]]}
    of_cfg = board_of(BoardRadar.model_validate({"cfg": AS_CFG, "array": array}), 1.0)
    of_yaml = board_of(frames_radar(), 1.0)
    for name in vars(of_cfg).keys() - {"array"}:
        one, other = getattr(of_cfg, name), getattr(of_yaml, name)
        assert other == (pytest.approx(one) if isinstance(one, float) else one), name
    assert vars(of_cfg.array) == vars(of_yaml.array)


def test_steps_and_limits_follow_from_the_numbers() -> None:
    board = board_of(frames_radar(), 1.0)
    assert (board.samples, board.n_bins, board.n_doppler, board.frames) == (128, 64, 64, 10)
    assert board.range_step_m == pytest.approx(SPEED_OF_LIGHT / 2e9)
    fastest = board.doppler_step_mps() * 32
    assert fastest == pytest.approx(SPEED_OF_LIGHT / (4 * board.centre_hz * 500e-6))


@given(
    chirps=st.sampled_from([1, 2, 5, 64]),
    places=st.lists(st.tuples(st.integers(-2, 2), st.integers(-2, 2)), min_size=1, max_size=4),
    transmitters=st.integers(1, 2),
    is_real=st.booleans(),
    pause=st.sampled_from([0.0, 0.013]),
)
@settings(max_examples=40, deadline=None)
def test_edges_make_maps_of_the_shape_that_the_axes_say(
    chirps: int,
    places: list[tuple[int, int]],
    transmitters: int,
    is_real: bool,
    pause: float,
) -> None:
    """One chirp a frame, one receiver, elements at one place, frames without a pause."""
    period = chirps * transmitters * 200e-6 + pause
    radar = frames_radar(
        frame={"chirps": chirps, "interval_s": 200e-6, "period_s": period},
        array={"tx": [[0, 0], [2, 0]][:transmitters], "rx": places},
        output="real" if is_real else "iq",
        adc_rate_hz=0.5e6,
    )
    assert radar.frames_apart == (pause > 0)
    board = board_of(radar, 2 * period)
    assert board.frames == 2
    sources = channels(board, P, V, A)
    cube, _ = exact_cube(sources, board)
    samples = np.ascontiguousarray(cube.real) if is_real else cube
    for kind in FRAME_MAP_KINDS.values():
        if radar.why_no_frames(kind.name) is None:
            maps = kind.make(samples, board, True)
            shape = (2, maps.rows.values.size, maps.columns.values.size)
            assert maps.power.shape == shape
            assert np.isfinite(maps.power).all()


@pytest.mark.parametrize("output", ["iq", "real"])
@pytest.mark.parametrize(
    "array", [BGT60["array"], {"tx": [[0, 0], [3, 0]], "rx": [[0, 0], [1, 0]]}]
)
def test_the_fast_engine_keeps_its_promise(output: str, array: dict[str, Any]) -> None:
    board = board_of(frames_radar(output=output, array=array), 0.3)
    sources = channels(board, P, V, A)
    exact, _ = exact_cube(sources, board)
    fast, _, error_db = fast_cube(sources, board, -80.0)
    if board.is_real:
        exact, fast = exact.real, fast.real
    measured = 10 * np.log10((abs(fast - exact) ** 2).sum() / (abs(exact) ** 2).sum())
    assert max(measured, error_db) < -80


def test_a_pulse_radar_with_a_frame_has_its_antennas_in_the_scene() -> None:
    plain = {"carrier_hz": 24e9, "bandwidth_hz": 250e6, "prf_hz": 2000.0, "adc_rate_hz": 1e6}
    plain |= {"chirp_s": 128e-6, "tx_m": [0.0, -0.1, 1.2], "rx_m": [0.0, 0.1, 1.2]}
    assert isinstance(config_of(plain, maps=["stft"]).radar, FmcwRadar)
    config = config_of(plain | {"frame": {"chirps": 64}})
    radar = config.radar
    assert isinstance(radar, ChirpFramesRadar)
    assert (radar.timing.loops, radar.prf_hz, radar.frames_apart) == (64, 2000, False)
    scene = nominal_scene(config, config.chosen_activities[0])
    antennas = antennas_of(scene)
    assert (antennas.tx, antennas.rx) == ((0.0, -0.1, 1.2), (0.0, 0.1, 1.2))
    board: Board = record(scene, ["board"]).products["board"]
    assert board.position == pytest.approx((0, 0, 1.2))


def test_interval_and_rate_say_the_same_and_survive_a_written_config(tmp_path: Path) -> None:
    config = config_of(BGT60 | {"array": {"tx": [[0, 0], [2, 0]], "rx": [[0, 0]]}})
    assert config.radar.prf_hz == pytest.approx(1000)
    (tmp_path / "again.yaml").write_text(as_yaml(config))
    assert load_config(tmp_path / "again.yaml") == config


def test_a_sweep_of_steps_is_a_chirp_of_as_many_samples() -> None:
    steps = {key: value for key, value in BGT60.items() if key not in ("adc_rate_hz", "chirp_s")}
    steps |= {"waveform": "sfcw", "steps": 128, "dwell_s": 0.5e-6}
    of_steps = config_of(steps).radar
    assert isinstance(of_steps, StepFramesRadar)
    boards = board_of(of_steps, 1.0), board_of(frames_radar(), 1.0)
    assert vars(boards[0].array) == vars(boards[1].array)
    for name in vars(boards[0]).keys() - {"array"}:
        one, other = (getattr(board, name) for board in boards)
        assert other == (pytest.approx(one) if isinstance(one, float) else one), name


def test_every_product_of_frames_is_made() -> None:
    config = config_of(BGT60, maps=ALL)
    scene = nominal_scene(config, config.chosen_activities[0])
    names = ("cube", "range_doppler", "range_azimuth", "range_elevation", "points", "skeleton")
    made = record(scene, names).products
    assert made["cube"].shape == (4, 64, 3, 128)
    assert made["cube"].dtype.kind == "f"
    assert made["range_doppler"].columns.name == "radial speed"
    assert made["skeleton"].shape[0] == 4


def test_a_walker_who_comes_closer_is_on_the_positive_side() -> None:
    """Real samples tell the sign of the Doppler by the sign of the range."""
    board = board_of(frames_radar(frame={"chirps": 64, "interval_s": 250e-6}), 0.02)
    cube, _ = exact_cube(channels(board, (3, 0, 1), (-1.0, 0, 0), 9.0), board)
    maps = range_doppler(np.ascontiguousarray(cube.real), board, True)
    row, column = np.unravel_index(maps.power[0].argmax(), maps.power[0].shape)
    assert maps.columns.values[column] == pytest.approx(1.0, abs=0.1)
    assert maps.rows.values[row] == pytest.approx(3.0, abs=0.2)


@pytest.mark.parametrize(
    ("radar", "line"),
    [
        ("{frame: {chirps: 0}}", "radar.frame.chirps = 0: should be"),
        ("{frame: {chirps: 64, chirp: 3}}", "radar.frame.chirp = 3: is an unknown key"),
        (
            "{frame: {chirps: 64, interval_s: 1e-3, period_s: 0.05}}",
            "radar.frame.period_s = 0.05: should be at least 0.064 s, 64 chirps of 0.001 s",
        ),
        (
            "{frame: {chirps: 64, interval_s: 3e-5}}",
            "radar.chirp_s = 4e-05: should be at most the time from chirp to chirp, 3e-05 s",
        ),
        (
            "{frame: {chirps: 64, interval_s: 1e-3}, prf_hz: 500}",
            "radar.prf_hz = 500.0: should be 1/(frame.interval_s) = 1000 Hz, or be left out",
        ),
        ("{frame: {chirps: 64}, adc_rate_hz: 1e10}", "radar.adc_rate_hz = 10000000000.0"),
        ("{frame: {chirps: 64}, tx_m: [0, 0, 1]}", "radar.rx_m = null: should be given with"),
        (
            f"{{frame: {{chirps: 64}}, {PAIR}, array: {{rx: [[0, 0], [1, 0]]}}}}",
            "should be left out with radar.tx_m and radar.rx_m",
        ),
        ("{frame: {chirps: 64}, device: IWR1443BOOST}", "radar.device"),
        (
            "{waveform: sfcw, frame: {chirps: 64, interval_s: 1e-3}, steps: 64, dwell_s: 2e-5}",
            "radar.steps = 64: should be at most the time from chirp to chirp, 0.001 s (steps * "
            "dwell_s is 0.00128 s)",
        ),
        (
            "{waveform: sfcw, frame: {chirps: 4}, steps: 70000, dwell_s: 1e-7}",
            "radar.steps = 70000: should be at most 65536 with radar.frame",
        ),
        ("{waveform: sfcw, frame: {chirps: 64}, steps: 64}", "radar.dwell_s: is required with"),
        (
            "{waveform: sfcw, frame: {chirps: 64}, steps: 64, dwell_s: 1e-5, chirp_s: 1e-3}",
            "radar.chirp_s",
        ),
        (
            "{waveform: impulse, frame: {chirps: 64}, profile_m: [0, 5]}",
            "should be left out with radar.waveform: impulse: fmcw, sfcw and cw have frames",
        ),
        (
            "{waveform: cw, frame: {chirps: 64}}",
            "should have prf_hz, the samples of each receiver per second, with waveform: cw",
        ),
        (
            "{waveform: cw, frame: {chirps: 64}, prf_hz: 1000}",
            'maps = ["range_doppler"]: should be some of',
        ),
        (
            "{waveform: cw, frame: {chirps: 64}, prf_hz: 1000}",
            "radar.waveform: cw has no range",
        ),
        (
            "{frame: {chirps: 64, period_s: {uniform: [0.05, 0.1]}}}",
            "should be a number: frames, bins and axes of all samples follow from it",
        ),
        (
            "{frame: {chirps: 64}, carrier_hz: {uniform: [24e9, 25e9]}}",
            "should be a number: frames, bins and axes of all samples follow from it",
        ),
        ("{chirps: 64}", "radar.chirps = 64: is a key of frame: radar.frame: {chirps: 64, "),
        ("{frame: {chirps: 64}, rx: 2}", "radar.rx = 2: is a key of array: radar.array: {tx: "),
        ("{frame: {chirps: 64, prf_hz: 9}}", "radar.frame.prf_hz = 9: is a key of radar, beside"),
        (
            "{frame: {chirps: 64}, array: {tx: [[0, 0]], rx: [[0, 0], [0.0062, 0]]}}",
            "should be half wavelengths: all elements lie within 0.0062 of one, and see no",
        ),
        *(
            (f"{{frame: {{chirps: 64}}, array: {array}}}", f"should be places apart: {count}")
            for array, count in (
                ("{rx: [[0, 0], [0, 0]]}", "all 2 elements lie at one place"),
                ("{tx: [[0, 0], [0, 0]], rx: [[1, 0]]}", "all 2 elements lie at one place"),
                ("{rx: [[0, 0], [1, 0], [1, 0]]}", "two receivers lie at one place"),
            )
        ),
        ("{carrier_hz: 24e9}", "FMCW radar with radar.frame, such as 'frame: {chirps: 64}'"),
    ],
)
def test_what_does_not_fit_is_said_in_a_line(radar: str, line: str, tmp_path: Path) -> None:
    text = refusal(tmp_path, radar)
    assert line in text
    assert len(text.splitlines()) == 1


def test_one_chirp_a_frame_and_one_receiver_have_no_angles(tmp_path: Path) -> None:
    text = refusal(tmp_path, "{frame: {chirps: 64}}", "maps: [range_azimuth]")
    assert "all elements of the array lie in one column" in text


def test_places_in_another_unit_are_told_by_angles_that_fold() -> None:
    """2.5 mm are half a wavelength at 60 GHz."""
    millimetres = {"array": {"tx": [[0, 0]], "rx": [[0, 0], [2.5, 0], [2.5, 2.5]]}}
    maps = ["range_azimuth"]
    (line,) = warnings_of_signal(config_of(BGT60 | millimetres, maps=maps))
    assert "2.5 half wavelengths apart or more, so that angles beyond 24 degrees fold" in line
    as_meant = BGT60 | millimetres | {"half_wavelength_m": 1e-3}
    assert not warnings_of_signal(config_of(as_meant, maps=maps))
    assert not warnings_of_signal(config_of(BGT60, maps=maps))


@pytest.mark.parametrize("wall", [{}, {"echoes": "exact"}, {"size_m": [0.1, 5, 2.5]}])
def test_layers_of_a_wall_are_refused_at_once_with_one_that_stands_for_them(
    wall: dict[str, Any],
) -> None:
    """Whatever else the wall has; the one layer is taken, and delays a wave as the layers do."""
    document = {"radar": BGT60, "maps": ["range_doppler"], "motion": {"place": {"range_m": 4}}}
    with pytest.raises(ConfigError, match=r"wall\.layers = .*should be left out") as refused:
        load_config({**document, "wall": {"layers": LAYERS, **wall}})
    assert ".echoes" not in str(refused.value)
    size, eps_r, loss = re.findall(
        r"(?:size_m|eps_r|loss_tangent): (\[.*?\]|[\d.]+)", str(refused.value)
    )
    one = {"size_m": json.loads(size), "eps_r": float(eps_r), "loss_tangent": float(loss)}
    accepted = load_config({**document, "wall": one}).wall
    assert accepted is not None
    optical = 0.025 * np.sqrt(permittivity("plasterboard", np.array(59e9))).real + 0.07
    assert one["size_m"][0] * np.sqrt(one["eps_r"]) == pytest.approx(optical, rel=1e-3)


@pytest.mark.parametrize(
    ("more", "size"),
    [
        ({}, (64, 40)),
        ({"duration_s": 9}, (64, 90)),
        ({"duration_s": 60}, (64, 256)),
        ({"duration_s": 1}, (64, 32)),
        ({"maps": ["stft", "rtm"]}, (64, 40)),
        ({"image": {"size_px": 128}}, (128, 128)),
        ({"image": {"dynamic_range_db": 40}}, (64, 40)),
        ({"image": {"kind": "cfar"}}, (256, 256)),
        ({"maps": ["stft", "range_doppler"]}, (256, 256)),
        ({"radar": {"carrier_hz": 24e9, "prf_hz": 3500}}, (256, 256)),
    ],
)
def test_images_of_frames_have_a_cell_a_pixel_if_no_size_is_given(
    more: dict[str, Any], size: tuple[int, int]
) -> None:
    """But sheets of frames, and radars whose chirps go on, which have the size of all others."""
    document = {"radar": BGT60, "maps": ["stft"], "duration_s": 4, **more}
    config = load_config(document)
    assert config.image.size_px == size
    assert load_config(yaml.safe_load(as_yaml(config))).image.size_px == size
