"""`radhar config schema`: what is shipped fits it, mistakes do not, and keys are described."""

import json
from pathlib import Path

import jsonschema
import pytest
from helpers.command_line import ROOT, radhar

from radhar_cli.config import Config
from radhar_cli.config.json_schema import json_schema
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.learning.settings import TrainConfig

FILES = sorted((ROOT / "configs").rglob("*.yaml"))
KINDS = {False: Config, True: TrainConfig}
CHECKS = {train: jsonschema.Draft202012Validator(json_schema(KINDS[train])) for train in KINDS}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_shipped_config_fits(path: Path) -> None:
    document, _ = parse_yaml(path.read_text(), str(path))
    CHECKS[path.parent.name == "train"].validate(document)


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
        CHECKS[False].validate(wrong)


def test_keys_are_described(tmp_path: Path) -> None:
    done = radhar("config", "schema", tmp_path / "schema.json")
    assert done.returncode == 0, done.stderr
    assert "yaml-language-server: $schema=" in done.stdout
    schema = json.loads((tmp_path / "schema.json").read_text())
    assert json.loads(radhar("config", "schema").stdout) == schema
    for part, kind in ((schema, Config),):
        assert all(
            part["properties"][key]["description"] == " ".join(text.split())
            for key, text in kind.descriptions().items()
            if key in part["properties"]
        )
    assert "chirps" in schema["$defs"]["FmcwRadar"]["properties"]["prf_hz"]["description"].lower()
