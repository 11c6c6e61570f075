"""`radhar generate`: a YAML file becomes a labelled data set."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import Overrides, Tolerance, resumable, with_tolerance

EXAMPLE = """
Example:

  radhar generate configs/paper/through_wall.yaml -o datasets/ttw_10dB --set snr_db=10 --jobs 2

The same command, run again, goes on where it stopped and says so when the folder is complete.
"""


def generate(
    config: Annotated[Path, typer.Argument(help="YAML file that describes the data set.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to build it in.")],
    set_: Overrides = None,
    tolerance: Tolerance = None,
    jobs: Annotated[
        int | None, typer.Option("--jobs", "-j", min=1, help="Processes; all cores if not given.")
    ] = None,
    batch: Annotated[
        int | None, typer.Option(min=1, help="Samples a batch; changes no byte of the result.")
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print the plan and an estimate; write nothing.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Start again in a folder that holds a data set.")
    ] = False,
) -> None:
    with resumable(f"what is finished in {out}"):
        _generate(config, out, with_tolerance(set_, tolerance), jobs, batch, dry_run, overwrite)


def _generate(
    path: Path,
    out: Path,
    overrides: list[str],
    jobs: int | None,
    batch: int | None,
    dry_run: bool,
    overwrite: bool,
) -> None:
    from radhar_cli.config import load_config
    from radhar_cli.dataset.workers import cores

    config = load_config(path, overrides)
    jobs = jobs or cores()
    if dry_run:
        from radhar_cli.commands.dry_run import print_plan

        print_plan(config, jobs)
        return
    from radhar_cli.commands.terminal import BarProgress, print_outcome
    from radhar_cli.dataset.build import build

    progress = BarProgress()
    try:
        outcome = build(config, out, jobs, progress, overwrite, batch)
    finally:
        progress.close()
    print_outcome(config, outcome)


generate.__doc__ = "Build a labelled data set from a config file.\n" + EXAMPLE
