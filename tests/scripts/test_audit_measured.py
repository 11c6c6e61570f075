"""scripts/studies/audit_measured.py: what of measured sets becomes images and tables."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from helpers import command_line


@pytest.fixture(scope="module")
def script() -> ModuleType:
    path = command_line.ROOT / "scripts/studies/audit_measured.py"
    spec = importlib.util.spec_from_file_location("audit_measured", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["audit_measured"] = module
    spec.loader.exec_module(module)
    return module


def test_masks_and_views(script: ModuleType, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    masks = rng.integers(0, 255, (12, 16, 2)).astype(np.uint8)
    classes = np.array(["walking", "falling"])
    np.savez(tmp_path / "glasgow_masks.npz", masks=masks, label=[0, 1] * 6, classes=classes)
    samples = list(script.glasgow(tmp_path))
    assert [s.label for s in samples[:2]] == ["walking", "falling"]
    assert [s.known["length_s"] for s in samples[:2]] == [10, 5]
    assert samples[0].levels.shape == (16, 16)
    np.savez(tmp_path / "mmrgait_maps.npz", view_000=rng.normal(80, 5, (20, 65)))
    views = list(script.mmrgait(tmp_path))
    assert [view.known["column"] for view in views] == [0, 30]


def test_windows_of_clouds(script: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "mars").mkdir()
    frames = np.repeat(np.arange(60), 5)
    points = np.random.default_rng(0).normal(0, 0.1, (300, 6))
    points[:, 0] = frames
    points[:, 2] += 1.8
    movement = np.repeat([0, 5], [25, 35])
    stored = {"points": points, "movement": movement, "frame_number": np.arange(60)}
    np.savez(tmp_path / "mars/subject1_test.npz", **stored)
    first, last = script.mars(tmp_path)
    assert (first.label, last.label) == ("left_upper_limb", "squat")
    assert first.known["person"] == "subject1"
    assert first.known["points_a_frame"] == 5
    assert first.known["range_m"] == pytest.approx(1.8, abs=0.05)
    assert first.levels.shape == (32, 20)


def test_an_audit_of_nothing_is_a_page_with_the_commit(
    script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "out").mkdir()
    monkeypatch.setattr(sys, "argv", ["audit_measured", str(tmp_path), "-o", str(tmp_path / "out")])
    script.main()
    assert (tmp_path / "out/audits.md").read_text().startswith("commit ")
    monkeypatch.setattr(sys, "argv", ["audit_measured", "nowhere", "-o", "out"])
    with pytest.raises(SystemExit, match="nowhere: no such folder"):
        script.main()
