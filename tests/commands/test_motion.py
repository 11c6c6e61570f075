"""`radhar motion` and `radhar simulate --motion`: our motions out, anyone's in."""

import json

import h5py
import numpy as np
import pytest
from helpers.command_line import ROOT, ok, radhar
from helpers.poses import BLAZE
from helpers.recorded import frames, write_npz
from helpers.slow import slow_but

from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.recorded.clip import make_clip
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.readers.motion.reading import read_motion

SMALL = """
duration_s: 1.5
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 200}
motion: {range_m: 3, angle_deg: 0}
subject: {height_m: 1.75, chest_m: 0, heart_m: 0}
classes: {wave: {files: [theirs.npz], up: z, joints: {right_knee: Knie}}}
"""


def test_a_motion_is_exported_and_read_back(tmp_path):
    path, bvh = tmp_path / "x.yaml", tmp_path / "kick.bvh"
    names = [n if n != "right_knee" else "Knie" for n in WANTED]
    write_npz(tmp_path / "theirs.npz", frames("punching", 2.0, 60.0), 60.0, names)
    path.write_text(SMALL)
    common = [path, "--activity", "kicking", "--nominal"]
    done = radhar("motion", *common, "-o", bvh, "--rate", 200)
    assert (done.returncode, done.stderr) == (0, "")
    assert f"{bvh}: 301 frames, 200 per second" in done.stdout
    again = radhar("motion", *common, "-o", bvh)
    assert (again.returncode, again.stderr) == (
        *(2, f"radhar: {bvh}: already exists; --overwrite replaces it\n"),
    )
    assert "Frames: 301" in bvh.read_text()
    scale = make_clip(read_motion(bvh).recording()).stature
    shown = ["--no-figures", "--maps", "stft", "-o"]
    radhar("simulate", *common, *shown, tmp_path / "a")
    done = ok(
        *("simulate", path, "--motion", bvh, "--nominal", *shown, tmp_path / "b"),
        *("--set", f"subject.height_m={scale}", "--set", "classes.from_file.low_pass_hz=null"),
    )
    assert "leg length of a person of 1.75 m" in done.stdout
    with h5py.File(tmp_path / "a/scene.h5") as a, h5py.File(tmp_path / "b/scene.h5") as b:
        p, q = a["truth/positions"][:], b["truth/positions"][:]
    shift = (p - q).mean(axis=(0, 1))
    found = np.abs(p - q - shift)[..., 2].max()
    assert found < 1e-3


@pytest.mark.every(3)
@pytest.mark.parametrize(
    "activity",
    slow_but([one.slug for one in ACTIVITIES], ("stationary", "walking", "walking_to_falling")),
)
def test_our_own_motion_of_the_demo_can_be_simulated(tmp_path, activity):
    """People come towards the radar: they start far enough away, or elsewhere."""
    path, bvh = ROOT / "configs/quickstart.yaml", tmp_path / "w.bvh"
    done = ok("motion", path, "--activity", activity, "-o", bvh)
    shown = ["--no-figures", "--maps", "stft"]
    done = radhar("simulate", path, "--motion", bvh, *shown, "-o", tmp_path / "scene")
    assert (done.returncode, done.stderr) == (0, "")


def test_simulate_motion_uses_the_joint_names_of_a_class(tmp_path):
    path = tmp_path / "x.yaml"
    names = [n if n != "right_knee" else "Knie" for n in WANTED]
    write_npz(tmp_path / "theirs.npz", frames("punching", 2.0, 60.0), 60.0, names)
    path.write_text(SMALL)
    look = ["simulate", path, "--motion", tmp_path / "theirs.npz", "--no-figures", "--maps", "stft"]
    done = radhar(*look, "-o", tmp_path / "a")
    assert done.returncode == 2
    assert "no joint that is right_knee by its name" in done.stderr
    done = ok(*look, "-o", tmp_path / "a", "--activity", "wave")


