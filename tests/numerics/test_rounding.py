"""Rounding of decimals as written: floor(product + 1/2), whatever the nearest doubles are."""

from fractions import Fraction
from math import floor

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.numerics.rounding import exact, half_up, show_beside


@pytest.mark.parametrize(
    ("factors", "rounded"),
    [
        ((0.5,), 1),
        ((2.5,), 3),  # to even would be 2
        ((0.49999999999999994,), 0),  # floor(x + 0.5) in doubles would be 1
        ((0.1, 15), 2),
        ((0.145, 100), 15),  # 14.499999999999998 in doubles
        ((1.005, 100), 101),  # 100.49999999999999 in doubles
        ((10e6, 40e-6), 400),
        ((0.1, 4.0, 5000.0), 2000),
        ((1e-3, 499), 0),
    ],
)
def test_halves_go_up(factors: tuple[float, ...], rounded: int) -> None:
    assert half_up(*factors) == rounded


@given(st.integers(0, 10**9), st.integers(0, 9), st.integers(0, 10**6))
@settings(deadline=None, max_examples=60)
def test_decimal_times_whole_number_is_exact(digits: int, places: int, count: int) -> None:
    decimal = float(f"{digits}e-{places}")
    assert half_up(decimal, count) == floor(Fraction(digits * count, 10**places) + Fraction(1, 2))


def test_a_float_is_the_decimal_it_was_written_as() -> None:
    assert exact(0.1) == Fraction(1, 10)
    assert exact(77e9) == 77 * 10**9
    assert exact(3) == 3


@pytest.mark.parametrize(
    ("number", "other", "text"),
    [
        (0.001, 0.0010000001, "0.001"),
        (0.0010000001, 0.001, "0.0010000001"),
        (1 / 2998, 0.000333556, "0.0003335557"),
        (0.03, 0.03 * (1 + 1e-6), "0.03"),
        (5.0, 7.0, "5"),
        (5.0, 5.0, "5"),
    ],
)
def test_a_number_is_written_with_digits_enough_to_differ(
    number: float, other: float, text: str
) -> None:
    assert show_beside(number, other) == text


@given(st.floats(1e-12, 1e12), st.floats(-1e-3, 1e-3))
def test_numbers_that_differ_never_read_alike(number: float, change: float) -> None:
    other = number * (1 + change)
    texts = show_beside(number, other), show_beside(other, number)
    assert (texts[0] == texts[1]) == (number == other)
    if number != other:
        assert (float(texts[0]) < other) == (number < other)
