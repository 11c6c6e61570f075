"""Boards through a config: cube, noise, poses, skeletons, Doppler maps, and what is refused."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.boards import CFG, MARS

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.board_cube import exact_cube
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.motion.skeleton import PARENTS
from radhar_cli.processing.frame_sheets import BONE, bones_sheet, cloud_sheet
from radhar_cli.processing.points import Cloud
from radhar_cli.scene.products.fallback import Fallback
from radhar_cli.scene.products.run import record
from radhar_cli.scene.radar import board_of
from radhar_cli.scene.scene import Scene, draw_scene
from radhar_cli.scene.single.scene_file import describe
from radhar_cli.scene.single.simulate import simulate

C = 299792458.0
QUIET = "receiver.noise_figure_db=null"

YAML = """
radar: {device: IWR1443BOOST, cfg: board.cfg, position_m: [0, 0, 1]}
activities: [punching]
motion: {range_m: 2.2}
duration_s: 0.3
samples_per_class: 2
cloud: {chain: best}
maps: [points]
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "board.cfg").write_text(CFG)
    (tmp_path / "config.yaml").write_text(YAML)
    return tmp_path / "config.yaml"


def scene_of(path: Path, *overrides: str) -> Scene:
    config = load_config(path, overrides)
    return draw_scene(config, config.chosen_activities[0], 0)


def made(path: Path, *names: str, overrides: tuple[str, ...] = ()) -> dict[str, Any]:
    return record(scene_of(path, *overrides), names).products


def test_a_config_gives_the_board_of_its_cfg(path: Path) -> None:
    scene = scene_of(path)
    board = board_of(scene.radar, scene.seconds)
    assert (board.carrier_hz, board.loops, board.frames, board.order) == (77.7e9, 32, 3, MARS.order)
    assert board.position == (0, 0, 1)
    assert board.gain == pytest.approx(10**0.9)


def test_a_written_config_has_the_text_of_the_cfg_and_gives_the_same(path: Path) -> None:
    from radhar_cli.config.identity import as_yaml

    config = load_config(path)
    assert config.radar.cfg == CFG
    (path.parent / "again").mkdir()
    again = path.parent / "again" / "config.yaml"
    again.write_text(as_yaml(config))
    assert load_config(again) == config


def test_cube_is_the_sum_over_the_scatterers_of_every_channel(path: Path) -> None:
    """Made anew from the joints of the motion, the antennas and the pattern."""
    found = made(path, "cube", "board", "motions", overrides=(QUIET,))
    board, motion = found["board"], found["motions"][0]
    for frame, loop, v, (k, r) in [(0, 0, 0, (0, 0)), (2, 31, 11, (2, 3)), (1, 9, 6, (1, 2))]:
        p = motion.positions(board.chirp_times()[frame, loop, k, None])
        antennas = board.antennas(k, r)
        legs = [np.linalg.norm(p[..., 0].T - one, axis=1) for one in (antennas.tx, antennas.rx)]
        a = np.sqrt(motion.cross_sections(np.zeros(1))[:, 0]) * board.aim.two_way(p)[:, 0]
        a *= board.gain * C / board.centre_hz / (4 * np.pi) ** 1.5 / (legs[0] * legs[1])
        tau = sum(legs) / C
        right = beat_matrix(tau[:, None], a[:, None], board.waveform)[:, 0]
        largest = np.abs(right).max()
        np.testing.assert_allclose(found["cube"][frame, loop, v], right, atol=1e-4 * largest)


def test_both_engines_agree_within_the_tolerance(path: Path) -> None:
    fast = made(path, "cube", "accuracy", overrides=(QUIET,))
    exact = made(path, "cube", overrides=(QUIET, "engine.kind=cube"))["cube"]
    error = np.linalg.norm(fast["cube"] - exact) / np.linalg.norm(exact)
    assert 20 * np.log10(error) < -80
    assert fast["accuracy"].error_db < -80


