"""The body at rest: links, RCS and weight scale as the paper's table says."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.motion.skeleton import (
    JOINTS,
    PARENTS,
    cross_sections,
    default_weight,
    links,
    standing_height,
    thigh_length,
)

HEIGHTS = st.floats(0.5, 2.5)
# A handful of roundings of numbers of order one.
ROUNDING = 1e-14

# (cross-range, height, RCS) of every scatterer of the reference person, 1.8 m and 84.24 kg.
STANDING = {
    "torso": (0.0, 1.2, 1.0),
    "head": (0.0, 1.5, 0.5),
    "right_shoulder": (-0.2, 1.4, 0.1),
    "right_elbow": (-0.2, 1.1, 0.3),
    "right_hand": (-0.2, 0.8, 0.2),
    "left_shoulder": (0.2, 1.4, 0.1),
    "left_elbow": (0.2, 1.1, 0.3),
    "left_hand": (0.2, 0.8, 0.2),
    "hip": (0.0, 0.9, 0.1),
    "right_knee": (0.0, 0.45, 0.4),
    "right_ankle": (0.0, 0.0, 0.3),
    "left_knee": (0.0, 0.45, 0.4),
    "left_ankle": (0.0, 0.0, 0.3),
}


def standing(height: float) -> np.ndarray:
    """Positions [13, 3] above the origin, links added up along the chain."""
    p = links(height)
    p[0, 2] += standing_height(height)
    for joint, parent in enumerate(PARENTS):
        if parent is not None:
            p[joint] += p[parent]
    return p


def test_the_reference_person_stands_as_in_the_table() -> None:
    assert tuple(STANDING) == JOINTS
    expected = [(0.0, y, z) for y, z, _ in STANDING.values()]
    np.testing.assert_allclose(standing(1.8), expected, atol=ROUNDING)


def test_parents_come_before_their_children() -> None:
    assert PARENTS[0] is None
    assert all(parent is not None and parent < i for i, parent in enumerate(PARENTS) if i)


@given(HEIGHTS)
@settings(deadline=None, max_examples=30)
def test_everybody_has_the_same_proportions(height: float) -> None:
    np.testing.assert_allclose(standing(height), standing(1.8) * height / 1.8, atol=ROUNDING)
    assert thigh_length(height) == pytest.approx(0.25 * height, rel=ROUNDING)


@given(HEIGHTS)
@settings(deadline=None, max_examples=30)
def test_everybody_stands_on_the_ground(height: float) -> None:
    ankles = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]
    np.testing.assert_allclose(standing(height)[ankles, 2], 0, atol=ROUNDING)


def test_rcs_of_the_reference_person() -> None:
    expected = [rcs for _, _, rcs in STANDING.values()]
    np.testing.assert_allclose(cross_sections(1.8, 84.24), expected, rtol=ROUNDING)


@given(HEIGHTS, st.floats(10, 300))
@settings(deadline=None, max_examples=30)
def test_rcs_grows_with_the_root_of_height_times_weight(height: float, weight: float) -> None:
    expected = cross_sections(1.8, 84.24) * np.sqrt(height * weight / (1.8 * 84.24))
    np.testing.assert_allclose(cross_sections(height, weight), expected, rtol=ROUNDING)


@pytest.mark.parametrize(
    ("height", "weight"),
    [(2.1, 114.66), (1.8, 84.24), (1.5, 58.5), (1.35, 17.0 * 1.35**2), (1.1, 18.755), (1.0, 15.5)],
)
def test_default_weight_is_26_kg_per_square_metre_of_grown_ups_and_less_of_children(
    height: float, weight: float
) -> None:
    assert default_weight(height) == pytest.approx(weight, rel=ROUNDING)
