"""Several people in a scene: how they are drawn, that they keep apart, and who hides whom."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.boards import CFG
from helpers.command_line import radhar
from helpers.listener import Listener
from helpers.small import fingerprint, full_disk_after, small_config

from radhar_cli import open_dataset, simulate
from radhar_cli.config import Config, load_config
from radhar_cli.config.checks.unused_keys import unused_keys
from radhar_cli.config.identity import resolved
from radhar_cli.dataset.build import build
from radhar_cli.dataset.table import entries
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, draw_scene

WALKING = activity_named("walking")
RADAR = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 1000}
PUNCHER = {"activity": "punching", "motion": {"range_m": 3.0}}
ANYBODY = {"activity": {"choice": ["walking", "grabbing"]}, "share": 0.5}


def config(*people: Mapping[str, Any], **more: Any) -> Config:
    document = {"radar": RADAR, "activities": ["walking"], "duration_s": 2, "people": [*people]}
    return Config.model_validate(document | more)


def own(scene: Scene) -> dict[str, Any]:
    """Numbers of a scene's first person; the range that images show is everybody's."""
    return {**resolved(scene.config), "people": [], "image": None}


def test_another_person_changes_nobody_else() -> None:
    alone, crowd = config(), config(PUNCHER, ANYBODY)
    for index in range(5):
        assert own(draw_scene(alone, WALKING, index)) == own(draw_scene(crowd, WALKING, index))
        first = draw_scene(config(PUNCHER), WALKING, index).people[1]
        again = draw_scene(crowd, WALKING, index).people[1]
        assert first.config.motion == again.config.motion
        assert first.config.subject == again.config.subject


def test_everybody_is_drawn_for_themselves() -> None:
    people = draw_scene(config(PUNCHER, PUNCHER), WALKING, 0).people
    assert [one.activity.slug for one in people] == ["walking", "punching", "punching"]
    assert len({one.subject.height_m for one in people}) == 3
    assert [one.motion.range_m for one in people[1:]] == [3, 3]
    across = {one.place[1] for one in people}
    assert len(across) == 3
    assert max(map(abs, across)) <= 1.5
    assert len({motion_of(one).positions(np.ones(1)).tobytes() for one in people}) == 3


def test_shares_and_choices() -> None:
    there = [draw_scene(config(ANYBODY), WALKING, index).people[1:] for index in range(200)]
    assert 70 < sum(map(bool, there)) < 130
    doing = [one.activity.slug for people in there for one in people]
    assert set(doing) == {"walking", "grabbing"}
    assert 0.3 < doing.count("walking") / len(doing) < 0.7


def test_a_scenes_config_gives_the_scene_again() -> None:
    crowd = config(ANYBODY, PUNCHER)  # the first is away in some
    for index in range(6):
        scene, _ = draw_valid_scene(crowd, WALKING, index)
        again = Config.model_validate(resolved(scene.config))
        redrawn, _ = draw_valid_scene(again, WALKING, index)
        assert resolved(redrawn.config) == resolved(scene.config)
        assert [one.number for one in redrawn.people] == [one.number for one in scene.people]


def test_people_keep_half_a_metre_apart() -> None:
    near = {"activity": "walking", "motion": {"range_m": {"uniform": [9, 11]}}}
    crowd = config(near, near, motion={"range_m": {"uniform": [9, 11]}}, duration_s=4)
    redrawn = 0
    for index in range(6):
        scene, _ = draw_valid_scene(crowd, WALKING, index)
        redrawn += own(scene) == own(draw_scene(crowd, WALKING, index)) and resolved(
            scene.config
        ) != resolved(draw_scene(crowd, WALKING, index).config)
        t = np.arange(0, 4, 0.02)
        torsos = [motion_of(one).torso(t)[:2, 0] for one in scene.people]
        for a in range(3):
            for b in range(a):
                assert np.hypot(*(torsos[a] - torsos[b])).min() >= 0.49
    assert redrawn


def test_who_is_drawn_again_moves_nobody_else() -> None:
    """Half of the far ones leave the half-band of 30 m and are drawn again, alone."""
    far = {"activity": "punching", "motion": {"range_m": {"uniform": [5, 60]}}}
    near = {"activity": "punching", "motion": {"range_m": {"uniform": [4, 6]}}}
    redrawn = 0
    for index in range(6):
        scenes = [
            draw_valid_scene(config(*people, motion={"range_m": 8}), WALKING, index)[0]
            for people in ((), (far,), (near,), (near, far))
        ]
        assert len({str(own(scene)) for scene in scenes}) == 1
        alone, crowd = scenes[2].people[1], scenes[3].people[1]
        assert alone.config.motion == crowd.config.motion
        first = draw_scene(config(far, motion={"range_m": 8}), WALKING, index).people[1]
        redrawn += first.motion.range_m != scenes[1].people[1].motion.range_m
    assert redrawn


@pytest.mark.parametrize("scatterers", ["points", "segments", "surfaces"])
def test_without_shadows_people_add_up(scatterers: str) -> None:
    """Whoever else is there, a person's echo is the same, body and all."""
    body = {"scatterers": scatterers, "shadowing": False}
    one = {"activity": "walking", "motion": {"range_m": 6}}
    two = {"activity": "grabbing", "motion": {"range_m": 3}}

    def echo(*shares: float) -> np.ndarray[Any, Any]:
        people = [{**who, "share": share} for who, share in zip((one, two), shares, strict=True)]
        crowd = config(*people, body=body, snr_db=None, duration_s=1, engine={"kind": "cube"})
        found: np.ndarray[Any, Any] = simulate(crowd, index=1, maps=("stft",)).signals["raw"].x
        return found

    both, neither = echo(1, 1), echo(0, 0)
    apart = echo(1, 0) + echo(0, 1) - neither
    assert np.linalg.norm(both - apart) < 1e-9 * np.linalg.norm(both)