def test_the_radar_equation_gives_436_db_for_a_square_metre_at_a_metre(path: Path) -> None:
    """12 dBm, 9 dBi each, noise figure 15 dB, 2.499 MHz."""
    found = made(path, "noise_sigma", "board")
    board = found["board"]
    a = board.gain * (C / board.centre_hz) / (4 * np.pi) ** 1.5
    assert 20 * np.log10(a / found["noise_sigma"]) == pytest.approx(43.6, abs=0.05)


def test_snr_is_of_a_raw_sample(path: Path) -> None:
    found = made(path, "noise_sigma", "signal_power", "cube", "echo", overrides=("snr_db=10",))
    assert found["signal_power"] / found["noise_sigma"] ** 2 == pytest.approx(10)
    noise = found["cube"] - found["echo"].cube
    assert np.mean(np.abs(noise) ** 2) == pytest.approx(found["noise_sigma"] ** 2, rel=0.02)


OTHERS = {
    "reflector": "room={reflectors: [{position_m: [2, 1, 1], rcs_dbsm: 10, residual_m: 0}]}",
    "faces": "room={box_m: {x: [-0.2, 4], y: [-2, 2], height: 2.6}, faces: {floor: metal}}",
    "people": "people=[{activity: punching, motion: {range_m: 1.2, cross_range_m: 1}}]",
    "wall": "wall={center_m: [1, 0, 1.25]}",
}


@pytest.mark.parametrize("engine", ["direct", "cube"])
@pytest.mark.parametrize("what", OTHERS)
def test_snr_refers_to_the_own_person_alone(path: Path, what: str, engine: str) -> None:
    """As of one channel: neither a room nor other people nor, in free space, a wall add noise."""
    snr = "snr_db=20", f"engine.kind={engine}"
    alone = made(path, "noise_sigma", overrides=snr)["noise_sigma"]
    found = made(path, "noise_sigma", "signal_power", "echo", overrides=(*snr, OTHERS[what]))
    assert found["noise_sigma"] == pytest.approx(alone, rel=1e-6)
    assert found["echo"].power != pytest.approx(found["signal_power"], rel=1e-3)


def test_received_snr_takes_the_loss_of_the_wall_with_it(path: Path) -> None:
    through = made(
        *(path, "signal_power", "echo"),
        overrides=("snr_db=20", "snr_reference=received", OTHERS["wall"]),
    )
    assert through["signal_power"] == pytest.approx(through["echo"].power, rel=1e-9)


TIGHT, CUBE = "engine.tolerance_db=-300", "engine.fallback=cube"


def test_a_board_falls_back_to_the_cube_and_says_so(path: Path) -> None:
    found = made(path, "accuracy", "echo", overrides=(QUIET, TIGHT, CUBE))
    assert isinstance(found["accuracy"], Fallback)
    exact = made(path, "echo", overrides=(QUIET, "engine.kind=cube"))["echo"]
    np.testing.assert_array_equal(found["echo"].cube, exact.cube)
    simulation = simulate(scene_of(path, QUIET, TIGHT, CUBE).config, maps=("points",))
    assert describe(simulation)["engine"] == "cube (fallback)"
    assert any("computed by the cube (engine.fallback)" in one for one in simulation.warnings)


def test_a_board_refuses_to_fall_back_and_names_a_tolerance_that_holds(path: Path) -> None:
    with pytest.raises(SceneError, match=r"or engine\.fallback: cube") as caught:
        made(path, "cube", overrides=(QUIET, TIGHT, "engine.fallback=refuse"))
    limit = re.search(r"should be (-\d+) or more", str(caught.value))
    assert limit
    held = f"engine.tolerance_db={limit[1]}", "engine.fallback=refuse"
    accuracy = made(path, "accuracy", overrides=(QUIET, *held))["accuracy"]
    assert accuracy.error_db <= float(limit[1])


def test_channels_have_noise_of_their_own(path: Path) -> None:
    found = made(path, "cube", "echo", overrides=("snr_db=0",))
    noise = (found["cube"] - found["echo"].cube).transpose(2, 0, 1, 3).reshape(12, -1)
    correlation = np.abs(np.corrcoef(noise)) - np.eye(12)
    assert correlation.max() < 0.05


