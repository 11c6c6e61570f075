"""The end of what is fine: found from a number that is, whatever the scale."""

import pytest

from radhar_cli.study.limits.judging import CLEAN, Consequence, Judgement
from radhar_cli.study.limits.search import GAP, End, Path, find_end, find_end_at_zero

BEYOND = Judgement(Consequence.WARNED, reason="beyond")


def up_to(threshold):
    return lambda number: CLEAN if number <= threshold else BEYOND


def down_to(threshold):
    return lambda number: CLEAN if number >= threshold else BEYOND


@pytest.mark.parametrize(
    ("start", "bound", "threshold"),
    [(2.0, 3.0, 2.71), (1.0, 1e9, 12345.0), (0.4, 1e6, 57.3), (-80.0, 300.0, 12.3), (0.0, 360, 90)],
)
def test_an_end_is_found_to_a_hundredth(start: float, bound: float, threshold: float) -> None:
    end = find_end(up_to(threshold), Path(start, bound))
    assert end.inside <= threshold < end.outside
    assert end.outside - end.inside <= 0.011 * abs(end.outside) + 1e-12
    assert end.judgement is BEYOND


@pytest.mark.parametrize("threshold", [1e-3, 3.3e3])
def test_a_lower_end(threshold: float) -> None:
    end = find_end(down_to(threshold), Path(1e4, 1e-9))
    assert end.outside < threshold <= end.inside
    assert end.inside <= (1 + 2 * GAP) * end.outside + 1e-12


def test_a_bound_that_is_fine_is_the_end_after_two_numbers() -> None:
    tried: list[float] = []

    def judge(number: float) -> Judgement:
        tried.append(number)
        return CLEAN

    assert find_end(judge, Path(1.0, 1e6)) == End(1e6, None, CLEAN)
    assert len(tried) == 2


def test_the_nearest_of_two_ends_is_found() -> None:
    def judge(number: float) -> Judgement:
        return BEYOND if 10 < number < 1e4 or number > 1e6 else CLEAN

    end = find_end(judge, Path(1.0, 1e9))
    assert end.inside <= 10 < end.outside


def test_whole_numbers() -> None:
    end = find_end(up_to(7), Path(0, 10, is_whole=True))
    assert (end.inside, end.outside) == (7, 8)


def test_zero_is_tried_first_and_may_be_fine_or_the_only_one_that_is_not() -> None:
    assert find_end_at_zero(down_to(0.0), Path(3.0, 0.0)).inside == 0
    end = find_end_at_zero(down_to(1e-300), Path(3.0, 0.0))
    assert (end.inside, end.outside) == (pytest.approx(3e-9), 0.0)
    end = find_end_at_zero(down_to(0.02), Path(3.0, 0.0))
    assert end.outside < 0.02 <= end.inside


def test_a_start_beyond_which_nothing_is_fine_is_its_own_end() -> None:
    end = find_end(up_to(5.0), Path(5.0, 1e6))
    assert end.inside == 5.0


def test_a_gap_on_the_way_of_a_place_is_the_end() -> None:
    """Nobody stands where the antenna is, whatever is beyond."""
    end = find_end(lambda x: BEYOND if abs(x - 0.4) < 0.3 or x < -7 else CLEAN, Path(2.5, -1e6))
    assert end.outside < 0.7 <= end.inside
    assert end.inside < 0.72


def test_what_comes_round_ends_at_the_first_angle() -> None:
    end = find_end(lambda x: BEYOND if 80 < x < 280 else CLEAN, Path(0.0, 360.0))
    assert end.inside <= 80 < end.outside
    assert end.judgement is BEYOND
