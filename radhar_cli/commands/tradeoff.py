"""`radhar tradeoff`: what accuracy costs on the scenes of a config."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from radhar_cli.commands.options import Overrides, resumable
from radhar_cli.commands.tell import report, tell

if TYPE_CHECKING:
    from radhar_cli.tradeoff.accuracy import Accuracy
    from radhar_cli.tradeoff.result_cache import ResultCache
    from radhar_cli.tradeoff.scenes import Scenes

CLEAN_DB = 30.0
EXAMPLE = """
Example:

  radhar tradeoff configs/paper/free_space.yaml -o out/tradeoff --quick

The same command, run again, resumes. Leave the machine idle meanwhile: a busy one distorts the
times, not the errors.
"""


def tradeoff(
    config: Annotated[Path, typer.Argument(help="YAML config whose scenes are measured.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="Three activities, three rounds: a first look.")
    ] = False,
    train: Annotated[
        bool, typer.Option("--train", help="Train a small network on data of each setting too.")
    ] = False,
    set_: Overrides = None,
    jobs: Annotated[
        int | None, typer.Option("--jobs", "-j", min=1, help="Processes that build data to train.")
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Start over in a folder that holds a sweep.")
    ] = False,
) -> None:
    from radhar_cli.commands.learning_options import needs, needs_torch

    needs("tradeoff", ["skimage"])
    if train:
        needs_torch()
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.folder import folder_lock
    from radhar_cli.tradeoff.folder import reserve
    from radhar_cli.tradeoff.report import write_report
    from radhar_cli.tradeoff.result_cache import ResultCache
    from radhar_cli.tradeoff.scenes import Scenes
    from radhar_cli.tradeoff.study import ROUNDS, run_sweep
    from radhar_cli.worker_process import prepare_process

    scenes = Scenes(config, tuple(set_ or ()), quick)
    loaded = scenes.config()
    command = " ".join(
        ["radhar tradeoff", str(config), f"-o {out}"]
        + [f"--set {each}" for each in scenes.overrides]
        + ["--quick"] * quick
        + ["--train"] * train
    )
    with resumable(f"what is measured in {out}"), folder_lock(out):
        prepare_process()
        reserve(out, loaded, overwrite)
        cache = ResultCache(out)
        with BarProgress("step") as progress:
            rows = run_sweep(scenes, cache, progress)
        conditions: dict[str, Any] = {"scenes": len(scenes.names()), "rounds": ROUNDS[quick]}
        accuracies: list[Accuracy] = []
        if train:
            # The results so far stay on disk if the training fails.
            write_report(out, config.stem, command, rows, [], conditions)
            accuracies, learned = _accuracies(scenes, out, cache, jobs)
            conditions |= learned
        written = write_report(out, config.stem, command, rows, accuracies, conditions)
    report(files=written)
    for file in written:
        tell(f"  {file}")


def _accuracies(
    scenes: "Scenes", out: Path, cache: "ResultCache", jobs: int | None
) -> tuple[list["Accuracy"], dict[str, Any]]:
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.layout import WORK
    from radhar_cli.dataset.workers import cores
    from radhar_cli.tradeoff.accuracy import find_snr, measure
    from radhar_cli.tradeoff.settings import trials
    from radhar_cli.tradeoff.trial import FULL, QUICK, Experiment

    sizes = QUICK if scenes.quick else FULL
    with BarProgress() as progress:
        experiment = Experiment(
            config=scenes.path,
            folder=out / WORK / "accuracy",
            cache=cache,
            progress=progress,
            jobs=jobs or cores(),
            sizes=sizes,
            overrides=scenes.overrides,
        )
        # Six samples per class teach nothing at any SNR: do not search for one.
        snr_db = CLEAN_DB if scenes.quick else find_snr(experiment)
        accuracies = measure(experiment, trials(scenes.config()), snr_db)
    learned = {
        "snr_db": snr_db,
        "train_per_class": sizes.train_per_class,
        "test_per_class": sizes.test_per_class,
        "epochs": sizes.epochs,
        "smoke_run": scenes.quick,
    }
    return accuracies, learned


tradeoff.__doc__ = "Measure what accuracy costs: tolerances, engines, physics.\n" + EXAMPLE
