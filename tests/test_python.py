"""The Python interface: configs of plain values, and data sets, networks and reports of them."""

from pathlib import Path
from typing import Any

import pytest
from helpers import small

import radhar
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.errors import ConfigError

SMALL = parse_yaml(small.SMALL, "small.yaml")[0]


def test_a_config_of_plain_values_is_that_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("snr_db: 12\nradar: {prf_hz: 3500}\n")
    assert radhar.load_config({"snr_db": 12, "radar": {"prf_hz": 3500}}) == radhar.load_config(
        tmp_path / "mine.yaml"
    )


def test_values_that_a_config_is_made_of_stay_as_they_are() -> None:
    values = {"radar": {"cfg": "iwr1443boost", "device": "IWR1443BOOST"}}
    config = radhar.load_config(values)
    assert config.radar.timing.loops > 1
    assert values == {"radar": {"cfg": "iwr1443boost", "device": "IWR1443BOOST"}}


def test_a_config_is_replaced_as_if_its_file_said_so(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("snr_db: 12\nmotion: {model: human}\n")
    config = radhar.load_config(tmp_path / "mine.yaml")
    for overrides in (
        {"snr_db": 5},
        {"radar.prf_hz": 3000.0, "seed": 3},
        {"motion.model": "paper"},
    ):
        other = config.replace(overrides)
        assert other == radhar.load_config(tmp_path / "mine.yaml", overrides)
        assert other != config
    assert config.replace(snr_db=5) == config.replace({"snr_db": 5})
    assert config.replace() == config


@pytest.mark.parametrize("name", ["quickstart", "human/room", "human/streams", "boards/iwr1443"])
def test_any_config_can_be_replaced(name: str) -> None:
    config = radhar.load_config(name)
    assert config.replace(seed=9).replace(seed=config.seed) == config.replace(seed=config.seed)
    assert config.replace(seed=9).seed == 9


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"snr": 5}, "snr = 5: is an unknown key; did you mean 'snr_db'?"),
        ({"radar.carrier_hz": 24}, "radar.carrier_hz = 24"),
        ({"snr_db": {1, 2}}, "snr_db = {1, 2}: should be a plain value"),
        ("snr_db=5", "overrides = 'snr_db=5': should be a list"),
    ],
)
def test_mistakes_name_keys_and_no_option(wrong: Any, said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        radhar.load_config("quickstart", wrong)
    assert said in str(caught.value)
    assert "--set" not in str(caught.value)


@pytest.mark.parametrize("wrong", [5, None, ["quickstart"]])
def test_what_is_no_config_is_named(wrong: Any) -> None:
    with pytest.raises(ConfigError, match="should be the path of a YAML file, a name that"):
        radhar.load_config(wrong)


def test_a_sweep_over_noise_is_built_trained_evaluated_and_audited(tmp_path: Path) -> None:
    config = radhar.load_config(SMALL).replace(
        {"activities": ["walking", "punching"], "samples_per_class": 20}
    )
    sets = [
        radhar.generate(config.replace(snr_db=snr), tmp_path / f"snr{snr}", jobs=1)
        for snr in (30, 10)
    ]
    assert [len(data) for data in sets] == [40, 40]
    run = radhar.train(tmp_path / "snr30", tmp_path / "run", {"epochs": 1})
    assert set(run.classes) == {"walking", "punching"}
    evaluated = radhar.evaluate(tmp_path / "run", [tmp_path / "snr30", tmp_path / "snr10"])
    (accuracies,) = evaluated.scores["accuracy"].values()
    assert accuracies.keys() == {"snr30", "snr10"}
    assert not (tmp_path / "run" / "eval").exists()
    audit = radhar.audit(tmp_path / "snr30", max_samples=8)
    assert audit.rows.size == 16


def test_a_data_set_of_several_radars_has_a_folder_each(tmp_path: Path) -> None:
    radars = {"radars": {"front": {}, "side": {"prf_hz": 400}}}
    data = radhar.generate(SMALL | {"activities": ["walking"]} | radars, tmp_path / "both", jobs=1)
    assert {path.parent.name for path in (tmp_path / "both").rglob("dataset.h5")} == {
        "front",
        "side",
    }
    assert len(data) > 0


def test_the_interface_has_no_folders_of_its_own() -> None:
    """So that no module is imported a second time, under another name."""
    assert not hasattr(radhar, "__path__")
    assert {"load_config", "simulate", "generate", "train", "evaluate", "audit"} <= {*dir(radhar)}
