"""Configs as YAML: what is written reads back, whatever texts are in it."""

import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config.identity import yaml_text
from radhar_cli.config.yaml_reader import parse_yaml

LINES = st.text(st.sampled_from("a 0%:#-'\"|>{}\t\r\n\x85\u2028\u00e9"))


@settings(deadline=None)
@given(LINES | st.text(st.characters(exclude_categories=["Cs"])))
def test_texts_of_any_lines_read_back(text: str) -> None:
    document = {"radar": {"cfg": text, "position_m": [0, {"uniform": [1, 2]}]}, "note": [text]}
    assert yaml.safe_load(yaml_text(document)) == document


def test_a_cfg_is_written_line_by_line() -> None:
    document = {"radar": {"cfg": "% of a board\nframeCfg 0 2 16\n", "position_m": [0, 0, 1]}}
    written = yaml_text(document)
    assert "  cfg: |\n    % of a board\n    frameCfg 0 2 16\n" in written
    assert parse_yaml(written, "mine.yaml")[0] == document
