"""The strength of noise: an SNR, the receiver's noise figure, or none; one law for every radar."""

from math import log10
from typing import Any

import numpy as np
import pytest
from helpers.boards import CFG
from helpers.command_line import ROOT

from radhar_cli.config.checks.unused_keys import unused_keys
from radhar_cli.config.data_set import Config
from radhar_cli.echo.receiver.noise_law import Silent, Snr, Thermal
from radhar_cli.scene.checks.warnings import config_warnings
from radhar_cli.scene.products.noise import noise_law_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, nominal_scene
from radhar_cli.scene.single.raw_echo import RAW_ECHO

BOLTZMANN, T0 = 1.380649e-23, 290.0
RADAR = {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 250}
SFCW = {"waveform": "sfcw", "steps": 100, "dwell_s": 1e-5, "prf_hz": 250}
ISK_CFG = (ROOT / "radhar_cli/config/radars/iwr6843isk.cfg").read_text()
BOARD = {"radar": {"device": "IWR1443BOOST", "cfg": CFG}, "duration_s": 0.3}
# {radar: (config, samples a second in which the receiver has its noise)}
RADARS: dict[str, tuple[dict[str, Any], float]] = {
    "direct": ({}, 10e6),
    "cube": ({"engine": {"kind": "cube"}}, 10e6),
    "gated": ({"processing": {"range_sum": "gated"}}, 10e6),
    "sfcw": ({"radar": SFCW}, 1e5),
    "cw": ({"radar": {"waveform": "cw", "carrier_hz": 24e9, "prf_hz": 400}}, 400),
    "board": (BOARD, 2.499e6),
}
PRODUCT = {"gated": "range_signals", "board": "cube"}


def scene_of(*more: dict[str, Any]) -> Scene:
    document: dict[str, Any] = {"radar": RADAR, "duration_s": 1, "motion": {"range_m": 3}}
    document |= {"activities": ["punching"], "maps": ["stft"]}
    for one in more:
        document |= one
    config = Config.model_validate(document)
    return nominal_scene(config, config.chosen_activities[0])


def samples(scene: Scene, product: str) -> Any:
    made = record(scene, [product])[product]
    return getattr(made, "x", made)


@pytest.mark.parametrize("radar", RADARS)
def test_thermal_noise_is_k_t0_fs_f_over_the_power_that_is_sent(radar: str) -> None:
    """The same samples as by the SNR that it makes: noise is drawn by one and the same code."""
    more, rate = RADARS[radar]
    hot = {"receiver": {"noise_figure_db": 60}}
    product = PRODUCT.get(radar, "signal")
    thermal = scene_of(more, hot)
    sent = 10 ** (thermal.radar.transmit_power_dbm / 10) / 1e3
    variance = BOLTZMANN * T0 * rate * 1e6 / sent
    assert record(thermal, ["noise_sigma"])["noise_sigma"] ** 2 == pytest.approx(variance)
    power = record(scene_of(more, {"snr_db": 0}), ["signal_power"])["signal_power"]
    by_snr = samples(scene_of(more, {"snr_db": 10 * log10(power / variance)}), product)
    found = samples(thermal, product)
    silent = {"snr_db": None, "receiver": {"noise_figure_db": None}}
    clean = samples(scene_of(more, silent), product)
    noise = np.abs(found - clean).std()
    assert noise > 0.1 * np.sqrt(variance)
    np.testing.assert_allclose(found, by_snr, rtol=0, atol=1e-5 * noise)


def test_a_raw_recording_has_it() -> None:
    hot, silent = ({"snr_db": None, "receiver": {"noise_figure_db": f}} for f in (60, None))
    noisy, clean = (
        record(scene_of(one), ["raw_echo"], [RAW_ECHO])["raw_echo"] for one in (hot, silent)
    )
    sent = 10 ** (12 / 10) / 1e3
    expected = BOLTZMANN * T0 * 10e6 * 1e6 / sent
    assert np.mean(np.abs(noisy - clean) ** 2) == pytest.approx(expected, rel=0.02)


def test_more_power_is_less_noise() -> None:
    hot = {"receiver": {"noise_figure_db": 60}}
    weak, strong = (
        record(scene_of(hot, {"radar": RADAR | {"transmit_power_dbm": dbm}}), ["noise_sigma"])
        for dbm in (0, 20)
    )
    assert weak["noise_sigma"] == pytest.approx(10 * strong["noise_sigma"])


