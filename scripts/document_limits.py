"""Put results of `radhar limits` into docs/results/extremes.md.

    python scripts/document_limits.py COMMIT OUT [OUT ...]

Each OUT is a folder that the command wrote; its part of the page is the one between the markers
`<!-- begin NAME -->` and `<!-- end NAME -->`, NAME being the config's. Numbers that go as far as
their keys are named in a sentence, the others in one table.
"""

import argparse
import re
from pathlib import Path

from page_parts import replace_part

from radhar_cli.study.limits.report import HEAD, TEXT

PAGE = Path(__file__).resolve().parents[1] / "docs/results/extremes.md"
ROW = re.compile(r"^\| `(?P<key>[^`]+)` \| (?P<now>[^|]+) \| (?P<low>[^|]+) \| (?P<high>[^|]+) \|")


def _without_noise(line: str) -> str:
    """A row without times below 3, which a busy machine makes of nothing."""
    return re.sub(r"; there [12](?:\.\d+)? times as slow", "", line)


def read_result(out: Path, commit: str) -> tuple[str, str]:
    """Read a result: its name, and its part of the page."""
    lines = (out / TEXT).read_text().replace(str(out), f"out/{out.name}").splitlines()
    lines = [_without_noise(line) for line in lines]
    margins = [line for line in lines if line.startswith("| ") and not ROW.match(line)]
    margins = [line for line in margins if line not in HEAD.splitlines()]
    rows = [match for line in lines if (match := ROW.match(line))]
    plain = [row for row in rows if row.string.endswith("| refused | refused |")]
    folded = ", ".join(f"`{row['key']}` {row['low']} to {row['high']}" for row in plain)
    notes = [line for line in lines if line.startswith(("No sample", "Not finished"))]
    text = [
        f"## {out.name}",
        "",
        f"{lines[2]} at commit {commit}:",
        *("", *margins),
        *("", HEAD, *(row.string for row in rows if row not in plain)),
        *("", f"As far as their keys go: {folded}."),
        *(line for note in notes for line in ("", note)),
    ]
    return out.name, "\n".join(text)


def main() -> None:
    """Write the parts of the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commit", help="commit of the runs")
    parser.add_argument("out", nargs="+", type=Path, help="folder of radhar limits")
    arguments = parser.parse_args()
    page = PAGE.read_text()
    for out in arguments.out:
        name, text = read_result(out, arguments.commit)
        try:
            page = replace_part(page, name, text)
        except ValueError as error:
            parser.error(f"{PAGE}: {error}")
    PAGE.write_text(page)


if __name__ == "__main__":
    main()
