"""scripts/studies/if_high_pass.py: the gain of two high-passes, and its table in the docs."""

import if_high_pass
import pytest
from helpers import command_line


def test_a_corner_takes_half_of_the_power() -> None:
    assert if_high_pass.attenuate(175e3, [175e3]) == pytest.approx(-3.0103, abs=1e-4)
    both = if_high_pass.attenuate(350e3, [175e3, 350e3])
    assert both == pytest.approx(-3.0103 - 0.9691, abs=1e-4)


def test_far_below_the_corners_it_falls_by_12_db_an_octave() -> None:
    low, lower = (if_high_pass.attenuate(f, [700e3, 2800e3]) for f in (2e3, 1e3))
    assert low - lower == pytest.approx(12.04, abs=0.01)


def test_the_docs_have_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    if_high_pass.main()
    rows = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    text = (command_line.ROOT / "docs/results/noise.md").read_text(encoding="utf-8")
    shown = [row for row in rows if f", {row[0]} |" in text]
    assert len(shown) == 3
    for name, slope, *losses in shown:
        cells = " | ".join(f"{loss} dB" for loss in losses)
        assert f"| {slope} MHz/us, {name} | {cells} |" in text
