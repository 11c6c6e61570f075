"""scripts/studies/price_of_realism.py: a row at the smallest size, and what is made once."""

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest
from helpers import command_line


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    folder = command_line.ROOT / "scripts/studies"
    monkeypatch.syspath_prepend(folder)
    spec = importlib.util.spec_from_file_location("price", folder / "price_of_realism.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_row_adds_something_that_fits(script: ModuleType, tmp_path: Path) -> None:
    """Configs that load, whose own person is the same with and without."""
    path = tmp_path / "scenes.yaml"
    path.write_text(script.SCENES)
    for row in script.ROWS:
        without, with_ = (script.load_config(path, on) for on in (row.base, row.base + row.added))
        assert without != with_
        assert (without.motion, without.subject) == (with_.motion, with_.subject)
        assert row.map in with_.maps


@pytest.mark.slow
def test_a_row(
    script: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    given = ["--per-class", "5", "--tested", "1", "--seeds", "2", "--only", "all labels"]
    monkeypatch.setattr(sys, "argv", ["price", "-o", str(tmp_path), *given])
    monkeypatch.setitem(script.FIXED, "epochs", 1)
    monkeypatch.setattr(script.Study, "time", lambda *_: 2.0)
    rows = []
    for _ in range(2):
        script.main()
        rows.append(capsys.readouterr().out.splitlines()[-1])
    share = r"\d+\.\d"
    score = rf"{share} \({share} to {share}\), mAP {share} \({share} to {share}\)"
    row = rf"\| another person, all labels \| 2\.0 \| {share} %( \| {score}){{4}} \|"
    assert re.fullmatch(row, rows[0]), rows[0]
    assert rows[1] == rows[0]
    assert len(list((tmp_path / "runs").glob("*/done"))) == 4
