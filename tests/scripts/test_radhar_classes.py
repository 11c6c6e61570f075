"""scripts/radhar_classes.py: windows of clouds, and what it refuses."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import command_line
import numpy as np
import pytest
import torch


@pytest.fixture(scope="module")
def script() -> ModuleType:
    path = command_line.ROOT / "scripts/radhar_classes.py"
    spec = importlib.util.spec_from_file_location("radhar_classes", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def recording(path: Path, frames: int = 180) -> Path:
    """A person who sways at 1.5 m, and a wall at 4 m."""
    rng = np.random.default_rng(0)
    frame = np.repeat(np.arange(frames), 4.0)
    points = np.zeros((frame.size, 9))
    points[:, 0] = frame
    points[:, 1] = 1.5 + 0.2 * np.sin(frame / 10) + 0.05 * rng.normal(size=frame.size)
    points[:, 2:4] = 0.1 * rng.normal(size=(frame.size, 2))
    points[::4, 1] = 4.0
    np.savez(path, points=points)
    return path


def test_windows_hold_people_and_not_the_room(script: ModuleType, tmp_path: Path) -> None:
    recording(tmp_path / "squats_1.npz")
    recording(tmp_path / "other.npz")
    windows, labels = script.measured(tmp_path)
    assert windows.shape == (3, 6, script.FRAMES, script.POINTS)
    assert labels.tolist() == [script.CLASSES.index("squats")] * 3
    present = windows[:, 5].sum(2)
    assert (present == 3).all()  # of four points a frame one is the wall's
    assert windows[:, 0].abs().max() < 0.6


def test_augmentation_leaves_points_out_and_keeps_the_rest_people(
    script: ModuleType, tmp_path: Path
) -> None:
    recording(tmp_path / "walk.npz")
    windows, _ = script.measured(tmp_path)
    torch.manual_seed(0)
    other = script.changed(windows)
    assert 0.5 < other[:, 5].sum() / windows[:, 5].sum() < 1
    assert (other[:, :4][:, :, other[0, 5] == 0][0] == 0).all()


def test_a_folder_without_recordings_is_refused(
    script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(SystemExit, match="has no recording"):
        script.measured(tmp_path)
    monkeypatch.setattr(sys, "argv", ["radhar_classes", str(tmp_path / "none"), "-o", "out"])
    with pytest.raises(SystemExit, match="no such folder"):
        script.main()
