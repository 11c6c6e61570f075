"""`radhar --help` with its commands under headings."""

from typing import Any

from typer.core import TyperGroup


class Headings(TyperGroup):
    """Group of commands whose help has a section for each `rich_help_panel`, without rich."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write a section for each heading, in the order of the commands."""
        sections: dict[str, list[tuple[str, str]]] = {}
        width = max(map(len, self.commands))
        for name, command in self.commands.items():
            heading = getattr(command, "rich_help_panel", None)
            row = (name.ljust(width), command.get_short_help_str(formatter.width - 6 - width))
            sections.setdefault(heading if isinstance(heading, str) else "Commands", []).append(row)
        for heading, rows in sections.items():
            with formatter.section(heading):
                formatter.write_dl(rows)