def test_errors_of_channels_stay_for_a_data_set_or_change_by_sample(path: Path) -> None:
    errors = "receiver.channel_gain_db=1", "receiver.channel_phase_deg=20", QUIET
    by_sample = "receiver.channel_errors=sample"

    def of(index: int, *more: str) -> Any:
        config = load_config(path, [*errors, *more])
        found = record(draw_scene(config, config.chosen_activities[0], index), ["cube", "echo"])
        return (found["cube"] / found["echo"].cube)[0, 0, :, 0]

    np.testing.assert_allclose(of(0), of(1), rtol=1e-3)
    assert np.abs(of(0, by_sample) - of(1, by_sample)).max() > 0.01
    assert np.std(np.degrees(np.angle(of(0)))) > 5


def test_a_board_that_is_moved_and_turned_sees_the_same_from_elsewhere(path: Path) -> None:
    """Skeletons are as the radar sees them: a turn of the radar turns them back."""
    straight = made(path, "skeleton")["skeleton"]
    turned = made(path, "skeleton", overrides=("radar.yaw_deg=30", "radar.position_m=[0.5, 0, 1]"))
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    back = np.array([[c, s], [-s, c]])
    expected = (straight[..., :2] - [0.5, 0]) @ back.T
    np.testing.assert_allclose(turned["skeleton"][..., :2], expected, atol=1e-5)
    np.testing.assert_allclose(turned["skeleton"][..., 2], straight[..., 2], atol=1e-5)


def test_skeletons_are_at_the_middle_of_the_chirps(path: Path) -> None:
    found = made(path, "skeleton", "skeleton_velocity", "motions", "board")
    t = np.arange(3) * 0.1 + 32 * 171e-6 / 2
    p = found["motions"][0].positions(t).T - [0, 0, 1]
    np.testing.assert_allclose(found["skeleton"][:, 0], p, atol=1e-6)
    later = found["motions"][0].positions(t + 0.01).T - [0, 0, 1]
    np.testing.assert_allclose(found["skeleton_velocity"][:, 0] * 0.01, later - p, atol=2e-3)


def test_points_lie_on_the_person_and_say_whose_they_are(path: Path) -> None:
    found = made(path, "cloud", "skeleton", "points_person", overrides=("duration_s=1.5",))
    cloud = found["cloud"]
    assert len(cloud.points) > 15
    frame = np.repeat(np.arange(15), np.diff(cloud.start))
    ways = cloud.points[:, None, :3] - found["skeleton"][frame, 0]
    apart = np.linalg.norm(ways, axis=2).min(axis=1)
    assert np.median(apart) < 0.1
    np.testing.assert_array_equal(found["points_person"], np.where(apart <= 0.5, 0, -1))


@pytest.mark.parametrize("names", [("stft", "rtm"), ("stft_compensated_denoised",)])
@pytest.mark.parametrize("range_sum", ["gated", "coherent"])
def test_doppler_maps_of_a_board(path: Path, names: tuple[str, ...], range_sum: str) -> None:
    """A scatterer of known speed: one window a frame, at its Doppler, in every column."""
    found = made(path, *names, overrides=(f"processing.range_sum={range_sum}", "duration_s=1"))
    for name in names:
        power_map = found[name]
        assert np.isfinite(power_map.power).all()
        if name != "rtm":
            assert power_map.power.shape == (32, 10)
            assert power_map.columns.values[1] - power_map.columns.values[0] == pytest.approx(0.1)
            assert power_map.rows.values[-1] == pytest.approx(1 / (2 * 171e-6) * 15 / 16)


def test_a_wall_and_a_room_are_seen_by_boards_too(path: Path) -> None:
    free = made(path, "echo")["echo"].power
    wall = made(path, "echo", overrides=(OTHERS["wall"],))["echo"].power
    assert wall < 0.7 * free
    assert "room" in made(path, "room", "cube", overrides=("room={reflectors: [{}]}",))


