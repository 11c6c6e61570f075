"""`radhar config schema`: what is shipped fits it, mistakes do not, and keys are described."""

import json
from functools import cache
from pathlib import Path

import jsonschema
import pytest
from helpers.command_line import ROOT, radhar

from radhar_cli.config import Config
from radhar_cli.config.json_schema import json_schema
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.schema.section import Section

FILES = sorted((ROOT / "configs").rglob("*.yaml"))


@cache
def check(kind: type[Section]) -> jsonschema.Draft202012Validator:
    return jsonschema.Draft202012Validator(json_schema(kind))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_shipped_config_fits(path: Path) -> None:
    document, _ = parse_yaml(path.read_text(), str(path))
    check(TrainConfig if path.parent.name == "train" else Config).validate(document)


@pytest.mark.parametrize(
    "wrong",
    [
        {"radar": {"prf_hertz": 1e3}},
        {"radar": {"prf_hz": {"uniform": [1]}}},
        {"radar": {"prf_hz": "fast"}},
        {"engine": {"kind": "quick"}},
        {"image": {"size_px": "large"}},
    ],
)
def test_a_mistake_does_not(wrong: dict[str, object]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        check(Config).validate(wrong)


def test_keys_are_described(tmp_path: Path) -> None:
    done = radhar("config", "schema", tmp_path / "schema.json")
    assert done.returncode == 0, done.stderr
    assert "yaml-language-server: $schema=" in done.stdout
    schema = json.loads((tmp_path / "schema.json").read_text())
    assert json.loads(radhar("config", "schema").stdout) == schema
    assert all(
        schema["properties"][key]["description"] == " ".join(text.split())
        for key, text in Config.descriptions().items()
        if key in schema["properties"]
    )
    assert "chirps" in schema["$defs"]["FmcwRadar"]["properties"]["prf_hz"]["description"].lower()
