"""Motion files of known motions, written by tests: no real recording is kept with the project."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.motion.recorded.writing import bvh_text
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.motion_file import sample_joints

# {bone: (the one it hangs on, the joint at its end)}, in tree order.
BONES = {
    "thorax": ("root", "torso"),
    "head": ("thorax", "head"),
    **{
        f"{side[0]}{bone}": (above if above in ("root", "thorax") else side[0] + above, end)
        for side in ("right", "left")
        for bone, above, end in (
            ("clavicle", "thorax", f"{side}_shoulder"),
            ("humerus", "clavicle", f"{side}_elbow"),
            ("radius", "humerus", f"{side}_hand"),
            ("hipjoint", "root", f"{side}_hip_joint"),
            ("femur", "hipjoint", f"{side}_knee"),
            ("tibia", "femur", f"{side}_ankle"),
        )
    },
}


def frames(activity: str = "walking", seconds: float = 3.0, rate: float = 120.0) -> Float:
    """Positions [frames, 15, 3] (m) of a nominal person of 1.75 m whose links are stiff."""
    config = Config.model_validate(
        {
            "duration_s": seconds,
            "subject": {"height_m": 1.75, "chest_m": 0, "heart_m": 0},
            "motion": {"range_m": 2, "angle_deg": 0},
        }
    )
    motion = motion_of(nominal_scene(config, activity_named(activity)).people[0])
    return sample_joints(motion, np.arange(round(seconds * rate) + 1) / rate)


def write_bvh(path: Path, positions: Float, rate: float = 120.0) -> Path:
    """Write a BVH file by our own writer."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(bvh_text(positions, rate))
    return path


def write_npz(path: Path, positions: Float, rate: float = 120.0, names: object = WANTED) -> Path:
    """Write positions as they are."""
    np.savez(path, names=np.array(names), positions=positions, rate=rate)
    return path


def write_json(path: Path, positions: Float, rate: float = 120.0) -> Path:
    """Write positions as JSON, in whole mm."""
    rows = np.round(1e3 * positions).astype(int).tolist()
    path.write_text(json.dumps({"names": list(WANTED), "positions": rows, "rate": rate}))
    return path


def write_amc(path: Path, positions: Float) -> Path:
    """Write AMC and ASF (`:units` length 0.45), each bone with axes of its own; y is up.

    The skeleton stands.
    """
    positions = np.concatenate([frames("stationary", 0.1)[:1], positions])
    p = positions[..., [1, 2, 0]] * 0.45 / 0.0254
    where = {name: p[:, WANTED.index(end)] for name, (_, end) in BONES.items()}
    where["root"] = p[:, WANTED.index("hip")]
    rng = np.random.default_rng(0)
    turned = {"root": Rotation.identity(len(p))}
    asf, lines = [], [[f"root {x:.9f} {y:.9f} {z:.9f} 0 0 0" for x, y, z in where["root"]]]
    for number, (name, (above, _)) in enumerate(BONES.items(), 1):
        link = where[name] - where[above]
        length = np.linalg.norm(link, axis=1)
        assert np.ptp(length) < 1e-6
        angles = rng.uniform(-90, 90, 3)
        own = Rotation.from_euler("xyz", angles, degrees=True)
        direction = link[0] / length[0]
        local = turned[above].inv().apply(link / length[:, None])
        axis = np.cross(direction, local)
        size = np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-15)
        angle = np.arctan2(size, (local @ direction)[:, None])
        turn = Rotation.from_rotvec(axis / size * angle)
        turned[name] = turned[above] * turn
        values = (own.inv() * turn * own).as_euler("xyz", degrees=True)
        lines.append([f"{name} {x:.9f} {y:.9f} {z:.9f}" for x, y, z in values])
        vector = " ".join(f"{v:.12f}" for v in direction)
        turns = " ".join(f"{v:.12f}" for v in angles)
        asf.append(
            f"  begin\n    id {number}\n    name {name}\n    direction {vector}\n"
            f"    length {length[0]:.12f}\n    axis {turns} XYZ\n    dof rx ry rz\n"
            f"    limits (-180.0 180.0)\n{'           (-180.0 180.0)' * 2}\n  end\n"
        )
    children: dict[str, list[str]] = {}
    for name, (above, _) in BONES.items():
        children.setdefault(above, []).append(name)
    links = "".join(f"  {above} {' '.join(names)}\n" for above, names in children.items())
    path.with_suffix(".asf").write_text(
        "# written by a test\n:version 1.10\n:name x\n:units\n  mass 1.0\n  length 0.45\n"
        "  angle deg\n:documentation\n   none\n:root\n   order TX TY TZ RX RY RZ\n   axis XYZ\n"
        "   position 0 0 0\n   orientation 0 0 0\n:bonedata\n"
        + "".join(asf)
        + f":hierarchy\n  begin\n{links}  end\n"
    )
    rows = zip(*lines, strict=True)
    body = "".join(f"{n}\n" + "\n".join(row) + "\n" for n, row in enumerate(rows) if n)
    path.write_text(f"#!OML:ASF x.asf\n:FULLY-SPECIFIED\n:DEGREES\n{body}")
    return path


def write_motions(document: dict[str, Any], folder: Path) -> None:
    """Write a file of a walk for every pattern of files that classes of a config name."""
    writers = {".bvh": write_bvh, ".npz": write_npz, ".amc": write_amc, ".json": write_json}
    for motion in document.get("classes", {}).values():
        patterns = motion if isinstance(motion, list) else motion.get("files", [])
        for pattern in [patterns] if isinstance(patterns, str) else patterns:
            path = folder / pattern.replace("*", "a_clip")
            path.parent.mkdir(exist_ok=True)
            writers[path.suffix](path, frames("walking", 8.0))
