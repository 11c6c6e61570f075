"""Poses of a known walker in the formats that people have."""

import io
import re
import struct
from pathlib import Path

import joint_set_errors
import numpy as np

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import Clip, make_clip
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.recording import MotionRecording
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.reading import read_motion

RATE = 30.0
WALKER = joint_set_errors.walker()
COCO = joint_set_errors.poses_of(JOINT_SETS["coco17"], WALKER)
NTU = joint_set_errors.poses_of(JOINT_SETS["ntu25"], WALKER)
BLAZE = joint_set_errors.poses_of(JOINT_SETS["blazepose33"], WALKER)
T = np.arange(len(WALKER)) / RATE


def names(key: str) -> list[str]:
    return [name.split("|")[0] for name in JOINT_SETS[key].names]


def camera(p: Float) -> Float:
    """x right, y down, z away of a camera that looks at us, m."""
    return np.stack([-p[..., 1], 1 - p[..., 2], p[..., 0] + 2], axis=-1)


def skeleton_text(bodies: list[Float]) -> str:
    """NTU's text of bodies [frames, 25, 3]; a frame without numbers has no body."""
    lines = [str(len(bodies[0]))]
    for frame in range(len(bodies[0])):
        there = [
            (n, body[frame]) for n, body in enumerate(bodies) if np.isfinite(body[frame]).all()
        ]
        lines.append(str(len(there)))
        for number, joints in there:
            lines += [f"7205759403{number} 0 1 1 1 1 0 0.01 -0.02 2", "25"]
            lines += [f"{x:.6f} {y:.6f} {z:.6f} 1 2 3 4 .1 .2 .3 .4 2" for x, y, z in joints]
    return "\n".join(lines) + "\n"


def trc_text(p: Float, joints: list[str]) -> str:
    """TRC in mm, y up."""
    q = 1000 * np.stack([p[..., 0], p[..., 2], -p[..., 1]], axis=-1)
    head = [
        "PathFileType\t4\t(X/Y/Z)\tx.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate",
        f"{RATE:.2f}\t{RATE:.2f}\t{len(p)}\t{len(joints)}\tmm\t{RATE:.2f}",
        "Frame#\tTime\t" + "\t\t\t".join(joints) + "\t\t",
        "\t\t" + "\t".join(f"X{n}\tY{n}\tZ{n}" for n in range(1, len(joints) + 1)),
        "",
    ]
    rows = [
        f"{n + 1}\t{n / RATE:.4f}\t" + "\t".join(f"{v:.3f}" for v in frame.ravel())
        for n, frame in enumerate(q)
    ]
    return "\n".join([*head, *rows]) + "\n"


def c3d_bytes(p: Float, joints: list[str], integers: bool = False, order: str = "<") -> bytes:
    """C3D in mm as the user guide lays it out: header, one group, points, an analog sample."""
    scale = 0.5 if integers else -1.0
    label = b"".join(name.encode().ljust(16) for name in joints)
    entries = io.BytesIO()

    def entry(name: bytes, group: int, body: bytes, last: bool = False) -> None:
        entries.write(struct.pack("<bb", len(name), group) + name)
        entries.write(struct.pack(f"{order}H", 0 if last else 2 + len(body)) + body)

    entry(b"POINT", -1, b"\0")
    entry(b"LABELS", 1, struct.pack("<bBBB", -1, 2, 16, len(joints)) + label + b"\0")
    entry(b"UNITS", 1, struct.pack("<bBB", -1, 1, 2) + b"mm" + b"\0", last=True)
    blocks = -(-(4 + entries.tell()) // 512)
    parameters = struct.pack("<4B", 1, 80, blocks, 84 if order == "<" else 86) + entries.getvalue()
    header = struct.pack("<BB", 2, 0x50)
    header += struct.pack(f"{order}5H", len(joints), 1, 1, len(p), 10)
    header += struct.pack(f"{order}fHHf", scale, 2 + blocks, 1, RATE)
    rows = np.zeros((len(p), 4 * len(joints) + 1))
    points = rows[:, :-1].reshape(len(p), len(joints), 4)
    points[..., :3] = 1000 * p / (0.5 if integers else 1)
    points[~np.isfinite(p).all(axis=2)] = [0, 0, 0, -1]
    number = f"{order}i2" if integers else f"{order}f4"
    body = (np.round(rows) if integers else rows).astype(number).tobytes()
    return header.ljust(512, b"\0") + parameters.ljust(512 * blocks, b"\0") + body


def csv_text(p: Float, joints: list[str], column: str = "{}_{}", separator: str = ",") -> str:
    head = ["time", *(column.format(name, axis) for name in joints for axis in "xyz")]
    rows = [
        [f"{t:.4f}", *(f"{v:.5f}" for v in frame.ravel())] for t, frame in zip(T, p, strict=True)
    ]
    return "\n".join(separator.join(row) for row in [head, *rows]) + "\n"


def landmarks(p: Float) -> list[object]:
    """Frames as MediaPipe's Python or JavaScript writes them."""
    return [
        {
            "timestamp_ms": 1000 * t,
            "pose_world_landmarks": [
                {"x": x, "y": y, "z": z, "visibility": 0.9} for x, y, z in frame.tolist()
            ],
        }
        for t, frame in zip(T.tolist(), camera(p), strict=True)
    ]


def npz_bytes(**arrays: object) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def npy_bytes(array: Float) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def answered_clip(file: MotionRecording, *told: object, **options: object) -> Clip:
    """Clip of a recording, of which the axis is told that a message asks for, where one does."""
    try:
        return make_clip(file, *told, **options)  # type: ignore[arg-type]
    except MotionFileError as asked:
        up = re.search(r"head is above the feet.*?\(--up (-?[xyz])\)", str(asked))
        if up is None:
            raise
    return make_clip(file, *told, **options, up=up[1])  # type: ignore[arg-type]


def clip_of(path: Path, data: bytes | None = None, **options: object) -> Clip:
    """Clip of a motion file, or of a folder of them; data, where given, is written to it first."""
    if data is not None:
        path.write_bytes(data)
    return answered_clip(read_motion(path).recording(path.name), **options)


def joint_errors(clip: Clip) -> Float:
    """Rms errors [joint] of the thirteen joints of a clip of the walker, m."""
    return joint_set_errors.joint_errors(WALKER[:, :13], clip.positions[:, :13])


def largest_error(clip: Clip) -> float:
    """Largest rms error of a joint of a clip of the walker, m."""
    return float(joint_errors(clip).max())
