"""scripts/studies/radhar_classes.py: windows of clouds, and what it refuses."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from helpers import command_line


@pytest.fixture(scope="module")
def script() -> ModuleType:
    path = command_line.ROOT / "scripts/studies/radhar_classes.py"
    spec = importlib.util.spec_from_file_location("radhar_classes", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def recording(path: Path, hertz: float = 0.5, away: float = 1.8, frames: int = 180) -> Path:
    """A person who goes to and fro, and a post at 2.4 m."""
    rng = np.random.default_rng(0)
    frame = np.repeat(np.arange(frames), 4)
    points = np.zeros((frame.size, 9))
    points[:, 0] = frame
    points[:, 1] = away + 0.2 * np.sin(2 * np.pi * hertz * frame / 30)
    points[:, 2:4] = 0.1 * rng.normal(size=(frame.size, 2))
    points[:, 5] = 25
    points[::4, 1:4] = 2.4, 0, 0
    points[:, 6] = np.linalg.norm(points[:, 1:4], axis=1)
    np.savez(path, points=points)
    return path


def test_what_stands_in_all_recordings_is_the_room(script: ModuleType, tmp_path: Path) -> None:
    recording(tmp_path / "squats_1.npz")
    recording(tmp_path / "walk_1.npz", away=1.5)
    recording(tmp_path / "other.npz")
    clouds, labels = script.measured(tmp_path)
    assert labels == [script.CLASSES.index("squats"), script.CLASSES.index("walk")]
    assert [len(one.frame) for one in clouds] == [3 * 180] * 2  # of four points one is the post's
    rows, truth = script.windows(clouds, labels, None)
    assert rows.shape == (6, 90)
    assert truth.tolist() == [3, 3, 3, 4, 4, 4]


@pytest.mark.parametrize(("hertz", "band"), [(0.6, 1), (1.1, 2)])
def test_a_movement_is_found_in_its_band(
    script: ModuleType, tmp_path: Path, hertz: float, band: int
) -> None:
    recording(tmp_path / "jack_1.npz", hertz)
    clouds, _ = script.measured(tmp_path)
    bands = script.features(script.series(clouds[0], 0)).reshape(9, 10)[3:, 1]
    assert bands.argmax() == band


def test_changes_leave_points_out_and_keep_the_rest_people(
    script: ModuleType, tmp_path: Path
) -> None:
    recording(tmp_path / "walk.npz")
    (cloud,), _ = script.measured(tmp_path)
    other = script.changed(cloud, np.random.default_rng(1))
    assert 0.2 < len(other.frame) / len(cloud.frame) < 1
    assert np.abs(other.points[:, 5] - 1.8).max() < 0.7
    reach = np.linalg.norm(other.points[:, :3], axis=1)
    np.testing.assert_allclose(reach, other.points[:, 5], atol=1e-9)
    steps = other.points[:, 3] / script.SPEED_STEP
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)


def test_a_folder_without_recordings_is_refused(
    script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(SystemExit, match="has no recording"):
        script.measured(tmp_path)
    monkeypatch.setattr(sys, "argv", ["radhar_classes", str(tmp_path / "none"), "-o", "out"])
    with pytest.raises(SystemExit, match="no such folder"):
        script.main()
