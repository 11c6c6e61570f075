"""The comparison of clouds, of pairs that the test makes itself."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers.boards import CFG

NAMES = (
    *("SpineBase", "SpineMid", "Neck", "Head", "ShoulderLeft", "ElbowLeft", "WristLeft"),
    *("HandLeft", "ShoulderRight", "ElbowRight", "WristRight", "HandRight", "HipLeft", "KneeLeft"),
    *("AnkleLeft", "FootLeft", "HipRight", "KneeRight", "AnkleRight", "FootRight"),
    *("SpineShoulder", "HandTipLeft", "ThumbLeft", "HandTipRight", "ThumbRight"),
)
UP = (0, 0.3, 0.6, 0.75, 0.5, 0.25, 0.0, -0.1, 0.5, 0.25, 0.0, -0.1, 0, -0.4, -0.85, -0.9)
UP = (*UP, 0, -0.4, -0.85, -0.9, 0.5, -0.15, -0.1, -0.15, -0.1)
ROOT = Path(__file__).resolve().parents[2]
LAST = re.compile(
    r"points a frame: ([\d.]+) \(measured ([\d.]+)\); zero Doppler: [\d.]+ % \([\d.]+ %\); "
    r"to the bone: ([\d.]+) m \([\d.]+ m\); "
    r"chamfer: ([\d.]+) m \(next frame ([\d.]+), shuffled ([\d.]+)\)"
)


@pytest.fixture(scope="module")
def pairs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Somebody who raises both arms, in 24 frames of two movements; clouds about the joints."""
    rng, frames = np.random.default_rng(1), 24
    joints = np.zeros((frames, 25, 3), np.float32)
    side = [0.2 * (("Right" in name) - ("Left" in name)) for name in NAMES]
    for n in range(frames):
        joints[n] = np.stack([side, np.full(25, 2.0), UP], axis=1)
        arms = [i for i, name in enumerate(NAMES) if re.match("Elbow|Wrist|Hand|Thumb", name)]
        joints[n, arms, 2] += 0.3 * np.sin(n / 3)
    points = []
    for n in range(frames):
        for joint in rng.integers(25, size=20):
            place = joints[n, joint] + rng.normal(0, 0.1, 3)
            points.append([n, *place, rng.choice([-0.356, 0, 0.356]), 20])
    path = tmp_path_factory.mktemp("pairs") / "pairs.npz"
    np.savez(
        path,
        points=np.array(points, np.float32),
        joints=joints,
        names=np.array(NAMES),
        frame_number=np.r_[0:12, 100:112].astype(float),
        movement=np.repeat([0, 1], 12),
    )
    (path.parent / "board.cfg").write_text(CFG)
    return path


@pytest.mark.slow
def test_a_table_figures_and_a_last_line(pairs: Path, tmp_path: Path) -> None:
    script = ROOT / "scripts" / "studies" / "clouds_against_measured.py"
    command = [sys.executable, str(script), str(pairs), "--cfg", str(pairs.parent / "board.cfg")]
    made = subprocess.run([*command, "-o", str(tmp_path / "out")], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    last = LAST.fullmatch(made.stdout.splitlines()[-1])
    assert last, made.stdout
    simulated, measured, bone, chamfer, following, _ = map(float, last.groups())
    assert measured == pytest.approx(20, abs=3)
    assert 2 < simulated < 60
    assert bone < 0.25
    assert 0 < chamfer < 1
    assert 0 < following < 1
    report = json.loads((tmp_path / "out" / "clouds.json").read_text())
    assert report["measured"]["points a frame"] == pytest.approx(measured, abs=0.05)
    for name in ("clouds.md", "frames.png", "statistics.png"):
        assert (tmp_path / "out" / name).stat().st_size > 500


POSE = re.compile(
    r"mean absolute error: ([\d.]+) cm \(mean pose ([\d.]+) cm\), mpjpe: ([\d.]+) cm, "
    r"n = (\d+) frames"
)


def _pose(pairs: Path, out: Path, *more: str) -> tuple[float, ...]:
    script = ROOT / "scripts" / "studies" / "pose_from_clouds.py"
    command = [sys.executable, str(script), "--train", str(pairs), "--test", str(pairs)]
    made = subprocess.run([*command, "-o", str(out), *more], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    last = POSE.fullmatch(made.stdout.splitlines()[-1])
    assert last, made.stdout
    assert (out / "pose.png").stat().st_size > 500
    return tuple(map(float, last.groups()))


@pytest.mark.slow
def test_joints_are_learned_from_measured_clouds(pairs: Path, tmp_path: Path) -> None:
    error, mean_pose, mpjpe, count = _pose(pairs, tmp_path / "out", "--epochs", "150")
    assert count == 24
    assert 0 < error < mean_pose
    assert mpjpe > error


@pytest.mark.slow
def test_simulated_clouds_need_the_joints_alone(pairs: Path, tmp_path: Path) -> None:
    """The measured points of the training pairs are not there at all."""
    with np.load(pairs) as file:
        held = {name: file[name] for name in file.files if name != "points"}
    np.savez(tmp_path / "joints.npz", **held)
    script = ROOT / "scripts" / "studies" / "pose_from_clouds.py"
    command = [sys.executable, str(script), "--train", str(tmp_path / "joints.npz")]
    command += ["--test", str(pairs), "--simulated", "--draws", "2", "--epochs", "4"]
    made = subprocess.run([*command, "-o", str(tmp_path)], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    assert POSE.fullmatch(made.stdout.splitlines()[-1])
