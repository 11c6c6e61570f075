"""`classes` with files: found from the config's folder, in order, with checksums."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from helpers.recorded import frames, write_bvh, write_npz

from radhar_cli.config import Config, load_config, resolved
from radhar_cli.config.identity import config_hash, flat_document
from radhar_cli.errors import ConfigError, MotionFileError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.recorded.clip import make_clip
from radhar_cli.motion.recorded.keypoints import make_keypoints
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.scene.motion_files import file_motion
from radhar_cli.scene.scene import draw_scene, nominal_scene

TEXT = """
duration_s: 0.5
motion: {model: file}
classes:
  walking: [walk/*.bvh]
  my_class: [b.npz, walk/0.bvh]
"""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    p = frames(seconds=0.5)
    for name in ("2", "0", "1"):
        write_bvh(tmp_path / f"walk/{name}.bvh", p[int(name) :])
    write_npz(tmp_path / "b.npz", p)
    (tmp_path / "x.yaml").write_text(TEXT)
    return tmp_path


def files(config: Config, slug: str) -> list[str]:
    return [*config.model_dump()["classes"][slug]["files"]]


def test_patterns_become_sorted_paths_with_checksums(place: Path) -> None:
    config = load_config(place / "x.yaml")
    assert files(config, "walking") == ["walk/0.bvh", "walk/1.bvh", "walk/2.bvh"]
    assert files(config, "my_class") == ["b.npz", "walk/0.bvh"]
    assert [(a.label, a.slug) for a in config.chosen_activities] == [
        ("S8", "walking"),
        ("S13", "my_class"),
    ]
    keys = flat_document(resolved(config))
    assert len(keys["classes.walking.files.walk/0.bvh"]) == 64
    assert not any("folder" in key for key in keys)


def test_a_key_of_a_class_that_is_a_list_of_files_can_be_set(place: Path) -> None:
    config = load_config(place / "x.yaml", ["classes.walking.mirror=0"])
    assert files(config, "walking") == files(load_config(place / "x.yaml"), "walking")
    assert config.model_dump()["classes"]["walking"]["mirror"] == 0


def test_folders_of_motion_files_are_no_part_of_a_config(place: Path) -> None:
    here = load_config(place / "x.yaml")
    shutil.copytree(place, place / "elsewhere")
    assert resolved(load_config(place / "elsewhere/x.yaml")) == resolved(here)
    (place / "elsewhere/x.yaml").rename(place / "y.yaml")
    named = load_config(place / "y.yaml", ["motion.folder=elsewhere"])
    assert resolved(named) == resolved(here)
    assert config_hash(named) == config_hash(here)
    stored = Config.model_validate(json.loads(json.dumps(resolved(here))))
    assert resolved(stored) == resolved(here)
    scene = nominal_scene(stored, stored.chosen_activities[0])
    with pytest.raises(MotionFileError, match=r"walk/1\.bvh: where the files .*motion\.folder"):
        file_motion(scene.people[0])


def test_another_file_of_the_same_name_is_another_data_set(place: Path) -> None:
    config = load_config(place / "x.yaml")
    scene = nominal_scene(config, config.chosen_activities[0])
    file_motion(scene.people[0])
    known = config.model_dump()["classes"]["walking"]["files"]
    (place / "walk/1.bvh").write_bytes((place / "walk/2.bvh").read_bytes())
    assert config_hash(load_config(place / "x.yaml")) != config_hash(config)
    text = f"classes: {{walking: {{files: {json.dumps(known)}}}}}\n"
    (place / "known.yaml").write_text(text)
    with pytest.raises(ConfigError, match=r"known\.yaml:1: classes\.walking\.files.*walk/1\.bvh"):
        load_config(place / "known.yaml")
    mine = config.chosen_activities[1]
    scenes = (draw_scene(config, mine, index) for index in range(50))
    changed = next(s for s in scenes if s.config.model_dump()["classes"]["my_class"]["file"] == 1)
    text_of = place / "walk/0.bvh"
    text_of.write_text(text_of.read_text() + "\n")
    with pytest.raises(MotionFileError, match=r"0\.bvh: is not the file it was"):
        file_motion(changed.people[0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("classes: {wave: [no/*.bvh]}", "classes.wave.files = .*there are none like it in"),
        ("classes: {wave: [no.bvh]}", r"classes\.wave\.files = .*no\.bvh: cannot be read"),
        (
            "classes: {wave: [x.yaml]}",
            r"x\.yaml: should be paths of \.bvh, .* three lines",
        ),
        ("classes: {wave: [../../../etc/passwd]}", "should be paths of"),
        ("classes: {wave: []}", "should have 1 to 1500 files"),
        ("classes: {wave: {files: [b.npz], joints: {knee: x}}}", "did you mean"),
        ("classes: {wave: {files: [b.npz], joints: {head: -1}}}", "its number from 0 where"),
        ("classes: {wave: {files: [b.npz], joints: {head: 1.5}}}", "head should be the name of"),
        (
            "classes: {wave: {files: [b.npz], joints: {hip: [1, true]}}}",
            "hip should be the name of",
        ),
        ("classes: {wave: {files: [b.npz], up: w}}", "classes.wave.up"),
        ("classes: {wave: {files: [b.npz], start: 2}}", "should be from 0 to 1"),
        (
            "classes: {wave: {files: [b.npz], skeleton: b.asf}}",
            "should have .amc files",
        ),
        ("classes: {wave: {files: [b.amc], skeleton: b.txt}}", "should have an .asf file as skel"),
        ("classes: {wave: {files: [b.npz], past_end: velocity}}", "should be 'rest' or 'loop'"),
        ("classes: {wave: {files: [b.npz], section_s: [2, 1]}}", "begins before it ends"),
        ("classes: {wave: {files: [b.npz], file: 1}}", "should have a file below 1"),
        ("classes: {wave: {files: [b.npz], speed: 2}}", "classes.wave.speed.*unknown key"),
        ("classes: {Wave: [b.npz]}", "should have a new name of a-z"),
        ("classes: {walking: {sequence: [walking]}}", "should have a new name of a-z"),
        ("motion: {model: file}", "should have files of each class"),
        ("motion: {model: file}\nactivities: [walking]", "should have files of it under classes"),
        (
            "motion: {model: file}\nclasses: {w: [b.npz], home: {sequence: [walking]}}",
            "classes.home.*should have files with motion.model: file",
        ),
        (
            "motion: {model: paper}\nclasses: {home: {sequence: [walking]}}",
            "classes.home.*should have files with motion.model: paper",
        ),
    ],
)
def test_wrong_classes_are_refused_in_one_line(text: str, message: str, place: Path) -> None:
    path = place / "wrong.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=message) as refused:
        load_config(path)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)


def test_file_classes_work_with_any_model(place: Path) -> None:
    """All of the twelve and the files' classes with a model; with `file`, those of the files."""
    for model, count in (("human", 13), ("paper", 13), ("file", 2)):
        config = load_config(place / "x.yaml", [f"motion.model={model}"])
        assert len(config.chosen_activities) == count
    human = load_config(place / "x.yaml", ["motion.model=human"])
    numbers = {a.slug: a for a in human.chosen_activities}
    assert numbers["walking"].index == activity_named("walking").index
    assert numbers["walking"].movements == ()
    assert numbers["my_class"].index == 12


def test_every_number_of_a_file_class_is_drawn_and_fixed(place: Path) -> None:
    config = load_config(place / "x.yaml")
    walking = config.chosen_activities[0]
    scenes = [draw_scene(config, walking, index) for index in range(30)]
    drawn = [scene.config.model_dump()["classes"]["walking"] for scene in scenes]
    assert {one["file"] for one in drawn} == {0, 1, 2}
    assert {one["mirror"] for one in drawn} == {0, 1}
    assert len({one["start"] for one in drawn}) == 30
    assert all(0.9 <= one["playback_speed"] <= 1.1 for one in drawn)
    nominal = nominal_scene(config, walking).config.model_dump()["classes"]["walking"]
    assert (nominal["file"], nominal["mirror"], nominal["playback_speed"]) == (1, 0, 1.0)


def test_persons_do_not_share_files(place: Path) -> None:
    """Where there are enough of them: nothing of a file is learned from and tested on."""
    text = TEXT + "samples_per_class: 8\nsplit: {by: subject, subjects: 2, train: 0.5,"
    (place / "x.yaml").write_text(text + " validation: 0.5}\n")
    config = load_config(place / "x.yaml")
    used: dict[int | None, set[int]] = {0: set(), 1: set()}
    for index in range(40):
        scene = draw_scene(config, config.chosen_activities[0], index)
        used[scene.subject].add(scene.config.model_dump()["classes"]["walking"]["file"])
    assert used == {0: {0, 2}, 1: {1}}


def test_a_folder_of_frames_is_a_file_of_a_class(tmp_path: Path) -> None:
    folder = tmp_path / "openpose.out"
    folder.mkdir()
    for n in range(3):
        (folder / f"{n}_keypoints.json").write_text("[]")
    config = tmp_path / "config.yaml"
    config.write_text("classes: {wave: {files: [openpose.out/]}}\nactivities: [wave, walking]\n")
    stored = load_config(config).model_dump()["classes"]["wave"]["files"]
    assert [*stored] == ["openpose.out/"]
    assert len(stored["openpose.out/"]) == 64
    config.write_text("classes: {wave: {files: [openpose.out]}}\nactivities: [wave, walking]\n")
    with pytest.raises(ConfigError, match="or FOLDER/ of JSON"):
        load_config(config)


def test_joints_without_names_are_known_by_their_numbers(tmp_path: Path) -> None:
    """As the refusal of a file whose order is unknown asks for them: alone and in lists."""
    p = frames(seconds=3.0, rate=30.0)[:, ::-1]
    np.savez(tmp_path / "x.npz", positions=p, rate=30.0)
    places = {name: len(WANTED) - 1 - n for n, name in enumerate(WANTED)}
    places["hip"] = [places["right_hip_joint"], places["left_hip_joint"]]
    for numbers in (places, {name: as_texts(place) for name, place in places.items()}):
        document = {
            "duration_s": 1,
            "classes": {"wave": {"files": ["x.npz"], "up": "z", "joints": numbers}},
            "activities": ["wave"],
        }
        (tmp_path / "x.yaml").write_text(json.dumps(document))
        config = load_config(tmp_path / "x.yaml")
        joints = config.model_dump()["classes"]["wave"]["joints"]
        assert joints["head"] == str(places["head"])
        assert list(joints["hip"]) == [str(place) for place in places["hip"]]
        scene = draw_scene(config, config.chosen_activities[0], 0)
        clip = file_motion(scene.people[0]).clip
        own = make_clip(make_keypoints("x", WANTED, p[:, ::-1], 30.0), up="z")
        assert np.abs(clip.positions - own.positions).max() < 0.01


def as_texts(place: int | list[int]) -> str | list[str]:
    return [str(one) for one in place] if isinstance(place, list) else str(place)
