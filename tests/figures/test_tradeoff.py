"""The figure of settings: what lies on the frontier, and names that lie on nothing."""

from itertools import combinations

import pytest

from radhar_cli.figures.page import page
from radhar_cli.figures.tradeoff import SettingMark, frontier, place_names, tradeoff_png

DEFAULT = SettingMark("default", 1.0, 0.0, True)


def test_only_what_saves_time_and_shows_all_maps_is_on_the_frontier():
    near, far = (
        SettingMark(n, r, lv, False, saves=True) for n, r, lv in (("a", 0.8, 2), ("b", 0.5, 9))
    )
    worse = SettingMark("slower and farther", 0.9, 5, False, saves=True)
    doubtful = SettingMark("within the blur", 0.97, 0.1, False)
    fewer = SettingMark("maps without x", 0.4, 0, False, has_all_maps=False, saves=True)
    marks = [DEFAULT, near, far, worse, doubtful, fewer]
    assert frontier(marks) == [far, near, DEFAULT]


@pytest.mark.parametrize("has_saving", [True, False])
def test_the_legend_has_the_frontier_only_where_it_is_drawn(monkeypatch, has_saving):
    figures = []
    monkeypatch.setattr("radhar_cli.figures.tradeoff.png_bytes", figures.append)
    tradeoff_png([DEFAULT, SettingMark("a", 0.8, 2, False, saves=has_saving)], "x")
    (axes,) = figures[0].axes
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert len(texts) == 4 + has_saving
    assert any("no other is both faster" in text for text in texts) is has_saving


def test_names_lie_beside_each_other():
    """Thirty settings in a small place: those that have a name have it for themselves."""
    from matplotlib.text import Text

    figure = page(10, 7)
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(0.5, 3)
    axes.set_ylim(0.001, 400)
    marks = [SettingMark(f"setting: {n}", 1 + 0.01 * n, 10.0, False) for n in range(30)]
    figure.canvas.draw()
    placed = place_names(axes, marks)
    assert len(placed) > 15
    renderer = figure.canvas.get_renderer()
    boxes = [Text.get_window_extent(text, renderer) for text in placed]
    assert not any(a.overlaps(b) for a, b in combinations(boxes, 2))


def test_a_sweep_without_rows_has_a_figure():
    assert tradeoff_png([], "none").startswith(b"\x89PNG")
