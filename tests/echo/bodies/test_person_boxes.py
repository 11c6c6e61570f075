"""What people who stand, sit or lie hide, by the boxes about their joints."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.echo.bodies.person_boxes import JOINTS, box_of_stature, boxes_of_body
from radhar_cli.numerics.accelerators import installed
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar import person_shadow
from radhar_cli.radar.person_shadow import BodyBox, field_behind_person

C = 299_792_458.0
ANTENNA, STATURE = (0.0, 0.0, 1.2), 1.75


def standing(x: float = 2.0) -> dict[str, Float]:
    """Joints [3, 1] of somebody who stands and faces the antenna."""
    heights = dict(zip(JOINTS, (1.516, 1.22, 0.93, 0.5, 0.5, 0.068, 0.068), strict=True))
    sides = {"right": -0.09, "left": 0.09}
    return {
        name: np.array([[x], [sides.get(name.partition("_")[0], 0.0)], [height]])
        for name, height in heights.items()
    }


def turned(points: dict[str, Float], about: tuple[float, float]) -> dict[str, Float]:
    """Joints that lie: turned by 90 degrees to the left about a place (x, z)."""
    return {
        name: np.array([[p[0, 0]], [p[2, 0] - about[0]], [about[1] + 0 * p[2, 0]]])
        for name, p in points.items()
    }


def to(x: float, y: float = 0.0, z: float = 1.0) -> Float:
    return np.reshape([x, y, z], (3, 1, 1)).astype(float)


def past(points: dict[str, Float], p: Float, wavelength: float = 0.0125) -> float:
    boxes = boxes_of_body(points, STATURE, 1.0)
    return float(field_behind_person(p, ANTENNA, boxes, wavelength)[0, 0])


def test_a_standing_person_is_as_tall_and_wide_as_their_joints() -> None:
    trunk, legs = boxes_of_body(standing(), STATURE, 1.0)
    tops = [float((box.centre[2] + np.sqrt(box.spread[2]))[0]) for box in (trunk, legs)]
    assert STATURE < tops[0] < STATURE + 0.035
    assert float(np.sqrt(trunk.spread[1, 0])) == pytest.approx(0.165)
    assert float((legs.centre[2] - np.sqrt(legs.spread[2]))[0]) == pytest.approx(0, abs=0.06)
    torso = np.array([[2.0], [0.0], [1.22]])
    alone = box_of_stature(torso, STATURE, 1.0)
    whole = float(field_behind_person(to(4), ANTENNA, (alone,), 0.0125)[0, 0])
    assert past(standing(), to(4)) == pytest.approx(whole, rel=0.15)


def test_who_lies_hides_what_is_low_and_no_more() -> None:
    lying = turned(standing(), (0.9, 0.12))
    low, high = past(lying, to(2.3, 0.0, 0.0)), past(lying, to(3.0, 0.0, 1.5))
    assert high > 0.98
    assert low < 0.5
    assert past(standing(), to(3.0, 0.0, 1.2)) < 0.3
    wide = [past(lying, to(2.3, y, 0.0)) for y in (-0.7, 0.0, 0.6)]  # across, as long as they are
    assert max(wide) < 0.6


def test_who_sits_lets_pass_what_is_above() -> None:
    sitting = standing()
    for name in ("head", "torso", "hip"):
        sitting[name] = sitting[name] - np.array([[0.0], [0.0], [0.45]])
    for side in ("right", "left"):
        sitting[f"{side}_knee"] = sitting[f"{side}_knee"] - np.array([[0.42], [0.0], [0.0]])
        sitting[f"{side}_ankle"] = sitting[f"{side}_ankle"] - np.array([[0.42], [0.0], [0.0]])
    assert past(sitting, to(4, 0, 1.9)) > 0.9 > 0.5 > past(standing(), to(4, 0, 1.9))
    assert past(sitting, to(4, 0, 0.6)) < 0.4


@pytest.mark.parametrize(
    ("p", "x", "why"),
    [
        (to(2), 3.0, "the other stands behind"),
        (to(2), -1.0, "behind the radar"),
        (to(4, 3), 2.0, "aside"),
        (to(3, 0, 5.5), 2.0, "above the head"),
    ],
)
def test_who_is_not_between_hides_nothing(p: Float, x: float, why: str) -> None:
    assert past(standing(x), p) == pytest.approx(1, abs=3e-3), why


@pytest.mark.skipif(installed("numba") is None, reason="needs radhar[fast]")
@pytest.mark.parametrize("wavelength", [0.004, 0.0125, 0.15])
def test_machine_code_computes_the_same(wavelength: float, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(4)
    ends = np.array([[-1.0], [-3.0], [0.0]])[..., None] + rng.uniform(0, 6, (3, 13, 400))
    moving = {
        name: p + np.array([[0.0], [1.0], [0.0]]) * np.linspace(-2, 2, 400)
        for name, p in standing().items()
    }
    boxes = boxes_of_body(moving, STATURE, 1.0)
    compiled = field_behind_person(ends, ANTENNA, boxes, wavelength)
    monkeypatch.setattr(person_shadow, "installed", lambda library: None)
    interpreted = field_behind_person(ends, ANTENNA, boxes, wavelength)
    assert np.abs(compiled - interpreted).max() < 1e-12
    assert compiled.min() < 0.8


def test_boxes_that_overlap_hide_once() -> None:
    boxes = boxes_of_body(standing(), STATURE, 1.0)
    one = field_behind_person(to(4), ANTENNA, boxes[:1], 0.0125)[0, 0]
    twice = field_behind_person(to(4), ANTENNA, (boxes[0], boxes[0]), 0.0125)[0, 0]
    assert one**2 < twice < one


@given(
    st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(0, 3)),
    st.tuples(st.floats(-20, 20), st.floats(-20, 20)),
    st.sampled_from([2e9, 24e9, 77e9]),
    st.integers(0, 2**32 - 1),
)
def test_it_is_a_share_wherever_people_are_and_however_they_lie(
    p: tuple[float, ...], place: tuple[float, ...], carrier_hz: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    points = {
        name: np.array([[place[0]], [place[1]], [0.0]])
        + rng.uniform(-1, 1, (3, 1)) * [[1], [1], [0]]
        + rng.uniform(0, 2, (3, 1)) * [[0], [0], [1]]
        for name in JOINTS
    }
    boxes: tuple[BodyBox, ...] = boxes_of_body(points, STATURE, 1.0)
    field = field_behind_person(to(*p), ANTENNA, boxes, C / carrier_hz)[0, 0]
    assert 0 < field < 1.3
