"""scripts/studies/points_of_scatterers.py: rows of the table of chains."""

import importlib.util
import sys
from types import ModuleType

import numpy as np
import pytest
from helpers.command_line import ROOT
from helpers.scatterers import ISK, echo_of


@pytest.fixture(scope="module")
def study() -> ModuleType:
    path = ROOT / "scripts/studies/points_of_scatterers.py"
    spec = importlib.util.spec_from_file_location("points_of_scatterers", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_samples_are_those_of_the_contract(study: ModuleType) -> None:
    scatterer = study.draw_scatterer(np.random.default_rng(2))
    for board, masks in ((ISK, (1, 2, 4)), (study.BPM, (5, 2, 5))):
        echo = study.sample(board, scatterer, np.random.default_rng(3))
        noise = study.sample(board, None, np.random.default_rng(3))
        position = scatterer.direction * scatterer.range
        moving = {
            "position_m": position,
            "velocity_mps": scatterer.direction * scatterer.speed,
            "amplitude": study.AMPLITUDE,
        }
        expected = echo_of(board, [moving], masks, board.bpm)
        np.testing.assert_allclose((echo - noise)[0], expected, atol=1e-9)


def test_a_row_has_the_errors_of_its_chain(study: ModuleType) -> None:
    board, find = study.chains()["best, ISK"]
    cells = study.row_of("best", board, find, 2, 1).split("|")
    assert [cell.strip() for cell in cells[1:2]] == ["best"]
    assert cells[3].strip() == "0 of 2"
    assert abs(float(cells[4].split("+-")[0])) < 20
    assert len(cells) == len(study.HEAD.splitlines()[0].split("|"))


def test_bpm_has_three_decibels_less_noise_and_more_points(study: ModuleType) -> None:
    """Peaks rise by less than 3 dB: what moves leaks between the two transmitters."""
    noise, peaks, counts = study.compare_bpm(8)
    assert noise == pytest.approx(-3.0, abs=0.15)
    assert 0.8 < peaks[0] - peaks[1] < 3.0
    assert counts[0] > 1.1 * counts[1]


@pytest.mark.parametrize("name", ["people_counting, IWR1642BOOST", "sdk1, IWR1443BOOST"])
def test_older_boards_find_single_scatterers_too(study: ModuleType, name: str) -> None:
    board, find = study.chains()[name]
    cells = study.row_of(name, board, find, 6, 2).split("|")
    assert int(cells[3].split()[0]) <= 1
    assert abs(float(cells[4].split("+-")[0])) < 40
    assert abs(float(cells[7].split("+-")[0])) < 0.1
