"""Each parameter beyond its limit: refused with its key and its value; at the limit: taken."""

import json
import math
import re
from typing import Any

import pytest
from helpers.boards import CFG

from radhar_cli.config import Config
from radhar_cli.config.radar import FmcwRadar
from radhar_cli.config.reading import validated
from radhar_cli.errors import ConfigError
from radhar_cli.schema.annotations import ByModel, annotations, of_kind
from radhar_cli.schema.number import Bounds

WALL = ("wall.center_m", "wall.size_m")
Limits = dict[str, tuple[Any, Any, Any, Any]]


PLACES = ("radar.tx_m", "radar.rx_m", "radar.position_m", "wall.center_m", "wall.size_m")


def of_the_schema() -> Limits:
    """{key of a number: (least, most) that is taken, then (too little, too much)}."""
    found: Limits = {}
    for key, about in annotations(Config).items():
        bounds = [one for one in about if isinstance(one, Bounds)]
        if bounds and not key.startswith(("room.", "receiver.", "image.")):
            low, high = max(one.low for one in bounds), min(one.high for one in bounds)
            below = low * (0.9 if low > 0 else 1.1) or -1
            axis = ".0" if key in PLACES else ""
            found[key + axis] = (low, high, below, high * 1.1)
    return found


# What other keys limit, and whole numbers.
LIMITS: Limits = of_the_schema() | {
    "seed": (0, 2**63 - 1, -1, 2**63),
    "samples_per_class": (1, 10_000_000, 0, 10_000_001),
    "processing.range_fft_length": (400, 25600, 398, 25602),
    "processing.window_s": (0.0016, 3.9998, 0.0014, 4.0),
    "body.points_per_segment": (1, 1000, 0, 1001),
    "body.cross_section_sd_db": (0, 12, -1, 13),
    "processing.overlap_fraction": (0, 0.9999, -0.1, 1),
    "processing.stft_fft_length": (2000, 128000, 1999, 128001),
    "processing.savgol.order": (0, 30, -1, 31),
    "processing.savgol.frame": (7, 19999, 5, 20001),
    "processing.fsst_threshold": (0, 0.999, -0.1, 1),
    "processing.fsst_hop_pulses": (1, 2**24, 0, 2**24 + 1),
    "engine.tolerance_db": (-400, -6, -401, -5),
    "image.size_px": (2, 8192, 1, 8193),
    "image.dynamic_range_db": (5e-324, 300, 0, 301),
    "split.train": (0, 1, -0.1, 1.1),
    "output.png_level": (0, 9, -1, 10),
    "output.hdf5_level": (0, 9, -1, 10),
}
# At their ends these need each other: tests/extremes/test_ranges.py goes there.
TOGETHER = ("duration_s", "radar.prf_hz", "radar.adc_rate_hz", "radar.chirp_s")
VECTORS = {"tx_m": [0.4, -0.1, 1.5], "rx_m": [0.4, 0.1, 1.5], "size_m": [0.24, 5.0, 2.5]}


def document(key: str, value: Any) -> dict[str, Any]:
    """A document with one key set; a number of a vector by its place in it."""
    *names, last = key.split(".")
    if last.isdigit():
        vector = list(VECTORS.get(names[-1], [1.0, 0.0, 1.25]))
        vector[int(last)] = value
        *names, last = names
        value = vector
    made: dict[str, Any] = {} if names[:1] == ["stream"] else {"motion": {"model": "paper"}}
    if names[:1] == ["radar"] and (*names, last)[1] not in FmcwRadar.model_fields:
        made["radar"] = {"cfg": CFG, "device": "IWR1443BOOST"}
    place = made
    for name in names:
        place = place.setdefault(name, {})
    place[last] = value
    if key == "split.train":  # the shares add up to 1
        made["split"]["validation"] = min(max(1 - value, 0), 1)
    if key == "processing.savgol.order":  # below the frame
        made["processing"]["savgol"]["frame"] = 33
    if key == "processing.savgol.frame":  # at most the signal, where a map is of it
        made["maps"] = ["stft_denoised"]
    if key == "wall.size_m.0":  # a thick wall that has no antenna inside
        made["wall"]["center_m"] = [1e6, 0.0, 1.25]
    return made


