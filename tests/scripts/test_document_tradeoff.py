"""scripts/document_tradeoff.py: a result is read as two parts of the documents."""

from document_tradeoff import read_result


def test_what_is_recommended_goes_with_its_figure_and_tables_apart(tmp_path):
    out = tmp_path / "x"
    out.mkdir()
    text = (
        f"# What accuracy costs: x\n\n`-o {out}`\n\n- Take it.\n\n![a](tradeoff.png)\n\n"
        "## Settings\n\nTimes.\n\n### Error\n\n| a |\n"
    )
    (out / "tradeoff.md").write_text(text)
    name, recommendation, tables = read_result(out)
    assert name == "x"
    assert recommendation.startswith("## x\n")
    assert "`-o out/x`" in recommendation
    assert "(../images/tradeoff/x.png)" in recommendation
    assert "Times" not in recommendation
    assert tables.startswith("## x\n")
    assert "#### Error\n\n| a |" in tables
    assert "Take it" not in tables
