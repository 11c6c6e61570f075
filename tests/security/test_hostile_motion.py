"""Motion files of anyone's: damage, bombs, pipes and lies are refused at once, in one line."""

import io
import json
import os
import random
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from helpers.poses import COCO, NTU, c3d_bytes, csv_text, names, npy_bytes, skeleton_text, trc_text
from helpers.recorded import frames, write_amc, write_bvh, write_npz
from helpers.slow import slow
from security.bounded import answers, limited, refused
from security.mutations import mutate_file

from radhar_cli.errors import MotionFileError, RadharError
from radhar_cli.motion.recorded.clip import make_clip
from radhar_cli.motion.recorded.recording import MAX_BYTES
from radhar_cli.readers.motion.reading import read_motion

HEAD = b"HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n"


def npy(shape: tuple[int, ...], dtype: str = "<f8", content: bytes = b"") -> bytes:
    """An array that says to be of a shape."""
    head = str({"descr": dtype, "fortran_order": False, "shape": shape}).encode()
    head += b" " * (-(len(head) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + content


def archive(**members: bytes) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in members.items():
            file.writestr(f"{name}.npy", data)
    return buffer.getvalue()


NAMES = npy((2,), "<U4", "Hips".encode("utf-32-le") + "Head".encode("utf-32-le"))
RATE = npy((), content=np.float64(30).tobytes())
HOSTILE: dict[str, tuple[str, Callable[[], bytes]]] = {
    "a zip bomb": (
        "x.npz",
        lambda: archive(names=NAMES, rate=RATE, positions=npy((9, 2, 3)) + bytes(MAX_BYTES)),
    ),
    "a claim of petabytes": (
        "x.npz",
        lambda: archive(names=NAMES, rate=RATE, positions=npy((10**15, 2, 3))),
    ),
    "a negative shape": (
        "x.npz",
        lambda: archive(names=NAMES, rate=RATE, positions=npy((-9, 2, 3), content=bytes(99))),
    ),
    "objects": ("x.npz", lambda: archive(names=NAMES, rate=RATE, positions=npy((3,), "|O"))),
    "names without end": (
        "x.npz",
        lambda: archive(names=npy((1,), "<U200000", bytes(800_000)), rate=RATE, positions=RATE),
    ),
    "no zip": ("x.npz", lambda: b"PK\x03\x04" + bytes(100)),
    "a tree without end": ("x.bvh", lambda: HEAD + b"JOINT a\n{\n" * 100_000),
    "deep braces": ("x.bvh", lambda: HEAD + b"{" * 300_000),
    "one endless line": ("x.bvh", lambda: b" " * 10_000_000),
    "a long name": ("x.bvh", lambda: b"HIERARCHY\nROOT " + b"x" * 900_000),
    "a steering name": ("x.bvh", lambda: b"HIERARCHY\n\x1b[2J\n"),
    "frames without end": (
        "x.bvh",
        lambda: HEAD + b"}\nMOTION\nFrames: 99999999999999999\nFrame Time: 0.01\n",
    ),
    "a frame time of nothing": (
        "x.bvh",
        lambda: HEAD + b"}\nMOTION\nFrames: 1\nFrame Time: 1e-999\n0 0 0\n",
    ),
    "a line of many numbers": (
        "x.bvh",
        lambda: HEAD + b"}\nMOTION\nFrames: 1\nFrame Time: 0.01\n" + b"0 " * 5_000_000,
    ),
    "an array of petabytes": ("x.npy", lambda: npy((10**15, 17, 3))),
    "an array of objects": ("x.npy", lambda: npy((3,), "|O")),
    "an array without frames": ("x.npy", lambda: npy((0, 17, 3))),
    "times that tell ages": (
        "x.npz",
        lambda: archive(
            names=NAMES,
            times=npy((2,), content=np.float64([0, 1e300]).tobytes()),
            positions=npy((2, 2, 3), content=bytes(96)),
        ),
    ),
    "a deep JSON": ("x.json", lambda: b"[" * 5_000_000),
    "a JSON of lists": ("x.json", lambda: b"[" + b"[]," * 1_000_000 + b"[]]"),
    "a JSON of joints": ("x.json", lambda: b"[[" + b"[1,2,3]," * 1_000_000 + b"[1,2,3]]]"),
    "a JSON of infinity": ("x.json", lambda: b"[" + b"[[1e999,1,1]]," * 20 + b"[[1,1,1]]]"),
    "a CSV of columns": ("x.csv", lambda: b",".join(b"j%d_x" % n for n in range(2_000_000))),
    "a CSV of rows": ("x.csv", lambda: b"a_x,a_y,a_z\n" + b"0,0,0\n" * 1_000_000),
    "a CSV without end": ("x.csv", lambda: b'a_x,a_y,a_z\n"' + b"0" * 30_000_000),
    "a steering CSV": ("x.csv", lambda: b"\x1b[2J_x,a_y,a_z\n0,0,0\n"),
    "a TRC of names": (
        "x.trc",
        lambda: b"PathFileType\nDataRate\tUnits\n30\tmm\n\t\t" + b"a\t\t\t" * 3_000_000 + b"\n\n\n",
    ),
    "a skeleton of frames": ("x.skeleton", lambda: b"999999999\n"),
    "a skeleton of bodies": ("x.skeleton", lambda: b"2\n" + b"9" * 9_000_000),
    "a skeleton of ghosts": ("x.skeleton", lambda: b"400000\n" + b"0\n" * 400_000),
    "a C3D that points to itself": ("x.c3d", lambda: (b"\x02\x50" + b"\x01" * 510) * 4),
    "a C3D that says more than it has": (
        "x.c3d",
        lambda: (
            b"\x02\x50\x11\x00\x00\x00\x01\x00\xfe\xff"
            + bytes(504)
            + b"\x01\x50\x01\x54"
            + bytes(508)
        ),
    ),
    "nulls": ("x.bvh", lambda: bytes(1000)),
    "an AMC of nulls": ("x.amc", lambda: bytes(1000)),
    "a frame without end": ("x.amc", lambda: b"1\n" + b"root\n" * 30_000_000),
    "many bones in a frame": ("x.amc", lambda: b"1\n" + b"a%d 0\n" * 150_000),
    "one endless line of an AMC": ("x.amc", lambda: b"1\nroot " + b"0 " * 50_000_000),
    "numbers of frames": ("x.amc", lambda: b"1\n" * 5_000_000),
    "a frame's number without end": ("x.amc", lambda: b"1" * 5_000_000 + b"\nroot 0\n"),
    "no tree": ("x.asf", lambda: b":hierarchy\nroot " + b"root " * 200_000),
    "a large skeleton": ("x.asf", lambda: b" " * 2_000_000),
    "a bone of many numbers": (
        "x.asf",
        lambda: b":bonedata\nbegin\nname a\ndirection " + b"1 " * 500_000 + b"\nend\n",
    ),
    "a steering bone": ("x.asf", lambda: b":hierarchy\nroot \x1b[2J\n"),
    "many sections": ("x.asf", lambda: b":a\n" * 300_000),
    "many bones": (
        "x.asf",
        lambda: (
            b":bonedata\n"
            + b"".join(b"name b%d\ndirection 1 0 0\nlength 1\nend\n" % n for n in range(20_000))
        ),
    ),
}
LAST_OF_EACH_SUFFIX = [*{Path(file).suffix: name for name, (file, _) in HOSTILE.items()}.values()]
POSES: dict[str, Callable[[], bytes]] = {
    "x.npy": lambda: npy_bytes(COCO),
    "x.csv": lambda: csv_text(COCO, names("coco17")).encode(),
    "x.json": lambda: json.dumps({"positions": COCO.tolist(), "rate": 30}).encode(),
    "x.trc": lambda: trc_text(COCO, names("coco17")).encode(),
    "x.c3d": lambda: c3d_bytes(COCO, names("coco17")),
    "x.skeleton": lambda: skeleton_text([NTU]).encode(),
}
SKELETON = b":root\norder rx\n:bonedata\nname a\ndirection 1 0 0\nlength 1\nend\n"
SKELETON += b":hierarchy\nroot a\n"


def written(folder: Path, name: str) -> Path:
    """The motion file of a case; an AMC has a skeleton beside it, and an ASF an AMC."""
    file, data = HOSTILE[name]
    (folder / "x.asf").write_bytes(SKELETON)
    (folder / "x.amc").write_bytes(b"1\nroot 0\n")
    (folder / file).write_bytes(data())
    return folder / (file if file != "x.asf" else "x.amc")


@pytest.mark.every(3)
@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_are_refused(name: str, tmp_path: Path) -> None:
    path = written(tmp_path, name)
    with limited(), pytest.raises(MotionFileError) as error:
        make_clip(read_motion(path).recording())
    assert str(error.value).startswith(str(tmp_path / HOSTILE[name][0]))
    assert len(str(error.value)) < 2000
    assert "\n" not in str(error.value)


def test_no_pipe_no_device_and_nothing_too_large(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "x.bvh")
    (tmp_path / "zero.bvh").symlink_to("/dev/zero")
    with (tmp_path / "large.bvh").open("wb") as file:
        file.truncate(MAX_BYTES + 1)
    for name, message in (("x", "FIFO"), ("zero", "device"), ("large", "should have at most")):
        with limited(), pytest.raises(MotionFileError, match=message):
            read_motion(tmp_path / f"{name}.bvh")


@pytest.mark.parametrize("names", [LAST_OF_EACH_SUFFIX, *slow([[*HOSTILE]])], ids=["some", "all"])
def test_the_program_refuses_them_in_one_line(tmp_path: Path, names: list[str]) -> None:
    for name in names:
        folder = tmp_path / name.replace(" ", "_")
        folder.mkdir()
        path = written(folder, name)
        (folder / "x.yaml").write_text(f"duration_s: 1\nclasses: {{wave: [{path.name}]}}\n")
    words = ["--activity", "wave", "-o", tmp_path / "out"]
    cases = {
        name: ["simulate", tmp_path / name.replace(" ", "_") / "x.yaml", *words] for name in names
    }
    for answer in answers(tmp_path, cases).values():
        assert "\n" not in refused(answer)


# (first case, cases): a tenth of them in every run, one that stays readable among them.
@pytest.mark.parametrize(
    ("first", "count"), [(30, 40), pytest.param(0, 440, marks=pytest.mark.slow)]
)
def test_damage_is_refused_or_does_no_harm(tmp_path: Path, first: int, count: int) -> None:
    p = frames(seconds=0.3)
    whole = {
        "x.bvh": write_bvh(tmp_path / "x.bvh", p).read_bytes(),
        "x.npz": write_npz(tmp_path / "x.npz", p).read_bytes(),
        **{name: data() for name, data in POSES.items()},
        "x.amc": write_amc(tmp_path / "x.amc", p).read_bytes(),
        "x.asf": (tmp_path / "x.asf").read_bytes(),
    }
    found = {"refused": 0, "read": 0}
    for case in range(first, first + count):
        rng = random.Random(case)
        name = rng.choice(sorted(whole))
        (tmp_path / name).write_bytes(mutate_file(rng, whole[name]))
        try:
            with limited():
                used = tmp_path / name.replace(".asf", ".amc")
                clip = make_clip(read_motion(used).recording("x"))
        except RadharError as error:
            found["refused"] += 1
            long = str(error)
        else:
            assert np.isfinite(clip.positions).all()
            found["read"] += 1
            long = ""
        assert "\n" not in long
        assert len(long) < 2000
        (tmp_path / name).write_bytes(whole[name])
    assert min(found.values()) > 0, found
