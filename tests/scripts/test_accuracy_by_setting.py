"""scripts/studies/accuracy_by_setting.py: its rows, the signal that is wrong, and the table."""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from helpers import command_line

from radhar_cli.config import load_config
from radhar_cli.products.run import record
from radhar_cli.scene_checks.drawing import draw_valid_scene
from radhar_cli.study.tradeoff.accuracy import SeedAccuracy
from radhar_cli.study.tradeoff.differences import relative_db


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    folder = command_line.ROOT / "scripts/studies"
    monkeypatch.syspath_prepend(folder)
    spec = importlib.util.spec_from_file_location("by_setting", folder / "accuracy_by_setting.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_row_is_another_config_or_signal(script: ModuleType) -> None:
    path = command_line.ROOT / "configs/quickstart.yaml"
    rows = [(load_config(path, row.overrides), row.error_db) for row in script.ROWS]
    assert all(rows.count(row) == 1 for row in rows)
    assert len({row.name for row in script.ROWS}) == len(rows)


@pytest.mark.parametrize("db", [-20.0, -50.0])
def test_the_error_of_the_signal(script: ModuleType, tmp_path: Path, db: float) -> None:
    """It has the level that its row names, relative to the signal without noise."""
    path = tmp_path / "c.yaml"
    path.write_text(
        "{activities: [walking], duration_s: 1, snr_db: 10, maps: [stft], "
        "radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 1000, adc_rate_hz: 1e6}}"
    )
    signals = []
    for overrides, products in (
        (("snr_db=null",), ()),
        ((), ()),
        ((), script.signal_error(db).products),
    ):
        config = load_config(path, overrides)
        scene = draw_valid_scene(config, config.chosen_activities[0], 0)[0]
        signals.append(record(scene, ["signal"], products)["signal"].x[0, 0])
    clean, noisy, wrong = signals
    # float32 of the engine's sum in each of the three
    assert relative_db(clean + wrong - noisy, clean) == pytest.approx(db, abs=0.1)
    spectrum = np.abs(np.fft.fft(wrong - noisy)) ** 2
    assert spectrum[: spectrum.size // 2].sum() == pytest.approx(spectrum.sum() / 2, rel=0.1)


def test_the_table_pairs_the_seeds_that_both_have(script: ModuleType) -> None:
    results = {
        script.DEFAULT: {1: SeedAccuracy(0.8, 0.8, 10), 2: SeedAccuracy(0.9, 0.9, 10)},
        "cheap": {2: SeedAccuracy(0.7, 0.75, 10), 3: SeedAccuracy(0.1, 0.1, 10)},
        "small": {1: SeedAccuracy(None, 0.7, 10), 2: SeedAccuracy(None, 0.8, 10)},
        "not yet": {},
    }
    *_, default, cheap, small = script.lines_of(results)
    assert default.startswith("| the config as it is | 85.0 (80.0 to 90.0) | 85.0 (80.0 to 90.0) |")
    assert cheap == "| cheap | 70.0 (70.0 to 70.0) | 75.0 (75.0 to 75.0) | -20.0 | 1 |"
    assert small == "| small | | 75.0 (70.0 to 80.0) | -10.0 (-10.0 to -10.0) | 2 |"
