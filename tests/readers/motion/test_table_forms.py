"""Tables that laboratories and cameras export: joints of a known walker come back from each."""

from datetime import datetime, timedelta
from pathlib import Path

import joint_set_errors
import numpy as np
import pytest
from helpers.poses import COCO, RATE, WALKER, answered_clip, clip_of, csv_text, joint_errors, names
from helpers.tables import TABLES, motive, two_lines, vicon
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.errors import MotionFileError
from radhar_cli.files.plain_text import decode_text
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.readers.motion.text_tables import read_table

SETS = ("coco17", "openpose25", "h36m17", "kinect2_25", "smpl24", "blazepose33", "azure32")


@pytest.mark.every(4)
@pytest.mark.parametrize("form", TABLES)
@pytest.mark.parametrize("key", SETS)
def test_the_walker_comes_back_from_every_table(form: str, key: str, tmp_path: Path) -> None:
    suffix, write = TABLES[form]
    p = joint_set_errors.poses_of(JOINT_SETS[key], WALKER)
    clip = clip_of(tmp_path / f"x{suffix}", write(p, names(key)))
    errors = joint_errors(clip)
    assert errors.mean() < 0.03
    assert errors.max() < 0.07
    assert clip.rate == pytest.approx(RATE, rel=2e-3)
    assert clip.remarks == ()
    assert not clip.bridged


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ("frame,landmark,x,y\n0,nose,1,2\n", "joints have x and y, but no z: pixels"),
        (",a,,b,\nF,X,Y,X,Y\n0,1,2,3,4\n", "X and Y, without Z: pixels"),
        ("scorer\n,,,\nF,X,Y,Z,X,Y,Z\n0,1,2,3,4,5,6\n", r"x\.csv:3: has X, Y, Z; a line above"),
        ("some words\n1,2,3,4,5,6\n", r"x\.csv:2: has numbers; a line above them should name"),
        ("frame,joint,x,y,z\n0,nose,1,2,q\n", r"x\.csv:2: 'q' should be a number"),
        ("id,joint,x,y,z\n1,a,0,0,0\n2,a,0,0,0\n", "has 2 people; should be one: keep the rows"),
    ],
)
def test_what_is_odd_is_said_with_its_line(data: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(MotionFileError, match=message):
        clip_of(tmp_path / "x.csv", data.encode())


def test_joints_that_a_row_calls_lost_are_gaps(tmp_path: Path) -> None:
    text = TABLES["long of a recorder"][1](COCO, names("coco17")).decode().splitlines()
    for frame in range(40, 46):
        row = 1 + 17 * frame + names("coco17").index("left_elbow")
        text[row] = text[row].replace("Tracked", "NotTracked")
    del text[1 + 17 * 60 + names("coco17").index("left_knee")]
    clip = clip_of(tmp_path / "x.csv", "\n".join(text).encode())
    assert clip.bridged.startswith("2 gaps of up to 0.5 s, 7 frames")
    assert "left_elbow, left_knee" in clip.bridged


def test_encodings(tmp_path: Path) -> None:
    text = csv_text(COCO, names("coco17"))
    expected = clip_of(tmp_path / "x.csv", text.encode()).positions
    for encoding in ("utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"):
        assert (clip_of(tmp_path / "x.csv", text.encode(encoding)).positions == expected).all()


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
def test_names_keep_their_letters(encoding: str) -> None:
    data = "Schulter_für_x,Schulter_für_y,Schulter_für_z\n1,2,3\n".encode(encoding)
    assert "Schulter_für_y" in decode_text(data)


@pytest.mark.parametrize(
    "begin", ["01/05/2026 23:59:59.900", "27/10/2026 11:59:59.900", "2026-05-01 23:59:59.900"]
)
def test_dates_of_frames_pass_midnight(tmp_path: Path, begin: str) -> None:
    lines = csv_text(COCO, names("coco17")).splitlines()
    form = "%Y-%m-%d %H:%M:%S.%f" if begin[4] == "-" else "%d/%m/%Y %H:%M:%S.%f"
    first = datetime.strptime(begin, form)
    dated = [
        f"{(first + timedelta(seconds=n / RATE)).strftime(form)},{row.partition(',')[2]}"
        for n, row in enumerate(lines[1:])
    ]
    clip = clip_of(tmp_path / "x.csv", "\n".join([lines[0], *dated]).encode())
    assert clip.rate == pytest.approx(RATE, rel=2e-3)


def test_only_pixels_of_a_two_line_table(tmp_path: Path) -> None:
    data = two_lines(COCO, names("coco17")).replace(b",Z", b",C")
    with pytest.raises(MotionFileError, match="pixels of an image"):
        clip_of(tmp_path / "x.csv", data)


BONES = "Hip:hip Chest:torso Head:head LShoulder:leftcollar LUArm:left_shoulder LFArm:left_elbow"
BONES += " LHand:left_hand RShoulder:rightcollar RUArm:right_shoulder RFArm:right_elbow"
BONES += " RHand:right_hand LThigh:left_hip_joint LShin:left_knee LFoot:left_ankle"
BONES += " RThigh:right_hip_joint RShin:right_knee RFoot:right_ankle"


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("empty", [True, False])
@pytest.mark.parametrize("label", ["ID", ""])
def test_bones_of_optitrack(label: str, empty: bool, separator: str, tmp_path: Path) -> None:
    """A bone is where it begins: the end that is nearer the trunk."""
    pairs = [pair.split(":") for pair in BONES.split()]
    collars = {
        f"{side}collar": WALKER[:, [WANTED.index(f"{side}_shoulder"), 0]].mean(axis=1)
        for side in ("left", "right")
    }
    p = np.stack(
        [collars[j] if j in collars else WALKER[:, WANTED.index(j)] for _, j in pairs], axis=1
    )
    text = motive(p, [name for name, _ in pairs], numbered=True).decode()
    text = text.replace(",ID,", f",{label},").replace(",", separator)
    clip = clip_of(tmp_path / "x.csv", (text if empty else text.replace("\n\n", "\n")).encode())
    assert joint_errors(clip).max() < 0.01
    assert clip.up == "y"


OUTPUTS = """Model Outputs
100
,,P1:CentreOfMass,,,P1:LKneeAngles,,
Frame,Sub Frame,X,Y,Z,X,Y,Z
,,mm,mm,mm,deg,deg,deg
1,0,5289.91,-1028.32,968.49,20.00,0.00,0.00
2,0,5239.17,-1010.22,960.86,21.99,0.00,0.00
"""
DEVICES = "Devices\n1000\n,,Force,,\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n1,0,0,0,1\n\n"


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize(
    "text", [OUTPUTS, DEVICES + OUTPUTS, OUTPUTS.replace("puts\n", "puts,,\n")]
)
def test_nexus_without_trajectories_is_told_to_export_them(
    text: str, separator: str, tmp_path: Path
) -> None:
    data = text.replace(",", separator).encode()
    with pytest.raises(MotionFileError, match=r"x\.csv: has .*Model Outputs.* export Trajectories"):
        clip_of(tmp_path / "x.csv", data)


def test_parts_of_nexus_around_trajectories_are_left_out(tmp_path: Path) -> None:
    text = vicon(COCO, names("coco17")).decode() + "\n" + OUTPUTS
    clip = clip_of(tmp_path / "x.csv", text.encode())
    assert joint_errors(clip).max() < 0.01


WORDS = ["", "Title", "Joints", "Trajectories", "Frame", "time", "X", "Y", "Z", "nose_x", "nose_y"]
WORDS += ["nose_z", "joint", "id", "MARKER_NAMES", "Name", "ID", "1", "-2.5", "nan", "12:00:00.1"]
WORDS += ["#", "mm", "fps: 30", "Rotation", "x", "y", "z", "x1", "y1", "z1", "x2", "y2"]
LINES = st.lists(st.sampled_from(WORDS), max_size=9) | st.lists(
    st.floats(-2, 2).map("{:.3f}".format), max_size=9
)


@given(lines=st.lists(LINES, max_size=9), separator=st.sampled_from([",", ";", "\t", " "]))
def test_no_table_ends_in_a_traceback(lines: list[list[str]], separator: str) -> None:
    text = "\n".join(separator.join(line) for line in [*lines, ["1.5"] * 6, ["2.5"] * 6])
    try:
        answered_clip(read_table(text.encode(), "x.csv"))
    except MotionFileError as refused:
        assert str(refused).startswith("x.csv")  # noqa: PT017
