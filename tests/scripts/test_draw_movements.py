"""The page of classes and movements is as the tables have it, and each has a small picture."""

import draw_movements as script
import pytest
from PIL import Image


def test_the_page_is_as_the_script_writes_it() -> None:
    assert script.PAGE.read_text(encoding="utf-8") == script.page()


def test_there_is_a_picture_of_each_and_of_nothing_else() -> None:
    pictures = {path.stem: path for path in script.PICTURES.glob("*.png")}
    assert pictures.keys() == set(script.names())
    for path in pictures.values():
        assert path.stat().st_size < script.MAX_BYTES, path.name


@pytest.mark.parametrize("name", ["walking", "falling"])
def test_a_picture_shows_figures_and_a_map(name: str) -> None:
    picture = script.draw_picture(name).convert("RGB")
    assert picture.size == (script.FIGURES * script.FIGURE_WIDTH + 2 * script.VIEW, 2 * script.VIEW)
    figures = picture.crop((0, 0, script.FIGURES * script.FIGURE_WIDTH, 2 * script.VIEW))
    assert isinstance(figures, Image.Image)
    assert len(figures.getcolors() or ()) > 3  # right, left, trunk and floor
