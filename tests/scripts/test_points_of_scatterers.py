"""scripts/studies/points_of_scatterers.py: rows of the table of chains."""

import numpy as np
import points_of_scatterers
import pytest
from helpers.scatterers import ISK, echo_of


def test_samples_are_those_of_the_contract() -> None:
    scatterer = points_of_scatterers.draw_scatterer(np.random.default_rng(2))
    for board, masks in ((ISK, (1, 2, 4)), (points_of_scatterers.BPM, (5, 2, 5))):
        echo = points_of_scatterers.sample(board, scatterer, np.random.default_rng(3))
        noise = points_of_scatterers.sample(board, None, np.random.default_rng(3))
        position = scatterer.direction * scatterer.range
        moving = {
            "position_m": position,
            "velocity_mps": scatterer.direction * scatterer.speed,
            "amplitude": points_of_scatterers.AMPLITUDE,
        }
        expected = echo_of(board, [moving], masks, board.bpm)
        np.testing.assert_allclose((echo - noise)[0], expected, atol=1e-9)


def test_a_row_has_the_errors_of_its_chain() -> None:
    board, find = points_of_scatterers.chains()["best, ISK"]
    cells = points_of_scatterers.row_of("best", board, find, 2, 1).split("|")
    assert [cell.strip() for cell in cells[1:2]] == ["best"]
    assert cells[3].strip() == "0 of 2"
    assert abs(float(cells[4].split("+-")[0])) < 20
    assert len(cells) == len(points_of_scatterers.HEAD.splitlines()[0].split("|"))


def test_bpm_has_three_decibels_less_noise_and_more_points() -> None:
    """Peaks rise by less than 3 dB: what moves leaks between the two transmitters."""
    noise, peaks, counts = points_of_scatterers.compare_bpm(8)
    assert noise == pytest.approx(-3.0, abs=0.15)
    assert 0.8 < peaks[0] - peaks[1] < 3.0
    assert counts[0] > 1.1 * counts[1]


@pytest.mark.parametrize("name", ["people_counting, IWR1642BOOST", "sdk1, IWR1443BOOST"])
def test_older_boards_find_single_scatterers_too(name: str) -> None:
    board, find = points_of_scatterers.chains()[name]
    cells = points_of_scatterers.row_of(name, board, find, 6, 2).split("|")
    assert int(cells[3].split()[0]) <= 1
    assert abs(float(cells[4].split("+-")[0])) < 40
    assert abs(float(cells[7].split("+-")[0])) < 0.1