WRONG = {
    "radar.device=null": "null: should name the board that radar.cfg",
    "radar.device=IWR1642": "channelCfg txChannelEn = 7: should be at most 3: the IWR1642BOOST",
    "radar.device=IWR9999": "radar.device",
    "radar.carrier_hz=24e9": "is unknown with radar.cfg, which gives it",
    "duration_s=0.05": "duration_s = 0.05: should hold a frame of 0.1 s",
    "processing.clutter=difference": "processing.clutter",
    "receiver.tones=[{doppler_hz: 10}]": "receiver",
    "engine={kind: cube, motion_in_chirp: true}": "engine.motion_in_chirp",
    "duration_s=5000": "should be at most",
    "output.slow_time=true": "output.slow_time",
    "radar.array={tx: [[0, 0]], rx: [[0, 0], [1, 0]]}": "receivers of the array, 1 and 2",
    "maps=[range_elevation]": "",
    "processing.savgol={order: 5, frame: 33}&maps=[stft_denoised]": (
        "processing.savgol.frame = 33: should be at most the 32 pulses of a frame"
    ),
    "image.doppler_limits_mps=[50, 60]&maps=[stft]": "within the unambiguous band, -5.",
    "image.doppler_limits_mps=[0, 0.5]&maps=[stft]": "should hold at least 2 Doppler bins",
    "processing.window_s=0.0005&maps=[stft]": "processing.window_s = 0.0005: should make",
    "processing.stft_fft_length=16&maps=[stft]": "at least the window of 32 pulses",
    "processing.stft_fft_length=4096&maps=[stft]": "at most 64 times the window of 32 pulses",
    "processing.gate_m=[0, 4]&maps=[stft]": "should end before the range half-band does, at 3.746",
    "processing.gate_m=2&maps=[stft]": "should be less than half the range half-band of 3.746 m",
    "output.power=float16": 'output.power = "float16": should be left out with points',
    "output.power=float16&maps=[stft, range_doppler]": "should be left out with range_doppler",
    "output.column_labels=true": "output.column_labels = true: should be left out with points",
    "image.kind=signed&maps=[rtm]": "image.kind",
    "radar.waveform=cw": "radar.waveform",
    "output.products=[range_elevation]&radar.array={tx: [[0, 0], [4, 0], [8, 0]], rx: [[0, 0], "
    "[1, 0], [2, 0], [3, 0]]}": "output.products",
}


@pytest.mark.parametrize("override", WRONG)
def test_what_a_board_cannot_do_is_said_in_a_line(path: Path, override: str) -> None:
    if not WRONG[override]:
        assert load_config(path, [override]).maps == ("range_elevation",)
        flat = "radar.array={tx: [[0, 0], [4, 0], [8, 0]], rx: [[0, 0], [1, 0], [2, 0], [3, 0]]}"
        with pytest.raises(ConfigError, match="all elements of the array lie in one row"):
            load_config(path, [override, flat])
        return
    with pytest.raises(ConfigError) as caught:
        load_config(path, override.split("&"))
    assert WRONG[override] in str(caught.value)


@pytest.mark.parametrize(
    "override", ["image.doppler_limits_mps=[50, 60]", "processing.window_s=0.0005"]
)
def test_the_pulse_rate_of_a_board_is_said_to_be_of_radar_cfg(path: Path, override: str) -> None:
    with pytest.raises(ConfigError, match=r"radar\.cfg has a PRF of [\d.]+ Hz") as caught:
        load_config(path, [override, "maps=[stft]"])
    assert "radar.prf_hz" not in str(caught.value)


def fewer(path: Path, loops: int, receivers: int = 15) -> None:
    """Frames of so many loops, and these receivers, in board.cfg."""
    text = CFG.replace("frameCfg 0 2 32", f"frameCfg 0 2 {loops}")
    text = text.replace("channelCfg 15", f"channelCfg {receivers}")
    (path.parent / "board.cfg").write_text(text)


