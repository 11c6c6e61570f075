"""`wall.echoes: exact`, `wall.layers` and `radar.waveform: impulse` in whole scenes."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml
from helpers.boards import CFG

from radhar_cli.config import load_config
from radhar_cli.config.checks.unused_keys import unused_keys
from radhar_cli.config.data_set import Config
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.exact import signal_power
from radhar_cli.echo.static_returns import leakage
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.scene_file import write_all
from radhar_cli.scene.single.simulate import simulate

WALKING = activity_named("walking")
RADAR = {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 128, "adc_rate_hz": 2e6}
IMPULSE = {
    **{"waveform": "impulse", "carrier_hz": 0.7e9, "bandwidth_hz": 1.6e9, "prf_hz": 64},
    **{"profile_m": [0, 5]},
}
WALL = {"center_m": [1.0, 0, 1.25], "echoes": "exact"}
PLASTERBOARD = [
    {"thickness_m": 0.0125, "material": "plasterboard"},
    {"thickness_m": 0.07, "eps_r": 1},
    {"thickness_m": 0.0125, "material": "plasterboard"},
]


DOCUMENT: dict[str, Any] = {
    **{"radar": RADAR, "activities": ["walking"], "duration_s": 1},
    **{"motion": {"range_m": 4, "angle_deg": 180, "walking": {"speed_mps": 0.8}}},
    **{"engine": {"kind": "cube"}, "snr_db": None, "wall": WALL},
}
GATED = {"range_sum": "gated", "clutter": "mean"}
AS_IMPULSE = {"radar": IMPULSE, "engine": {}, "processing": GATED, "maps": ["rtm", "stft"]}


def config(**more: Any) -> Config:
    return Config.model_validate(DOCUMENT | more)


def echo(**more: Any) -> np.ndarray:
    return record(nominal_scene(config(**more), WALKING), ["signal"])["signal"].x[0, 0]


def relative_db(x: np.ndarray, right: np.ndarray) -> float:
    return 20 * np.log10(np.linalg.norm(x - right) / np.linalg.norm(right))


def impulse(**more: Any) -> Config:
    return config(**AS_IMPULSE | more)


def test_a_wall_of_air_is_none() -> None:
    air = {**WALL, "layers": [{"thickness_m": 0.3, "eps_r": 1}]}
    assert relative_db(echo(wall=air), echo(wall=None)) < -150


@pytest.mark.parametrize("scatterers", ["points", "segments", "surfaces"])
def test_one_layer_is_the_homogeneous_wall(scatterers: str) -> None:
    body = {"scatterers": scatterers, "points_per_segment": 2}
    layer = {"thickness_m": 0.24, "eps_r": 6, "loss_tangent": 0.03}
    layered = echo(body=body, wall={**WALL, "layers": [layer]})
    assert np.array_equal(layered, echo(body=body, wall=WALL))


def test_what_ringing_changes() -> None:
    # Without reflections inside it would be the plane wave's delay and loss.
    single = echo(wall={**WALL, "echoes": "none"})
    assert -14 < relative_db(echo(), single) < -4
    thin = {**WALL, "size_m": [0.24, 5, 2.5], "eps_r": 1.02, "loss_tangent": 0.0}
    assert relative_db(echo(wall=thin), echo(wall=thin | {"echoes": "none"})) < -40


def test_polarisation_matters_beside_the_wall_normal() -> None:
    motion = {"range_m": 4, "cross_range_m": 2.5, "angle_deg": 180, "walking": {"speed_mps": 0.4}}
    both = [
        echo(motion=motion, radar=RADAR | {"polarisation": one})
        for one in ("vertical", "horizontal")
    ]
    assert -25 < relative_db(*both) < -5


def test_rooms_are_seen_through_it() -> None:
    room = {"faces": {"floor": "concrete"}}
    assert -30 < relative_db(echo(room=room), echo()) < 0


def test_power_is_what_the_wall_leaves() -> None:
    scene = nominal_scene(config(snr_db=20, snr_reference="received"), WALKING)
    recorded = record(scene, ["signal_power", "paths", "waveform"])
    clear = nominal_scene(config(wall=None), WALKING)
    air = record(clear, ["paths"])["paths"]
    loss = recorded["signal_power"] / signal_power(air, recorded["waveform"])
    assert -14 < 10 * np.log10(loss) < -7  # 2 faces and 0.24 m, twice, some 5 dB a leg


def test_a_raw_echo_has_its_reflection() -> None:
    made, plain = (
        simulate(config(wall={**WALL, "echoes": one}), raw=True) for one in ("exact", "none")
    )
    assert made.wall is not None
    assert made.wall.layers is not None
    assert made.beat is not None
    assert plain.beat is not None
    still = leakage(made.antennas)
    leaked = beat_matrix(np.array([[still.delay]]), np.array([[still.amplitude]]), made.waveform)
    change = (made.beat - leaked).mean(axis=1) / (plain.beat - leaked).mean(axis=1)
    reflected = made.wall.layers.scattering_coefficients(
        made.waveform.frequencies(), np.ones(())
    ).reflected
    right = reflected / abs(made.wall.reflection)
    assert np.abs(change - right).max() < 0.1  # the person's echo is there, too


def test_samples_of_impulses_are_real() -> None:
    made = record(nominal_scene(impulse(snr_db=20), WALKING), ["range_signals", "stft", "rtm"])
    assert not made["range_signals"].x.imag.any()
    spectrum = made["stft"].power
    odd = len(spectrum) % 2 == 0  # -PRF/2 has no partner
    mirrored = spectrum[odd:][::-1]
    assert np.abs(spectrum[odd:] - mirrored).max() < 1e-12 * spectrum.max()


def test_their_noise_is_white_and_as_strong_as_asked() -> None:
    quiet = record(nominal_scene(impulse(), WALKING), ["range_signals", "signal_power"])
    noisy = record(nominal_scene(impulse(snr_db=3), WALKING), ["range_signals"])
    noise = (noisy["range_signals"].x - quiet["range_signals"].x).real[0]
    pulses = noise.shape[1]
    right = quiet["signal_power"] / 10**0.3 * (1 - 1 / pulses)  # less its mean
    assert noise.var() == pytest.approx(right, rel=0.05)
    neighbours = (noise[1:] * noise[:-1]).mean() / noise.var()
    assert abs(neighbours) < 0.03


def test_people_are_where_they_are(tmp_path: Path) -> None:
    made = simulate(impulse(wall=None), maps=("rtm",))
    ranges = made.maps["rtm"].rows.values
    strongest = ranges[made.maps["rtm"].power.argmax(axis=0)]
    torso = made.truth.positions[:, 0]
    away = np.linalg.norm(torso - [0.4, 0, 1.5], axis=1)
    assert np.abs(np.median(strongest) - np.median(away)) < 0.25


def test_a_range_gain_is_that_of_the_bins() -> None:
    plain = record(nominal_scene(impulse(), WALKING), ["rtm"])["rtm"]
    gained = {"range_sum": "gated", "clutter": "mean", "range_gain_power": 2}
    made = record(nominal_scene(impulse(processing=gained), WALKING), ["rtm"])["rtm"]
    right = plain.power * ((plain.rows.values / plain.rows.values[-1]) ** 4)[:, None]
    assert made.power == pytest.approx(right)


def test_signed_images_have_zero_in_the_middle(tmp_path: Path) -> None:
    image = {"kind": "signed", "size_px": 64}
    given = impulse(maps=["rtm"], image=image, processing={"clutter": "mean"})
    made = record(nominal_scene(given, WALKING), ["image:rtm", "rtm"])
    grey = made["image:rtm"].levels
    assert np.abs(grey[-2:].astype(int) - 128).max() <= 1  # nothing stands at the radar
    assert (grey == 0).mean() + (grey == 255).mean() == pytest.approx(0.02, abs=0.01)
    simulation = simulate(given)
    write_all(simulation, tmp_path)
    with h5py.File(tmp_path / "scene.h5") as file:
        assert file["maps/rtm"][:].min() < 0 < file["maps/rtm"][:].max()


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"engine": {}}, r"engine\.kind.*direct.*should be cube with wall.echoes"),
    ({"wall": WALL | {"rays": "straight"}}, r"wall\.rays.*should be plane"),
    ({"wall": WALL | {"fresnel": "parallel"}}, r"wall\.fresnel.*radar\.polarisation"),
    ({"wall": WALL | {"layers": PLASTERBOARD, "eps_r": 3}}, r"wall\.eps_r = 3.*wall\.layers"),
    (
        {"wall": WALL | {"layers": PLASTERBOARD, "size_m": [0.2, 5, 2]}},
        r"wall\.size_m\.0 = 0.2.*null",
    ),
    ({"wall": WALL | {"size_m": [None, 5, 2]}}, r"wall\.size_m\.0 = null.*a number"),
    ({"wall": {"layers": PLASTERBOARD}}, r"wall\.echoes.*should be exact"),
    ({"wall": WALL | {"layers": []}}, r"wall\.layers"),
    ({"wall": WALL | {"layers": [{"thickness_m": 1}]}}, r"wall\.layers\.0.*a material, or eps_r"),
    (
        {"wall": WALL | {"layers": [{"thickness_m": 1, "material": "wood", "eps_r": 2}]}},
        r"wall\.layers\.0.*a material, or eps_r",
    ),
    ({"wall": WALL | {"layers": [{"thickness_m": 1, "material": "cheese"}]}}, r"concrete"),
    (
        {"radar": {"cfg": CFG, "device": "IWR1443BOOST"}, "engine": {}, "maps": ["points"]},
        r"wall\.echoes.*none with radar\.cfg",
    ),
    (
        {"radar": RADAR | {"profile_m": [0, 3]}},
        r"radar\.profile_m.*a key of radar\.waveform: impulse",
    ),
    ({"image": {"kind": "signed"}, "maps": ["rtm"]}, r"image\.kind.*impulse"),
]
WRONG_IMPULSES: list[tuple[dict[str, Any], str]] = [
    ({"radar": IMPULSE | {"profile_m": None}}, r"radar\.profile_m = null.*a list"),
    ({"radar": IMPULSE | {"profile_m": [3, 1]}}, r"radar\.profile_m = \[3.*from < to"),
    ({"radar": IMPULSE | {"profile_samples": 64}}, r"profile_samples = 64: should be 207 or more"),
    ({"engine": {"kind": "cube"}}, r"engine\.kind.*should be direct"),
    ({"maps": ["fsst"]}, r"^[^\n]*maps.*fsst.*real[^\n]*$"),
    ({"radar": IMPULSE | {"adc_rate_hz": 1e6}}, r"^[^\n]*adc_rate_hz.*is unknown with[^\n]*$"),
    ({"processing": {"range_fft_length": 64} | GATED}, r"range_fft_length = 64.*left out"),
    ({"maps": ["stft_compensated"]}, r"maps.*real"),
    ({"processing": {}}, r"^[^\n]*processing\.range_sum.*gated[^\n]*$"),
    ({"image": {"kind": "signed"}}, r"maps.*\[rtm\] with image\.kind: signed"),
    ({"output": {"slow_time": True}}, r"output\.slow_time"),
    ({"radar": IMPULSE | {"residual_video_phase": True}}, r"residual_video_phase"),
    ({"radar": IMPULSE | {"chirp_s": 1e-5}}, r"radar\.chirp_s.*is unknown with"),
    ({"radar": IMPULSE | {"steps": 4}}, r"radar\.steps.*a key of radar\.waveform: sfcw"),
    ({"receiver": {"noise_corner_hz": 10}, "snr_db": 3}, r"noise_corner_hz.*real"),
]


def refused(document: dict[str, Any], tmp_path: Path, message: str) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(yaml.safe_dump(document))
    with pytest.raises(ConfigError, match=message):
        load_config(path)


@pytest.mark.parametrize(("more", "message"), WRONG)
def test_walls_that_do_not_go_together_are_refused(
    more: dict[str, Any], message: str, tmp_path: Path
) -> None:
    refused(DOCUMENT | more, tmp_path, message)


@pytest.mark.parametrize(("more", "message"), WRONG_IMPULSES)
def test_impulse_radars_that_do_not_either(
    more: dict[str, Any], message: str, tmp_path: Path
) -> None:
    refused(DOCUMENT | AS_IMPULSE | more, tmp_path, message)


def test_polarisation_without_walls_is_said_to_have_no_effect() -> None:
    given = config(radar=RADAR | {"polarisation": "horizontal"}, wall=None)
    assert any("radar.polarisation has no effect" in one for one in unused_keys(given))
    assert not unused_keys(config(radar=RADAR | {"polarisation": "horizontal"}, wall=WALL))


def test_layers_are_drawn_and_written() -> None:
    layers = [{"thickness_m": {"uniform": [0.1, 0.3]}, "eps_r": {"uniform": [3, 9]}}]
    given = config(wall=WALL | {"layers": layers})
    again = Config.model_validate(given.model_dump(mode="json"))
    assert again.wall == given.wall
    assert given.wall is not None
    assert given.wall.size_m[0] is None
