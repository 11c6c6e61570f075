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


def test_what_is_recommended_goes_with_its_figure_and_tables_apart(tmp_path):
    out = tmp_path / "x"
    out.mkdir()
    text = (
        f"# What accuracy costs: x\n\n`-o {out}`\n\n- Take it.\n\n![a](tradeoff.png)\n\n"
        "## Settings\n\nTimes.\n\n### Error\n\n| a |\n"
    )
    (out / "tradeoff.md").write_text(text)
    name, said, tables = part(out)
    assert name == "x"
    assert said.startswith("## x\n")
    assert "`-o out/x`" in said
    assert "(../images/tradeoff/x.png)" in said
    assert "Times" not in said
    assert tables.startswith("## x\n")
    assert "#### Error\n\n| a |" in tables
    assert "Take it" not in tables
