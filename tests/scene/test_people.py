"""People from a config: drawn, reproducible, physically sound for every draw."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.bodies import links_of
from helpers.movements import in_groups

from radhar_cli.config import Config, load_config
from radhar_cli.config.checks.people import HUMAN_LIMITS
from radhar_cli.config.motion import EARLIER_KEYS
from radhar_cli.config.reading import validated
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.physique import froude_scale
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.falling import FALLS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.checks.validity import check_scene
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import (
    PERSONAL,
    UNSTEADY,
    Scene,
    draw_scene,
    nominal_scene,
    scene_numbers,
)
from radhar_cli.scene.single.scene_file import write_all
from radhar_cli.scene.single.simulate import simulate

ROOT = Path(__file__).resolve().parents[2]
FREE_SPACE = ROOT / "configs/human/free_space_77GHz.yaml"
WALL = ROOT / "configs/human/through_wall_2GHz.yaml"
TWELVE = [activity.slug for activity in ACTIVITIES]
ANKLES = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]
KNEES = [JOINTS.index("right_knee"), JOINTS.index("left_knee")]
TORSO = JOINTS.index("torso")
STIFF = 1e-9  # m


def people(motion: dict[str, Any] | None = None, **more: Any) -> Config:
    return Config.model_validate(
        {"duration_s": 6.0, "motion": {"model": "human"} | in_groups(motion or {})} | more
    )


HOME = {
    "coming_home": {
        "sequence": ["walking", "sitting_down", "standing_up"],
        "durations_s": [{"uniform": [0.8, 1.6]}, None, 1.5],
        "pauses_s": [0.3, 0, {"uniform": [0.2, 0.9]}],
    }
}


def moving(scene: Scene) -> HumanMotion:
    motion = motion_of(scene.people[0])
    assert isinstance(motion, HumanMotion)
    return motion


def assert_a_body(motion: HumanMotion, t: np.ndarray) -> None:
    """Links keep their lengths, those at the torso up to its breath, and the floor holds."""
    p, hips = motion.positions(t), motion.hip_joints(t)
    for joint, (parent, link) in enumerate(zip(PARENTS, links_of(motion.person), strict=True)):
        if parent is None:
            continue
        start = hips[:, KNEES.index(joint)] if joint in KNEES else p[:, parent]
        off = np.abs(np.linalg.norm(p[:, joint] - start, axis=0) - np.linalg.norm(link)).max()
        # Height of a breath 10 mm: (10.5 mm)^2 / (2 x 0.23 m).
        assert off < (3e-4 if TORSO in (joint, parent) else STIFF), JOINTS[joint]
    assert p[2].min() > 0


@pytest.mark.every(4)
@pytest.mark.parametrize("slug", TWELVE)
@pytest.mark.parametrize("path", [FREE_SPACE, WALL], ids=lambda path: path.stem)
def test_draws_of_the_configs_are_bodies(slug: str, path: Path) -> None:
    config = load_config(path)
    for index in range(6):
        scene, _ = draw_valid_scene(config, activity_named(slug), index)
        assert_a_body(moving(scene), np.arange(0, 6, 0.02))


def at_the_limits(rng: np.random.Generator) -> Config:
    """Every number of people anywhere in its range, at its ends as often as not."""
    document: dict[str, Any] = {"duration_s": 5.0, "seed": int(rng.integers(10**6))}
    document |= {"subject": {}, "motion": {"model": "human"}, "timing": {}}
    for key, (low, high) in HUMAN_LIMITS.items():
        section, _, name = key.rpartition(".")
        if section.partition(".")[2] in (
            "lying",
            "kneeling",
            "crawling",
            "running",
            "limping",
            "aids",
            "carrying",
        ):
            continue  # of which the twelve have no use
        if section and name != "walk_start_s":
            high = 4.0 if section == "timing" and high > 4 else high  # s, of a recording of 5 s
            at = rng.choice([low, high]) if rng.random() < 0.5 else rng.uniform(low, high)
            section, *group = section.split(".")
            inner = document[section]
            for part in group:
                inner = inner.setdefault(part, {})
            inner[name] = float(at)
    smallness = min(froude_scale(document["subject"]["height_m"], 1.5), 1.0)
    # No child walks at 2.8 m/s, nor starts to within a moment, half risen.
    walking = document["motion"]["walking"]
    walking["speed_mps"] = min(walking["speed_mps"], 2.8 * smallness**2)
    document["motion"] |= {
        "rotating": {"turn_deg": float(rng.uniform(-90, 90))},
        "falling": {"direction": str(rng.choice(["forward", "backward", "sideways"]))},
    }
    return Config.model_validate(document)


@pytest.mark.parametrize("block", range(4))
def test_bodies_up_to_the_limits_of_every_number(block: int) -> None:
    rng, t = np.random.default_rng([14, block]), np.arange(0, 5, 0.02)
    for _ in range(4):
        config = at_the_limits(rng)
        for activity in ACTIVITIES:
            assert_a_body(moving(draw_scene(config, activity, 0)), t)


@pytest.mark.every(4)
@pytest.mark.parametrize("slug", TWELVE)
def test_velocities_of_people_are_continuous(slug: str) -> None:
    """The change of velocity from sample to sample falls with the sample interval."""
    config = load_config(FREE_SPACE)
    for index in range(3):
        motion = moving(draw_scene(config, activity_named(slug), index))
        worst = [
            np.abs(np.diff(motion.positions(np.arange(0, 6, 1 / rate)), n=2, axis=2)).max() * rate
            for rate in (1000, 8000)
        ]
        assert worst[1] < worst[0] / 6


@pytest.mark.parametrize("slug", TWELVE)
def test_nominal_people_sway_and_breathe_and_nothing_else_is_random(slug: str) -> None:
    config = people()
    scene = nominal_scene(config, activity_named(slug))
    other = nominal_scene(config.model_copy(update={"seed": 99}), activity_named(slug))
    t = np.arange(0, 6, 0.01)
    p = moving(scene).positions(t)
    np.testing.assert_array_equal(p, moving(other).positions(t))
    assert not any(scene_numbers(scene).get(key) for key in UNSTEADY)
    assert moving(scene).idle.fidgets == ()
    breath = moving(scene).idle(t).breath
    assert 0.003 < breath.max() < 0.006


@pytest.mark.parametrize(
    ("slug", "before", "after"),
    [("sitting_down", -0.3, -0.3), ("standing_up", 0.0, 0.3), ("grabbing", None, None)],
)
def test_people_step_to_the_chair_and_away_from_it(
    slug: str, before: float | None, after: float | None
) -> None:
    """Backwards before they sit down, ahead after they have stood up, around what they pick up."""
    config = people({"step_m": 0.3, "shuffle_hz": 0.0, "angle_deg": 0}, timing={"visible": 1})
    ways = set()
    for index in range(8):
        scene = draw_scene(config, activity_named(slug), index)
        motion = moving(scene)
        names = [name for _, name in motion.phases]
        assert names.count("stepping") == (2 if slug == "grabbing" else 1)
        at = np.array([-9.0, motion.parts[-1][0].begin, motion.parts[-1][0].end])
        ankles = motion.positions(at)[:, ANKLES].mean(axis=1)
        ways |= {round(float(x), 9) for x in ankles[0, 1:] - ankles[0, 0]}
        assert np.abs(ankles[1] - ankles[1, 0]).max() < 0.13
    if before is None:
        assert {0.3, -0.3} <= ways <= {-0.6, -0.3, 0.0, 0.3, 0.6}
    else:
        assert ways == {before, after}
    nominal = moving(nominal_scene(config, activity_named(slug)))
    assert "stepping" not in [name for _, name in nominal.phases]


QUIET = {
    **{"step_m": 0.0, "fidget_hz": 0.0, "settle_size": 0.0, "shuffle_hz": 0.0},
    **{"angle_deg": 0, "range_m": 5.0},
}


def test_joints_lead_and_lag_out_of_step_and_no_movement_takes_longer() -> None:
    """Of who is in step trunk and legs bend alike; else one is ahead, another in each sample."""
    t, leads = np.arange(0, 6, 0.01), []
    for joint_lag in (0.0, 0.4):
        for index in range(4):
            timing = {"grab_duration_s": 2.0, "grab_start_s": 0.5}
            config = people(QUIET | {"joint_lag": joint_lag}, timing=timing)
            motion = moving(draw_scene(config, activity_named("grabbing"), index))
            part = motion.parts[0][0]
            course = dict(zip(part.course.channels, part.course(t), strict=True))
            begin, end = part.begin, part.begin + 2.0 * 1.2 / 2.5
            shares = [
                (course[name][t <= end] - course[name][0]) / (course[name][t <= end][-1])
                for name in ("trunk", "right_shoulder")
            ]
            assert [share[0] for share in shares] == pytest.approx([0.0, 0.0], abs=1e-9)
            assert [share[-1] for share in shares] == pytest.approx([1.0, 1.0], abs=1e-3)
            leads.append(float(np.abs(shares[0] - shares[1]).max()))
            assert begin == 0.5
    assert max(leads[:4]) < 1e-9
    assert min(leads[4:]) > 0.01
    assert np.ptp(leads[4:]) > 0.05


def test_hands_are_on_the_lap_or_beside_the_seat_and_people_lean_back() -> None:
    at, hand = np.arange(0, 6, 0.01), JOINTS.index("right_hand")
    ahead = {}
    for lap in (0.0, 1.0):
        config = people(QUIET | {"hands_on_lap": lap})
        p = moving(nominal_scene(config, activity_named("sitting_down"))).positions(at)
        ahead[lap] = p[0, hand, -1] - p[0, TORSO, -1]
    assert ahead[0.0] < 0.1 < 0.4 < ahead[1.0]
    config = people(QUIET | {"recline_deg": 20.0})
    p = moving(nominal_scene(config, activity_named("sitting_down"))).positions(at)
    reclines = p[0, TORSO] - p[0, JOINTS.index("hip")]
    assert reclines[-1] == pytest.approx(-0.3 * np.sin(np.radians(20)), abs=0.02)


def test_who_stands_at_first_walks_when_told_to() -> None:
    config = people(QUIET | {"speed_mps": 1.2}, timing={"walk_begin_s": 1.5})
    scene = nominal_scene(config, activity_named("walking"))
    t = np.arange(0, 6, 0.01)
    v = np.gradient(moving(scene).torso(t)[0, 0], t)
    assert np.abs(v[t < 1.4]).max() < 0.05
    assert v[t > 3].mean() == pytest.approx(1.2, abs=0.1)
    assert [phase.name for phase in moving(scene).phases] == ["standing", "walking"]
    at_once = moving(nominal_scene(people(QUIET | {"speed_mps": 1.2}), activity_named("walking")))
    assert np.gradient(at_once.torso(t)[0, 0], t)[t < 1].mean() == pytest.approx(1.2, abs=0.15)


def test_people_settle_when_they_sit_down() -> None:
    quiet = {"step_m": 0.0, "fidget_hz": 0.0, "settle_size": 0.0}
    sitting = activity_named("sitting_down")
    for more, channels in (
        ({}, set()),
        ({"settle_size": 2.0}, None),
    ):
        motion = moving(draw_scene(people(quiet | more), sitting, 2))
        fidgets = motion.idle.fidgets
        assert channels is None or {fidget.channel for fidget in fidgets} == channels
        if channels is None:
            at = [fidget.start_s - motion.parts[-1][0].end for fidget in fidgets]
            assert len(at) == 4
            assert -0.9 < min(at) < max(at) < 1.3


def test_walkers_turn_round_where_the_lane_ends() -> None:
    config = people(
        {"lane_m": 2.0, "lane_start": 0.5, "speed_mps": 1.2, "angle_deg": 0, "range_m": 5.0},
        duration_s=9.0,
    )
    motion = moving(nominal_scene(config, activity_named("walking")))
    x, y, _ = motion.torso(np.arange(0, 9, 0.01))[:, 0] - np.array([[5.0], [0.0], [0.0]])
    assert 1.3 < x.max() < 1.8  # half of the lane was behind, and the arc is 0.55 m deep
    assert -1.8 < x.min() < -1.3
    assert 0.5 < np.ptp(y) < 0.8
    straight = moving(nominal_scene(people({"speed_mps": 1.2}), activity_named("walking")))
    assert straight.parts[0][0].gait.lane is None


def test_feet_swing_up_as_a_fall_lands_on_the_knees_and_come_down_again() -> None:
    t, foot = np.arange(0, 6, 0.01), JOINTS.index("right_ankle")
    up = {}
    for heels in (0.0, 60.0):
        config = people(QUIET | {"heels_deg": heels})
        up[heels] = moving(draw_scene(config, activity_named("S12"), 0)).positions(t)[2, foot]
    raised = up[60.0] - up[0.0]
    assert raised.max() == pytest.approx(up[0.0][-1] + 0.3, abs=0.15)
    assert raised[-1] == pytest.approx(0.0, abs=1e-9)
    assert np.count_nonzero(raised > 0.01) * 0.01 < 0.9


def test_who_rises_before_the_descent_ends_never_comes_to_rest_at_the_floor() -> None:
    t, still = np.arange(0, 6, 0.01), {}
    for dwell_s in (0.0, -0.6):
        motion = moving(
            nominal_scene(people(QUIET | {"dwell_s": dwell_s}), activity_named("grabbing"))
        )
        trunk = motion.parts[0][0].course(t)[2]
        bent = trunk > 0.5 * trunk.max()
        still[dwell_s] = np.count_nonzero(np.abs(np.gradient(trunk, t))[bent] < 0.3) * 0.01
    assert still[-0.6] < 0.5 * still[0.0]


def test_who_gains_speed_slowly_falls_behind_by_half_of_that_time() -> None:
    t, x = np.arange(0, 6, 0.01), {}
    for strides in (0.6, 1.6):
        config = people(
            QUIET | {"speed_mps": 1.0, "speed_up": strides}, timing={"walk_begin_s": 0.5}
        )
        motion = moving(nominal_scene(config, activity_named("walking")))
        x[strides] = motion.torso(t)[0, 0]
        stride = motion.parts[0][0].stride
    assert x[0.6][-1] - x[1.6][-1] == pytest.approx(stride / 2, abs=0.02)


@pytest.mark.parametrize("slug", ["stationary", "walking", "punching"])
def test_samples_differ_and_are_reproducible(slug: str) -> None:
    config, t = people(), np.arange(0, 6, 0.05)
    first, second = (draw_scene(config, activity_named(slug), index) for index in (1, 2))
    p = moving(first).positions(t)
    np.testing.assert_array_equal(
        p, moving(draw_scene(config, activity_named(slug), 1)).positions(t)
    )
    assert np.abs(p - moving(second).positions(t)).max() > 0.01


def test_strides_punches_and_kicks_vary() -> None:
    config = people({"tempo_jitter": 0.1, "size_jitter": 0.1, "speed_variation": 0.06})
    punch, kick = (
        moving(draw_scene(config, activity_named(slug), 0)).parts[0][0].course
        for slug in ("punching", "kicking")
    )
    for course in (punch, kick):
        assert np.unique(np.round(course.lengths, 9)).size > 4
    gait = moving(draw_scene(config, activity_named("walking"), 0)).parts[0][0].gait
    assert np.std(gait.jitter[:20]) == pytest.approx(0.03 / 2**0.5, rel=0.5)


def test_persons_keep_their_body_and_gait() -> None:
    config = people(split={"by": "subject", "subjects": 4}, samples_per_class=8)
    scenes = [draw_scene(config, activity_named("walking"), index) for index in (1, 5)]
    one, again = (scene_numbers(scene) for scene in scenes)
    assert {key for key in PERSONAL if key in one and one[key] != again[key]} == set()
    assert one["motion.idle.phase_s"] != again["motion.idle.phase_s"]


def test_keys_of_the_other_model_are_ignored() -> None:
    walking, t = activity_named("walking"), np.arange(0, 2, 0.1)
    for model, keys in {
        "human": {"gait_hz": 3.0, "thigh_deg": 80},
        "paper": {"arm_swing": 9.0, "fidget_hz": 900, "fall": "sideways"},
    }.items():
        plain = Config(motion={"model": model})
        more = Config(
            motion={"model": model, **in_groups(keys)},
            timing={"overlap_s": 99 * (model == "paper")},
        )
        a, b = (draw_scene(config, walking, 0) for config in (plain, more))
        assert scene_numbers(a) == scene_numbers(b)
        np.testing.assert_array_equal(
            motion_of(a.people[0]).positions(t), motion_of(b.people[0]).positions(t)
        )
        keys_of_other = {key for key, earlier in EARLIER_KEYS.items() if earlier[7:] in keys}
        assert not keys_of_other & set(scene_numbers(a))


@pytest.mark.parametrize("slug", ["sitting_to_walking", "falling_to_walking"])
def test_walking_follows_rising_unless_walk_start_s_is_given(slug: str) -> None:
    activity = activity_named(slug)
    _, (begin, _), *_, (walks, name) = moving(nominal_scene(people(), activity)).phases
    assert name == "walking"
    assert walks - begin == pytest.approx(
        {"sitting_to_walking": 1.8, "falling_to_walking": 3.0}[slug]
    )
    late = moving(nominal_scene(people(timing={"walk_start_s": 4.5}), activity)).phases
    assert late[-1][0] == pytest.approx(4.5)
    early = moving(nominal_scene(people(timing={"overlap_s": 0.4}), activity)).phases
    assert early[-1][0] == pytest.approx(walks - 0.4)


@pytest.mark.parametrize("fall", ["forward", "backward", "sideways"])
def test_falls_go_in_the_configured_direction(fall: str) -> None:
    config = people({"fall": fall, "speed_mps": 1.2, "angle_deg": 0})
    scene = nominal_scene(config, activity_named("walking_to_falling"))
    p = moving(scene).positions(np.array([5.9]))[..., 0]
    ahead, left, _ = p[:, JOINTS.index("head")] - p[:, ANKLES].mean(axis=1)
    assert p[2].max() < 0.6
    where = {"forward": ahead, "backward": -ahead, "sideways": abs(left)}
    assert where[fall] > 1.0
    assert scene_numbers(scene)["motion.falling.direction"] == [
        "forward",
        "backward",
        "sideways",
    ].index(fall)


def test_directions_of_falls_are_drawn() -> None:
    config = people({"fall": {"choice": ["forward", "forward", "sideways"]}})
    falls = [
        draw_scene(config, activity_named("S12"), index).config.motion.falling.direction
        for index in range(90)
    ]
    assert 40 < falls.count("forward") < 80
    assert falls.count("sideways") == 90 - falls.count("forward")


@pytest.mark.every(3)
@pytest.mark.parametrize("nominal", [True, False])
@pytest.mark.parametrize("slug", ["stationary", "walking_to_falling", "coming_home"])
def test_a_written_scene_gives_the_same_recording(slug: str, nominal: bool, tmp_path: Path) -> None:
    radar = {"carrier_hz": 10e9, "bandwidth_hz": 2e8, "prf_hz": 300, "adc_rate_hz": 1e6}
    config = people({"fall": {"choice": ["sideways", "backward"]}}, classes=HOME, radar=radar)
    made = simulate(config, slug, index=3 * (not nominal), nominal=nominal, maps=("stft",))
    write_all(made, tmp_path)
    again = simulate(
        load_config(tmp_path / "scene.yaml"), slug, index=made.scene.index, maps=("stft",)
    )
    np.testing.assert_array_equal(again.truth.positions, made.truth.positions)
    np.testing.assert_array_equal(again.signals["raw"].x, made.signals["raw"].x)
    with h5py.File(tmp_path / "scene.h5") as file:
        assert file["truth/positions"].shape == (1800, 13, 3)
        assert file["truth/hip_joints"].shape == (1800, 2, 3)


def test_the_papers_model_has_no_hip_joints() -> None:
    assert (
        simulate(Config(motion={"model": "paper"}), "walking", maps=("stft",)).truth.hip_joints
        is None
    )


@pytest.mark.parametrize("slug", TWELVE)
def test_the_direct_engine_keeps_its_tolerance(slug: str) -> None:
    scene = draw_scene(load_config(FREE_SPACE), activity_named(slug), 1)
    found = record(scene, ["accuracy"])["accuracy"]
    assert found.error_db < scene.config.engine.tolerance_db


def test_a_sequence_is_a_class_of_its_own() -> None:
    config = people(classes=HOME)
    home = config.chosen_activities[-1]
    assert (home.slug, home.index) == ("coming_home", 12)
    scene = draw_scene(config, home, 4)
    numbers = {k: v for k, v in scene_numbers(scene).items() if k.startswith("classes.")}
    walked, paused = (numbers[f"classes.coming_home.{k}"] for k in ("durations_s.0", "pauses_s.2"))
    assert 0.8 < walked < 1.6
    assert 0.2 < paused < 0.9
    names = [name for _, name in moving(scene).phases]
    assert names == ["standing", "walking", "sitting down", "seated", "standing up", "standing"]
    starts = [start for start, _ in moving(scene).phases]
    assert starts[1] - moving(scene).begin == pytest.approx(0.3)
    assert starts[4] - starts[3] == pytest.approx(paused)
    assert_a_body(moving(scene), np.arange(0, 6, 0.02))


def test_a_sequence_among_chosen_activities_keeps_its_streams() -> None:
    classes = {"waiting": {"sequence": ["stationary"]}, **HOME}
    config = people(classes=classes, activities=["coming_home", "walking"])
    assert [(a.slug, a.index) for a in config.chosen_activities] == [
        ("coming_home", 13),
        ("walking", 7),
    ]
    assert [a.slug for a in config.every_class][:2] == ["coming_home", "walking"]
    assert config.every_class[-1].slug == "waiting"


@pytest.mark.parametrize("name", [name for name in MOVEMENTS if name != NOBODY])
def test_every_movement_can_begin_a_sequence(name: str) -> None:
    config = people(classes={"own": {"sequence": [name]}}, activities=["own"])
    motion = moving(draw_scene(config, config.chosen_activities[0], 0))
    assert np.isfinite(motion.positions(np.arange(0, 6, 0.1))).all()


@pytest.mark.parametrize(
    ("classes", "expected"),
    [
        ({"own": {"sequence": ["qwerty"]}}, "movements.md lists them; motion files have others"),
        ({"own": {"sequence": ["swimming"]}}, "motion files can"),
        ({"own": {"sequence": ["waking", "falling"]}}, "did you mean 'walking'"),
        ({"own": {"sequence": ["walking", "falling"]}}, "a duration of walking"),
        (
            {"own": {"sequence": ["sitting_down", "grabbing"]}},
            "grabbing begins standing, .* seated",
        ),
        ({"own": {"sequence": ["falling"], "pauses_s": [1, 2]}}, "as many"),
        ({"own": {"sequence": ["walking", "falling"], "durations_s": [0.0, None]}}, "from 0.3"),
        ({"walking": {"sequence": ["falling"]}}, "new name"),
        ({"../up": {"sequence": ["falling"]}}, "new name"),
    ],
)
def test_impossible_sequences_are_refused(
    classes: dict[str, Any], expected: str, tmp_path: Path
) -> None:
    import yaml

    path = tmp_path / "own.yaml"
    path.write_text(yaml.safe_dump({"motion": {"model": "human"}, "classes": classes}))
    with pytest.raises(ConfigError, match=expected) as error:
        load_config(path)
    assert "classes" in str(error.value)


@pytest.mark.parametrize("direction", FALLS)
@pytest.mark.parametrize("name", [name for name in MOVEMENTS if name.startswith("falling")])
def test_whoever_falls_however_tries_to_get_up_and_stands(name: str, direction: str) -> None:
    own = {"sequence": [name, "trying_to_get_up", "getting_up", "stationary"]}
    config = people(
        classes={"own": own}, activities=["own"], motion={"falling": {"direction": direction}}
    )
    motion = moving(draw_scene(config, config.chosen_activities[0], 0))
    names = [phase.name for phase in motion.phases]
    assert [n for n in names if n != "standing up"][1:] == [
        *("falling", "getting up", "getting up", "standing")
    ]
    head = motion.positions(np.array([motion.parts[-1][0].begin]))[2, 1, 0]
    assert head > 0.8 * motion.person.stature
    for part, _ in motion.parts[1:]:
        before, after = (motion.positions(np.array([part.begin + d])) for d in (-1e-6, 1e-6))
        assert np.abs(after - before).max() < 1e-4


def test_the_papers_model_has_no_sequences(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text("motion: {model: paper}\nclasses: {own: {sequence: [falling]}}")
    with pytest.raises(ConfigError, match=r"classes\.own = .*: should have files with motion"):
        load_config(path)


@pytest.mark.parametrize(
    ("key", "value"), [("motion.walking.speed_mps", 0), ("subject.height_m", 0.5)]
)
def test_human_limits_apply_to_the_human_model(key: str, value: float) -> None:
    section = key.partition(".")[0]
    for model, slugs, refused in [
        ("human", ["walking"], True),
        ("human", ["punching"], section == "subject"),
        ("paper", ["walking"], False),
    ]:
        path, what = FREE_SPACE, [f"{key}={value}", f"motion.model={model}", f"activities={slugs}"]
        if refused:
            with pytest.raises(ConfigError, match=rf"{key} = .*: should be from .* motion.model"):
                load_config(path, what)
        else:
            load_config(path, what)


def document(key: str, value: float) -> dict[str, Any]:
    section, _, name = key.rpartition(".")
    base: dict[str, Any] = {
        "duration_s": 5.0,
        "radar": {"prf_hz": 500},
        "motion": {"model": "human"},
        "classes": {
            f"own_{name}": {"sequence": [name]}
            for name in (
                *("squatting", "tripping", "turning_over", "kneeling", "crawling"),
                *("running", "jogging_in_place", "limping", "carrying"),
                *("walking_with_stick", "walking_with_walker"),
                *("waving", "drinking", "clapping", "writing"),
            )
        },
    }
    if key == "motion.walking.lane_start":  # which acts on lanes alone
        base["motion"]["walking"] = {"lane_m": 3.0}
    inner = base
    for part in filter(None, section.split(".")):
        inner = inner.setdefault(part, {})
    inner[name] = value
    return base


@pytest.mark.every(4)
@pytest.mark.parametrize("key", HUMAN_LIMITS)
def test_the_limits_of_people(key: str) -> None:
    low, high = HUMAN_LIMITS[key]
    for value in (low or 1.0 * (key == "duration_s"), high):
        validated(Config, document(key, value), "here", {})
    beyond = [high * 1.01, *([low * 0.99 if low > 0 else low * 1.01] if low else [])]
    for value in [*beyond, {"uniform": [high / 2, high * 1.01]}]:
        with pytest.raises(ConfigError, match=rf"^here: {key} = .*: should be from "):
            validated(Config, document(key, value), "here", {})


@pytest.mark.parametrize(
    "name", ["human/free_space_77GHz.yaml", "human/through_wall_2GHz.yaml", "quickstart.yaml"]
)
def test_nominal_scenes_have_no_warnings(name: str) -> None:
    config = load_config(ROOT / "configs" / name)
    for activity in config.chosen_activities:
        assert not check_scene(nominal_scene(config, activity)).flags, activity.slug


@pytest.mark.parametrize("wall", [None, {}])
def test_people_keep_clear_of_the_radar_and_face_it_half_of_the_time(wall: object) -> None:
    config = Config(wall=wall)
    for activity in config.chosen_activities:
        found = check_scene(nominal_scene(config, activity))
        assert found.flags & ~Flags.ALIASING == 0, activity.slug
        assert found.closest.distance > 0.9, activity.slug  # of any joint; of the torso 1
        angles = [draw_scene(config, activity, n).config.motion.angle_deg for n in range(40)]
        towards = [angle for angle in angles if 150 <= angle <= 210]
        assert all(abs(angle) <= 30 for angle in angles if angle not in towards)
        assert 8 < len(towards) < 32
        assert nominal_scene(config, activity).config.motion.angle_deg == 180
    away = nominal_scene(Config(motion={"model": "paper"}), activity_named("walking"))
    assert (away.config.motion.angle_deg, away.config.motion.range_m) == (0, 2)


@pytest.mark.parametrize(
    ("label", "asked", "most"),
    [
        ("S9", {"rise_duration_s": 1.5}, 0.45),
        ("S10", {"sit_duration_s": 2.0}, 0.6),
        ("S11", {"rise_duration_s": 2.0}, 0.6),
        ("S12", {"fall_duration_s": 1.0}, 0.3),
    ],
)
def test_the_number_of_an_overlap_is_the_overlap_that_there_is(
    label: str, asked: dict[str, float], most: float
) -> None:
    activity = activity_named(label)
    for overlap in (0.2, 0.8):
        scene = nominal_scene(people(timing={"overlap_s": overlap} | asked), activity)
        held = scene_numbers(scene)["timing.overlap_s"]
        assert held == pytest.approx(min(overlap, most))
        (first, _), (second, _) = moving(scene).parts
        assert first.end - second.begin == pytest.approx(held)
    if label == "S12":
        sideways = people({"fall": "sideways"}, timing={"overlap_s": 0.8})
        assert scene_numbers(nominal_scene(sideways, activity))["timing.overlap_s"] == 0


def test_walking_starts_no_earlier_than_legs_allow() -> None:
    timing = {"rise_start_s": 0.5, "rise_duration_s": 2.0, "walk_start_s": 0.6}
    scene = nominal_scene(people(timing=timing), activity_named("S9"))
    assert scene_numbers(scene)["timing.walk_start_s"] == pytest.approx(0.5 + 0.7 * 2.0)
    assert moving(scene).parts[1][0].begin == pytest.approx(1.9)
