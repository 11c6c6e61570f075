"""BVH and ASF/AMC against transforms written out one by one, and our motions there and back."""

import re
from pathlib import Path

import numpy as np
import pytest
from helpers.poses import answered_clip, c3d_bytes
from helpers.recorded import frames, write_amc, write_bvh, write_npz
from hypothesis import given, settings
from hypothesis import strategies as st

import radhar_cli.readers.motion.frames
from radhar_cli.motion.recorded.names import WANTED, joint_means
from radhar_cli.motion.recorded.recording import MotionRecording
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.bvh import read_bvh
from radhar_cli.readers.motion.reading import read_motion

AXES = np.eye(3)


def matrix(axis: int, degrees: float) -> Float:
    """Rodrigues' formula."""
    k, a = AXES[axis], np.radians(degrees)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(a) * cross + (1 - np.cos(a)) * cross @ cross


@given(st.integers(0, 10_000))
@settings(max_examples=30)
def test_a_bvh_tree_is_the_product_of_its_transforms(seed: int) -> None:
    """Channels in any order, positions of inner joints in place of their offsets."""
    rng = np.random.default_rng(seed)
    parents = [None, *(int(rng.integers(0, n)) for n in range(1, 8))]
    offsets, channels, order = rng.normal(size=(8, 3)), [], []
    for _ in parents:
        axes = [*rng.permutation(3)]
        moves = [f"{'XYZ'[a]}position" for a in rng.permutation(3)] if rng.random() < 0.5 else []
        channels.append([*moves, *(f"{'xyz'[a]}rotation" for a in axes)])

    def tree(n: int) -> str:
        order.append(n)
        inner = "".join(tree(m) for m, parent in enumerate(parents) if parent == n)
        x, y, z = offsets[n]
        return (
            f"{'JOINT' if n else 'ROOT'} j{n}\n{{\nOFFSET {x} {y} {z}\n"
            f"CHANNELS {len(channels[n])} {' '.join(channels[n])}\n{inner}}}\n"
        )

    text = f"HIERARCHY\n{tree(0)}MOTION\nFrames: 2\nFrame Time: 0.01\n"
    values = rng.uniform(-180, 180, (2, sum(len(c) for c in channels)))
    text += "\n".join(" ".join(map(repr, row.tolist())) for row in values)
    file = read_bvh(text.encode(), "x.bvh")
    found = file.positions([file.names.index(f"j{n}") for n in range(8)])
    for frame, row in enumerate(values):
        at, turned = {}, {}
        left = iter(row)
        for n in order:
            local, own = offsets[n].copy(), np.eye(3)
            for name in channels[n]:
                axis = "xyz".index(name[0].lower())
                if "position" in name:
                    local[axis] = next(left)
                else:
                    own = own @ matrix(axis, next(left))
            parent = parents[n]
            outer = np.eye(3) if parent is None else turned[parent]
            at[n] = outer @ local + (0 if parent is None else at[parent])
            turned[n] = outer @ own
        right = np.array([at[n] for n in range(8)])
        np.testing.assert_allclose(found[frame], right, atol=1e-9)


def in_metres(file: MotionRecording, unit: float) -> Float:
    """[frames, 15, 3] in our axes, from a file whose y is up."""
    means = joint_means(file, {})
    return (
        file.positions([mean.numbers[0] for mean in means if mean is not None])[..., [2, 0, 1]]
        * unit
    )


@pytest.mark.parametrize(
    "activity",
    ["stationary", "punching", "kicking", "grabbing", "standing_up", "falling_to_walking"],
)
def test_bvh_and_amc_round_trips(activity: str, tmp_path: Path) -> None:
    """Through BVH and AMC every joint is reproduced to 1e-6 m; a fallen person too."""
    p = frames(activity, 2.0)
    bvh = read_motion(write_bvh(tmp_path / "x.bvh", p)).recording()
    assert np.abs(in_metres(bvh, 0.01) - p).max() < 1e-6
    assert bvh.rate == 120
    amc = read_motion(write_amc(tmp_path / "x.amc", p)).recording()
    assert amc.unit == pytest.approx(0.0254 / 0.45)
    assert np.abs(in_metres(amc, 0.0254 / 0.45) - p).max() < 1e-6
    npz = read_motion(write_npz(tmp_path / "x.npz", p)).recording()
    assert np.array_equal(npz.positions(range(len(WANTED))), p)


