"""What `make test` leaves out and `make test-all` runs: cases of a test, and examples of a law."""

from collections.abc import Collection, Iterable
from typing import Any

import pytest

FAST_SHARE = 0.2  # of the examples that Hypothesis draws
FEWEST = 5

whole_suite = False  # conftest.py says so where no test is left out


def slow(cases: Iterable[Any]) -> list[Any]:
    """The cases of a parametrised test, marked slow; a tuple is a row of several arguments."""
    return [
        pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.slow)
        for case in cases
    ]


def slow_but(cases: Iterable[Any], kept: Collection[Any]) -> list[Any]:
    """All cases of a parametrised test, marked slow but for those that are kept."""
    return [case if case in kept else pytest.param(case, marks=pytest.mark.slow) for case in cases]


def examples(count: int) -> int:
    """Number of examples or draws of a costly test, of `count` in the whole suite."""
    return count if whole_suite else min(count, max(FEWEST, round(FAST_SHARE * count)))
