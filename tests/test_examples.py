"""The examples run, and show what they say."""

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import pytest
from helpers.command_line import ROOT, radhar
from PIL import Image


def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"example_{name}", ROOT / f"examples/{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_example_is_tested() -> None:
    names = {path.stem for path in (ROOT / "examples").glob("*.py")}
    assert names == {"look_at_one_scene", "config_to_confusion_matrix"}


def test_look_at_one_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    example("look_at_one_scene").main(tmp_path / "walk.png")
    assert "torso from" in capsys.readouterr().out
    with Image.open(tmp_path / "walk.png") as image:
        assert image.width > image.height
        assert len(image.convert("L").getcolors(256) or []) > 50


@pytest.mark.slow
def test_config_to_confusion_matrix(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In this process: four that import PyTorch take their time."""
    module = example("config_to_confusion_matrix")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    (tmp_path / "other.yaml").write_text("seed: 9")
    assert module.radhar("config", "show", tmp_path / "other.yaml")["seed"] == 9

    def here(*words: object) -> object:
        more = ("--jobs", 1) if words[0] == "generate" else ()
        done = radhar(*words, *more, "--json")
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    monkeypatch.setattr(module, "radhar", here)
    module.main(tmp_path, samples=8, epochs=1)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("24 samples in ")
    assert lines[2].startswith("test accuracy")
    rows = [line.split() for line in lines[-3:]]
    assert [row[0] for row in rows] == ["walking", "punching", "sitting_down"]
    assert sum(int(cell) for row in rows for cell in row[1:4]) == 6
