"""`radhar tradeoff`: what accuracy costs on the scenes of a config."""

from pathlib import Path
from typing import Annotated, Any

import typer

from radhar_cli.commands.options import Overrides, ReplaceResults, refuse_to_replace_results
from radhar_cli.commands.tell import report


def tradeoff(
    config: Annotated[Path, typer.Argument(help="YAML config whose scenes are measured.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="Measure only three activities, in three rounds.")
    ] = False,
    set_: Overrides = None,
    overwrite: ReplaceResults = False,
) -> None:
    """Measure what accuracy costs: error and time of engine settings.

    Example:

      radhar tradeoff configs/paper/free_space.yaml -o out/tradeoff --quick

    Keep the machine idle during the run: load distorts the times, but not the errors.
    """
    from radhar_cli.commands.learning_options import needs

    needs("tradeoff", ["skimage"])
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.folder import refuse_file
    from radhar_cli.processes.worker_process import prepare_process
    from radhar_cli.tradeoff.report import FILES, write_report
    from radhar_cli.tradeoff.settings import Scenes
    from radhar_cli.tradeoff.study import ROUNDS, run_sweep

    refuse_file(out)
    refuse_to_replace_results(out, FILES, overwrite)
    scenes = Scenes(config, tuple(set_ or ()), quick)
    scenes.config()
    command = " ".join(
        ["radhar tradeoff", str(config), f"-o {out}"]
        + [f"--set {each}" for each in scenes.overrides]
        + ["--quick"] * quick
    )
    prepare_process()
    with BarProgress("step") as progress:
        rows = run_sweep(scenes, progress)
    conditions: dict[str, Any] = {"scenes": len(scenes.names()), "rounds": ROUNDS[quick]}
    written = write_report(out, config.stem, command, rows, conditions)
    report(files=written)
