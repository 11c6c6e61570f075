"""What is recommended of synthetic rows: nothing within the blur, and what it costs."""

import json
from dataclasses import replace

import pytest

from radhar_cli.config.engine import EngineConfig
from radhar_cli.study.tradeoff.differences import PointDifference
from radhar_cli.study.tradeoff.recommendation import recommend
from radhar_cli.study.tradeoff.settings import DEFAULT, Change
from radhar_cli.study.tradeoff.sweep import (
    AccuracyNumbers,
    MapNumbers,
    Omission,
    Ratio,
    Row,
    Sweep,
)

ENGINE = EngineConfig()
AS_IT_IS = Row(
    *("default", DEFAULT, (), DEFAULT, Change.ERROR),
    is_default=True,
    sample_ms=20.0,
    ratio=1.0,
    ratio_low=0.99,
    ratio_high=1.01,
    rounds=7,
    scenes=3,
    error_of="the signal",
    error_db=-107.0,
)


def row(name, ratio, spread=0.01, over_one=0.3, effect=Change.PICTURE, **more):
    maps = {"stft": MapNumbers(over_one, over_one, 0.9, 5.0, 1.0, over_one, 5.0)}
    times = {"ratio_low": ratio - spread, "ratio_high": ratio + spread, "rounds": 5}
    values = {"sample_ms": 20 * ratio, "ratio": ratio, **times, "maps": maps, **more}
    return Row("group", name, (name,), DEFAULT, effect, **values)


def sweep(*rows, blur=0.03, **more):
    pairs = [Ratio(20.0, 1 + blur, 0.98, 1.04, 7)]
    return Sweep([AS_IT_IS, *rows], {"stft": -53}, 3, pairs, [0.5, 1.5], **more)


def text(*rows, **more):
    return "\n".join(recommend(sweep(*rows, **more), ENGINE, cores=2))


def accuracy(*by_seed):
    mean = sum(by_seed) / len(by_seed)
    return AccuracyNumbers(by_seed, mean, mean - 0.02, mean + 0.02)


def test_the_floor_of_the_image_and_the_error_of_the_config():
    lines = text()
    assert "8 bits show an error of the signal from -53 dB (stft) on" in lines
    assert "own error, worst of 3 scenes, is -107 dB of the signal, 54 dB below that" in lines


def test_an_error_that_shows_is_said():
    sentences = recommend(replace(sweep(), rows=[replace(AS_IT_IS, error_db=-40.0)]), ENGINE)
    assert any("shows in stft" in sentence for sentence in sentences)


@pytest.mark.parametrize(
    ("ratio", "spread", "is_saving"),
    [(0.8, 0.01, True), (0.98, 0.0, False), (0.8, 0.18, False), (1.2, 0.01, False)],
)
def test_nothing_within_the_blur_is_a_saving(ratio, spread, is_saving):
    tried = row("image.size_px: [32, 32]", ratio, spread)
    assert tried.saves(0.03) is is_saving
    assert ("`image.size_px: [32, 32]` saves" in text(tried)) is is_saving


def test_a_single_round_concludes_nothing():
    assert not row("body.scatterers: points", 0.4, rounds=1).saves(0.03)


def test_where_nothing_saves_the_config_stays():
    assert "Recommended: the config as it is; nothing" in text(row("x: 1", 0.99))


def test_a_saving_that_is_not_seen_is_recommended():
    lines = text(row("processing.overlap_fraction: 0.88", 0.9, over_one=0.002))
    assert "saves 10 % (9 to 11) of the time and changes 0.2 % of the pixels" in lines
    assert "Recommended: `processing.overlap_fraction: 0.88`." in lines


def test_another_picture_is_named_and_not_recommended_unmeasured():
    lines = text(row("body.scatterers: points", 0.4))
    assert "`body.scatterers: points` saves 60 % (59 to 61) of the time and gives another" in lines
    assert "Recommended: the config as it is" in lines
    assert "The effect on a network was not measured; `--accuracy 5`" in lines


def test_accuracy_that_is_lost_beyond_chance_is_a_price():
    tried = row("body.scatterers: points", 0.4, accuracy=accuracy(0.76, 0.77, 0.78, 0.77, 0.77))
    default = replace(AS_IT_IS, accuracy=accuracy(0.8, 0.81, 0.82, 0.81, 0.81))
    lines = "\n".join(recommend(replace(sweep(), rows=[default, tried]), ENGINE))
    assert "saves 60 % (59 to 61) of the time and costs 4 points of accuracy" in lines
    assert "(81 to 77, 5 seeds)" in lines
    assert "Recommended: the config as it is" in lines
    assert "not measured" not in lines


