"""Accuracy of networks by setting: what is tested on what, and what is made once."""

import json

import pytest
from helpers.listener import Listener

from radhar_cli.errors import ConfigError
from radhar_cli.study.tradeoff import accuracy
from radhar_cli.study.tradeoff.accuracy import AccuracyStudy, SeedAccuracy, Sizes
from radhar_cli.study.tradeoff.samples import Scenes
from radhar_cli.study.trials import Budget

CONFIG = """
motion: {model: paper}
activities: [punching, walking]
samples_per_class: 8
duration_s: 1.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500, adc_rate_hz: 1e6}
maps: [stft, fsst]
image: {size_px: 16}
"""
SIZES = Sizes(learned=8, tested=2, epochs=1)


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    path = tmp_path_factory.mktemp("accuracy") / "c.yaml"
    path.write_text(CONFIG)
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the tests make in common."""
    return tmp_path_factory.mktemp("networks")


def study(config, folder, listener=None):
    return AccuracyStudy(Scenes(config, (), False), folder, listener or Listener(), SIZES)


def measure(config, folder, *setting, seeds=1, listener=None, minutes=10):
    return study(config, folder, listener).measure(setting, seeds, Budget(60 * minutes))


def folders(folder, name):
    return {path.name for path in (folder / name).iterdir()}


def test_the_config_as_it_is(config, folder):
    result = measure(config, folder, seeds=2)
    assert len(result.by_seed) == 2
    assert result.tested_on == "default"
    assert result.low <= result.mean <= result.high
    assert all(0 <= share <= 1 for share in result.by_seed)


def test_what_was_measured_is_read(config, folder, monkeypatch):
    first = measure(config, folder)
    monkeypatch.setattr(accuracy, "train", None)
    monkeypatch.setattr(accuracy, "measure_share", None)
    assert measure(config, folder) == first
    records = [json.loads(path.read_text()) for path in (folder / "records").iterdir()]
    assert {"setting": [], "seed": 1}.items() <= min(
        records, key=lambda record: (record["setting"], record["seed"])
    ).items()


def test_one_that_was_stopped_goes_on(config, tmp_path, monkeypatch):
    """Between training and test: the network is kept, and the result is that of one go."""
    with monkeypatch.context() as patch:
        patch.setattr(accuracy, "measure_share", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            measure(config, tmp_path)
    assert not (tmp_path / "records").exists()
    monkeypatch.setattr(accuracy, "train", None)
    measure(config, tmp_path)
    assert len(folders(tmp_path, "records")) == 1


def test_settings_of_the_same_images_share_the_network(config, folder):
    default = measure(config, folder)
    networks = folders(folder, "runs")
    records = folders(folder, "records")
    assert measure(config, folder, "engine.precision=double").by_seed == default.by_seed
    assert folders(folder, "runs") == networks
    assert folders(folder, "records") > records


@pytest.mark.parametrize(
    ("setting", "tested_on"),
    [
        ("snr_db=0", "default"),
        ("maps=[fsst]", "default"),  # which the config makes, too
        ("maps=[rtm]", "own"),
        ("image.size_px=24", "own"),
        ("radar.prf_hz=400", "own"),  # another axis of Doppler
        ("image.doppler_limits_mps=[-3, 3]", "own"),
        ("activities=[punching, kicking]", "own"),
    ],
)
def test_what_is_tested_on_what(config, folder, setting, tested_on):
    parts = study(config, folder).parts((setting,), 1)
    assert ("default" in parts) == (tested_on == "default")
    learned, own = parts["learned"], parts["own"]
    assert learned.seed != own.seed
    assert learned.maps == own.maps
    if tested_on == "default":
        right = parts["default"]
        assert right.seed == own.seed
        assert right.maps == own.maps
        assert right.snr_db == study(config, folder).scenes.config().snr_db


def test_a_setting_of_its_own_axes(config, folder):
    result = measure(config, folder, "image.size_px=24")
    assert result.tested_on == "own"


def test_seeds_are_of_other_scenes_and_the_same_under_every_setting(config, folder):
    networks = study(config, folder)
    seeds = {
        (number, name): part.seed
        for number in (1, 2)
        for name, part in networks.parts((), number).items()
    }
    assert len(set(seeds.values())) == 4
    for (number, name), seed in seeds.items():
        assert networks.parts(("snr_db=0",), number)[name].seed == seed


@pytest.mark.parametrize(
    ("setting", "why"),
    [
        (("activities=[walking]",), "there is a single class"),
        (("motion.model=human", "stream={}"), "streams have no single class"),
    ],
)
def test_nothing_to_learn_is_said_in_a_line(config, folder, setting, why):
    listener = Listener()
    assert measure(config, folder, *setting, seeds=2, listener=listener) is None
    assert listener.messages == [f"no accuracy of {' '.join(setting)}: {why}"]


def test_a_setting_that_does_not_fit(config, folder):
    with pytest.raises(ConfigError, match="prf"):
        measure(config, folder, "radar.prf=3")


def test_no_time(config, folder):
    listener = Listener()
    assert measure(config, folder, seeds=5, listener=listener, minutes=0) is None
    assert listener.messages == [
        "no accuracy of the config as it is: the time was over after 0 networks"
    ]


def test_a_network_that_cannot_be_built_is_said(config, folder):
    listener = Listener()
    assert measure(config, folder, "image.size_px=8", seeds=2, listener=listener) is None
    (message,) = listener.messages
    assert "both sides should have at least 16" in message


def test_accuracies_on_images_of_the_config_count_before_those_on_own_ones(
    config, tmp_path, monkeypatch
):
    results = iter([SeedAccuracy(0.5, 0.6), SeedAccuracy(0.7, 0.8)])
    monkeypatch.setattr(AccuracyStudy, "measure_seed", lambda *_: next(results))
    together = measure(config, tmp_path, seeds=2)
    assert together.by_seed == (0.5, 0.7)
    assert together.mean == pytest.approx(0.6)


@pytest.mark.parametrize("damage", ["", "[1]", '{"accuracy": {"on_default": 7, "on_own": 0.5}}'])
def test_a_damaged_record_is_said_and_measured_again(config, folder, damage):
    first, listener = measure(config, folder), Listener()
    for record in (folder / "records").iterdir():
        record.write_text(damage)
    assert measure(config, folder, listener=listener) == first
    (message,) = listener.messages
    assert message.endswith(".json: is damaged; the network is tested again")
