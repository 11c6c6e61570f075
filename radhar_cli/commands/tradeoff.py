"""`radhar tradeoff`: what accuracy costs on the scenes of a config."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import Overrides

EXAMPLE = """
Example:

  radhar tradeoff configs/paper/free_space.yaml -o out/tradeoff --quick

The same command, run again, goes on where it stopped. Keep the machine quiet meanwhile: errors do
not mind, times do.
"""


def tradeoff(
    config: Annotated[Path, typer.Argument(help="YAML file whose scenes are looked at.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="Three activities, two rounds: a first look.")
    ] = False,
    train: Annotated[
        bool, typer.Option("--train", help="Train a small network on data of each setting too.")
    ] = False,
    set_: Overrides = None,
    jobs: Annotated[
        int | None, typer.Option("--jobs", "-j", min=1, help="Processes that build data to train.")
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Start again in a folder that holds a sweep.")
    ] = False,
) -> None:
    from radhar_cli.commands.learning_options import needs, needs_torch

    needs("tradeoff", ["skimage"])
    if train:
        needs_torch()
    try:
        _tradeoff(config, out, quick, train, set_ or [], jobs, overwrite)
    except KeyboardInterrupt:
        typer.echo(
            f"\ninterrupted: what is measured in {out} is kept; the same command goes on", err=True
        )
        raise typer.Exit(130) from None


def _tradeoff(
    path: Path,
    out: Path,
    quick: bool,
    train: bool,
    overrides: list[str],
    jobs: int | None,
    overwrite: bool,
) -> None:
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.folder import locked
    from radhar_cli.process import prepare_process
    from radhar_cli.tradeoff.folder import claim
    from radhar_cli.tradeoff.ledger import Ledger
    from radhar_cli.tradeoff.report import write_report
    from radhar_cli.tradeoff.scenes import Scenes
    from radhar_cli.tradeoff.study import ROUNDS, run_sweep

    scenes = Scenes(path, tuple(overrides), quick)
    config = scenes.config()
    command = " ".join(
        ["radhar tradeoff", str(path), f"-o {out}"]
        + [f"--set {each}" for each in overrides]
        + ["--quick"] * quick
        + ["--train"] * train
    )
    prepare_process()
    progress = BarProgress("setting")
    with locked(out):
        claim(out, config, overwrite)
        ledger = Ledger(out)
        try:
            rows = run_sweep(scenes, ledger, progress)
        finally:
            progress.close()
        conditions = {"scenes": len(scenes.names()), "rounds": ROUNDS[quick]}
        written = write_report(out, path.stem, command, rows, [], conditions)
    for file in written:
        typer.echo(f"  {file}")


tradeoff.__doc__ = "Measure what accuracy costs: budgets, engines, precision, physics.\n" + EXAMPLE
