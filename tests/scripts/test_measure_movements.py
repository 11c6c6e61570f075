"""Every movement lies within its bounds, and the page of figures is as the script writes it."""

import measure_movements as script
import pytest


def excesses(bounds: list[script.Bound]) -> list[str]:
    """What lies out of its bounds, in words."""
    return [
        f"{bound.quantity}: {least:.3g} to {most:.3g}, not {bound.least:g} to {bound.most:g}"
        for bound in bounds
        for least, most in [script.values(bound)]
        if least < bound.least or most > bound.most
    ]


@pytest.mark.every(4)
@pytest.mark.parametrize("way", script.WAYS)
def test_a_movement_is_within_its_bounds(way: str) -> None:
    bounds = [bound for bound in script.bounds() if bound.way == way]
    assert len(bounds) >= 6
    assert excesses(bounds) == []


def test_the_page_has_every_movement_and_bound() -> None:
    page = script.PAGE.read_text(encoding="utf-8")
    assert all(f"| {way} |" in page for way in script.WAYS)
    for bound in script.MEASURED:
        assert f"| {bound.least:g} to {bound.most:g} | {bound.source} |" in page
