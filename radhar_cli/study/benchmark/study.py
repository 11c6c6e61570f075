"""The benchmark: every protocol whose measured data set is there, row by row."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import load_section
from radhar_cli.dataset.estimate import Estimate, estimate
from radhar_cli.dataset.layout import Rows
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.study.benchmark.engine import SIMULATION, Bench, RowResult
from radhar_cli.study.benchmark.protocols import PERSONS, Protocol, choose_protocols
from radhar_cli.study.benchmark.sets import (
    MeasuredSource,
    find_measured_set,
    open_both,
    prepare_measured_set,
    simulate,
    simulation_config,
)

RADHAR = "radhar"  # simulator, where no other one is given
TRIAL_S = 6.0  # of timing samples, in a dry run


@dataclass(frozen=True)
class BenchmarkOptions:
    """Data, rows and sizes of a benchmark.

    Attributes:
        folder: holds downloads, or data sets that were prepared of them.
        out: folder of all that is made.
        rows: rows of the table.
        seeds: number of networks of each row.
        epochs: passes over the training samples; None is the default of `radhar train`.
        per_class: simulated samples of a class; None is the preset's.
        simulated: data set that stands in place of the simulation of each protocol, if any.
        protocols: names of protocols; all where none is given.
        jobs: number of processes that prepare and simulate.
    """

    folder: Path
    out: Path
    rows: tuple[str, ...]
    seeds: int
    epochs: int | None = None
    per_class: int | None = None
    simulated: Path | None = None
    protocols: tuple[str, ...] = ()
    jobs: int = 1

    def training(self, protocol: Protocol) -> TrainConfig:
        """Training config of a protocol."""
        epochs = {} if self.epochs is None else {"epochs": self.epochs}
        return load_section(TrainConfig, {**protocol.training, **epochs})


@dataclass(frozen=True)
class ProtocolResult:
    """Rows of a protocol, or why there are none."""

    name: str
    protocol: Protocol
    simulated: Path | None  # data set of another simulator; None is radhar's own simulation
    classes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()  # measured classes that the simulation lacks
    rows: list[RowResult] = field(default_factory=list)
    why_not: str = ""

    @property
    def simulator(self) -> str:
        """Name of the simulator: radhar, or the folder of the other one's data set."""
        return str(self.simulated or RADHAR)


class FoundProtocol(NamedTuple):
    """Protocol whose measured data set was looked for."""

    name: str
    protocol: Protocol
    source: MeasuredSource | None
    why_not: str


def find_protocols(options: BenchmarkOptions) -> list[FoundProtocol]:
    """Find the measured data sets of the protocols that are asked for.

    Raises:
        RadharError: there is no such folder or protocol, or no data set of any.
    """
    for path, holds in ((options.folder, "downloads"), (options.simulated, "simulated samples")):
        if path is not None and not path.exists():
            raise FolderError(f"{path}: no such folder; should hold {holds}")
    if not options.folder.is_dir():
        raise FolderError(f"{options.folder}: is no folder; should be unpacked into one")
    choices = [
        _find_protocol(name, protocol, options)
        for name, protocol in choose_protocols(options.protocols).items()
    ]
    if all(choice.source is None for choice in choices):
        raise FolderError("; ".join(choice.why_not for choice in choices))
    return choices


def _find_protocol(name: str, protocol: Protocol, options: BenchmarkOptions) -> FoundProtocol:
    """Find the measured data set of a protocol."""
    folder = options.folder
    try:
        source = find_measured_set(protocol, folder, options.out)
    except RadharError as error:
        return FoundProtocol(name, protocol, None, str(error))
    why_not = "" if source else f"{folder}: holds no {protocol.recipe} {protocol.part}".rstrip()
    return FoundProtocol(name, protocol, source, why_not)


def run_benchmark(options: BenchmarkOptions, progress: Progress) -> Iterator[ProtocolResult]:
    """Yield the rows of every protocol; what an earlier call has trained is not trained again."""
    for choice in find_protocols(options):
        result = ProtocolResult(choice.name, choice.protocol, options.simulated)
        if choice.source is None:
            yield replace(result, why_not=choice.why_not)
            continue
        try:
            bench = _open_bench(choice.protocol, choice.source, options, progress)
        except RadharError as error:
            yield replace(result, why_not=str(error))
            continue
        rows = [bench.measure_row(row, options.seeds) for row in options.rows]
        classes = bench.both.measured.classes
        yield replace(result, classes=classes, left_out=bench.both.left_out, rows=rows)


def _open_bench(
    protocol: Protocol, source: MeasuredSource, options: BenchmarkOptions, progress: Progress
) -> Bench:
    """Prepare, simulate and open the two data sets of a protocol."""
    out, jobs = options.out, options.jobs
    measured = prepare_measured_set(source, out / "measured" / protocol.data, jobs, progress)
    simulated = options.simulated
    if simulated is None:
        config = simulation_config(protocol, options.per_class)
        simulated = simulate(config, out / "simulated", jobs, progress)
    training = options.training(protocol)
    both = open_both(protocol, training, measured, simulated)
    for note in dict.fromkeys((*both.measured.notes, *both.simulated.notes)):
        progress.say(note)
    bench = Bench(protocol, training, both, out / "runs" / protocol.data, progress)
    return bench if options.epochs is None else replace(bench, adapting=options.epochs)


def plan_lines(options: BenchmarkOptions) -> Iterator[str]:
    """Yield what a benchmark will do, and how long its simulations take; nothing is written."""
    for choice in find_protocols(options):
        if choice.source is None:
            yield f"{choice.name}: not done: {choice.why_not}"
            continue
        source, protocol = choice.source, choice.protocol
        measured = (
            f"{source.dataset} is prepared"
            if source.preparation is None
            else f"{source.recordings} recordings will be prepared"
        )
        yield f"{choice.name}: {measured}"
        yield f"  simulated: {_simulation_in_words(protocol, options)}"
        folds = protocol.folds if protocol.split == PERSONS else 1
        per_seed = sum(1 if row == SIMULATION else folds for row in options.rows)
        training = options.training(protocol)
        yield (
            f"  {training.model}: at most {options.seeds * per_seed} trainings (rows: "
            f"{len(options.rows)}, seeds: {options.seeds}, parts: at most {folds}, epochs: "
            f"{training.epochs})"
        )


def _simulation_in_words(protocol: Protocol, options: BenchmarkOptions) -> str:
    """Simulated data set of a protocol and the time of its build, in words."""
    if options.simulated is not None:
        return str(options.simulated)
    config: Config = simulation_config(protocol, options.per_class)
    cost = estimate(config, options.jobs, TRIAL_S, NO_PROGRESS)
    minutes = (cost.seconds if isinstance(cost, Estimate) else cost.seconds_range[0]) / 60
    count = len(Rows.of(config))
    return f"{count} samples of {protocol.simulation}, about {minutes:.1f} min"
