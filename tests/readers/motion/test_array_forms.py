"""Arrays of one walker in the shapes, names, times and marks of lost joints that people save."""

import json
from pathlib import Path

import joint_set_errors
import numpy as np
import pytest
from helpers.poses import (
    COCO,
    RATE,
    WALKER,
    T,
    camera,
    clip_of,
    csv_text,
    largest_error,
    names,
    npy_bytes,
    npz_bytes,
)

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import require_complete
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.numerics.arrays import Float

CERTAIN = np.concatenate([COCO, np.full((*COCO.shape[:2], 1), 0.9)], axis=2)
CHANNELS = np.moveaxis(COCO, 2, 0)
SHAPES = {
    "[F, J, 3]": COCO,
    "[F, 3 J]": COCO.reshape(len(COCO), -1),
    "[F, J, 4]": CERTAIN,
    "[F, J, 5]": np.concatenate([CERTAIN, CERTAIN[..., 3:]], axis=2),
    "[1, F, J, 3]": COCO[None],
    "[F, 1, J, 3]": COCO[:, None],
    "float16": COCO.astype(np.float16),
    "whole mm": (1000 * COCO).astype(np.int16),
    "big-endian": COCO.astype(">f8"),
}
# {shape: (array, the line of NumPy that turns it)}
OTHER_SHAPES = {
    "[J, F, 3]": (np.moveaxis(COCO, 1, 0), "p.transpose(1, 0, 2)"),
    "[F, 3, J]": (np.swapaxes(COCO, 1, 2), "p.transpose(0, 2, 1)"),
    "[J, 3, F]": (np.moveaxis(COCO, 0, 2), "p.transpose(2, 0, 1)"),
    "[3, F, J]": (CHANNELS, "p.transpose(1, 2, 0)"),
    "[3, J, F]": (np.moveaxis(COCO, (0, 1, 2), (2, 1, 0)), "p.transpose(2, 1, 0)"),
    "[2, F, J, 3]": (np.stack([COCO, COCO * np.nan]), "p[0]"),
    "[F, J, 3, 2]": (np.stack([COCO, COCO * np.nan], axis=3), "p[..., 0]"),
}
LABELS = names("coco17")
DATES = np.datetime64("2026-05-01T12:00:00.000") + np.round(1000 * T).astype("timedelta64[ms]")
ARCHIVES: dict[str, dict[str, object]] = {
    "kpts3d": {"kpts3d": COCO, "names": LABELS, "fps": 30},
    "poses, but no parameters": {"poses": COCO, "names": LABELS, "fps": 30},
    "names as bytes": {"joints": COCO, "names": np.array(LABELS, "S"), "fps": 30},
    "sampling_rate": {"joints": COCO, "names": LABELS, "sampling_rate": 30},
    "dt": {"joints": COCO, "names": LABELS, "dt": 1 / 30},
    "a rate a frame": {"joints": COCO, "names": LABELS, "fps": np.full(len(T), 30.0)},
    "a rate as text": {"joints": COCO, "names": LABELS, "fps": "30"},
    "dates": {"joints": COCO, "names": LABELS, "times": DATES},
    "dates as texts": {"joints": COCO, "names": LABELS, "timestamps": DATES.astype(str)},
    "whole ms since 1970": {
        **{"joints": COCO, "names": LABELS, "timestamps": np.round(1e3 * (T + 1.7e9))}
    },
    "a frame twice": {
        **{"joints": np.insert(COCO, 50, COCO[50], 0), "names": LABELS},
        "times": np.insert(T, 50, T[50]),
    },
}


@pytest.mark.parametrize("shape", SHAPES)
def test_frames_joints_and_coordinates_are_read_in_this_order(shape: str, tmp_path: Path) -> None:
    array = SHAPES[shape]
    named = clip_of(tmp_path / "x.npz", npz_bytes(names=LABELS, positions=array, rate=RATE))
    nameless = clip_of(tmp_path / "x.npy", npy_bytes(array), rate=RATE, joints="coco17")
    assert largest_error(named) < 0.01
    assert largest_error(nameless) < 0.01


@pytest.mark.parametrize("shape", OTHER_SHAPES)
def test_axes_in_another_order_are_asked_for_with_the_line_that_turns_them(
    shape: str, tmp_path: Path
) -> None:
    p, line = OTHER_SHAPES[shape]
    with pytest.raises(MotionFileError, match="positions should be") as refused:
        clip_of(tmp_path / "x.npz", npz_bytes(names=LABELS, positions=p, rate=RATE))
    assert f"positions={line})" in str(refused.value)
    turned = eval(line, {"p": p})
    clip = clip_of(tmp_path / "x.npz", npz_bytes(names=LABELS, positions=turned, rate=RATE))
    assert largest_error(clip) < 0.01


