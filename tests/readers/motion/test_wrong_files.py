"""Wrong files: one line with the file, the line or frame, and what is missing or odd."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from helpers.poses import answered_clip
from helpers.recorded import frames, write_amc, write_bvh, write_npz

from radhar_cli.errors import MotionFileError
from radhar_cli.readers.motion.reading import read_motion

FIRST = 100  # line of the first frame in our BVH files


def changed(pattern: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        found = re.sub(pattern, new, text, count=1, flags=re.MULTILINE)
        assert found != text
        return found

    return change


def in_line(number: int, change: Callable[[str], str]) -> Callable[[str], str]:
    def whole(text: str) -> str:
        lines = text.split("\n")
        lines[number - 1] = change(lines[number - 1])
        return "\n".join(lines)

    return whole


def scaled(text: str) -> str:
    """Four times as large, but for its positions."""
    return re.sub(r"OFFSET (.*) (.*) (.*)", four_times, text)


def four_times(found: re.Match[str]) -> str:
    return "OFFSET " + " ".join(str(4 * float(value)) for value in found.groups())


# {name: (change of a BVH file, what the message says)}
BROKEN_BVH = {
    "no such joint": (
        changed("RightLeg", "Stick"),
        r"x\.bvh: has no joint that is right_knee .* it has Hips, Spine2, .*, Stick, .*joints: ",
    ),
    "NaN": (
        in_line(FIRST + 4, changed(r"^\S+ \S+", "1.0 nan")),
        rf"x\.bvh:{FIRST + 4}: 'nan' should be a number",
    ),
    "a word": (
        in_line(FIRST + 7, changed(r" \S+$", " 1,5")),
        rf"x\.bvh:{FIRST + 7}: '1,5' should be a number",
    ),
    "zero frames": (
        changed(r"Frames: \d+[\s\S]*", "Frames: 0\nFrame Time: 0.01\n"),
        r"x\.bvh:98: has 0 frames; should have 1 to",
    ),
    "cut short": (
        lambda text: "\n".join(text.split("\n")[: FIRST + 20]) + "\n",
        rf"x\.bvh:{FIRST + 21}: ends after 21 frames; 'Frames:' says 61",
    ),
    "a frame too long": (
        in_line(FIRST + 2, lambda line: line + " 1.0"),
        rf"x\.bvh:{FIRST + 2}: has 43 numbers; its joints have 42 channels",
    ),
    "an unknown channel": (
        changed("Zrotation", "Wrotation"),
        r"x\.bvh:5: 'wrotation' is not a channel such as",
    ),
    "no frame time": (
        changed(r"Frame Time: \S+", "Frame Time: 0"),
        r"x\.bvh:99: a frame time of 0 s should be",
    ),
    "an open brace": (
        changed(r"^\}\n", ""),
        r"x\.bvh:\d+: the hierarchy ends before its last }",
    ),
    "units that make a giant": (scaled, r"x\.bvh: has legs of \d+ units, .* unit_m"),
    "another file": (lambda text: "hello", r"x\.bvh: is not a BVH file"),
    "two people": (
        changed("MOTION", "ROOT Hips\n{\nOFFSET 0 0 0\n}\nMOTION"),
        r"x\.bvh:97: 'ROOT Hips' is a second tree",
    ),
    "a heap of braces": (
        changed("JOINT Spine2", "{"),
        r"x\.bvh:\d+: \{ should follow ROOT, JOINT or End Site",
    ),
}


@pytest.mark.parametrize("name", BROKEN_BVH)
def test_broken_bvh_is_refused(name: str, tmp_path: Path) -> None:
    change, message = BROKEN_BVH[name]
    path = write_bvh(tmp_path / "x.bvh", frames(seconds=0.5))
    assert path.read_text().split("\n")[FIRST - 2].startswith("Frame Time")
    path.write_text(change(path.read_text()))
    with pytest.raises(MotionFileError) as refused:
        answered_clip(read_motion(path).recording("x.bvh"))
    assert re.match(message, str(refused.value)), refused.value
    assert "\n" not in str(refused.value)


BROKEN_AMC = {
    "a bone is missing": (
        ".amc",
        in_line(9, lambda line: ""),
        r"x\.amc:4: its first frame should have the bone '\w+' once",
    ),
    "an unknown bone": (".amc", changed("thorax", "tail"), r"x\.amc:4: the skeleton has no bone"),
    "a frame is missing": (
        ".amc",
        changed(r"^7$", "8"),
        r"x\.amc:\d+: frame 8 should be frame 7: frames are missing",
    ),
    "an infinite angle": (
        ".amc",
        in_line(30, changed(r"\S+$", "inf")),
        r"x\.amc:30: 'inf' should be a number",
    ),
    "no frames": (
        ".amc",
        changed(r"^1\n[\s\S]*", ""),
        r"x\.amc: is not an AMC file: it has no line with the number",
    ),
    "angles in turns": (
        ".asf",
        changed("angle deg", "angle turns"),
        r".*x\.asf:\d+: angle should be deg or rad",
    ),
    "nothing that moves": (
        ".asf",
        lambda text: re.sub(r"dof .*|order .*", "", text),
        r".*x\.amc:\d+: the skeleton has no bone 'thorax' that moves",
    ),
    "no hierarchy": (
        ".asf",
        changed(r":hierarchy[\s\S]*", ""),
        r".*x\.asf: is not an ASF file: it has no :hierarchy",
    ),
    "a bone twice": (".asf", changed("name head", "name thorax"), r".*x\.asf:\d+: the bone 'tho"),
    "a bone without length": (
        ".asf",
        changed(r"    length \S+\n", ""),
        r".*x\.asf:\d+: length should have 1 number",
    ),
    "a length of nothing": (
        ".asf",
        changed("length 0.45", "length 0"),
        r".*x\.asf:\d+: a length of 0 should be above 0",
    ),
}


@pytest.mark.parametrize("name", BROKEN_AMC)
def test_broken_amc_is_refused(name: str, tmp_path: Path) -> None:
    suffix, change, message = BROKEN_AMC[name]
    path = write_amc(tmp_path / "x.amc", frames(seconds=0.5))
    broken = path.with_suffix(suffix)
    broken.write_text(change(broken.read_text()))
    with pytest.raises(MotionFileError) as refused:
        answered_clip(read_motion(path).recording("x.amc"))
    assert re.match(message, str(refused.value)), refused.value
    assert "\n" not in str(refused.value)


def test_broken_npz_is_refused(tmp_path: Path) -> None:
    p, path = frames(seconds=0.5), tmp_path / "x.npz"
    hole, few = p.copy(), p[:5]
    hole[20, 3, 1] = 1e12
    for positions, more, message in (
        (hole, {}, r"frame 21: right_elbow y is 1000000000000\.0; should be a number"),
        (few, {}, r"has 5 frames; should have 12 or more"),
        (
            p[:, :13],
            {},
            r"positions should be \[frames, 15, 3\] of one person, not float64 \[61, 13, 3\]",
        ),
        (p * 0, {}, r"torso is lost \(NaN or 0, 0, 0\) in every frame"),
        (p * 0 + 1, {}, r"has legs of 0 units"),
        (p[..., :2], {}, r"positions have two coordinates: pixels of an image"),
        (p, {"rate": 0.0}, r"rate should be one number"),
        (p, {"names": np.array([object()] * 15)}, r"names is not an array .*objects"),
        (p, {"names": np.zeros(15)}, r"names should be 1 to 1000 texts, not float64 \[15\]"),
    ):
        write_npz(path, positions)
        with np.load(path) as file:
            arrays = {**file, **more}
        np.savez(path, allow_pickle=True, **arrays)
        with pytest.raises(MotionFileError, match=message):
            answered_clip(read_motion(path).recording("x.npz"))
    np.savez(path, places=p[:, :13], others=p)
    with pytest.raises(MotionFileError, match=r"has no array 'positions'; .* it has places"):
        read_motion(path).recording()
    np.savez(path, positions=p[:, :13])
    with pytest.raises(MotionFileError, match="13 joints without names"):
        answered_clip(read_motion(path).recording())


def test_unknown_motion_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.fbx").write_text("")
    (tmp_path / "x.bvh").mkdir()
    for name, message in (
        ("x.fbx", "should be paths of .bvh, .amc, .npz"),
        ("x.fbx", "Blender imports it and exports .bvh"),
        ("x.pkl", "pickles run code"),
        ("x.xyz", "by three lines of NumPy: np.savez"),
        ("x.asf", "name its .amc files"),
        ("x.bvh", "is a folder"),
        ("y.bvh", "no such file"),
    ):
        with pytest.raises(MotionFileError, match=message):
            read_motion(tmp_path / name)
