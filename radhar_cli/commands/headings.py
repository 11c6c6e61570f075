"""`radhar --help` lists its commands under the headings that they were given."""

from typing import Any

from typer.core import TyperGroup


class Headings(TyperGroup):
    """A group whose help has a section for each `rich_help_panel`, without importing rich."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the sections."""
        sections: dict[str, list[tuple[str, str]]] = {}
        width = max(map(len, self.commands))
        for name, command in self.commands.items():
            heading = getattr(command, "rich_help_panel", None)
            row = (name.ljust(width), command.get_short_help_str(formatter.width - 6 - width))
            sections.setdefault(heading if isinstance(heading, str) else "Commands", []).append(row)
        for heading, rows in sections.items():
            with formatter.section(heading):
                formatter.write_dl(rows)
