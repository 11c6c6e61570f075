"""The noise and the places of a simulation are found again in clouds that it made."""

from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.listener import Listener
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.config import load_config
from radhar_cli.config.identity import yaml_text
from radhar_cli.dataset.build import build
from radhar_cli.errors import CaptureError, ConfigError, FolderError
from radhar_cli.study import cloud_fit
from radhar_cli.study.cloud_fit import FIGURES_DB, figure_of, fit_clouds

BOARD = """
seed: 3
base: boards/iwr1443
samples_per_class: 1
activities: [walking, kicking]
duration_s: 0.6
maps: [points]
output: {png: false}
receiver: {noise_figure_db: 20}
motion: {place: {range_m: 3, cross_range_m: 0.5}}
split: {train: 0.5, validation: 0.5, test: 0}
"""


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The config of a board, and beside it `set`, two samples that it made."""
    path = tmp_path_factory.mktemp("board") / "board.yaml"
    path.write_text(BOARD)
    build(load_config(path), path.with_name("set"), 1, Listener())
    return path


@pytest.fixture(autouse=True)
def few_trials(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulate two scenes at three noise figures."""
    monkeypatch.setattr(cloud_fit, "SCENES", 2)
    monkeypatch.setattr(cloud_fit, "FIGURES_DB", np.array([0.0, 20.0, 40.0]))


@given(st.floats(0.5, 60), st.floats(0.01, 0.2), st.floats(0, 40))
def test_the_figure_of_a_falling_curve_is_found(most: float, slope: float, figure: float) -> None:
    points = most * np.exp(-slope * FIGURES_DB)
    exact = float(np.interp(figure, FIGURES_DB, points))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cloud_fit, "FIGURES_DB", FIGURES_DB)
        assert figure_of(points, exact) == pytest.approx(figure, abs=1e-6)
        assert figure_of(points, 2 * most) == FIGURES_DB[0]
        assert figure_of(points, -1) == FIGURES_DB[-1]


def test_noise_and_place_of_a_data_set_come_back(board: Path, tmp_path: Path) -> None:
    # The same scenes: noise that is scaled is the noise that a config with that figure has.
    fitted = fit_clouds([board.with_name("set")], board, tmp_path / "own.yaml")
    assert fitted.measured_points > 1
    assert fitted.noise_figure_db == pytest.approx(20, abs=1e-6)
    place = fitted.document["motion"]["place"]
    for key, middle in (("range_m", 3), ("cross_range_m", 0.5)):
        law = place[key]
        ends = law["uniform"] if isinstance(law, dict) else law
        assert np.mean(ends) == pytest.approx(middle, abs=0.3)


def test_what_is_written_is_a_config(board: Path, tmp_path: Path) -> None:
    out = tmp_path / "deeper" / "own.yaml"
    out.parent.mkdir()
    fitted = fit_clouds([board.with_name("set")], board, out, ["radar.yaw_deg=5", "seed=8"])
    assert fitted.notes, "people before a board that is turned are not placed"
    out.write_text(yaml_text(fitted.document))
    config = load_config(out)
    assert config.seed == 8
    assert config.receiver.noise_figure_db == pytest.approx(fitted.noise_figure_db, abs=0.05)
    fitted.draw(out.with_suffix(".png"))
    assert out.with_suffix(".png").stat().st_size > 1000


def test_more_points_than_any_noise_leaves_are_refused(
    board: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cloud_fit, "FIGURES_DB", np.array([50.0, 60.0]))
    with pytest.raises(CaptureError, match=r"moving points a frame; .*cfarCfg"):
        fit_clouds([board.with_name("set")], board, tmp_path / "own.yaml")


def test_what_holds_no_clouds_is_refused(board: Path, small_set: Path, tmp_path: Path) -> None:
    out = tmp_path / "own.yaml"
    with pytest.raises(FolderError, match=r"has no clouds; should have been made with maps"):
        fit_clouds([small_set], board, out)
    with pytest.raises(ConfigError, match=r"radar"):
        fit_clouds([board.with_name("set")], Path("quickstart"), out)
    asked = radhar("fit", board.with_name("set"), "-o", out)
    assert asked.returncode == 2
    assert "--config should name a config" in asked.stderr
    assert asked.stderr.count("\n") == 1
    assert not out.exists()


@pytest.mark.slow
def test_the_command_writes_config_and_figure(board: Path, tmp_path: Path) -> None:
    out = tmp_path / "own.yaml"
    told = ok("fit", board.with_name("set"), "--config", board, "-o", out)
    assert "noise_figure_db" in told.stdout
    assert load_config(out).receiver.noise_figure_db is not None
    assert out.with_suffix(".png").is_file()
