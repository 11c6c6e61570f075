"""A config goes to other processes whole: pickle finds every class of it by its name."""

import pickle
from pathlib import Path

import pytest
from helpers.command_line import ROOT

from radhar_cli.config import load_radars
from radhar_cli.config.reading import load_section
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.schema.section import Section

FOLDER = ROOT / "configs"
FILES = sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.yaml"))


def read(path: Path) -> Section:
    training = path.parent.name == "train"
    return load_section(TrainConfig, path) if training else next(iter(load_radars(path).values()))


@pytest.mark.parametrize("name", FILES)
def test_every_config_is_the_same_after_pickle(name: str) -> None:
    config = read(FOLDER / name)
    assert pickle.loads(pickle.dumps(config)) == config
