"""A config goes to other processes whole: pickle finds every class of it by its name."""

import pickle
from pathlib import Path

import pytest
from command_line import ROOT, process

from radhar_cli.config import load_config, schema
from radhar_cli.config.reading import load_section
from radhar_cli.config.schema import PerActivity, Section
from radhar_cli.learning.settings import TrainConfig

FOLDER = ROOT / "configs"
FILES = sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.yaml"))


def read(path: Path) -> Section:
    training = path.parent.name == "train"
    return load_section(TrainConfig, path) if training else load_config(path)


@pytest.mark.parametrize("name", FILES)
def test_every_config_is_the_same_after_pickle(name: str) -> None:
    config = read(FOLDER / name)
    assert pickle.loads(pickle.dumps(config)) == config


def test_numbers_by_activity_have_names_of_their_own_in_every_process() -> None:
    kinds = PerActivity.__subclasses__()
    assert all(getattr(schema, kind.__qualname__) is kind for kind in kinds)
    there = process(
        "-c",
        "from radhar_cli.config.schema import PerActivity\n"
        "print(*(kind.__qualname__ for kind in PerActivity.__subclasses__()))",
    )
    names = there.stdout.split()
    assert {"PerActivity[Speed]", "PerActivity[Samples]"} <= {*names}
    assert sorted(names) == sorted(kind.__qualname__ for kind in kinds)


def test_a_number_without_a_name_cannot_be_one_by_activity() -> None:
    with pytest.raises(TypeError, match="should have a name in "):
        PerActivity[set[int]]