@pytest.mark.parametrize(
    ("document", "law"),
    [
        ({}, Snr(30)),
        ({"snr_db": None}, Silent()),
        ({"receiver": {"noise_figure_db": 8}}, Thermal(8, 12)),
        ({"snr_db": None, "receiver": {"noise_figure_db": 8}}, Thermal(8, 12)),
        ({"snr_db": 20, "receiver": {"noise_figure_db": 8}}, Snr(20)),
        (BOARD, Thermal(15, 12)),
        (BOARD | {"radar": {"device": "IWR6843ISK", "cfg": ISK_CFG}}, Thermal(30, 12)),
        (
            BOARD | {"radar": {"array": {"tx": [[0, 0], [4, 0], [2, 1]]}, "cfg": CFG}},
            Thermal(30, 12),
        ),
        (BOARD | {"snr_db": None}, Thermal(15, 12)),
        (BOARD | {"snr_db": 20}, Snr(20)),
        (BOARD | {"snr_db": None, "receiver": {"noise_figure_db": None}}, Silent()),
        (BOARD | {"receiver": {"noise_figure_db": None}}, Silent()),
    ],
)
def test_what_null_means_is_the_same_written_or_left_out(document: Any, law: Any) -> None:
    config = Config.model_validate(document)
    assert noise_law_of(config) == law
    assert config.has_noise == (law != Silent())
    stored = Config.model_validate(config.model_dump(mode="json"))
    assert noise_law_of(stored) == law
    ignored = document.get("snr_db") == 20 and "receiver" in document
    assert any("noise_figure_db" in one for one in unused_keys(config)) == ignored


def test_an_impulse_radar_has_no_noise_figure() -> None:
    radar = {"waveform": "impulse", "carrier_hz": 7e9, "profile_m": [0, 9], "profile_samples": 1500}
    document = {"radar": radar, "maps": ["rtm"], "receiver": {"noise_figure_db": 8}}
    with pytest.raises(ValueError, match=r"noise_figure_db.*should be null with .*impulse"):
        Config.model_validate(document)


def sigma_db(*more: dict[str, Any]) -> float:
    return 20 * log10(record(scene_of(*more), ["noise_sigma"])["noise_sigma"])


AWAY = {"radar": RADAR | {"beam": {"pan_deg": 60, "azimuth_deg": 70}}}
RECEIVED = {"snr_reference": "received"}


def test_a_beam_that_looks_away_costs_snr_unless_that_is_of_what_is_received() -> None:
    """At pan degrees from the boresight a leg has 12 (pan/width)^2 dB less, both 17.6 dB."""
    assert sigma_db(AWAY) == pytest.approx(sigma_db({}), abs=1e-6)
    ahead = {"radar": RADAR | {"beam": {"azimuth_deg": 70}}}
    loss = sigma_db(ahead, RECEIVED) - sigma_db(AWAY, RECEIVED)
    assert loss == pytest.approx(2 * 12 * (60 / 70) ** 2, abs=0.5)
    assert sigma_db(RECEIVED) == pytest.approx(sigma_db({}), abs=1e-6)


def test_a_board_that_looks_away_costs_snr_too() -> None:
    turned = BOARD["radar"] | {"yaw_deg": 60}
    ahead, away = BOARD | {"snr_db": 20}, BOARD | {"radar": turned, "snr_db": 20}
    assert sigma_db(away) == pytest.approx(sigma_db(ahead), abs=0.1)
    assert sigma_db(away, RECEIVED) < sigma_db(ahead, RECEIVED) - 10


@pytest.mark.parametrize(
    "more",
    [
        {"room": {"reflectors": [{"position_m": [4, 0, 1], "rcs_dbsm": 10}]}},
        {"room": {"faces": {"floor": "metal"}}},
        {"people": [{"activity": "walking", "motion": {"range_m": 5, "cross_range_m": 1.2}}]},
        {"wall": {}},
    ],
)
@pytest.mark.parametrize("radar", ["direct", "cube", "board"])
def test_the_snr_is_that_of_the_samples_own_person(radar: str, more: dict[str, Any]) -> None:
    """Not of the room, nor of others; a wall takes it where it refers to free space."""
    alone = [RADARS[radar][0], {"snr_db": 20, "motion": {"range_m": 3}}]
    assert sigma_db(*alone, more) == pytest.approx(sigma_db(*alone), abs=0.01)


def test_a_board_whose_person_is_below_its_thermal_noise_is_told() -> None:
    radar = BOARD["radar"] | {"yaw_deg": 150}
    document = BOARD | {"radar": radar, "maps": ["points"], "activities": ["punching"]}
    found = config_warnings(Config.model_validate(document | {"motion": {"range_m": 3}}))
    assert any("maps show noise alone" in one and "radar.yaw_deg" in one for one in found)
    facing = Config.model_validate(document | {"radar": BOARD["radar"]})
    assert not any("noise alone" in one for one in config_warnings(facing))
