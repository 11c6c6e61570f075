"""Extreme settings: refused in a clear line, or finite and not empty, and warned of as said.

What `radhar limits` says of a single number agrees with what becomes of it.
"""

import re
from itertools import groupby
from math import isclose
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.slow import slow
from study.limits.extremes import EXTREMES, SLOW_EXTREMES, Extreme, config_of, document_of

from radhar_cli.dataset.sample import StoredSample, synthesise
from radhar_cli.errors import ConfigError, RadharError
from radhar_cli.processes.progress import NO_PROGRESS
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.visibility import CHEST_M
from radhar_cli.scene.checks.warnings import config_warnings, scene_warnings
from radhar_cli.scene.products.table import plan_images
from radhar_cli.study.limits.judging import ConfigTrial, Consequence
from radhar_cli.study.limits.search import GAP
from radhar_cli.study.limits.study import Limit, RangeSide, study_limits

FAULT = re.compile(r"^extreme\.yaml: [\w.]+ = .+: .+")
BLACK = "black"
# A gap of 0.4 m, which a search may step over; and what simulating alone shows, which is done no
# farther than the first limit.
NOT_SEARCHED = ("walks through the radar", "which is what the direct engine reaches here")


def sample_of(extreme: Extreme) -> tuple[StoredSample, list[str]]:
    """The first sample of a setting, and what is warned of."""
    config = config_of(extreme)
    scene, _ = draw_valid_scene(config, config.chosen_activities[0], 0)
    said = scene_warnings(scene)
    sample = synthesise(scene, plan_images(config), config)
    if not all(image.levels.any() for image in sample.images.values()):
        said.append(BLACK)
    return sample, said


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("extreme", [*EXTREMES, *slow((one,) for one in SLOW_EXTREMES)], ids=str)
def test_an_extreme_is_refused_clearly_or_gives_finite_maps(extreme: Extreme) -> None:
    if extreme.outcome == "refused":
        with pytest.raises(RadharError) as caught:
            sample_of(extreme)
        assert_refused(extreme, caught.value)
        return
    sample, said = sample_of(extreme)
    for name, value in sample.columns.items():
        array = np.asarray(value)
        assert array.dtype.kind != "f" or np.isfinite(array).all(), name
    if extreme.outcome == "fine":
        assert said == []
    else:
        assert any(extreme.words in line for line in said), said


def assert_refused(extreme: Extreme, error: RadharError) -> None:
    """A line for each mistake, which names key, value and what would be right."""
    lines = str(error).splitlines()
    key, _, right = extreme.words.rpartition(" = … ")
    if not key:
        assert not isinstance(error, ConfigError), lines
        assert len(lines) == 1
        assert right in lines[0]
        return
    assert all(FAULT.match(line) for line in lines), lines
    assert any(line.startswith(f"extreme.yaml: {key} = ") and right in line for line in lines)


# Numbers that several extremes are of alone, and that are looked at by `radhar limits` here.
SINGLE = {
    "fmcw": ("snr_db", "motion.range_m", "radar.prf_hz", "engine.tolerance_db"),
    "wall": ("wall.loss_tangent",),
    "walker": ("motion.walking.speed_mps",),
    "board": ("receiver.noise_figure_db",),
}
FURTHER = {
    "fmcw": (
        *("duration_s", "radar.bandwidth_hz", "radar.carrier_hz", "radar.adc_rate_hz"),
        *("radar.chirp_s", "subject.height_m", "processing.window_s", "image.dynamic_range_db"),
        *("processing.overlap_fraction", "motion.angle_deg", "radar.antenna_gain_dbi"),
    ),
    "paper": ("subject.height_m", "motion.paper.gait_hz", "motion.range_m"),
    "wall": ("wall.eps_r",),
    "board": ("radar.yaw_deg", "duration_s", "snr_db"),
}


def singles(keys: dict[str, tuple[str, ...]]) -> list[tuple[str, str]]:
    return [(base, key) for base, some in keys.items() for key in some]


@pytest.mark.parametrize(("base", "key"), [*singles(SINGLE), *slow(singles(FURTHER))])
def test_limits_tells_of_the_end_of_a_number(base: str, key: str) -> None:
    trial = ConfigTrial.of_values(document_of(Extreme(base, noisy(key))), Path())
    study = study_limits(trial, [key], 120, NO_PROGRESS)
    low, high = (study.limits[key, side] for side in RangeSide)
    assert low.value is not None
    assert high.value is not None
    alone = [one for one in (*EXTREMES, *SLOW_EXTREMES) if one.base == base]
    tried = [one for one in alone if list(one.changes) == [key]]
    assert tried
    for extreme in tried:
        number = extreme.changes[key]
        if number is None or extreme.words in NOT_SEARCHED:
            continue
        inside = low.value <= number <= high.value
        limit = high if number > high.value else low
        if extreme.outcome == "fine":
            near = isclose(number, limit.value or 0.0, rel_tol=GAP)  # as an end is found
            is_behind = key == "motion.range_m" and number < 0  # no search gets there
            slower = limit.beyond.effect is Consequence.SLOWER
            assert inside or near or slower or is_behind, (number, limit)
        elif extreme.words != BLACK:
            assert not inside, (number, low, high)
            assert_same_end(extreme, number, limit)


def noisy(key: str) -> dict[str, Any]:
    return {"snr_db": 20.0} if key == "snr_db" else {}


def assert_same_end(extreme: Extreme, number: float, limit: Limit) -> None:
    """What is said beyond a limit is what becomes of a number there."""
    effect, farther = limit.beyond.effect, limit.last_accepted
    if extreme.outcome == "warned":
        assert effect in (Consequence.WARNED, Consequence.SLOWER, Consequence.BLACK)
        return
    if farther is not None and effect not in (Consequence.REFUSED, Consequence.REDRAWN):
        assert number > farther if limit.side is RangeSide.HIGH else number < farther
        assert limit.refusal is not None


def test_what_is_said_of_an_end_holds_on_both_sides() -> None:
    """Just inside nothing is warned of; just outside it is what is said."""
    key = "snr_db"
    document = document_of(Extreme("fmcw", {key: 20.0}))
    limit = study_limits(ConfigTrial.of_values(document, Path()), [key], 60, NO_PROGRESS).limits[
        key, RangeSide.LOW
    ]
    assert limit.value is not None
    assert sample_of(Extreme("fmcw", {key: limit.value}))[1] == []
    said = sample_of(Extreme("fmcw", {key: limit.value - 0.6}))[1]
    assert len(said) == 1
    assert "noise alone" in said[0]
    assert "noise alone" in limit.sentence
    assert limit.beyond.effect is Consequence.WARNED


def test_every_class_of_setting_is_there() -> None:
    assert len(EXTREMES) + len(SLOW_EXTREMES) >= 154
    by_outcome = {
        outcome: len(list(group))
        for outcome, group in groupby(sorted(one.outcome for one in EXTREMES))
    }
    assert min(by_outcome.values()) > 30


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_an_antenna_in_somebody_divides_by_nothing() -> None:
    """A search for limits asks for what is warned of before any scene is drawn."""
    place = {"radar.position_m": [2.5, 0.0, CHEST_M], "motion.range_m": 2.5}
    assert isinstance(config_warnings(config_of(Extreme("board", place))), list)
