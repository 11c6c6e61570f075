"""Write docs/reference/commands/*.md, a page a heading of `radhar --help`, out of the program.

python scripts/command_pages.py
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from typer.main import get_command

from radhar_cli.cli import COMMANDS, DATA_SETS, program

FOLDER = Path(__file__).resolve().parents[1] / "docs/reference/commands"
COMMON = ("--json", "--quiet")


def pages() -> dict[str, str]:
    """{file name: text}."""
    known: Any = get_command(program())
    found = {}
    for heading, names in COMMANDS.items():
        shown = [f"`{name}`" for name in names]
        lines = [
            f"# Commands: {heading.lower()}",
            "",
            f"After this page you know every argument and option of {', '.join(shown)}.",
            "All commands also take `--json`, `--quiet` and `--help`: [output](../output.md).",
        ]
        for name in names:
            lines += _command(f"radhar {name}", known.commands[name])
        if heading == DATA_SETS:
            for name, command in known.commands["config"].commands.items():
                lines += _command(f"radhar config {name}", command)
        found[f"{heading.lower().replace(' ', '_')}.md"] = "\n".join([*lines, ""])
    return found


def _command(words: str, command: Any) -> Iterator[str]:
    """A section: what it does, an example, a row for each argument and option."""
    yield from ("", f"## {words}", "")
    text = re.sub(r"^ +(radhar .*(?:\n +.*)*)$", r"```text\n\1\n```", command.help, flags=re.M)
    yield from text.replace("Example:\n\n", "").splitlines()
    yield from ("", "| argument or option | meaning |", "| --- | --- |")
    context = command.context_class(command, info_name=words)
    for parameter in command.params:
        record = parameter.get_help_record(context)
        if record and not set(COMMON) & set(parameter.opts):
            named, meaning = (re.sub(r"\s+", " ", text).replace("|", "\\|") for text in record)
            yield f"| `{named}` | {meaning} |"


def main() -> None:
    """Write the pages."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in pages().items():
        (FOLDER / name).write_text(text)


if __name__ == "__main__":
    main()
