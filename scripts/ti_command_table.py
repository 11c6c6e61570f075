"""Write the table of TI's commands into docs/reference/ti_commands.md, out of the parser's.

    python scripts/ti_command_table.py

The table stands between `<!-- commands -->` and `<!-- end -->`; what stands around it is written by
hand.
"""

from collections.abc import Iterator
from pathlib import Path

from page_parts import replace_part

from radhar_cli.radar.ti_commands import COMMANDS, Argument, Command, Effect

PAGE = Path(__file__).resolve().parents[1] / "docs/reference/ti_commands.md"


def fill_table(page: str) -> str:
    """Return a page with its table as the parser has it."""
    table = "\n".join(_sections())
    return replace_part(page, "commands", table, "<!-- commands -->", "<!-- end -->")


def _sections() -> Iterator[str]:
    """Lines of a table for each effect."""
    commands = [command for family in COMMANDS.values() for command in family]
    for effect in Effect:
        yield from ("", f"**{effect.value[0].upper()}{effect.value[1:]}:**", "")
        of_effect = [command for command in commands if command.effect is effect]
        detailed = [command for command in of_effect if command.arguments or command.reason]
        if detailed:
            yield from ("| command | software | right |", "| --- | --- | --- |")
            yield from map(_row, detailed)
            yield ""
        names = [f"`{command.name}`" for command in of_effect if command not in detailed]
        if names:
            yield ", ".join(names) + "."


def _row(command: Command) -> str:
    """Row of a command, with the arguments whose limits say more than that they are numbers."""
    limits = "; ".join(
        f"{argument.name}: {argument.right}" for argument in command.arguments if _says(argument)
    )
    return f"| `{command.usage}` | {command.family.value} | {command.reason or limits} |"


def _says(argument: Argument) -> bool:
    """Whether the limits of an argument are more than those of all numbers."""
    return bool(argument.meaning) or argument.high < 2**16 or argument.low > 0


def main() -> None:
    """Write the page."""
    PAGE.write_text(fill_table(PAGE.read_text()))


if __name__ == "__main__":
    main()
