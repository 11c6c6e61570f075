"""`radhar prepare`: a public download becomes a data set."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import StartOver, jobs_option, resumable
from radhar_cli.commands.tell import counted, report, tell
from radhar_cli.errors import ConfigError
from radhar_cli.processes import interrupts


def prepare(
    name: Annotated[
        str | None, typer.Argument(help="Recipe, such as mars; without it, all are listed.")
    ] = None,
    folder: Annotated[
        Path | None, typer.Argument(help="Folder of the download, or for points or images a file.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder to write the data set to.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Key that the recipe asks for, such as frame_s=0.1, or of the config of the data "
            "set, such as recordings.window_s=2; may be repeated.",
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        jobs_option("Number of worker processes; one for each core."),
    ] = None,
    overwrite: StartOver = False,
) -> None:
    """Build a data set from a public download.

    Tables of points and images of your own are read as well.

    Recordings are kept in OUT/recordings, with the manifest that `generate --recordings` takes.

    Example:

      radhar prepare mars downloads/MARS -o datasets/mars

    The same command resumes what was interrupted.
    """
    if name is None:
        _list_recipes()
        return
    if folder is None or out is None:
        raise ConfigError(f"should be: radhar prepare {name} FOLDER -o DATASET")
    with resumable(f"what is finished in {out}"):
        from radhar_cli.capture.preparing import prepare_dataset, read_preparation
        from radhar_cli.commands.terminal import BarProgress, print_outcome
        from radhar_cli.dataset.workers import cores
        from radhar_cli.processes.worker_process import prepare_process

        prepare_process()
        preparation = read_preparation(name, folder, set_ or [])
        with BarProgress() as bars:
            dataset = prepare_dataset(preparation, out, jobs or cores(), bars, overwrite)
        interrupts.complete(str(out))
        if (prepared := dataset.recordings).takes:
            recordings = counted(prepared.takes, "recording")
            tell(f"{recordings}, {prepared.new} new, {len(prepared.left_out)} left out")
        print_outcome(dataset.config, dataset.outcome)


def _list_recipes() -> None:
    """Print source, content and tests of each recipe, and the sets that are refused."""
    from radhar_cli.capture.recipes.registry import REFUSED, every_recipe

    recipes = every_recipe()
    for name, recipe in recipes.items():
        licence = recipe.licence or "licence not stated"
        tell(f"{name}: {recipe.source} ({licence})")
        tell(f"  {recipe.holds}")
        if recipe.count is not None:
            tell(f"  {recipe.count} recordings in all")
        tell(f"  holds {recipe.layout}")
        tell(f"  tested on {recipe.tested}")
    for name, why in REFUSED.items():
        tell(f"{name}: {why}")
    keys = ("source", "licence", "holds", "count", "layout", "tested")
    report(
        recipes={
            name: {key: getattr(recipe, key) for key in keys} for name, recipe in recipes.items()
        },
        refused=REFUSED,
    )
