"""`radhar limits`: what it prints and writes, what it refuses, and that every config has limits."""

import json
from pathlib import Path

import pytest
from helpers.command_line import radhar
from helpers.slow import slow

from radhar_cli.config import Config, load_config
from radhar_cli.config.reading import config_of_values, read_values
from radhar_cli.schema.number import MAX_NUMBER
from radhar_cli.study.limits.judging import CLEAN, Consequence, Judgement, Origin
from radhar_cli.study.limits.keys import PEOPLE, NumberKey, acting_numbers, with_number
from radhar_cli.study.limits.study import KEY_ENDS, Limit, RangeSide

ROOT = Path(__file__).resolve().parents[3]
CONFIGS = sorted(
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "configs").rglob("*.yaml")
    if "train" not in path.parts and "\nradars:" not in path.read_text()
)
FAST = ("configs/smoke.yaml", "configs/human/people.yaml", "configs/boards/iwr1443.yaml")
SMALL = """
activities: [punching, walking]
samples_per_class: 1
duration_s: 1
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 1000, adc_rate_hz: 2.5e6}
motion: {range_m: 5}
snr_db: 20
image: {size_px: 32}
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("limits") / "small.yaml"
    path.write_text(SMALL)
    return path


def test_it_prints_and_writes_the_limits_of_a_key(small: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = radhar("limits", small, "--key", "snr_db", "-o", out, "--minutes", "2", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    low, high = told["limits"]
    assert (low["key"], low["side"], low["effect"], low["source"]) == (
        *("snr_db", "below", "warned", "noise"),
    )
    assert -40 < low["value"] < -15
    assert low["simulated"]
    assert low["last_accepted"] == -300
    assert (high["value"], high["effect"]) == (300, "refused")
    assert told["unfinished"] == told["not_simulated"] == []
    assert {one["name"] for one in told["margins"]} >= {"farthest joint"}
    written = json.loads((out / "limits.json").read_text())
    assert written["limits"] == told["limits"]
    text = (out / "limits.md").read_text()
    assert "| `snr_db` | 20 dB | -" in text
    assert "--key snr_db --minutes 2" in text
    again = radhar("limits", small, "--key", "snr_db", "-o", out)
    assert again.returncode == 2
    assert "--overwrite" in again.stderr


def test_a_key_without_effect_is_refused(small: Path) -> None:
    done = radhar("limits", small, "--key", "wall.eps_r")
    assert done.returncode == 2
    assert "--key wall.eps_r: is no number that has an effect with this config" in done.stderr


def test_what_there_was_no_time_for_is_named(small: Path) -> None:
    done = radhar("limits", small, "--key", "radar", "--minutes", "0.01")
    assert done.returncode == 0, done.stderr
    assert "not finished: radar." in done.stderr


def test_a_config_that_is_refused_is_refused_as_ever(small: Path) -> None:
    done = radhar("limits", small, "--set", "radar.prf_hz=1e9")
    assert done.returncode == 2
    assert "radar.prf_hz = 1000000000.0: should be from 0.001 to 1e+07 Hz" in done.stderr
    assert "--set radar.prf_hz = " in done.stderr


@pytest.mark.parametrize(
    "command", [["limits"], ["tradeoff", "-o", "out"], ["generate", "-o", "out"]], ids=" ".join
)
def test_a_mistake_in_a_config_is_named_with_its_file_and_line(
    command: list[str], tmp_path: Path
) -> None:
    name, *options = command
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(SMALL.replace("snr_db: 20", "snr_db: loud"))
    options = [str(tmp_path / word) if word == "out" else word for word in options]
    done = radhar(name, wrong, *options)
    assert done.returncode == 2
    assert f'{wrong}:7: snr_db = "loud": should be ' in done.stderr


@pytest.mark.parametrize("name", [*FAST, *slow((one,) for one in CONFIGS if one not in FAST)])
def test_every_number_of_a_shipped_config_can_be_replaced(name: str) -> None:
    """By itself, or by an end of what is drawn: the config is accepted, and has that number."""
    path = ROOT / name
    config, values = load_config(path), read_values(path)
    numbers = acting_numbers(config)
    assert {number.key for number in numbers} >= {"duration_s", "image.size_px.0"}
    for number in numbers:
        low, high = number.range
        assert number.low <= low <= high <= number.high, number
        changed = with_number(values, config, number.key, high)
        assert values == read_values(path)
        made = config_of_values(changed, path.parent)
        assert isinstance(made, Config)
        assert {one.key: one for one in acting_numbers(made)}[number.key].range[1] == high


def test_numbers_that_have_no_effect_are_left_out() -> None:
    human = {number.key for number in acting_numbers(Config.model_validate({}))}
    assert human >= {PEOPLE, "motion.walking.speed_mps", "snr_db", "radar.tx_m.2"}
    assert not {"motion.paper.gait_hz", "processing.gate_m", "seed", "split.train"} & human
    board = acting_numbers(load_config(ROOT / "configs/boards/iwr1443.yaml"))
    assert not {"radar.prf_hz", "radar.tx_m.0"} & {number.key for number in board}
    assert all(number.high <= MAX_NUMBER for number in board)


def test_a_limit_in_words() -> None:
    beyond = Judgement(Consequence.WARNED, Origin.MODEL, "Doppler folds")
    limit = Limit(NumberKey("motion.walking.speed_mps", 1, 0, 9), RangeSide.HIGH, 7.4, beyond)
    assert limit.sentence == "up to 7.4 (Doppler folds: warned)"
    slower = Judgement(Consequence.SLOWER, Origin.TIME, "10 times the work")
    limit = Limit(
        NumberKey("duration_s", 1, 0, 9), RangeSide.HIGH, 60.0, slower, 600.0, KEY_ENDS, 9.04, True
    )
    assert limit.sentence == (
        "up to 60 (10 times the work: slower; there 9 times as slow; beyond 600 as far as the key "
        "goes: refused)"
    )
    assert CLEAN.is_clean
