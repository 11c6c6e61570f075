"""`radhar generate`: a YAML file becomes a labelled data set."""

import os
from contextlib import nullcontext
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import Overrides, Tolerance, resumable, with_tolerance
from radhar_cli.commands.tell import report, tell
from radhar_cli.errors import ConfigError

if TYPE_CHECKING:
    from radhar_cli.config import Config

ARRAY = "slurm"  # the part that the environment names
EXAMPLE = """
Example:

  radhar generate configs/paper/through_wall.yaml -o datasets/ttw_10dB --set snr_db=10 --jobs 2

The same command, run again, resumes where it stopped and says so when the folder is complete.
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
    shard: Annotated[
        str | None,
        typer.Option(
            metavar="[K/N]",
            help="Make part K of N, for `radhar merge`; without K/N the part of this task of a "
            "SLURM array.",
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Run on the workers of a dask scheduler, tcp://host:8786, or `local`.",
        ),
    ] = None,
    recordings: Annotated[
        Path | None,
        typer.Option(
            metavar="MANIFEST",
            help="Instead of scenes: CSV or YAML of recordings (file, label, person, start, stop), "
            "or a tree of class folders, or an .npz of masks.",
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Start over in a folder that holds a data set.")
    ] = False,
) -> None:
    with resumable(f"what is finished in {out}"):
        from radhar_cli.config import load_config
        from radhar_cli.dataset.workers import cores

        loaded, jobs = load_config(config, with_tolerance(set_, tolerance)), jobs or cores()
        if recordings is not None:
            if shard is not None or cluster is not None:
                raise ConfigError("--recordings: cannot be combined with --shard or --cluster")
            _of_recordings(loaded, recordings, out, jobs, batch, dry_run, overwrite)
        elif loaded.recordings is not None:
            raise ConfigError(
                f"{config}: recordings: --recordings MANIFEST should say where they lie"
            )
        elif dry_run:
            from radhar_cli.commands.dry_run import print_plan

            print_plan(loaded, jobs)
        else:
            _of_scenes(loaded, out, jobs, batch, shard, cluster, overwrite)


def shard_named(arguments: list[str]) -> list[str]:
    """The arguments with a value after each --shard; typer lets nobody leave a value out."""
    named = list(arguments)
    for place, (one, following) in reversed([*enumerate(pairwise([*arguments, "-"]))]):
        if one == "--shard" and not following[:1].isdigit():
            named.insert(place + 1, ARRAY)
    return named


def _of_scenes(
    config: "Config",
    out: Path,
    jobs: int,
    batch: int | None,
    shard: str | None,
    cluster: str | None,
    overwrite: bool,
) -> None:
    from radhar_cli.commands.terminal import BarProgress, print_outcome, print_part
    from radhar_cli.dataset.build import build, build_part
    from radhar_cli.dataset.layout import Rows
    from radhar_cli.dataset.parts import Part
    from radhar_cli.dataset.workers import on_cluster

    most = min(jobs, len(Rows.of(config)))
    where = nullcontext(jobs) if cluster is None else on_cluster(cluster, most)
    with BarProgress() as progress, where as jobs:
        if shard is None:
            outcome = build(config, out, jobs, progress, overwrite, batch)
        else:
            part = Part.of_array_task(os.environ) if shard == ARRAY else Part.parse(shard)
            outcome = build_part(config, out, part, jobs, progress, overwrite, batch)
    if shard is None:
        print_outcome(config, outcome)
    else:
        print_part(outcome, out, str(part))


def _of_recordings(
    config: "Config",
    manifest: Path,
    out: Path,
    jobs: int,
    batch: int | None,
    dry_run: bool,
    overwrite: bool,
) -> None:
    from radhar_cli.capture.windows import WindowFactory, warnings_of, with_recordings
    from radhar_cli.commands.terminal import BarProgress, class_counts, print_outcome
    from radhar_cli.dataset.build import build
    from radhar_cli.dataset.layout import Rows

    measured = with_recordings(config, manifest)
    for warning in warnings_of(measured):
        tell(f"warning: {warning}", err=True)
    if dry_run:
        rows = Rows.of(measured)
        report(samples=len(rows), classes=class_counts(rows), maps=measured.maps)
        tell(f"samples     {len(rows)} = {rows.counted}")
        tell("nothing was written")
        return
    folder = manifest if manifest.is_dir() else manifest.parent
    factory = WindowFactory(folder.absolute())
    with BarProgress() as progress:
        outcome = build(measured, out, jobs, progress, overwrite, batch, factory)
    print_outcome(measured, outcome)


generate.__doc__ = "Build a labelled data set from a config file.\n" + EXAMPLE
