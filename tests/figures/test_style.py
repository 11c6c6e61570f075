"""One style of figures: colours that differ, numbers that are write_rounded, left on the left."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from radhar_cli.figures.page import page
from radhar_cli.figures.sides import VIEWS, SideView, StillView
from radhar_cli.figures.stickman import near_limits, wide_limits
from radhar_cli.figures.stream_page import AT_REST, label_colours
from radhar_cli.figures.style import (
    LEFT,
    MIDDLE,
    RIGHT,
    decibels_in_words,
    describe_band,
    distinct_colours,
    joint_colours,
    write_rounded,
)


def is_grey(colour: object) -> bool:
    red, green, blue = to_rgb(colour)  # type: ignore[arg-type]
    return max(red, green, blue) - min(red, green, blue) < 0.02


@pytest.mark.parametrize("count", [2, 12, 18, 30])
def test_colours_of_classes_differ_and_none_is_grey(count: int) -> None:
    colours = [np.array(to_rgb(colour)) for colour in distinct_colours(count)]
    assert len(colours) == count
    assert not any(map(is_grey, distinct_colours(count)))
    assert min(np.abs(a - b).max() for a, b in combinations(colours, 2)) > 0.05


def test_rest_alone_is_grey() -> None:
    names = [*(f"class {n}" for n in range(9)), "pause", "transition"]
    assert [
        name for name, colour in zip(names, label_colours(names), strict=True) if is_grey(colour)
    ] == [*AT_REST]


def test_joints_have_the_colour_of_their_side() -> None:
    assert joint_colours(("torso", "right_hand", "left_ankle")) == [MIDDLE, RIGHT, LEFT]


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [
        (77.42e9, 80.31811e9, "77.4 to 80.3 GHz"),
        (24.02e9, 24.22e9, "24.02 to 24.22 GHz"),
        (1e9, 3e9, "1.0 to 3.0 GHz"),
    ],
)
def test_a_band_has_the_decimals_that_tell_its_ends_apart(
    low: float, high: float, words: str
) -> None:
    assert describe_band(low, high) == words


@pytest.mark.parametrize(
    ("value", "text"), [(7352.9, "7350"), (12345, "12300"), (0.03456, "0.0346"), (-0.0, "0")]
)
def test_numbers_are_rounded_without_exponents(value: float, text: str) -> None:
    assert write_rounded(value) == text


@pytest.mark.parametrize(("value", "text"), [(25.3, "25 dB"), (2.53, "2.5 dB"), (-0.01, "0 dB")])
def test_decibels_are_rounded(value: float, text: str) -> None:
    assert decibels_in_words(value) == text


@pytest.mark.parametrize("name", ["from the radar", "from above"])
def test_left_of_the_radar_is_on_the_left(name: str) -> None:
    axes = page(4, 4).subplots()
    limits = np.array([(0.0, 5.0), (-2.0, 2.0), (0.0, 2.0)])
    SideView(axes, name, limits, 1.0, [], StillView())
    (left, _), (right, _) = (axes.transData.transform((y, 1.0)) for y in (1.0, -1.0))
    assert left < right


def test_near_views_hold_all_and_have_one_scale() -> None:
    places = np.array([(-0.4, -0.3, 0.05), (0.5, 0.3, 1.9)])
    limits = near_limits(places)
    assert (limits[:, 0] < places[0]).all()
    assert (limits[:, 1] > places[1]).all()
    assert np.ptp(limits, axis=1) == pytest.approx(np.ptp(limits[0]))
    assert limits[2, 0] > -0.2  # a person stands at the bottom of the picture


def test_the_view_from_above_has_the_radar_and_the_walls() -> None:
    wall = np.array([(1.0, -2.5), (1.2, 2.5)])
    limits = wide_limits(np.array([(4.0, 0.0, 0.0), (6.0, 0.5, 1.8)]), StillView(outlines=(wall,)))
    assert VIEWS["from above"] == (1, 0)
    for ahead, left in ((0.0, 0.0), (1.0, -2.5), (1.2, 2.5), (6.0, 0.5)):
        assert limits[0, 0] < ahead < limits[0, 1]
        assert limits[1, 0] < left < limits[1, 1]
