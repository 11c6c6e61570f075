"""`radhar config init`: a file out of the schema that says every key, its default and meaning."""

import re
from pathlib import Path
from types import NoneType
from typing import get_args

import pytest

from radhar_cli.config import Config, load_config
from radhar_cli.config.reading import load_section
from radhar_cli.config.schema import Section, WallConfig
from radhar_cli.config.starting_file import WIDTH, as_commented_yaml
from radhar_cli.learning.settings import TrainConfig

KINDS = pytest.mark.parametrize("kind", [Config, TrainConfig], ids=["data", "train"])


def keys(kind: type[Section]) -> set[str]:
    """Names of the keys of a file, those of sections that are null by default too."""
    found = set()
    for name, field in kind.model_fields.items():
        if not field.exclude:
            found.add(name)
            parts = get_args(field.annotation)
            for one in parts if NoneType in parts else [field.annotation]:
                if isinstance(one, type) and issubclass(one, Section):
                    found |= keys(one)
    return found


@KINDS
def test_it_reads_back_as_the_defaults(tmp_path: Path, kind: type[Section]) -> None:
    path = tmp_path / "new.yaml"
    path.write_text(as_commented_yaml(kind))
    assert load_section(kind, path) == kind()


@KINDS
def test_every_key_stands_in_it_and_is_explained(kind: type[Section]) -> None:
    text = as_commented_yaml(kind)
    lines = text.splitlines()
    assert max(map(len, lines)) <= WIDTH
    stand = {}
    for number, line in enumerate(lines):
        found = re.match(r" *(?:# )? *([a-z][a-z0-9_]*):(?: |$)", line)
        if found:
            explained = "  # " in line or re.match(r" *(?:# )? *# ", lines[number - 1])
            stand[found[1]] = bool(explained) or line.endswith(f"{found[1]}:")
    assert keys(kind) <= stand.keys()
    assert not [key for key in keys(kind) if not stand[key]]


def test_the_starting_file_leaves_defaults_of_the_model_alone(tmp_path: Path) -> None:
    path = tmp_path / "new.yaml"
    path.write_text(as_commented_yaml(Config).replace("model: human", "model: paper"))
    assert load_config(path) == Config(motion={"model": "paper"})


def test_a_commented_section_can_be_uncommented(tmp_path: Path) -> None:
    text = as_commented_yaml(Config)
    path = tmp_path / "new.yaml"
    before, _, rest = text.partition("wall: null")
    block, _, after = rest.partition("\n\n")
    wall = "\n".join(line.removeprefix("# ") for line in block.splitlines()[1:])
    path.write_text(f"{before}{wall}\n\n{after}")
    assert load_config(path) == Config(wall=WallConfig())
