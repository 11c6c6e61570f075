"""Maps that show noise alone are warned of, by the gain of their processing; others are not."""

from math import log10
from typing import Any

import numpy as np
import pytest
from helpers.boards import CFG

from radhar_cli.config.data_set import Config
from radhar_cli.scene.checks.visibility import LEAST_CELL_SNR_DB, cell_gain_db
from radhar_cli.scene.checks.warnings import config_warnings
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import nominal_scene

K24: dict[str, Any] = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 1000}
RADARS: dict[str, dict[str, Any]] = {
    "fmcw": K24,
    "sfcw": {"waveform": "sfcw", "steps": 100, "dwell_s": 1e-5, "prf_hz": 250},
    "cw": {"waveform": "cw", "carrier_hz": 24e9, "prf_hz": 1000},
    "impulse": {
        "waveform": "impulse",
        "carrier_hz": 7e9,
        "bandwidth_hz": 1.5e9,
        "profile_m": [0, 9],
        "profile_samples": 1200,
        "prf_hz": 200,
    },
    "impulse, iq": {
        "waveform": "impulse",
        "output": "iq",
        "carrier_hz": 7e9,
        "bandwidth_hz": 1.5e9,
        "profile_m": [0, 9],
        "profile_samples": 180,
        "prf_hz": 200,
    },
    "board": {"device": "IWR1443BOOST", "cfg": CFG},
}
BACKWARDS = {"radar": K24 | {"beam": {"pan_deg": 180}}}
HOT = {"snr_db": None, "receiver": {"noise_figure_db": 80}}


def config(**more: Any) -> Config:
    document: dict[str, Any] = {"radar": K24, "motion": {"range_m": 3}, "duration_s": 2}
    document |= {"activities": ["walking"], "maps": ["stft"]}
    return Config.model_validate(document | more)


def said(c: Config) -> list[str]:
    return [line for line in config_warnings(c) if "maps show noise alone" in line]


@pytest.mark.parametrize("radar", RADARS)
def test_an_snr_that_no_processing_makes_up_for_is_warned_of(radar: str) -> None:
    gated = {"processing": {"range_sum": "gated", "gate_m": [1, 4]}} if radar == "impulse" else {}
    more = gated | {"radar": RADARS[radar]}
    assert len(said(config(snr_db=-75, **more))) == 1
    assert not said(config(snr_db=10, **more))
    assert not said(config(snr_db={"uniform": [-75, 75]}, **more))
    if radar in ("fmcw", "impulse", "impulse, iq"):
        assert len(said(config(snr_db=-75, maps=["rtm"], **(more | {"processing": {}})))) == 1


@pytest.mark.parametrize(
    ("more", "keys"),
    [
        ({"snr_db": -30}, "(snr_db)"),
        ({"snr_db": -75}, "(snr_db)"),
        (BACKWARDS | {"snr_db": -75}, "(snr_db)"),
        (BACKWARDS | {"snr_db": 0}, "(radar.beam, snr_db or snr_reference: received)"),
        (BACKWARDS | {"snr_db": 0, "snr_reference": "received"}, None),
        (BACKWARDS | {"snr_db": 60}, None),
        (HOT, "(motion.range_m, radar.transmit_power_dbm or receiver.noise_figure_db)"),
        (HOT | {"motion": {"range_m": 0.6}}, None),
        (HOT | BACKWARDS, "(radar.beam, motion.range_m,"),
        ({"snr_db": -10}, None),
        ({"snr_db": -20}, None),
    ],
)
def test_the_cure_names_keys_that_act(more: Any, keys: str | None) -> None:
    lines = said(config(**more))
    assert [keys is not None and keys in line for line in lines] == [True] * (keys is not None)


def test_a_longer_window_or_another_map_shows_more() -> None:
    assert said(config(snr_db=-29))
    assert not said(config(snr_db=-29, processing={"window_s": 1.0}))
    assert not said(config(snr_db=-29, maps=["stft", "rtm"]))


@pytest.mark.parametrize(
    ("more", "name"),
    [
        ({}, "stft"),
        ({"processing": {"range_sum": "gated", "gate_m": 0.075, "clutter": "none"}}, "stft"),
        ({"radar": RADARS["sfcw"]}, "stft"),
        ({"radar": RADARS["cw"]}, "stft"),
    ],
)
def test_the_gain_is_what_a_point_in_the_middle_of_a_cell_has(more: Any, name: str) -> None:
    """The strongest cell of people over mean noise is near it.

    Scatterers add in amplitude, or lie in several cells.
    """
    ratio = []
    for snr in (150, -150):
        c = config(**({"processing": {"clutter": "none"}} | more), snr_db=snr, maps=[name])
        isolated = c.radar.model_copy(update={"antenna_isolation_db": 300.0})  # people alone
        c = c.model_copy(update={"radar": isolated})
        scene = nominal_scene(c, c.chosen_activities[0])
        ratio.append(record(scene, [name])[name].power)
    found = 10 * log10(ratio[0].max() / np.mean(ratio[1])) + 150
    assert -8 < found - cell_gain_db(scene, name) < 9


def test_where_it_is_said_the_image_is_that_of_noise() -> None:
    """At the limit the image of a walker is that at -250 dB, of the same noise."""

    def image(snr: float) -> np.ndarray[Any, Any]:
        c = config(snr_db=snr)
        made = record(nominal_scene(c, c.chosen_activities[0]), ["image:stft"])["image:stft"]
        return np.asarray(made.levels, float).ravel()

    c = config()
    limit = LEAST_CELL_SNR_DB - cell_gain_db(nominal_scene(c, c.chosen_activities[0]), "stft")
    noise = image(-250)
    assert np.corrcoef(noise, image(limit))[0, 1] > 0.99
    assert np.corrcoef(noise, image(limit + 30))[0, 1] < 0.97


@pytest.mark.parametrize("snr_db", [None, 60.0])
def test_a_beam_that_looks_away_from_people_is_said(snr_db: float | None) -> None:
    """Whatever the noise, in a line that names what it takes and the key."""

    def said(pan_deg: float) -> list[str]:
        radar = {"carrier_hz": 24e9, "beam": {"pan_deg": pan_deg, "most_db": 28.5}}
        noise = {} if snr_db is not None else {"receiver": {"noise_figure_db": None}}
        config = Config(radar=radar, snr_db=snr_db, maps=["stft"], duration_s=2, **noise)
        return [line for line in config_warnings(config) if "the beam" in line]

    (line,) = said(180.0)
    assert line.startswith("the beam looks away from people: it takes 57 dB of their echo")
    assert line.endswith("(radar.beam)")
    assert said(0.0) == said(20.0) == []
