"""The first command of a newcomer: a data set, checked, and what comes next."""

from pathlib import Path

import pytest
from helpers.command_line import ok


@pytest.mark.slow
def test_the_demo_builds_the_quickstart_and_says_what_comes_next(tmp_path: Path) -> None:
    said = ok("demo", tmp_path / "set").stdout
    assert "720 samples, 720 new" in said
    assert "synthesised again and equal byte for byte" in said
    gallery = next(line for line in said.splitlines() if line.startswith("look at"))
    assert Path(gallery.removeprefix("look at").strip()).is_file()
    assert f"radhar train {tmp_path / 'set'}" in said
