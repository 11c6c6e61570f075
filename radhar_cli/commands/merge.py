"""`radhar merge`: parts that `generate --shard` made become one data set."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import jobs_option, resumable
from radhar_cli.commands.tell import for_each_radar
from radhar_cli.processes import interrupts


def merge(
    out: Annotated[Path, typer.Argument(help="Folder of the data set to make.")],
    parts: Annotated[
        list[Path] | None,
        typer.Argument(help="Parts, or folders that hold parts, in addition to those below OUT."),
    ] = None,
    jobs: Annotated[
        int | None,
        jobs_option("Number of processes that write PNGs. The default is one for each core."),
    ] = None,
) -> None:
    """Merge the parts of a data set, which are not changed.

    Missing rows are listed with the --shard options that make them; the exit status is then 1.

    Example:

      radhar merge datasets/large
    """
    from radhar_cli.commands.terminal import BarProgress, print_outcome
    from radhar_cli.dataset.merge import merge as merge_parts
    from radhar_cli.dataset.radar_folders import folders_of_merged_radars
    from radhar_cli.dataset.workers import cores

    folders = folders_of_merged_radars(out, parts or [])

    def merge_radar(name: str, folder: Path) -> None:
        inner = [one / name if name and (one / name).is_dir() else one for one in parts or []]
        with BarProgress(radar=name or None) as progress:
            config, outcome = merge_parts(folder, inner, jobs or cores(), progress)
        if name == [*folders][-1]:
            interrupts.complete(str(out))
        print_outcome(config, outcome)

    with resumable("every part"):
        for_each_radar(folders, merge_radar)
