"""`radhar merge`: parts that `generate --shard` made become one data set."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli import interrupts
from radhar_cli.commands.options import resumable


def merge(
    out: Annotated[Path, typer.Argument(help="Folder of the data set.")],
    parts: Annotated[
        list[Path] | None,
        typer.Argument(help="Parts, or folders that hold parts, in addition to those below OUT."),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option("--jobs", "-j", min=1, help="Processes that write PNGs.")
    ] = None,
) -> None:
    """Merge the parts of a data set; the parts are not changed.

    If rows are missing, prints them with the --shard that makes them, and exits with status 1.

    Example:

      radhar merge datasets/large
    """
    from radhar_cli.commands.terminal import BarProgress, print_outcome
    from radhar_cli.dataset.merge import merge as merge_parts
    from radhar_cli.dataset.workers import cores

    with resumable("every part"), BarProgress() as progress:
        config, outcome = merge_parts(out, parts or [], jobs or cores(), progress)
        interrupts.complete(str(out))
    print_outcome(config, outcome)