def test_an_array_of_another_name_and_names_of_another_are_asked_for(tmp_path: Path) -> None:
    arrays = {"a": COCO, "b": COCO, "labels": np.array(LABELS)}
    with pytest.raises(MotionFileError, match=r"no array 'positions'.*it has a, b, labels.*savez"):
        clip_of(tmp_path / "x.npz", npz_bytes(**arrays))


@pytest.mark.parametrize("kind", ARCHIVES)
def test_arrays_are_found_by_their_names_or_their_kind(kind: str, tmp_path: Path) -> None:
    clip = clip_of(tmp_path / "x.npz", npz_bytes(**ARCHIVES[kind]))
    assert largest_error(clip) < 0.01
    assert clip.rate == pytest.approx(RATE, rel=1e-3)


@pytest.mark.parametrize("mark", [np.nan, np.inf, 0.0, -1.0, -9999.0, 1e6])
def test_marks_of_lost_joints_are_gaps(mark: float, tmp_path: Path) -> None:
    p = COCO.copy()
    p[40:46, LABELS.index("left_elbow")] = mark
    clip = clip_of(tmp_path / "x.npz", npz_bytes(names=LABELS, positions=p, rate=RATE))
    assert "bridged: left_elbow" in clip.bridged
    assert largest_error(clip) < 0.02


@pytest.mark.parametrize("third", [0.0, 1.0, np.linspace(0.4, 1, 17)])
def test_pixels_with_a_confidence_are_no_positions(third: float | Float, tmp_path: Path) -> None:
    """As they were taken in silence: a body on its side in the plane of the image."""
    p = np.stack([300 + 100 * COCO[..., 1], 400 - 100 * COCO[..., 2], 0 * COCO[..., 0]], axis=2)
    p[..., 2] = third
    data = npz_bytes(names=LABELS, positions=p, rate=RATE)
    with pytest.raises(MotionFileError, match="lie in a plane, as x, y and a confidence do: pix"):
        clip_of(tmp_path / "x.npz", data)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"positions": np.stack([COCO, COCO + 1])}, r"of one person, .*positions=p\[0\]"),
        ({"positions": COCO, "times": np.where(np.arange(len(T)) == 9, 0, T)}, "frame 10: its ti"),
    ],
)
def test_what_has_no_one_meaning_is_refused(
    arrays: dict[str, object], message: str, tmp_path: Path
) -> None:
    with pytest.raises(MotionFileError, match=message):
        clip_of(tmp_path / "x.npz", npz_bytes(**{"names": LABELS, **arrays}))


def test_names_that_are_python_objects_are_not_read(tmp_path: Path) -> None:
    data = npz_bytes(names=np.array(LABELS, object), positions=COCO, rate=RATE)
    with pytest.raises(MotionFileError, match=r"np\.savez\(OUT, names=\[str\(n\)"):
        clip_of(tmp_path / "x.npz", data)


FACE = [LABELS.index(name) for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]


@pytest.mark.parametrize(
    ("lost", "until"),
    [(FACE[3:4], 60), (FACE[3:4], None), (FACE[1:], 60), (FACE[1:], None), (FACE, None)],
)
def test_a_head_is_made_of_what_is_seen(lost: list[int], until: int | None, tmp_path: Path) -> None:
    """From the side a camera does not see the far ear; who walks away has no face."""
    p = COCO.copy()
    p[:until, lost] = np.nan
    clip = clip_of(tmp_path / "x.npz", npz_bytes(names=LABELS, positions=p, rate=RATE))
    assert largest_error(clip) < (0.12 if len(lost) > 1 else 0.02)  # a nose is 11 cm ahead
    assert not clip.lost
    assert any("no head" in remark for remark in clip.remarks) == (len(lost) == len(FACE))
    assert any("a nose only" in remark for remark in clip.remarks) == (lost == FACE[1:])


def test_a_pose_without_a_head_has_one_above_the_shoulders(tmp_path: Path) -> None:
    data = npz_bytes(names=LABELS[5:], positions=COCO[:, 5:], rate=RATE)
    clip = clip_of(tmp_path / "x.npz", data)
    assert largest_error(clip) < 0.03
    assert "no head" in clip.remarks[0]


ELBOW = LABELS.index("left_elbow")
SWAPPED = [0, *(n + (1 if n % 2 else -1) for n in range(1, 17))]  # left_eye, right_eye, ...


@pytest.mark.parametrize("part", ["all", "legs", "from the start"])
def test_sides_that_are_exchanged_for_some_frames_are_a_jump(part: str, tmp_path: Path) -> None:
    p = COCO.copy()
    rows = slice(0, 20) if part == "from the start" else slice(60, 67)
    swapped = p[rows][:, SWAPPED]
    first = LABELS.index("left_hip") if part == "legs" else 0
    p[rows, first:] = swapped[:, first:]
    clip = clip_of(tmp_path / "x.npz", npz_bytes(names=LABELS, positions=p, rate=RATE))
    with pytest.raises(MotionFileError, match=r"jumps .*, as nobody moves; .*\(--section "):
        require_complete(clip, 0.0, clip.seconds)
    require_complete(clip, rows.stop / RATE + 0.2, clip.seconds)


