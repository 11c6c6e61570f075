"""scripts/studies/two_in_a_cell.py and kinds_of_ghosts.py: their rows and counts."""

import importlib.util
import sys
from types import ModuleType

import numpy as np
import pytest
from helpers.command_line import ROOT


def _load(name: str) -> ModuleType:
    folder = str(ROOT / "scripts/studies")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    spec = importlib.util.spec_from_file_location(name, f"{folder}/{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def test_two_beside_each_other_are_found_without_a_stray() -> None:
    cells = _load("two_in_a_cell").row_of("IWR6843ISK", "azimuth", 6, 3).split("|")
    assert [cell.strip() for cell in cells[1:4]] == ["IWR6843ISK", "azimuth", "0 %"]
    assert cells[5].strip() == "100 %"
    assert float(cells[6]) < 0.5


@pytest.mark.parametrize("axis", ["azimuth", "elevation"])
def test_directions_are_apart_along_one_axis(axis: str) -> None:
    study = _load("two_in_a_cell")
    for seed in range(5):
        ways = study.draw_directions(np.random.default_rng(seed), axis)
        np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1)
        az = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
        el = np.degrees(np.arcsin(ways[:, 2]))
        apart, same = (az, el) if axis == "azimuth" else (el, az)
        assert 20 <= np.ptp(apart) <= 80
        assert np.ptp(same) < 1e-9


def test_ways_of_points_follow_from_the_echoes_of_each() -> None:
    study = _load("kinds_of_ghosts")
    counts = study.count_kinds(2, 5, "torso")
    best = counts["best, ISK"]
    assert sum(best.values()) > 3
    right = sum(n for (true, kind), n in best.items() if true == kind)
    assert right >= 0.7 * sum(n for (true, _), n in best.items() if true >= 0)
