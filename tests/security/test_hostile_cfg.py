"""The .cfg of a board is a text of strangers: it is read, or refused in a short line."""

import pytest
from helpers.boards import CFG
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.errors import CaptureError
from radhar_cli.readers.ti.ti_cfg import parse_frames, parse_ti_cfg
from radhar_cli.readers.ti.ti_commands import COMMANDS

NUMBERS = ("-1", "0", "1", "3", "511", "4294967295", "4294967296", "1e308", "-1e308", "5e-324")
OTHERS = ("0x", "0xFFFFFFFFFF", "0x" + "F" * 300, "nan", "inf", "1_0", "\u0661", "\x1b[2J", "%")
NONSENSE = st.sampled_from([*NUMBERS, *OTHERS, "x" * 900])


def parse(text: str) -> None:
    """Parse a text for a board and for a capture; a refusal names the place in a short line."""
    for reader in (parse_ti_cfg, parse_frames):
        message = "board.cfg"
        try:
            reader(text, "board.cfg")
        except CaptureError as error:
            message = str(error)
        assert message.startswith("board.cfg")
        assert "\n" not in message
        assert len(message) < 1000


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_words_replaced_by_nonsense(data: st.DataObject) -> None:
    lines = [line.split() for line in CFG.splitlines()]
    for _ in range(data.draw(st.integers(1, 3))):
        words = data.draw(st.sampled_from([line for line in lines if line]))
        words[data.draw(st.integers(0, len(words) - 1))] = data.draw(NONSENSE)
    parse("\n".join(map(" ".join, lines)))


@settings(max_examples=100, deadline=None)
@given(name=st.sampled_from(sorted(COMMANDS)), words=st.lists(NONSENSE, max_size=40))
def test_every_command_with_any_words(name: str, words: list[str]) -> None:
    parse(f"{CFG}{name} {' '.join(words)}\n")


@given(text=st.text(max_size=300))
def test_any_text(text: str) -> None:
    parse(text)
    parse(CFG + text)


@pytest.mark.parametrize(
    "lines",
    [
        "chirpCfg 0 4294967295 0 0 0 0 0 1\nframeCfg 0 4294967295 4294967295 0 1000000 1 0\n",
        "".join(f"chirpCfg {n} {n} 0 0 0 0 0 {n + 1}\n" for n in range(512))
        + "frameCfg 0 511 1 0 999 1 0\n",
        "chirpCfg 0 511 0 0 0 0 0 1\n" * 2000,
        "x" * 60_000,
    ],
    ids=["huge counts", "many masks", "many lines", "a long word"],
)
def test_counts_that_would_take_long(lines: str) -> None:
    parse(CFG + lines)
