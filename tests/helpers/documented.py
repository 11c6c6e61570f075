"""The keys that docs/reference/output.md promises of a command's --json."""

import re

from helpers.command_line import ROOT


def rows() -> dict[str, set[str]]:
    """{command: keys}, what stands in brackets aside."""
    found = {}
    for line in (ROOT / "docs/reference/output.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if len(cells) == 2 and cells[0].startswith("`"):
            told = re.sub(r"\([^)]*\)|\{[^}]*\}|; .*", "", cells[1])
            for command in re.findall(r"`([^`]*)`", cells[0]):
                found[command] = set(re.findall(r"`([^`]*)`", told))
    return found


KEYS = rows()
