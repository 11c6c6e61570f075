"""Words of errors that several commands share."""

import importlib.util
import re
import sys
from pathlib import Path

import pytest

from radhar_cli.errors import describe_schema, how_to_install

ROOT = Path(__file__).parents[1]


def test_a_newer_file_asks_for_an_update_and_an_earlier_one_for_its_cure() -> None:
    assert describe_schema(9, 3, ", in which x") == (
        "schema_version = 9: is written by a newer radhar, this one reads 3: update radhar"
    )
    assert describe_schema(2, 3, ", in which x") == "schema_version = 2: should be 3, in which x"


@pytest.mark.parametrize("path", sorted((ROOT / "radhar_cli").rglob("*.py")), ids=str)
def test_no_message_installs_radhar_from_an_index_that_does_not_have_it(path: Path) -> None:
    assert "pip install 'radhar[" not in path.read_text()


def test_packages_that_messages_name_are_those_of_the_extras() -> None:
    extras = (ROOT / "pyproject.toml").read_text()
    modules = "torch safetensors sklearn skimage timm numba distributed pyarrow onnx plotly"
    for package in how_to_install(*modules.split()).split()[-len(modules.split()) :]:
        assert re.search(rf'"{package}>=', extras), package


def test_packages_go_to_the_python_that_runs_wherever_the_user_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    python = tmp_path / "my project/.venv/bin/python"
    monkeypatch.setattr(sys, "executable", str(python))
    monkeypatch.chdir(tmp_path)
    assert how_to_install("timm") == "'my project/.venv/bin/python' -m pip install timm"
    python.parent.mkdir(parents=True)
    monkeypatch.chdir(python.parents[1])
    assert how_to_install("timm") == "bin/python -m pip install timm"
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    assert how_to_install("timm") == f"'{python}' -m pip install timm"


def test_an_environment_without_pip_is_filled_by_uv(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert how_to_install("sklearn").startswith("uv pip install --python ")
    assert how_to_install("sklearn").endswith("python scikit-learn")


@pytest.mark.parametrize(("system", "has_index"), [("linux", True), ("darwin", False)])
def test_pytorch_is_the_build_for_the_cpu(
    system: str, has_index: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of Linux, where the usual one brings CUDA."""
    monkeypatch.setattr(sys, "platform", system)
    assert ("--extra-index-url https://" in how_to_install("torch")) == has_index
    assert "index" not in how_to_install("numba")
