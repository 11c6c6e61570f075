"""What files say reaches the terminal as text, not as commands to it."""

import pytest

from radhar_cli.commands.inspect import print_summary
from radhar_cli.commands.tell import tell
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.files.untrusted import escaped

HOSTILE = "a\x1b[2J\x9b31m\r\x08\x07\u202e\udcff[red]b[/] :smile:\nc"
ESCAPED = r"a\x1b[2J\x9b31m\r\x08\x07\u202e\udcff[red]b[/] :smile:"


def test_control_sequences_are_escaped_and_text_is_kept() -> None:
    assert escaped(HOSTILE) == ESCAPED + "\nc"
    assert escaped("Größe 漢字 █ ▁ µ λ²") == "Größe 漢字 █ ▁ µ λ²"


@pytest.mark.parametrize("say", [tell, BarProgress().say])
def test_messages_are_escaped(say: object, capsys: pytest.CaptureFixture[str]) -> None:
    say(HOSTILE)  # type: ignore[operator]
    printed = capsys.readouterr()
    assert ESCAPED + "\nc\n" in printed.out + printed.err
    assert "\x1b" not in printed.out + printed.err


def test_a_stored_scene_and_data_set_are_shown_escaped(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    common = {"path": HOSTILE, "seed": HOSTILE, "maps": {HOSTILE: [2, 3]}, "warnings": [HOSTILE]}
    scene = {
        **{"kind": "scene", "activity": {"label": HOSTILE, "slug": HOSTILE}, "joint": HOSTILE},
        **{"engine": HOSTILE, "entropy_bits": {HOSTILE: 1.0}},
        **{"parameters": {HOSTILE: 1.0}, "derived": {}},
    }
    drawn = {"unit": HOSTILE, "min": 0, "mean": 1, "max": 2, "samples": 3, "counts": [1, 2]}
    data = {
        **{"kind": "data set", "samples": 1, "bytes": 1, "config_hash": HOSTILE},
        **{"versions": {HOSTILE: HOSTILE}, "classes": {HOSTILE: {"train": 1, "b": 2, "c": 3}}},
        **{"entropy_bits": {HOSTILE: {HOSTILE: {"mean": 1.0}}}, "drawn": {HOSTILE: drawn}},
        "warnings": [{"message": HOSTILE}],
    }
    for summary in (scene, data):
        print_summary({**common, **summary})
        out = capsys.readouterr().out
        assert all(c.isprintable() or c == "\n" for c in out), ascii(out)
        assert "[red]b[/]" in out