def test_options_say_what_a_motion_file_does_not(tmp_path):
    """`--up` and `--joints` stand for keys of the class, and messages name the option."""
    config, path, names = tmp_path / "c.yaml", tmp_path / "x.npz", [*WANTED]
    config.write_text("duration_s: 1\nradar: {prf_hz: 500}\nmotion: {range_m: 6}\nmaps: [stft]\n")
    names[WANTED.index("right_knee")] = "Knie"
    write_npz(path, frames("punching", 1.2), names=names)
    (tmp_path / "ours.yaml").write_text("right_knee: Knie\n")
    (tmp_path / "wrong.yaml").write_text("knee: Knie\n")
    play = ["simulate", config, "--no-figures", "-o", tmp_path / "out", "--motion", path]
    done = ok(*play, "--joints", tmp_path / "ours.yaml", "--up", "z")
    assert "; z is up, a unit is 1 m, 120 frames/s; " in done.stdout
    refused = {
        (): "no joint that is right_knee by its name",
        ("--joints", tmp_path / "ours.yaml"): "(--up z)",
        ("--joints", tmp_path / "ours.yaml", "--up", "z", "--left-handed"): "without --left-handed",
        ("--joints", tmp_path / "wrong.yaml"): "--joints =",
        ("--up", "w"): "--up = ",
        ("--skeleton", "x.asf"): "--skeleton = ",
    }
    for words, message in refused.items():
        done = radhar(*play, *words, "--overwrite")
        assert done.returncode == 2
        assert message in done.stderr
    alone = radhar("simulate", config, "-o", tmp_path / "out", "--up", "y")
    assert (alone.returncode, alone.stderr) == (
        *(2, "radhar: --up y: should go with --motion, whose file it reads\n"),
    )


def test_poses_without_names_or_a_rate_need_options_that_messages_name(tmp_path):
    config, path = tmp_path / "c.yaml", tmp_path / "x.npy"
    config.write_text("duration_s: 1\nradar: {prf_hz: 500}\nmotion: {range_m: 6}\nmaps: [stft]\n")
    poses = BLAZE.copy()
    poses[60:63, 0] = 0  # the nose, which is not needed
    poses[20:24, 13] = np.nan
    np.save(path, poses - poses[:, [23, 24]].mean(axis=1, keepdims=True))
    play = ["simulate", config, "--no-figures", "-o", tmp_path / "out", "--motion", path]
    told = ("--rate", 30, "--joints", "blazepose33")
    refused = {
        (): "has 33 joints without names; sets of so many are blazepose33 (BlazePose, MediaPipe)",
        ("--joints", "blazepose33"): "should have a frame rate of 1 to 10000 Hz: rate_hz of its "
        "class (--rate HZ)",
        ("--rate", 30, "--joints", "coco18"): "did you mean 'coco17'?",
        ("--rate", 30, "--joints", "coco17"): "has 33 joints; coco17 (COCO) has 17",
        ("--rate", 30, "--travel", "hands"): "--travel = ",
        ("--rate", 30, "--section", "3"): "--section 3: should be FROM,TO",
        (*told, "--unit", 5): "those of a person of 8.75 m in 5 m",
    }
    for words, message in refused.items():
        done = radhar(*play, *words, "--overwrite")
        assert (done.returncode, "classes." in done.stderr) == (2, False)
        assert message in done.stderr
    done = ok(*play, *told, "--up", "z", "--section", "0.5,3.5")
    warnings = done.stderr.splitlines()
    assert any("marches on the spot" in line for line in warnings)
    assert any("1 gap of up to 0.5 s, 4 frames" in line for line in warnings)
    assert "0.50 to 1.50 s of its" in done.stdout
    done = ok(*play, *told, "--up", "z", "--travel", "feet", "--overwrite")
    assert "marches" not in done.stderr


def test_simulate_says_which_part_of_a_file_is_repeated_and_where_it_starts(tmp_path):
    write_npz(tmp_path / "wave.npz", frames("punching", 2.0, 60.0), 60.0, [*WANTED])
    (tmp_path / "x.yaml").write_text(
        "duration_s: 6\nradar: {prf_hz: 500}\nmaps: [stft]\nmotion: {range_m: 6}\n"
        "classes: {wave: {files: [wave.npz], up: z, past_end: loop, start: 1}}\n"
        "activities: [wave]\n"
    )
    done = ok("simulate", tmp_path / "x.yaml", "--no-figures", "-o", tmp_path / "out")
    file = json.loads((tmp_path / "out/scene.json").read_text())["motion_file"]
    assert file["loops"]
    assert 0 <= file["begin_s"] < file["start_s"] < file["end_s"] <= file["lasts_s"]
    assert f"in a loop that starts at {file['start_s']:.2f} s" in done.stdout