def test_shadows_have_an_effect_wherever_there_are_others() -> None:
    told = "body.shadowing has no effect"
    without = {"body": {"shadowing": False}}
    assert any(told in line for line in unused_keys(config(**without)))
    assert not any(told in line for line in unused_keys(config(PUNCHER, **without)))


def test_a_back_wall_stands_behind_everybody() -> None:
    with pytest.raises(ValueError, match=r"people\.0\.motion\.range_m"):
        config({"motion": {"range_m": 8}}, motion={"range_m": 3}, room={"back_wall_m": 7})


def test_no_place_is_said_so() -> None:
    inside = {"activity": "walking", "motion": {"range_m": 9, "cross_range_m": 0.1}}
    crowd = config(inside, motion={"range_m": 9})
    with pytest.raises(SceneError, match=r"people\.0 comes within 0\.5 m of another person in 100"):
        draw_valid_scene(crowd, WALKING, 0)
    with pytest.raises(SceneError, match=r"walking/0: people\.0 comes within 0\.5 m"):
        simulate(crowd, nominal=True)


STILL = {"sway_ahead_m": 0, "sway_aside_m": 0, "breathing_hz": 0, "pulse_hz": 0}
BACK = {"range_m": 4, "cross_range_m": 0, "angle_deg": 180}


def standing(range_m: float, cross_range_m: float = 0.0) -> dict[str, Any]:
    motion = {"range_m": range_m, "cross_range_m": cross_range_m, "angle_deg": 180}
    return {"activity": "stationary", "subject": STILL, "motion": motion}


@pytest.mark.parametrize("scatterers", ["points", "segments"])
def test_who_stands_in_front_takes_the_echo(scatterers: str) -> None:
    """More than 10 dB of who stands behind; of who stands in front or aside nothing."""
    more = {"activities": ["stationary"], "subject": STILL, "motion": BACK, "snr_db": None}
    body = {"body": {"scatterers": scatterers}}
    activity = activity_named("stationary")

    def power(*people: Mapping[str, Any], **other: Any) -> float:
        scene, _ = draw_valid_scene(config(*people, **more | body | other), activity, 0)
        made = record(scene, ["paths"]).products["paths"](np.ones(1))
        count = len(made.amplitude) // len(scene.people)
        if scatterers == "segments":
            alone = record(scene, ["paths"], motions=(motion_of(scene.people[0]),))
            count = len(alone["paths"](np.ones(1)).amplitude)
        return float((made.amplitude[:count] ** 2).sum())

    alone = power()
    assert power(standing(2.0)) < 0.1 * alone
    assert power(standing(6.0)) == pytest.approx(alone, rel=1e-3)
    assert power(standing(2.0, 1.2)) == pytest.approx(alone, rel=0.02)
    lit = {"body": {"scatterers": scatterers, "shadowing": False}}
    if scatterers == "points":  # which have no shadow of their own
        assert power(standing(2.0), **lit) == pytest.approx(alone, rel=1e-12)