MARS = joint_set_errors.poses_of(JOINT_SETS["mars19"], WALKER)
LABELS_57 = np.swapaxes(MARS, 1, 2).reshape(len(MARS), 57)
# {kind: (suffix, bytes of columns [frames, 57] by axis)}
BY_AXIS = {
    "npy": (".npy", npy_bytes(LABELS_57.astype(np.float32))),
    "npz": (".npz", npz_bytes(arr_0=LABELS_57)),
    "npz under another name": (".npz", npz_bytes(labels=LABELS_57, notes=np.zeros(5))),
    "csv": (".csv", "\n".join(",".join(map(str, r)) for r in LABELS_57.tolist()).encode()),
    "txt": (".txt", "\n".join(" ".join(map(str, r)) for r in LABELS_57.tolist()).encode()),
    "csv of pandas": (
        ".csv",
        "\n".join(
            [
                ",".join(["", *map(str, range(57))]),
                *(",".join(map(str, [n, *r])) for n, r in enumerate(LABELS_57.tolist())),
            ]
        ).encode(),
    ),
}


@pytest.mark.parametrize("kind", BY_AXIS)
def test_all_x_then_all_y_then_all_z(kind: str, tmp_path: Path) -> None:
    """The labels of MARS, as our own conversion writes them."""
    suffix, data = BY_AXIS[kind]
    clip = clip_of(tmp_path / f"x{suffix}", data, rate=RATE, joints="mars19")
    assert largest_error(clip) < 0.01
    assert clip.remarks[0] == "its columns are all x, then all y, then all z"
    with pytest.raises(MotionFileError, match=r"19 joints without names; .*\(--joints mars19"):
        clip_of(tmp_path / f"x{suffix}", data, rate=RATE)


HEADINGS = ["{}_{}", "{} {}", "{}.{}", "{}:{}", "{}({})", "{}[{}]", "{}_pos_{}", "{}_position_{}"]


@pytest.mark.parametrize("heading", [*HEADINGS, "{}_{} [mm]", "{}_{}_mm"])
def test_columns_are_named_in_other_ways(heading: str, tmp_path: Path) -> None:
    unit = 1000 if "mm" in heading else 1
    text = "# made by a camera\n" + csv_text(unit * COCO, LABELS, heading)
    assert largest_error(clip_of(tmp_path / "x.csv", text.encode())) < 0.01


@pytest.mark.parametrize("word", ["visibility", "confidence", "v", "score"])
def test_a_column_of_confidence_says_what_is_lost(word: str, tmp_path: Path) -> None:
    p, certain = COCO.copy(), np.ones(COCO.shape[:2])
    p[40:46, ELBOW] += 0.3
    certain[40:46, ELBOW] = 0
    head = ["time", *(f"{name}_{axis}" for name in LABELS for axis in ("x", "y", "z", word))]
    cells = np.concatenate([p, certain[..., None]], axis=2).reshape(len(p), -1)
    rows = [[t, *row] for t, row in zip(T.tolist(), cells.tolist(), strict=True)]
    text = "\n".join(",".join(map(str, row)) for row in [head, *rows])
    clip = clip_of(tmp_path / "x.csv", text.encode())
    assert "bridged: left_elbow" in clip.bridged
    assert largest_error(clip) < 0.02
    frames = [
        [
            {"name": n, "x": x, "y": y, "z": z, word: c}
            for n, (x, y, z), c in zip(LABELS, body, sure, strict=True)
        ]
        for body, sure in zip(p.tolist(), certain.tolist(), strict=True)
    ]
    if word != "v":
        document = {"fps": RATE, "frames": frames}
        clip = clip_of(tmp_path / "x.json", json.dumps(document).encode())
        assert "bridged: left_elbow" in clip.bridged


def test_frames_of_panoptic_are_read_as_a_list(tmp_path: Path) -> None:
    p = 100 * camera(joint_set_errors.poses_of(JOINT_SETS["panoptic19"], WALKER))
    rows = np.concatenate([p, np.ones((*p.shape[:2], 1))], axis=2).reshape(len(p), -1)
    frames = [
        {"univTime": 1000 * t + 5e4, "bodies": [{"id": 0, "joints19": row}]}
        for t, row in zip(T.tolist(), rows.tolist(), strict=True)
    ]
    clip = clip_of(tmp_path / "x.json", json.dumps(frames).encode())
    assert largest_error(clip) < 0.01
    with pytest.raises(MotionFileError, match=r"one frame of several; .*json\.dump\(frames"):
        clip_of(tmp_path / "y.json", json.dumps(frames[0]).encode())