def test_block_borders_do_not_matter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pieces of text are read as one; empty lines and CR LF do not matter."""
    monkeypatch.setattr(radhar_cli.readers.motion.frames, "BLOCK", 5000)
    p = frames(seconds=0.5)
    bvh, amc = write_bvh(tmp_path / "x.bvh", p), write_amc(tmp_path / "x.amc", p)
    assert np.abs(in_metres(read_motion(bvh).recording(), 0.01) - p).max() < 1e-6
    assert np.abs(in_metres(read_motion(amc).recording(), 0.0254 / 0.45) - p).max() < 1e-6
    lines = bvh.read_text().split("\n")
    lines.insert(-20, "")
    bvh.write_text("\r\n".join(lines) + "\r\n\r\n", newline="")
    assert np.abs(in_metres(read_motion(bvh).recording(), 0.01) - p).max() < 1e-6


@pytest.mark.parametrize(("written", "rate"), [("0.033333", 30), ("0.0083333", 120), ("0.04", 25)])
def test_frame_times_are_rounded_rates(written: str, rate: float, tmp_path: Path) -> None:
    path = write_bvh(tmp_path / "x.bvh", frames(seconds=0.5))
    lines = path.read_text().split("\n")
    text = "\n".join(f"Frame Time: {written}" if "Frame T" in line else line for line in lines)
    assert read_bvh(text.encode(), "x").rate == rate


def test_cmu_keeps_one_skeleton_a_subject(tmp_path: Path) -> None:
    path = write_amc(tmp_path / "02_01.amc", frames(seconds=0.5))
    path.with_suffix(".asf").rename(tmp_path / "02.ASF")
    assert read_motion(path).skeleton is not None
    (tmp_path / "02.ASF").rename(tmp_path / "02.asf")
    assert read_motion(path).skeleton is not None
    (tmp_path / "02.asf").rename(tmp_path / "other.asf")
    assert read_motion(path).skeleton is not None
    (tmp_path / "third.asf").write_text("")
    with pytest.raises(Exception, match=r"needs its skeleton beside it, 02_01\.asf or 02\.asf; or"):
        read_motion(path)
    assert read_motion(path, tmp_path / "other.asf").recording().names[0] == "root"


GERMAN = {"left_knee": "Knie_l\u00fcnks", "right_knee": "Knie_b\u00f6", "hip": "H\u00fcfte"}


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8"])
@pytest.mark.parametrize("suffix", [".bvh", ".c3d", ".npz"])
def test_names_with_umlauts_are_kept(suffix: str, encoding: str, tmp_path: Path) -> None:
    """In UTF-8 and in Latin-1, which some programs of Windows write."""
    p = frames(seconds=0.5)
    path = tmp_path / f"x{suffix}"
    if suffix == ".npz":
        names = [GERMAN.get(name, name).encode(encoding) for name in WANTED]
        write_npz(path, p, names=names)
        theirs = GERMAN
    elif suffix == ".c3d":
        ascii_names = [GERMAN.get(name, name) for name in WANTED]
        data = c3d_bytes(p, [n.encode("ascii", "replace").decode() for n in ascii_names])
        for name in GERMAN.values():
            plain = name.encode("ascii", "replace").ljust(16)
            data = data.replace(plain, name.encode(encoding).ljust(16)[:16])
        path.write_bytes(data)
        theirs = GERMAN
    else:
        text = write_bvh(path, p).read_text()
        theirs = {name: GERMAN[name] for name in ("left_knee", "right_knee")}
        for own_name, name in zip(("LeftLeg", "RightLeg"), theirs.values(), strict=True):
            text = re.sub(rf"\b{own_name}\b", name, text)
        path.write_bytes(text.encode(encoding))
    clip = answered_clip(read_motion(path).recording("x"), theirs, rate=120.0)
    own = answered_clip(read_motion(write_npz(tmp_path / "own.npz", p)).recording("x"))
    assert np.abs(clip.positions - own.positions).max() < 1e-3
