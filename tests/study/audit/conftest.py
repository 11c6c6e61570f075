"""Audits write many figures, at which few of these tests look."""

import pytest


@pytest.fixture(autouse=True)
def quick_reports(blank_figures: None) -> None:
    """Write blank figures."""