keys = pytest.mark.parametrize("key", LIMITS)


@keys
def test_limits_are_accepted_and_values_beyond_are_refused_by_key(key: str) -> None:
    least, most, below, above = LIMITS[key]
    if key not in TOGETHER:
        for value in (least, most):
            validated(Config, document(key, value), "here", {})
    for value in (below, above):
        with pytest.raises(ConfigError) as caught:
            validated(Config, document(key, value), "here.yaml", {})
        text = str(caught.value)
        section = key.rpartition(".")[0] if key.startswith("processing.savgol") else key
        named = [line for line in text.splitlines() if f"here.yaml: {section}" in line]
        assert named, text
        assert any(shown(value) in line for line in named), text
        assert "should" in named[0]


def shown(value: Any) -> str:
    return json.dumps(value) if abs(value) < 1e-3 or abs(value) >= 1e3 else f"{value:g}"


NUMBERS = [key for key in LIMITS if key.split(".")[0] in ("radar", "subject", "motion", "timing")]


@pytest.mark.parametrize("key", ["radar.carrier_hz", "motion.angle_deg", "snr_db", "wall.eps_r"])
@pytest.mark.parametrize("form", ["uniform", "choice", "normal"])
def test_a_distribution_that_exceeds_a_limit_is_refused(key: str, form: str) -> None:
    """Every draw has to be in the range; the message says how far this one reaches."""
    with pytest.raises(ConfigError, match=re.escape(f"here: {key} = ")) as caught:
        validated(Config, document(key, reaching(key)[form]), "here", {})
    assert f'"{form}"' in str(caught.value)
    assert "reaches from" in str(caught.value) or "within" in str(caught.value)


def reaching(key: str) -> dict[str, dict[str, Any]]:
    """Distributions from inside the range to beyond it."""
    low, high, _, above = LIMITS[key]
    return {
        "uniform": {"uniform": [low, above]},
        "choice": {"choice": [low, high, above]},
        "normal": {"normal": [high, above - high]},
    }


def test_every_distribution_of_a_number_is_checked_against_its_range() -> None:
    for key in [*NUMBERS, "snr_db", "duration_s", "wall.eps_r"]:
        for value in reaching(key).values():
            with pytest.raises(ConfigError, match=re.escape(f"here: {key} = ")):
                validated(Config, document(key, value), "here", {})


FFTS = ("processing.range_fft_length", "processing.stft_fft_length", "processing.fsst_hop_pulses")
# Null takes what the model of motion has.
OF_THE_MODEL = tuple(key for key, _ in of_kind(Config, ByModel))
NULLABLE = (
    "processing.window_s",
    "snr_db",
    "subject.weight_kg",
    "timing.walk_begin_s",
    "timing.grab_start_s",
    *OF_THE_MODEL,
    *FFTS,
)


def spoilt(key: str, value: Any) -> dict[str, Any]:
    """A document whose `key` holds `value`, whatever it is."""
    made = document(key, 1)
    place: Any = made
    *names, last = key.split(".")
    for name in names:
        place = place[name]
    place[int(last) if last.isdigit() else last] = value
    return made


@pytest.mark.parametrize("value", ["fast", [], {}, None, True, math.nan, math.inf, 10**400])
def test_nonsense_is_refused_for_every_key(value: Any) -> None:
    for key in LIMITS:
        if value is None and key in NULLABLE:
            continue
        with pytest.raises(ConfigError) as caught:
            validated(Config, spoilt(key, value), "here", {})
        named = key if key != "processing.savgol.frame" else "processing.savgol"  # the two in one
        assert any(f"here: {named}" in line for line in str(caught.value).splitlines()), key
