"""Tables of a walker as programs of laboratories and of cameras export them."""

from collections.abc import Callable

import numpy as np
from helpers.poses import RATE, T, csv_text

from radhar_cli.numerics.arrays import Float

Writer = Callable[[Float, list[str]], bytes]


def _rows(p: Float, separator: str = ",", first: Callable[[int], str] | None = None) -> str:
    """Numbers of frames, a row each, behind what `first` says of it."""
    lines = []
    for n, frame in enumerate(p):
        cells = [f"{v:.5f}" for v in frame.ravel()]
        lines.append(separator.join([first(n), *cells] if first else cells))
    return "\n".join(lines)


def _clock(n: int, separator: str = ",") -> str:
    return f"{n + 1}{separator}{T[n]:.4f}"


def two_lines(p: Float, names: list[str], separator: str = ",", blank: bool = True) -> bytes:
    """Names of joints, then X, Y, Z below them."""
    cells = [cell for name in names for cell in ([name, "", ""] if blank else [name] * 3)]
    head = [separator.join(["", "", *cells])]
    head.append(separator.join(["Frame", "Time", *["X", "Y", "Z"] * len(names)]))
    return "\n".join([*head, _rows(p, separator, lambda n: _clock(n, separator))]).encode()


def vicon(p: Float, names: list[str]) -> bytes:
    """Vicon Nexus: force plates, then trajectories in mm with the subject before the names."""
    devices = ["Devices", "1000", ",,Force,,", "Frame,Sub Frame,Fx,Fy,Fz", ",,N,N,N"]
    devices += [f"{n},{sub},0,0,1" for n in range(1, 4) for sub in range(10)]
    head = ["", "Trajectories", f"{RATE:g}", ",," + ",".join(f"Anna:{name},," for name in names)]
    head += ["Frame,Sub Frame" + ",X,Y,Z" * len(names), "," + ",mm" * 3 * len(names)]
    rows = _rows(1000 * p, ",", lambda n: f"{n + 1},0")
    return ("\ufeff" + "\r\n".join([*devices, *head, *rows.split("\n")]) + "\r\n").encode()


