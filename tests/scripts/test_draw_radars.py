"""Built-in radars beside their data sheets: every figure within its tolerance, and on the page."""

from functools import lru_cache

import draw_radars
import numpy as np
import pytest
from draw_radars import CALCULATED, MEMORY

from radhar_cli.config.documents import RADARS, WRITTEN_RADARS
from radhar_cli.scene.radar_figures import RadarFigures, beam_width_deg, describe_figures

NAMES = (*WRITTEN_RADARS, *RADARS)
SHEETS, SOURCES, TOLERANCES = draw_radars.read_sheets()
each = pytest.mark.parametrize("name", NAMES)


@lru_cache
def figures_of_radar(name: str) -> RadarFigures:
    return draw_radars.compute_figures(name)


def test_every_built_in_radar_has_a_data_sheet_and_no_other_has() -> None:
    assert sorted(SHEETS) == sorted(NAMES)
    assert len(WRITTEN_RADARS) >= 14


@each
def test_its_figures_are_those_of_the_data_sheet(name: str) -> None:
    figures, sheet = figures_of_radar(name), SHEETS[name]
    for key, (value, source) in sheet.figures.items():
        assert source in SOURCES
        tolerance = TOLERANCES.get(key, 0)  # numbers of elements are exact
        assert getattr(figures, key) == pytest.approx(value, rel=tolerance), key
    antennas, source = sheet.antennas
    assert antennas == f"{figures.transmitters} x {figures.receivers}"
    assert source in SOURCES


@each
def test_what_it_has_no_figure_for_it_cannot_see(name: str) -> None:
    figures, typed = figures_of_radar(name), SHEETS[name].figures
    has_range = figures.range_step_m is not None
    assert has_range is ("range_step_m" in typed) is ("last_range_m" in typed)
    assert (figures.azimuth_deg is not None) is ("azimuth_deg" in typed)
    assert "speed_limit_mps" in typed


@each
def test_its_row_stands_in_the_documents(name: str) -> None:
    """`python scripts/draw_radars.py COMMIT` writes them."""
    row = draw_radars.table_row(name, figures_of_radar(name), SHEETS[name], 0.0)
    assert row.removesuffix("0 dB |") in draw_radars.PAGE.read_text()


def test_sources_stand_in_the_documents() -> None:
    page = draw_radars.PAGE.read_text()
    assert all(where in page for name, where in SOURCES.items() if name != CALCULATED)
    assert MEMORY in SOURCES


@pytest.mark.parametrize(
    ("places", "width"),
    [([0, 1], 60.0), ([0, 1, 2, 3], 26.3), (range(8), 12.8), ([0, 2], 28.96), ([0], None)],
)
def test_a_beam_is_as_wide_as_that_of_its_row(places: list[int], width: float | None) -> None:
    """Of two elements |cos(pi d sin/2)|^2 is a half at sin = 1/(2 d)."""
    computed = beam_width_deg(np.array(places, float))
    assert computed is None if width is None else computed == pytest.approx(width, abs=0.05)


def test_a_radar_without_range_says_none() -> None:
    line = describe_figures(figures_of_radar("klc6"))
    assert "ranges" not in line
    assert "2560 pulses a second" in line


@pytest.mark.parametrize(
    ("name", "least_db", "most_db"),
    [("tinyrad24g", 50, 75), ("klc6", 40, 62), ("a121", 3, 25), ("bgt60tr13c", 30, 55)],
)
def test_a_walker_at_3_m_stands_above_the_noise_as_makers_say(
    name: str, least_db: float, most_db: float
) -> None:
    """Within what docs/guide/radars.md derives: 1 m^2 of TinyRad's maker is 75 dB, of RFbeam 62."""
    walk = draw_radars.walk_to(name, 7)
    assert least_db < draw_radars.level_above_noise(walk) < most_db


def test_a_walker_to_the_left_is_seen_there() -> None:
    points = draw_radars.walk_to("tinyrad24g", 7).frames["cloud"].points
    assert np.median(points[:, 1]) == pytest.approx(draw_radars.LEFT_M, abs=0.2)
