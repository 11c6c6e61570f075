"""`radhar inspect`: what is in a data set, a half-built folder, or a scene."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.tell import tell


def inspect(
    path: Annotated[Path, typer.Argument(help="Folder or file that radhar wrote.")],
    json_: Annotated[bool, typer.Option("--json", help="Print JSON, for scripts.")] = False,
) -> None:
    """Summarise a data set, a half-built folder or a scene.

    Example:

      radhar inspect datasets/quickstart
    """
    import json

    from radhar_cli.dataset.summary import summarise

    summary = summarise(path)
    if json_:
        tell(json.dumps(summary, indent=2))
        return
    from radhar_cli.commands.summary_view import print_summary

    print_summary(summary)
