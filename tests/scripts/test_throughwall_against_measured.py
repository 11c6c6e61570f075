"""scripts/studies/throughwall_against_measured.py: reads a picture, measures what trails in it."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

PATH = Path(__file__).parents[2] / "scripts/studies/throughwall_against_measured.py"
SPEC = importlib.util.spec_from_file_location(PATH.stem, PATH)
assert SPEC is not None
assert SPEC.loader is not None
SCRIPT = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(SCRIPT)


def decaying(db_per_stripe: float) -> np.ndarray:
    """Columns of stripes that begin at row 40 and lose so much from one to the next."""
    rows = np.arange(256) - 40
    stripe = np.floor(rows / SCRIPT.STRIPE_ROWS)
    column = np.where(rows >= 0, 10 ** (-db_per_stripe / 20 * stripe), 0)
    return np.tile(column[:, None], 256)


def test_a_picture_is_read_as_it_was_drawn(tmp_path: Path) -> None:
    right = decaying(2) * np.sign(np.arange(256) - 100)
    drawn = colormaps["jet"]((right[::-1] + 1) / 2, bytes=True)[..., :3]
    Image.fromarray(drawn).resize((1024, 1024), Image.Resampling.NEAREST).save(tmp_path / "a.png")
    assert np.abs(SCRIPT.measured(tmp_path / "a.png") - right).max() < 0.02


@pytest.mark.parametrize("decay", [1.0, 3.0])
def test_the_trail_is_what_is_behind(decay: float) -> None:
    right = -decay * np.arange(1, SCRIPT.STRIPES + 1)
    assert SCRIPT.trail(decaying(decay)) == pytest.approx(right, abs=decay)


def test_a_wall_that_rings_trails_more() -> None:
    single = SCRIPT.trail(SCRIPT.simulated(SCRIPT.SCENES["a wall, one pass"], 1))
    rings = SCRIPT.trail(SCRIPT.simulated(SCRIPT.SCENES["its reflections, too"], 1))
    assert rings[4:8].mean() > single[4:8].mean() + 3