@pytest.mark.parametrize("loops", [1, 3, 4, 7, 8, 11])
def test_what_frames_of_few_loops_show_is_made_and_the_rest_refused(path: Path, loops: int) -> None:
    fewer(path, loops)
    still = "processing.clutter=none"
    possible = {"rtm", "range_azimuth", "range_elevation", "cube", "azimuth_time", "elevation_time"}
    if loops >= 4 or loops == 1:
        possible |= {"range_doppler", "doppler_azimuth", "doppler_elevation", "points"}
    possible |= {"stft", "stft_compensated"} if loops >= 8 else set()
    possible |= {"stft_denoised", "stft_compensated_denoised"} if loops >= 11 else set()
    simulation = simulate(load_config(path, ["maps=[rtm]", still]), maps="all")
    shown = {*simulation.maps, *simulation.frames} - {"cloud", "skeletons", "points_person"}
    assert shown == possible - {"points"}
    assert ("cloud" in simulation.frames) == ("points" in possible)
    for maps in (*simulation.maps.values(), simulation.frames["range_azimuth"]):
        assert np.isfinite(maps.power).all()
        assert maps.power.any()
    for name in {"points", "range_doppler", "stft", "stft_denoised"} - possible:
        with pytest.raises(ConfigError, match=r"of a frame\W.*radar\.cfg"):
            load_config(path, [f"maps=[{name}]", still])


def test_the_mean_of_a_single_loop_which_would_leave_nothing_is_not_removed(path: Path) -> None:
    fewer(path, 1)
    names = ("range_doppler", "points", "signal")
    still, mean = (
        made(path, *names, overrides=(f"processing.clutter={clutter}", "cloud.chain=best"))
        for clutter in ("none", "mean")
    )
    assert still["range_doppler"].power.shape[2] == 1
    assert still["range_doppler"].columns.values.tolist() == [0]
    np.testing.assert_array_equal(still["range_doppler"].power, mean["range_doppler"].power)
    np.testing.assert_array_equal(still["points"], mean["points"])
    np.testing.assert_array_equal(still["signal"].x, mean["signal"].x)
    assert (still["points"][:, 3] == 0).all()


def test_points_of_a_row_that_does_not_tell_azimuths_are_refused(path: Path) -> None:
    fewer(path, 32, receivers=5)  # two half wavelengths apart
    for chain in ("best", "board"):
        words = rf"elements at 0, 2, 4, 6 half wavelengths, .* cloud\.chain: {chain}"
        with pytest.raises(ConfigError, match=words):
            load_config(path, [f"cloud.chain={chain}"])
    assert "points" not in simulate(load_config(path, ["maps=[range_azimuth]"])).frames
    fewer(path, 32, receivers=7)  # 0, 1, 2, 4, 5, 6: the firmware takes them for neighbours
    with pytest.raises(ConfigError, match="does not tell azimuths apart"):
        load_config(path, ["cloud.chain=board"])
    assert len(made(path, "cloud", overrides=("duration_s=1",))["cloud"].points) > 5


def test_one_channel_has_points_without_angles(path: Path) -> None:
    one = "radar.array={tx: [[0, 0]], rx: [[0, 0]]}"
    text = CFG.replace("channelCfg 15 7", "channelCfg 1 1").replace("frameCfg 0 2", "frameCfg 0 0")
    (path.parent / "board.cfg").write_text(text)
    for more in ((), (one,)):
        cloud = made(path, "cloud", overrides=("duration_s=1", *more))["cloud"]
        assert len(cloud.points) > 5
        assert not cloud.points[:, 1:3].any()
        with pytest.raises(ConfigError, match="all elements of the array lie in one column"):
            load_config(path, ["maps=[range_azimuth]", *more])


STILL = (
    "activities=[stationary]",
    "subject={sway_ahead_m: 0, sway_aside_m: 0, chest_m: 0, heart_m: 0}",
    "motion={range_m: 2, idle: {fidget_hz: 0, shuffle_hz: 0}}",
    "snr_db=null",
    QUIET,
)


