"""Numbers of a scene: every distribution form, its support, its nominal and its quantiles."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError
from scipy.stats import truncnorm

from radhar_cli.schema.number import Number, is_fixed, nominal, quantile, support

NUMBER: TypeAdapter[Any] = TypeAdapter(Number)
VALUES = st.floats(-1e6, 1e6)
FRACTIONS = st.floats(0, 1)
GRID = (np.arange(2000) + 0.5) / 2000


def uniforms() -> st.SearchStrategy[dict[str, Any]]:
    return st.tuples(VALUES, VALUES).map(lambda pair: {"uniform": sorted(pair)})


@st.composite
def normals(draw: st.DrawFn) -> dict[str, Any]:
    """Bounds, where there are any, lie within 6 standard deviations, also both on one side."""
    mean, sd = draw(VALUES), draw(st.floats(1e-3, 1e3))
    low, high = sorted((draw(st.floats(-5.9, 5.9)), draw(st.floats(-5.9, 5.9))))
    form: dict[str, Any] = {"normal": [mean, sd]}
    if draw(st.booleans()):
        form["min"] = mean + low * sd
    if draw(st.booleans()):
        form["max"] = mean + high * sd
    return form


def varies() -> st.SearchStrategy[dict[str, Any]]:
    return st.tuples(VALUES, FRACTIONS).map(lambda pair: {"vary": list(pair)})


def choices() -> st.SearchStrategy[dict[str, Any]]:
    return st.lists(VALUES, min_size=1, max_size=6).map(lambda values: {"choice": values})


CONTINUOUS = st.one_of(VALUES, uniforms(), normals(), varies())
FORMS = st.one_of(CONTINUOUS, choices())


@given(FORMS, st.lists(FRACTIONS, max_size=8))
@settings(deadline=None, max_examples=150)
def test_draws_and_nominal_lie_within_the_support(form: Any, fractions: list[float]) -> None:
    number = NUMBER.validate_python(form)
    low, high = support(number)
    drawn = [quantile(number, u) for u in (0.0, 1.0, *fractions)]
    assert all(low <= value <= high for value in [*drawn, nominal(number)])


@given(CONTINUOUS, st.lists(FRACTIONS, min_size=2, max_size=8))
@settings(deadline=None, max_examples=100)
def test_quantiles_rise(form: Any, fractions: list[float]) -> None:
    number = NUMBER.validate_python(form)
    drawn = [quantile(number, u) for u in sorted(fractions)]
    assert drawn == sorted(drawn)


@given(choices(), st.lists(FRACTIONS, min_size=2, max_size=8))
@settings(deadline=None, max_examples=50)
def test_quantiles_of_choices_rise_in_whatever_order_they_are_written(
    form: Any, fractions: list[float]
) -> None:
    number = NUMBER.validate_python(form)
    drawn = [quantile(number, u) for u in sorted(fractions)]
    assert drawn == sorted(drawn)


@given(CONTINUOUS)
@settings(deadline=None, max_examples=100)
def test_quantiles_span_the_whole_support(form: Any) -> None:
    number = NUMBER.validate_python(form)
    low, high = support(number)
    # An end of a Gaussian is found again by its probability, to about 1e-6 of the 6 sd reach;
    # below that, by the rounding of an sd of up to 1e3.
    reach = 1e-6 * (high - low) + 1e-12 * max(1.0, abs(low), abs(high))
    assert quantile(number, 0.0) == pytest.approx(low, abs=reach)
    assert quantile(number, 1.0) == pytest.approx(high, abs=reach)


@given(FORMS)
@settings(deadline=None, max_examples=100)
def test_a_fixed_number_has_one_value(form: Any) -> None:
    number = NUMBER.validate_python(form)
    low, high = support(number)
    assert is_fixed(number) == (low == high)
    if is_fixed(number):
        assert {quantile(number, u) for u in (0.0, 0.3, 1.0)} == {nominal(number)}


@pytest.mark.parametrize(
    ("form", "supported", "middle"),
    [
        (1.8, (1.8, 1.8), 1.8),
        (2, (2, 2), 2),
        ({"uniform": [1.5, 1.9]}, (1.5, 1.9), 1.7),
        ({"normal": [1.7, 0.1]}, (1.1, 2.3), 1.7),
        ({"normal": [1.7, 0.1], "min": 1.5}, (1.5, 2.3), 1.7),
        ({"normal": [1.7, 0.1], "min": 1.8, "max": 2.0}, (1.8, 2.0), 1.8),
        ({"normal": [1.7, 0.1], "max": 1.6}, (1.1, 1.6), 1.6),
        ({"normal": [1.7, 0.0]}, (1.7, 1.7), 1.7),
        ({"choice": [10, 20, 30]}, (10, 30), 20),
        ({"choice": [30, 10, 20, 0]}, (0, 30), 10),
        ({"vary": [30, 0.2]}, (24, 36), 30),
        ({"vary": [-30, 0.2]}, (-36, -24), -30),
    ],
)
def test_support_and_nominal(form: Any, supported: tuple[float, float], middle: float) -> None:
    number = NUMBER.validate_python(form)
    assert support(number) == pytest.approx(supported, rel=1e-14)
    assert nominal(number) == pytest.approx(middle, rel=1e-14)


@pytest.mark.parametrize("form", [{"uniform": [24, 36]}, {"vary": [30, 0.2]}])
def test_uniform_and_vary_are_uniform(form: Any) -> None:
    number = NUMBER.validate_python(form)
    assert [quantile(number, u) for u in GRID] == pytest.approx(list(24 + 12 * GRID), rel=1e-14)


@pytest.mark.parametrize(
    ("low", "high"),
    [(-6.0, 6.0), (-1.0, 0.5), (0.3, 2.0), (-3.0, -2.0), (5.0, 5.5), (-5.5, -5.0)],
)
def test_normal_is_a_truncated_gaussian(low: float, high: float) -> None:
    mean, sd = 1.7, 0.1
    number = NUMBER.validate_python(
        {"normal": [mean, sd], "min": mean + low * sd, "max": mean + high * sd}
    )
    expected = truncnorm.ppf(GRID, low, high, loc=mean, scale=sd)
    # Both sides invert a tail probability of down to 1e-9, of which doubles keep 7 digits.
    assert [quantile(number, u) for u in GRID] == pytest.approx(list(expected), rel=1e-8)


def test_weights_say_how_often_each_choice_is_drawn() -> None:
    law = NUMBER.validate_python({"choice": [0, 90, -90, 180], "weights": [3, 2, 2, 1]})
    drawn = [law.quantile((place + 0.5) / 800) for place in range(800)]
    assert [drawn.count(value) for value in (0, 90, -90, 180)] == [300, 200, 200, 100]
    assert (law.quantile(0.0), law.quantile(1.0), law.nominal) == (-90, 180, 0)
    repeated = NUMBER.validate_python({"choice": [0, 0, 0, 90, 90, -90, -90, 180]})
    assert all(law.quantile(u) == repeated.quantile(u) for u in np.linspace(0, 1, 1001))
    assert NUMBER.validate_python({"choice": [0, 1], "weights": [0, 2]}).quantile(0.0) == 1
    parts = NUMBER.validate_python({"choice": [{"uniform": [0, 1]}, 5], "weights": [3, 1]})
    assert parts.quantile(0.375) == pytest.approx(0.5)


@pytest.mark.parametrize("weights", [[1], [1, -1], [0, 0], [1, 1, 1], [1, "many"], 3])
def test_weights_that_are_no_law_are_refused(weights: object) -> None:
    with pytest.raises(ValidationError, match="weights"):
        NUMBER.validate_python({"choice": [0, 1], "weights": weights})


def test_choices_without_weights_are_written_without() -> None:
    assert NUMBER.validate_python({"choice": [0, 1]}).model_dump() == {"choice": (0.0, 1.0)}
    assert NUMBER.validate_python({"choice": [0, 1], "weights": [2, 1]}).model_dump()[
        "weights"
    ] == (2.0, 1.0)


def test_choices_are_equally_likely() -> None:
    number = NUMBER.validate_python({"choice": [30, -10, 20, 20]})
    values, counts = np.unique([quantile(number, u) for u in GRID], return_counts=True)
    assert dict(zip(values, counts, strict=True)) == {-10: 500, 20: 1000, 30: 500}


@pytest.mark.parametrize(
    "form",
    [
        True,
        "1.8",
        None,
        [1.5, 1.9],
        float("nan"),
        float("inf"),
        1e31,
        {},
        {"gaussian": [1, 2]},
        {"uniform": [1.5, 1.9], "vary": [1.7, 0.1]},
        {"uniform": [1.9, 1.5]},
        {"uniform": [1.5]},
        {"uniform": [1.5, 1.7, 1.9]},
        {"uniform": [False, True]},
        {"uniform": ["1", "2"]},
        {"uniform": [0, float("inf")]},
        {"uniform": [1, 2], "min": 1},
        {"normal": [1.7, -0.1]},
        {"normal": [1.7, 0.1], "min": 1.9, "max": 1.8},
        {"normal": [1.7, 0.1], "min": 2.4},
        {"normal": [1.7, 0.1], "max": 1.0},
        {"choice": []},
        {"choice": [1, "a"]},
        {"vary": [30, -0.1]},
        {"vary": [30, 1.1]},
        {"vary": [30, float("nan")]},
    ],
)
def test_invalid_numbers_are_refused(form: Any) -> None:
    with pytest.raises(ValidationError):
        NUMBER.validate_python(form)
