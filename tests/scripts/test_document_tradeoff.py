"""scripts/document_tradeoff.py: a result takes the place of its part of the page alone."""

import pytest
from document_tradeoff import part, with_part


def test_a_part_is_replaced_and_the_others_stay():
    page = "top\n<!-- begin a -->\nold\n<!-- end a -->\n<!-- begin b -->\nb\n<!-- end b -->\n"
    changed = with_part(page, "a", "new")
    assert "old" not in changed
    assert "<!-- begin a -->\n\nnew\n\n<!-- end a -->" in changed
    assert changed.endswith("<!-- begin b -->\nb\n<!-- end b -->\n")


def test_a_page_without_its_markers_is_refused():
    with pytest.raises(ValueError, match="no markers for c"):
        with_part("page", "c", "new")


def test_headings_go_one_down_and_the_figure_is_that_of_the_documents(tmp_path):
    out = tmp_path / "x"
    out.mkdir()
    text = f"# What accuracy costs: x\n\n`-o {out}`\n\n![a](tradeoff.png)\n\n## Settings\n"
    (out / "tradeoff.md").write_text(text)
    name, placed = part(out)
    assert name == "x"
    assert "## What accuracy costs: x" in placed
    assert "### Settings" in placed
    assert "`-o out/x`" in placed
    assert "(../images/tradeoff/x.png)" in placed
