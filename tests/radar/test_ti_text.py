"""A .cfg says the same however it is typed: ends of lines, blanks, comments, 0x, order."""

import random
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from radhar_cli.config.documents import RADARS
from radhar_cli.readers.ti.ti_cfg import BoardHeader, parse_ti_cfg

FOLDERS = Path(__file__).with_name("cfg"), Path(__file__).parents[2] / "configs/boards"
PATHS = [*RADARS.values(), *(path for folder in FOLDERS for path in sorted(folder.glob("*.cfg")))]
FILES = {path.stem: path for path in PATHS if path.stem != "xwrl6432"}  # which is refused
SEED = 1


def read(text: str) -> BoardHeader:
    return parse_ti_cfg(text, "board.cfg")


def lines_of(name: str) -> list[str]:
    """Lines of a file with a command."""
    lines = FILES[name].read_text().splitlines()
    return [line for line in (re.split("%|//|#", line)[0].strip() for line in lines) if line]


def in_hexadecimal(line: str) -> str:
    """A line whose whole numbers that are not negative are written as 0x."""
    name, *words = line.split()
    return " ".join([name, *(hex(int(word)) if word.isdigit() else word for word in words)])


def with_comments(line: str) -> str:
    return random.Random(line).choice(["% ", "//", " # ", "\t%"]).join([line, " 1 sensorStart -1"])


def with_tabs(line: str) -> str:
    return "\t " + re.sub(r"\s+", " \t ", line) + " \t"


def after_a_wrong_one(line: str) -> str:
    """A line after another of its command, which does not hold as it is not the last."""
    repeats = {"frameCfg", "adcCfg", "channelCfg", "sensorPosition", "boundaryBox"}
    name, *words = line.split()
    if name not in repeats:
        return line
    return f"{' '.join([name, words[0], '0', *words[2:]])}\n{line}"


WAYS: dict[str, Callable[[list[str]], str]] = {
    "byte-order mark": lambda lines: "\ufeff" + "\n".join(lines),
    "CR LF": lambda lines: "\r\n".join(lines) + "\r\n",
    "CR": lambda lines: "\r".join(lines),
    "no end of the last line": lambda lines: "\n".join(lines),
    "tabs and blanks": lambda lines: "\n".join(map(with_tabs, lines)),
    "blank lines": lambda lines: "\n\n \n\t\n".join(lines),
    "comments": lambda lines: "% first\n" + "\n// and\n#\n".join(map(with_comments, lines)),
    "0x": lambda lines: "\n".join(map(in_hexadecimal, lines)),
    "equal lines": lambda lines: "\n".join(line for one in lines for line in (one, one)),
    "the last of a command": lambda lines: "\n".join(map(after_a_wrong_one, lines)),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", FILES)
def test_a_file_says_the_same_however_it_is_typed(name: str, way: str) -> None:
    lines = lines_of(name)
    assert read(WAYS[way](lines)) == read("\n".join(lines))


@pytest.mark.parametrize("name", FILES)
def test_the_order_of_lines_does_not_matter(name: str) -> None:
    """Of commands that stand once, of chirps and profiles with other numbers, of subframes."""
    lines = lines_of(name)
    header, draw = read("\n".join(lines)), random.Random(SEED)
    for _ in range(8):
        draw.shuffle(lines)
        read_again = read("\n".join(lines))
        assert sorted(read_again.not_simulated) == sorted(header.not_simulated)
        assert replace(read_again, not_simulated=header.not_simulated) == header


@pytest.mark.parametrize("name", [name for name in FILES if "iwrl" not in name])
def test_the_last_chirp_of_an_index_holds(name: str) -> None:
    lines = lines_of(name)
    (first, *_) = (line for line in lines if line.startswith("chirpCfg"))
    words = first.split()
    another = " ".join([*words[:-1], "2" if words[-1] != "2" else "1"])
    assert read("\n".join([another, *lines])) == read("\n".join(lines))