def lines_with_accuracies(*shares: float) -> str:
    """Sentences on a body of points whose networks have these accuracies."""
    tried = row("body.scatterers: points", 0.4, accuracy=accuracy(*shares))
    default = replace(AS_IT_IS, accuracy=accuracy(0.80, 0.81, 0.82))
    return "\n".join(recommend(replace(sweep(), rows=[default, tried]), ENGINE))


def test_accuracy_that_is_the_same_for_sure_is_recommended():
    lines = lines_with_accuracies(0.80, 0.812, 0.82)
    assert "costs at most 2 points of accuracy (81 to 81, 3 seeds)" in lines
    assert "Recommended: `body.scatterers: points`." in lines


def test_accuracy_of_which_little_is_known_is_not_recommended():
    lines = lines_with_accuracies(0.70, 0.88, 0.81)
    assert "and may cost " in lines
    assert "Recommended: the config as it is" in lines


def test_what_was_timed_too_seldom_is_named():
    lines = text(replace(row("maps without fsst", 0.6, over_one=0.0), rounds=1))
    assert "Timed too seldom to say that it saves time, which more " in lines
    assert "decide: `maps without fsst`" in lines


def test_maps_that_are_left_out_are_no_free_saving():
    lines = text(row("maps without fsst", 0.6, over_one=0.0))
    assert "changes nothing of the maps that stay" in lines
    assert "Recommended: the config as it is" in lines


def test_a_looser_tolerance_that_is_the_same_says_so():
    tried = row("engine.tolerance_db: -60", 1.0, over_one=0.0, effect=Change.ERROR, error_db=-107.0)
    assert "`engine.tolerance_db: -60` is the same signal as the default's" in text(tried)


@pytest.mark.parametrize(
    ("tolerance_db", "engine", "is_same"),
    [
        (-60, ENGINE, True),
        (-100, ENGINE, False),
        (-80, EngineConfig(tolerance_db=-60.0), True),
        (-60, EngineConfig(tolerance_db=-100.0), False),
        (-60, EngineConfig(fallback="cube"), False),  # which is for fewer scenes at -60 dB
    ],
)
def test_the_same_signal_follows_from_the_config_whatever_scenes_were_compared(
    tolerance_db, engine, is_same
):
    name = f"engine.tolerance_db: {tolerance_db}"
    tried = row(name, 1.0, over_one=0.0, effect=Change.ERROR, error_db=-111.0, scenes=2)
    lines = "\n".join(recommend(sweep(tried), engine))
    assert (f"`{name}` is the same signal as the default's" in lines) is is_same


def test_the_cube_is_slower_and_shows_nothing_more():
    tried = row("engine.kind: cube", 19.0, over_one=0.0, effect=Change.ERROR, error_db=-300.0)
    assert "`engine.kind: cube` takes 19 times the time and changes nothing" in text(tried)


def test_an_engine_setting_that_was_timed_once_is_not_called_as_fast():
    tried = row("engine.precision: double", 1.5, effect=Change.ERROR, error_db=-107.0, rounds=1)
    assert "`engine.precision: double` was timed too seldom to say" in text(tried)


def test_points_that_move_are_counted():
    moved = PointDifference(0.5, 0.03, 20.0, 40.0)
    lines = text(row("1 transmitter", 0.5, maps={}, points=moved))
    assert "50 % of the points, 20.0 a frame instead of 40.0" in lines


def test_load_and_what_was_not_measured_are_told():
    lines = text(unmeasured=[Omission("room.order: 2", "more than 9 s")])
    assert "differs from itself by up to 3 % in time (1 comparisons, load 0.5 to 1.5 on 2" in lines
    assert "Not measured for lack of time: `room.order: 2`." in lines


def test_rows_survive_json():
    tried = row("body.scatterers: points", 0.4, accuracy=accuracy(0.7, 0.8), error_db=float("-inf"))
    for each in (tried, replace(tried, points=PointDifference(0.5, None, 20.0, 40.0))):
        numbers = json.loads(json.dumps(sweep(each).numbers()))
        assert Sweep.read(numbers).rows == [AS_IT_IS, each]