def test_noise_is_that_of_the_own_person_alone() -> None:
    """P_s of `snr_db`, and the noise itself: another person changes neither."""
    scenes = [draw_valid_scene(config(*people), WALKING, 1)[0] for people in ((), (PUNCHER,))]
    alone, crowd = (record(scene, ["noise"])["noise"] for scene in scenes)
    assert crowd.sigma == pytest.approx(alone.sigma, rel=1e-6)
    assert crowd.stream("x").random() == alone.stream("x").random()


@pytest.mark.parametrize("wall", [None, {}])
@pytest.mark.parametrize("scatterers", ["points", "segments"])
def test_the_fast_echo_keeps_its_tolerance(scatterers: str, wall: dict[str, Any] | None) -> None:
    more = {"body": {"scatterers": scatterers}, "wall": wall, "snr_db": None}
    scene, _ = draw_valid_scene(
        config(PUNCHER, {"activity": "walking"}, **more, duration_s=1), WALKING, 0
    )
    exact = scene.config.model_copy(
        update={"engine": scene.config.engine.model_copy(update={"kind": "cube"})}
    )
    fast = record(scene, ["signal", "accuracy"])
    right = record(Scene(exact, WALKING, 0), ["signal"])["signal"].x
    error = 20 * np.log10(np.linalg.norm(fast["signal"].x - right) / np.linalg.norm(right))
    assert error < -85
    assert fast["accuracy"].error_db < -90


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"people": [{"activity": "dancing"}]}, r"people\.0\.activity .*not an act"),
        ({"people": [{"motion": {"model": "paper"}}]}, r"people\.0\.motion\.model .*should be hum"),
        (
            {"people": [{}], "motion": {"model": "paper"}},
            r"people .*should be empty with motion\.m",
        ),
        (
            {"people": [{"motion": {"walking": {"speed_mps": 9}}}]},
            r"people\.0\.motion\.walking\.speed_mps .*0\.3 to 2\.8",
        ),
        ({"people": [{"share": 2}]}, r"people\.0\.share = 2"),
        ({"people": [{}] * 8}, r"people .*at most 7"),
        ({"people": 3}, r"people = 3: should be a list"),
        ({"people": [{"wall": {}}]}, r"people\.0\.wall"),
        ({"people": [{"shar": 0.5}]}, r"people\.0\.shar .*did you mean 'share'"),
    ],
)
def test_mistakes_name_key_and_value(
    document: dict[str, Any], message: str, tmp_path: Path
) -> None:
    path = small_config(tmp_path, json.dumps(document))
    with pytest.raises(ConfigError, match=message):
        load_config(path)


def test_scene_h5_has_the_truth_of_everybody(tmp_path: Path) -> None:
    path = tmp_path / "two.yaml"
    path.write_text(
        "radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 500}\nactivities: [walking]\n"
        "duration_s: 1\npeople: [{activity: punching, motion: {range_m: 3}}]\n"
    )
    made = radhar("simulate", path, "-o", tmp_path / "out", "--index", "2", "--no-figures")
    assert made.returncode == 0, made.stderr
    scene, _ = draw_valid_scene(load_config(path), WALKING, 2)
    with h5py.File(tmp_path / "out/scene.h5") as file:
        assert file["truth/person_1"].attrs["activity"] == "punching"
        for group, person in zip(("truth", "truth/person_1"), scene.people, strict=True):
            right = motion_of(person).positions(file[group]["time"][:])
            np.testing.assert_array_equal(file[group]["positions"][:], right.transpose(2, 1, 0))
    again = radhar(
        *("simulate", tmp_path / "out/scene.yaml", "-o", tmp_path / "again", "--index", "2"),
        "--no-figures",
    )
    assert again.returncode == 0, again.stderr
    with h5py.File(tmp_path / "out/scene.h5") as one, h5py.File(tmp_path / "again/scene.h5") as two:
        np.testing.assert_array_equal(one["maps/stft"][:], two["maps/stft"][:])


