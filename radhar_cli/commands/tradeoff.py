"""`radhar tradeoff`: what accuracy costs on the scenes of a config."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import Overrides, ReplaceResults, resumable
from radhar_cli.commands.tell import report, tell

if TYPE_CHECKING:
    from radhar_cli.study.tradeoff.report import TradeoffFiles
    from radhar_cli.study.tradeoff.sweep import Sweep

QUICK_S = 168.0  # of a quick sweep, its start and figure left out


def tradeoff(
    config: Annotated[Path, typer.Argument(help="YAML config whose scenes are measured.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results.")],
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Measure three scenes in few rounds, within three minutes."),
    ] = False,
    minutes: Annotated[
        float | None,
        typer.Option(
            "--minutes",
            min=0.1,
            max=10_000,
            help="Time for the sweep; settings that do not fit are named. The default is none, "
            "with --quick 3.",
        ),
    ] = None,
    accuracy: Annotated[
        int | None,
        typer.Option(
            "--accuracy",
            metavar="SEEDS",
            min=2,
            max=100,
            help="Also train networks on data of each setting that saves time, with so many seeds "
            "(needs PyTorch).",
        ),
    ] = None,
    set_: Overrides = None,
    overwrite: ReplaceResults = False,
) -> None:
    """Measure what accuracy costs: time and error of settings.

    Example:

      radhar tradeoff paper/free_space -o out/tradeoff --quick

    Keep the machine idle during the run: load blurs the times, and the report says how far. What
    is measured is kept at once; the same command goes on after a stop.
    """
    from radhar_cli.commands.learning_options import needs, needs_torch

    needs("skimage")
    if accuracy is not None:
        needs_torch()
    from radhar_cli.dataset.folder import refuse_file
    from radhar_cli.dataset.workers import cores
    from radhar_cli.processes.worker_process import prepare_process
    from radhar_cli.study.tradeoff.report import TradeoffFiles
    from radhar_cli.study.tradeoff.samples import Scenes

    refuse_file(out)
    scenes = Scenes(config, tuple(set_ or ()), quick)
    scenes.config()
    words = ["radhar tradeoff", str(config), f"-o {out}"]
    words += [f"--set {override}" for override in scenes.overrides] + ["--quick"] * quick
    words += [] if minutes is None else [f"--minutes {minutes:g}"]
    words += [] if accuracy is None else [f"--accuracy {accuracy}"]
    files = TradeoffFiles(out, scenes, " ".join(words), cores())
    sweep = files.read_earlier(overwrite)
    prepare_process()
    seconds = QUICK_S if quick and minutes is None else 60 * (minutes or float("inf"))
    _measure(files, sweep, seconds, accuracy)
    written = files.write(sweep)
    sentences = files.recommendation(sweep)
    for sentence in sentences:
        tell(sentence)
    report(files=written, recommendation=sentences)


def _measure(files: "TradeoffFiles", sweep: "Sweep", seconds: float, seeds: int | None) -> None:
    """Measure what is not measured yet; what there is when it is stopped is written.

    Args:
        sweep: measurements so far; grows.
        seconds: time for all of it, s.
        seeds: seeds of networks; None for no networks.
    """
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.study.tradeoff.study import TradeoffStudy
    from radhar_cli.study.trials import Budget

    budget = Budget(seconds)
    with BarProgress("setting") as progress, resumable(f"what was measured in {files.folder}"):
        try:
            study = TradeoffStudy(files.scenes, sweep, budget, progress, lambda: files.keep(sweep))
            study.run()
            if seeds is not None:
                # which need PyTorch
                from radhar_cli.study.tradeoff.accuracy import AccuracyStudy, measure_accuracies

                networks = AccuracyStudy(files.scenes, files.folder / "accuracy", progress)
                measure_accuracies(networks, sweep, seeds, budget, lambda: files.keep(sweep))
        except (KeyboardInterrupt, SystemExit):
            if sweep.rows:
                files.write(sweep)
            raise