@pytest.mark.parametrize("body", ["points", "segments"])  # surfaces tremble
@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_a_person_who_does_not_move_at_all_is_black_and_said_to_be(
    path: Path, engine: str, body: str
) -> None:
    options = *STILL, f"engine.kind={engine}", f"body.scatterers={body}"
    simulation = simulate(load_config(path, options), maps="all")
    names = ["stft", "rtm", "range_doppler", "range_azimuth", "range_elevation", "points"]
    (said,) = [one for one in simulation.warnings if "a map is black" in one]
    assert not {*names} - {*said.partition(": ")[0].split(", ")}
    for chain in ("board", "best"):
        assert not len(made(path, "points", overrides=(*options, f"cloud.chain={chain}"))["points"])


@pytest.mark.every(4)
@pytest.mark.parametrize("distance", [2.0, 3.0, 5.0])
@pytest.mark.parametrize("body", ["points", "segments", "surfaces"])
@pytest.mark.parametrize("device", ["IWR6843ISK", "IWR6843AOP", "IWR1443BOOST"])
def test_all_channels_see_one_body(path: Path, device: str, body: str, distance: float) -> None:
    """Segments have as many points as the nearest antenna needs; at 3 m channels disagreed."""
    cfg = device.lower()
    options = (
        *(f"radar.device={device}", f"radar.cfg={cfg}", f"body.scatterers={body}", QUIET),
        *(f"motion.range_m={distance}", "activities=[walking]", "maps=[range_doppler]"),
    )
    scene = scene_of(path, *options)
    found = record(scene, ["channels", "echo", "board"])
    first, *rest = (source(np.zeros(1)) for source in found["channels"])
    for paths in rest:
        np.testing.assert_allclose(paths.delay, first.delay, atol=2e-10)
        np.testing.assert_allclose(paths.amplitude, first.amplitude, rtol=0.3, atol=1e-6)
    exact, power = exact_cube(found["channels"], found["board"])
    error = np.linalg.norm(found["echo"].cube - exact) / np.linalg.norm(exact)
    assert 20 * np.log10(error) < -80
    assert found["echo"].power == pytest.approx(power, rel=1e-6)


def test_points_do_not_show_the_truth(path: Path) -> None:
    """Networks train on the images of points: skeletons are drawn beneath for looking only."""
    found = made(path, "image:points", "cloud", "skeleton", overrides=(QUIET,))
    nothing = Cloud.of([np.empty((0, 8))] * 3)
    size = found["image:points"].levels.shape
    assert not cloud_sheet(nothing, size).levels.any()
    np.testing.assert_array_equal(
        found["image:points"].levels, cloud_sheet(found["cloud"], size).levels
    )
    bones = bones_sheet(found["skeleton"], PARENTS, size)
    assert {*np.unique(bones)} == {0, BONE}
    assert (bones > 0).any()


def test_speeds_beyond_the_board_say_that_angles_are_wrong_too(path: Path) -> None:
    slow = CFG.replace("profileCfg 0 77 17", "profileCfg 0 77 600")
    (path.parent / "board.cfg").write_text(slow)
    (said,) = [one for one in simulate(load_config(path)).warnings if "aliases" in one]
    assert "its angles are wrong, too" in said
    (path.parent / "board.cfg").write_text(
        slow.replace("600", "2000").replace("frameCfg 0 2", "frameCfg 0 0")
    )
    one = simulate(load_config(path))
    (said,) = [one for one in one.warnings if "aliases" in one]
    assert "angles" not in said


@pytest.mark.parametrize("name", ["range_doppler", "points"])
def test_frames_without_a_board_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"of the frames of a board \(radar\.cfg"):
        Config(maps=(name,))


def test_a_cfg_that_is_not_there_is_named(path: Path) -> None:
    path.write_text(YAML.replace("board.cfg", "missing.cfg"))
    with pytest.raises(ConfigError, match=r'radar\.cfg = "missing\.cfg": should be the path'):
        load_config(path)


def test_a_mistake_in_the_cfg_is_named_with_its_line(path: Path) -> None:
    (path.parent / "board.cfg").write_text(CFG.replace("adcCfg 2 1", "adcCfg 2 3"))
    with pytest.raises(ConfigError, match=r"^board\.cfg:3: adcCfg adcOutputFmt = 3: should be 0"):
        load_config(path)
