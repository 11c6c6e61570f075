"""Tests of the direct engine hold for both of its sums, where numba is installed."""

from collections.abc import Iterator

import pytest

from radhar_cli.echo import compiled
from radhar_cli.numerics.accelerators import installed


@pytest.fixture(scope="module", params=["numpy", "numba"])
def either_sum(request: pytest.FixtureRequest) -> Iterator[None]:
    """The sum over paths with NumPy, and then as machine code."""
    if request.param == "numba" and installed("numba") is None:
        pytest.skip("needs radhar[fast]")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "pays", lambda terms: request.param == "numba")
        yield
