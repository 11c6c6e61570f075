"""Segments are found by the names of joints and follow them, whatever moves."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.motion.protocol import Motion, ScattererSubset
from radhar_cli.motion.segments import (
    SEGMENTS,
    landmark_names,
    segment_positions,
    segments_between,
    segments_of_joint,
    thickness,
)
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import nominal_scene

STATURE = 1.75
NAMES = [one.name for one in SEGMENTS]


def motion(model: str, slug: str = "walking") -> Motion:
    people = {"model": model, "range_m": 4.0, "angle_deg": 180.0}
    config = Config.model_validate({"subject": {"height_m": STATURE}, "motion": people})
    return motion_of(nominal_scene(config, activity_named(slug)).people[0])


def times(count: int = 801, seconds: float = 4.0) -> np.ndarray:
    return np.linspace(0, seconds, count)


def segments_at(who: Motion, t: np.ndarray):
    return segment_positions(who, segments_between(landmark_names(who)), STATURE, t)


class TestFinding:
    def test_the_thirteen_joints_give_all_segments(self):
        assert segments_between(JOINTS) == SEGMENTS
        assert len(SEGMENTS) == 14

    def test_unknown_names_give_no_segments(self):
        assert segments_between(("ball", "string")) == ()

    def test_a_leg_alone_gives_thigh_and_shank(self):
        names = ("right_hip", "right_knee", "right_ankle", "tail")
        assert [one.name for one in segments_between(names)] == ["right_thigh", "right_shank"]

    def test_every_joint_has_a_segment(self):
        assert all(segments_of_joint(joint, SEGMENTS) for joint in JOINTS)
        of_the_hip = [SEGMENTS[n].name for n in segments_of_joint("hip", SEGMENTS)]
        assert of_the_hip == ["trunk"]
        assert [SEGMENTS[n].name for n in segments_of_joint("left_ankle", SEGMENTS)] == [
            "left_shank",
            "left_foot",
        ]


def test_thickness_goes_with_stature_and_weight():
    assert thickness(1.75, 26 * 1.75**2) == pytest.approx(1)
    assert thickness(1.75, 4 * 26 * 1.75**2) == pytest.approx(2)
    assert thickness(0.875, 26 * 0.875**2) == pytest.approx(0.5)


@pytest.mark.parametrize("model", ["human", "paper"])
@pytest.mark.parametrize("activity", ACTIVITIES, ids=lambda one: one.slug)
def test_segments_stay_as_long_as_they_are(model, activity):
    """Feet fade where a leg lies along the body's left, which nothing here does for long."""
    placed = segments_at(motion(model, activity.slug), times(201))
    length = np.linalg.norm(placed.end - placed.start, axis=0)
    assert np.isfinite(length).all()
    feet = [one.endswith("foot") for one in NAMES]
    rigid = length[~np.array(feet)]
    assert np.ptp(rigid, axis=1).max() < 1e-9
    assert length[feet].max() < 0.2505
    assert np.linalg.norm(placed.beside, axis=0) == pytest.approx(1, abs=1e-9)


def test_a_walker_has_thighs_from_the_hip_joints_and_feet_ahead_of_ankles():
    who = motion("human")
    t = times()
    placed, p = segments_at(who, t), who.positions(t)
    right = NAMES.index("right_thigh")
    assert placed.start[:, right] == pytest.approx(who.hip_joints(t)[:, 0])
    assert placed.end[:, right] == pytest.approx(p[:, JOINTS.index("right_knee")])
    foot = NAMES.index("right_foot")
    ahead = p[0, JOINTS.index("right_ankle")] - placed.end[0, foot]  # heading 180 degrees
    assert ahead.min() > 0.05


def test_a_planted_foot_lies_still_on_the_floor():
    """While the ankle stands, heel and toes do, and both are level with it."""
    who, t = motion("human"), times()
    placed, p = segments_at(who, t), who.positions(t)
    ankle, foot = p[:, JOINTS.index("right_ankle")], NAMES.index("right_foot")
    planted = np.linalg.norm(np.gradient(ankle, t, axis=1), axis=0) < 1e-3
    assert np.count_nonzero(planted) > 200
    toes = placed.end[:, foot]
    speed = np.abs(np.gradient(toes[0], t))  # aside they follow the pelvis by some centimetres
    assert np.median(speed[planted]) < 0.02
    assert speed[planted].max() < 0.15
    assert np.abs(toes[2] - ankle[2])[planted].max() < 0.02


@pytest.mark.parametrize("model", ["human", "paper"])
def test_a_trunk_breathes_with_its_torso_point(model):
    who, t = motion(model, "stationary"), times()
    placed, torso = segments_at(who, t), who.positions(t)[:, 0]
    middle = 0.5 * (placed.start + placed.end)[:, NAMES.index("trunk")]
    assert np.abs((middle - torso) - (middle - torso)[:, :1]).max() < 2e-3


@dataclass(frozen=True)
class Pointing:
    """Arms and legs along the body's left, where frames lose their direction."""

    whole: Motion
    names = JOINTS

    def positions(self, t):
        p = self.whole.positions(t)
        left = np.array([0.0, 1.0, 0.0])[:, None]
        for side in ("right", "left"):
            chain = [f"{side}_{one}" for one in ("shoulder", "elbow", "hand")]
            chain2 = ["hip", f"{side}_knee", f"{side}_ankle"]
            for names in (chain, chain2):
                for parent, joint in pairwise(names):
                    p[:, JOINTS.index(joint)] = p[:, JOINTS.index(parent)] + 0.4 * left
        return p


def test_no_pose_gives_nan():
    placed = segments_at(Pointing(motion("paper", "stationary")), times(5))
    assert all(np.isfinite(part).all() for part in placed)


def test_coincident_points_give_no_nan():
    @dataclass(frozen=True)
    class Nowhere(Pointing):
        def positions(self, t):
            return np.zeros((3, 13, t.size))

    placed = segments_at(Nowhere(motion("paper")), times(3))
    assert all(np.isfinite(part).all() for part in placed)


def test_a_selection_of_joints_keeps_its_names():
    who = motion("human")
    assert landmark_names(ScattererSubset(who, (3,))) == (JOINTS[3],)