def motive(p: Float, names: list[str], numbered: bool = False) -> bytes:
    """OptiTrack Motive: a line of settings, types, names, identities, turns and positions; y up.

    Bones are `numbered` from 1, as those of a skeleton are, or have an identity.
    """
    q = np.stack([p[..., 1], p[..., 2], p[..., 0]], axis=-1)
    head = [
        "Format Version,1.23,Take Name,walk,Capture Frame Rate,120.000000,Export Frame Rate,"
        f"{RATE:f},Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global",
        "",
    ]
    for label, cells in (
        ("Type", ["Bone"]),
        ("Name", None),
        ("ID", ["0A1B"]),
        ("", ["Rotation"] * 4 + ["Position"] * 3),
    ):
        per_joint = [cells or [f"Skeleton 001:{name}"] for name in names]
        if numbered and label == "ID":
            per_joint = [[str(number)] for number, _ in enumerate(names, 1)]
        head.append(f",{label}," + ",".join(c for cs in per_joint for c in cs * (7 // len(cs))))
    head.append("Frame,Time (Seconds)" + ",X,Y,Z,W,X,Y,Z" * len(names))
    turned = np.concatenate([np.full((*q.shape[:2], 4), 0.5), q], axis=2)
    return "\n".join([*head, _rows(turned, ",", _clock)]).encode()


def qualisys(p: Float, names: list[str], is_new: bool = False) -> bytes:
    """Qualisys Track Manager: settings, a line of names, numbers in mm."""
    head = [f"NO_OF_FRAMES\t{len(p)}", f"NO_OF_MARKERS\t{len(names)}", f"FREQUENCY\t{RATE:g}"]
    head += ["DESCRIPTION\t--", "TIME_STAMP\t2019-11-14, 12:41:05.123\t1234.5"]
    head += ["DATA_INCLUDED\t3D", "MARKER_NAMES\t" + "\t".join(names)]
    if is_new:
        columns = "\t".join(f"{name} {axis}" for name in names for axis in "XYZ")
        head.append(f"Frame\tTime\t{columns}")
    rows = _rows(1000 * p, "\t", (lambda n: _clock(n, "\t")) if is_new else None)
    return "\n".join([*head, rows]).encode()


def visual3d(p: Float, names: list[str]) -> bytes:
    """Visual3D, as Theia's users export: files, names, types, folders, ITEM and axes."""
    threes = {"walk.c3d": 1, "NAME": 2, "TARGET": 3, "PROCESSED": 4}
    head = [
        "\t" + "\t".join(name if word == "NAME" else word for name in names for _ in range(3))
        for word in threes
    ]
    head.append("ITEM" + "\tX\tY\tZ" * len(names))
    rows = _rows(p, "\t", lambda n: str(n + 1))
    return "\n".join(["Frame rate: 30", *head, rows]).encode()


def deeplabcut(p: Float, names: list[str]) -> bytes:
    """DeepLabCut and Anipose: scorer, body parts, coordinates."""
    head = ["scorer" + ",net" * 3 * len(names)]
    head.append("bodyparts," + ",".join(name for name in names for _ in range(3)))
    head.append("coords" + ",x,y,z" * len(names))
    return "\n".join(["# fps: 30", *head, _rows(p, ",", str)]).encode()


def long_form(p: Float, names: list[str]) -> bytes:
    """A row a joint: frame, joint, x, y, z."""
    rows = ["frame,time,joint,x,y,z"]
    for n, frame in enumerate(p):
        for name, (x, y, z) in zip(names, frame, strict=True):
            rows.append(f"{n},{T[n]:.4f},{name},{x:.5f},{y:.5f},{z:.5f}")
    return "\n".join(rows).encode()


def long_dump(p: Float, names: list[str]) -> bytes:
    """A row a joint, as recorders of the Kinect write: semicolons, decimal commas, clock, state."""
    rows = ["Timestamp;BodyID;JointName;Position.X;Position.Y;Position.Z;Orientation.X;State"]
    for n, frame in enumerate(p):
        clock = f"23:59:{58 + T[n]:.3f}" if T[n] < 2 else f"00:00:{T[n] - 2:06.3f}"
        for name, (x, y, z) in zip(names, frame, strict=True):
            cells = f"{x:.5f};{y:.5f};{z:.5f}".replace(".", ",")
            rows.append(f"{clock};7;{name};{cells};0,5;Tracked")
    return "\n".join(rows).encode()


def dates(p: Float, names: list[str]) -> bytes:
    """UTF-16 as Excel writes, tabs, dates with times and a zone."""
    head, *rows = csv_text(1000 * p, names, "JOINT_{}.{}", "\t").splitlines()
    lines = [head.replace("time", "Timestamp\tSerial")]
    for n, row in enumerate(rows):
        cells = row.split("\t", 1)[1]
        lines.append(f"2026-05-01 12:00:{2 + T[n]:09.6f}+02:00\tA1B2\t{cells}")
    return "\n".join(lines).encode("utf-16")


def with_rate(p: Float, names: list[str]) -> bytes:
    """Lines of the rate and the unit above the names; decimal commas."""
    head, *rows = csv_text(100 * p, names, "{}_{}", ";").splitlines()
    lines = ["Frame rate;30", "Units;cm", "", head.replace("time", "frame")]
    lines += [f"{n};" + row.split(";", 1)[1].replace(".", ",") for n, row in enumerate(rows)]
    return "\n".join(lines).encode()


# {what it is: (suffix, writer)}
TABLES: dict[str, tuple[str, Writer]] = {
    "two lines": (".csv", two_lines),
    "two lines, names repeated": (".csv", lambda p, names: two_lines(p, names, ";", blank=False)),
    "Vicon": (".csv", vicon),
    "OptiTrack": (".csv", motive),
    "OptiTrack with numbers of bones": (".csv", lambda p, names: motive(p, names, numbered=True)),
    "Qualisys": (".tsv", qualisys),
    "Qualisys with a line of columns": (".tsv", lambda p, names: qualisys(p, names, is_new=True)),
    "Visual3D": (".txt", visual3d),
    "DeepLabCut": (".csv", deeplabcut),
    "long": (".csv", long_form),
    "long of a recorder": (".txt", long_dump),
    "dates": (".tsv", dates),
    "rate and unit": (".csv", with_rate),
}
