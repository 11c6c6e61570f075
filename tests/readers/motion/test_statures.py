"""People of every stature come back from motion files as tall as they were."""

import json
from pathlib import Path

import numpy as np
import pytest
from helpers.poses import clip_of, npz_bytes

from radhar_cli.motion.human.idle import Idle
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.walking import Gait, Walk
from radhar_cli.motion.recorded.motion import FileMotion
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.motion.recorded.writing import bvh_text
from radhar_cli.motion.skeleton import JOINTS, leg_length, stature_of_leg
from radhar_cli.numerics.arrays import Float

RATE, SECONDS = 100.0, 4.0
STATURES = (1.0, 1.1, 1.2, 1.35, 1.45, 1.5, 1.55, 1.75, 1.9, 2.1)
T = np.arange(round(SECONDS * RATE) + 1) / RATE


def walker(stature: float) -> Float:
    """Joints and hip joints [frames, 15, 3] (m) of a walker."""
    person = Physique(stature)
    walk = Walk(Gait(0.8 * stature**0.5), from_rest=False)
    motion = HumanMotion(person, (walk,), (0.0, 0.0), 0.0, 0.0, SECONDS, Idle(person))
    return motion.landmark_positions(T).transpose(2, 1, 0)


def csv(p: Float, joints: tuple[str, ...]) -> bytes:
    head = ",".join(["time", *(f"{name}_{axis}" for name in joints for axis in "xyz")])
    rows = (
        ",".join(f"{v:.6f}" for v in (t, *frame.ravel())) for t, frame in zip(T, p, strict=True)
    )
    return "\n".join([head, *rows, ""]).encode()


FORMS = {
    "BVH": ("k.bvh", lambda p: bvh_text(p, RATE).encode()),
    "npz": ("k.npz", lambda p: npz_bytes(names=WANTED, positions=p, rate=RATE)),
    "npz in mm": ("k.npz", lambda p: npz_bytes(names=WANTED, positions=1000 * p, rate=RATE)),
    "npz without hip joints": (
        "k.npz",
        lambda p: npz_bytes(names=JOINTS, positions=p[:, : len(JOINTS)], rate=RATE),
    ),
    "csv": ("k.csv", lambda p: csv(p, WANTED)),
    "csv without hip joints": ("k.csv", lambda p: csv(p[:, : len(JOINTS)], JOINTS)),
    "json": (
        "k.json",
        lambda p: json.dumps(
            [
                {"time": t, "joints": dict(zip(WANTED, frame.tolist(), strict=True))}
                for t, frame in zip(T.tolist(), p, strict=True)
            ]
        ).encode(),
    ),
}


@pytest.mark.every(4)
@pytest.mark.parametrize("stature", STATURES)
@pytest.mark.parametrize("form", FORMS)
def test_joints_are_as_high_as_they_were(form: str, stature: float, tmp_path: Path) -> None:
    name, bytes_of = FORMS[form]
    p = walker(stature)
    clip = clip_of(tmp_path / name, bytes_of(p), **({"rate": RATE} if name[-4:] == "json" else {}))
    assert clip.stature == pytest.approx(stature, rel=1e-3)
    motion = FileMotion(clip, stature, 70.0, (0.0, 0.0), 0.0, SECONDS)
    heights = motion.positions(T)[2].T
    inner = slice(20, -20)  # away from the ends of the low-pass filter
    assert np.abs(heights - p[:, : len(JOINTS), 2])[inner].max() < 0.002


def test_a_leg_tells_its_stature() -> None:
    for stature in np.linspace(0.3, 2.5, 441):
        assert stature_of_leg(leg_length(stature)) == pytest.approx(stature, rel=1e-12)


@pytest.mark.parametrize("stature", [0.96, 1.3, 1.75, 2.25])
def test_unit_of_every_stature_is_found(stature: float, tmp_path: Path) -> None:
    """Whoever is told in m, cm or mm is not taken for a child in inches."""
    p = walker(stature)
    for unit in (1.0, 100.0, 1000.0):
        data = npz_bytes(names=WANTED, positions=unit * p, rate=RATE)
        assert clip_of(tmp_path / "k.npz", data).stature == pytest.approx(stature, rel=1e-3)
