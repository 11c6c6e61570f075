"""`radhar benchmark`: what simulated data sets are worth on public measured ones."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import jobs_option, resumable
from radhar_cli.commands.tell import report, tell
from radhar_cli.errors import FolderError
from radhar_cli.processes import interrupts


def benchmark(
    folder: Annotated[
        Path,
        typer.Argument(
            help="Folder of the downloads, unpacked, or of data sets that `radhar prepare` made."
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of all that is made.")],
    rows: Annotated[
        str,
        typer.Option(
            help="Rows of the table: simulation, adapted, measured, together, and numbers of "
            "measured labels a class."
        ),
    ] = "simulation,adapted,1,5,10,20,measured,together",
    protocols: Annotated[
        str | None,
        typer.Option(help="Protocols, such as radhar,mars. The default is all that can be done."),
    ] = None,
    simulated: Annotated[
        Path | None,
        typer.Option(
            metavar="DATASET",
            help="Data set of another simulator, which stands in place of radhar's.",
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, max=100, help="Number of networks of a row.")] = 5,
    epochs: Annotated[
        int | None,
        typer.Option(min=1, max=10_000, help="Epochs of every training. The default is train's."),
    ] = None,
    per_class: Annotated[
        int | None,
        typer.Option(min=3, help="Simulated samples of a class. The default is the config's."),
    ] = None,
    jobs: Annotated[
        int | None,
        jobs_option("Number of processes that prepare and simulate; one for each core."),
    ] = None,
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run", help="Print what will be done, and the time of simulations; write nothing."
        ),
    ] = False,
) -> None:
    """Compare simulators by networks tested on measured data.

    Example:

      radhar benchmark downloads -o out/benchmark

      radhar benchmark downloads -o out/benchmark --protocols radhar --simulated datasets/theirs

    A row that is done is not trained again, so that the same command goes on after a stop.
    """
    from radhar_cli.commands.learning_options import needs_torch

    needs_torch()
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.workers import cores
    from radhar_cli.processes.worker_process import prepare_process
    from radhar_cli.study.benchmark.engine import parse_rows
    from radhar_cli.study.benchmark.report import benchmark_report, result_lines
    from radhar_cli.study.benchmark.study import BenchmarkOptions, plan_lines, run_benchmark

    prepare_process()
    options = BenchmarkOptions(
        folder=folder,
        out=out,
        rows=parse_rows(rows),
        seeds=seeds,
        epochs=epochs,
        per_class=per_class,
        simulated=simulated,
        protocols=tuple(word.strip() for word in (protocols or "").split(",") if word.strip()),
        jobs=jobs or cores(),
    )
    if dry_run:
        lines = [*plan_lines(options)]
        for line in lines:
            tell(line)
        report(plan=lines)
        return
    results = []
    with resumable(f"what is trained in {out}"), BarProgress() as bars:
        for result in run_benchmark(options, bars):
            results.append(result)
            bars.close()
            for line in result_lines(result):
                tell(line)
        files = benchmark_report(options, results).write(out)
        interrupts.complete(str(out))
    report(files=files, protocols={r.name: asdict(r) | {"simulated": r.simulator} for r in results})
    if all(result.why_not for result in results):
        raise FolderError("; ".join(f"{result.name}: {result.why_not}" for result in results))