DATA = """
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 500}
activities: [walking, punching]
samples_per_class: 4
duration_s: 2
image: {size_px: 32}
people:
  - {activity: {choice: [walking, sitting_down]}, share: 0.5}
  - {activity: kicking, motion: {range_m: 3}}
maps: [rtm, stft]
"""


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("people")
    build(load_config(small_config(folder, DATA)), folder / "set", 1, Listener())
    return folder


def test_a_data_set_knows_what_everybody_does(data: Path) -> None:
    with open_dataset(data / "set") as found:
        assert found.labels is not None
        assert found.person_label is not None
        assert found.labels.shape == (8, 12)
        assert found.person_label.shape == (8, 3)
        assert found.classes == ("walking", "punching")
        assert found.class_slugs[:2] == ["walking", "punching"]
        assert set(found.label.tolist()) == {0, 1}
        for labels, persons, label in zip(
            found.labels, found.person_label, found.label, strict=True
        ):
            assert persons[0] == label
            assert persons[2] == found.class_slugs.index("kicking")
            assert set(np.flatnonzero(labels)) == set(persons[persons >= 0])
        absent = found.person_label[:, 1] < 0
        assert absent.any()
        assert not absent.all()
        np.testing.assert_array_equal(np.isnan(found.scene["people_1_range"][:]), absent)
        assert (found.scene["people_2_range"][:] == 3).all()


def test_it_is_verified_and_listed(data: Path) -> None:
    for command in (("verify",), ("inspect",)):
        done = radhar(*command, data / "set")
        assert done.returncode == 0, done.stderr
    assert "kicking: 8" in done.stdout
    with h5py.File(data / "set/dataset.h5") as one, open_dataset(data / "set") as found:
        assert one["labels"].attrs["class_slugs"].tolist() == found.class_slugs
        assert "kicking" in next(entries(found)).labels.split()


def test_changed_labels_are_found(data: Path, tmp_path: Path) -> None:
    path = tmp_path / "dataset.h5"
    path.write_bytes((data / "set/dataset.h5").read_bytes())
    with h5py.File(path, "r+") as file:
        file["labels"][3] = 1
    done = radhar("verify", path)
    assert done.returncode == 1
    assert "/labels: does not match its checksum" in done.stdout + done.stderr


def test_its_bytes_depend_neither_on_workers_nor_on_interruptions(
    data: Path, tmp_path: Path
) -> None:
    few = load_config(small_config(tmp_path, DATA))
    build(few, tmp_path / "two", 2, Listener())
    with full_disk_after(3):
        build(few, tmp_path / "cut", 1, Listener(), batch_size=2)
    build(few, tmp_path / "cut", 1, Listener())
    right = fingerprint(data / "set")
    assert fingerprint(tmp_path / "two") == right
    assert fingerprint(tmp_path / "cut") == right


def test_boards_see_everybody(tmp_path: Path) -> None:
    text = """
radar: {device: IWR1443BOOST, cfg: board.cfg, position_m: [0, 0, 1]}
activities: [punching]
motion: {range_m: 2, cross_range_m: -0.5}
duration_s: 0.5
samples_per_class: 3
body: {scatterers: surfaces}
cloud: {chain: board}
people: [{activity: walking, motion: {range_m: 3, cross_range_m: 0.8}, share: 0.5}]
maps: [range_doppler, points]
image: {size_px: 32}
seed: 3
"""
    (tmp_path / "board.cfg").write_text(CFG)
    build(load_config(small_config(tmp_path, text)), tmp_path / "set", 1, Listener())
    seen = set()
    with open_dataset(tmp_path / "set") as found:
        assert found.person_label is not None
        for row in range(3):
            skeletons, whose = found.products["skeleton"][row], found.products["points_person"][row]
            there = found.person_label[row] >= 0
            assert skeletons.shape[1] == 2
            np.testing.assert_array_equal(~np.isnan(skeletons).any(axis=(0, 2, 3)), there)
            assert set(whose.tolist()) - {-1} == set(np.flatnonzero(there).tolist())
            seen.add(bool(there[1]))
    assert seen == {True, False}
    assert load_config(small_config(tmp_path, text), ["snr_db=20"]).snr_db == 20
