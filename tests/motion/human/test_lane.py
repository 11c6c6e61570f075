"""Half turns of walkers to and fro: where they begin, and which are left out."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.motion.human.lane import Lane, WalkTimes, place_half_turns, position_along_lane

LANE = Lane(3.0, first=1.0, slow=0.4)
WALK = WalkTimes(begin=0.0, end=20.0, stops=True, start_up=0.0, ramp=0.6, stride=1.1)
ARC = 1.5
lengths, speeds, times = st.floats(0, 10), st.floats(0.3, 2.5), st.floats(0.1, 2)


def test_turns_are_a_straight_and_an_arc_apart() -> None:
    starts = place_half_turns(LANE, 1.2, ARC, WALK)
    assert starts[0] == LANE.first
    np.testing.assert_allclose(np.diff(starts), LANE.length + ARC)


def test_short_lanes_leave_room_to_change_speed() -> None:
    starts = place_half_turns(Lane(0.1), 1.2, ARC, WALK)
    np.testing.assert_allclose(np.diff(starts), ARC + 1.2 * WALK.ramp)


@given(lengths, speeds, times, times, st.booleans(), st.floats(0.1, 0.6))
def test_turns_are_those_of_a_walk_step_by_step(
    length: float, speed: float, ramp: float, stride: float, stops: bool, slow: float
) -> None:
    """A walker loses `slow` of the speed in each arc; no turn begins after the end."""
    lane, walk = Lane(length, slow=slow), WalkTimes(0.0, 20.0, stops, 0.0, ramp, stride)
    starts = place_half_turns(lane, speed, ARC, walk)
    lost = ARC * slow / (1 - slow)
    begins_s = (starts + lost * np.arange(starts.size)) / speed
    after_s = (ARC + lost) / speed if stops else 0.0
    limit_s = walk.end - ramp if stops else walk.end + stride
    assert (begins_s + after_s <= limit_s + 1e-9).all()
    if starts.size:
        spacing_s = (ARC + max(length, speed * ramp) + lost) / speed
        assert begins_s[-1] + spacing_s + after_s >= limit_s - 1e-9


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_who_has_turned_walks_back(side: float) -> None:
    x, _, heading = position_along_lane(np.array([0.5, 5.5]), np.array([2.0]), ARC, side)
    assert heading == pytest.approx([0.0, side * pi])
    assert x[1] < 2.0
