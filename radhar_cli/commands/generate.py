"""`radhar generate`: a YAML file becomes a labelled data set."""

from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import (
    Overrides,
    StartOver,
    Tolerance,
    jobs_option,
    resumable,
    with_tolerance,
)
from radhar_cli.commands.tell import for_each_radar, tell
from radhar_cli.errors import ConfigError
from radhar_cli.processes import interrupts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from radhar_cli.config.data_set import AnyConfig, Config
    from radhar_cli.dataset.parts import DataSetPart
    from radhar_cli.dataset.sample import RowFactory


def generate(
    config: Annotated[Path, typer.Argument(help="YAML file that describes the data set.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to write the data set to.")],
    set_: Overrides = None,
    tolerance: Tolerance = None,
    jobs: Annotated[
        int | None,
        jobs_option(
            "Number of worker processes. The default is one for each core, fewer for data "
            "sets too small to gain from as many."
        ),
    ] = None,
    batch: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Number of samples that a worker makes before it writes them. The data set has "
            "the same bytes whatever it is.",
        ),
    ] = None,
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run",
            help="Print size and time that some samples tell, and where the time goes (at most "
            "30 s); write nothing.",
        ),
    ] = False,
    shard: Annotated[
        str | None,
        typer.Option(
            metavar="K/N",
            help="Make only part K of N of the data set; `radhar merge` puts the parts together.",
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Dask scheduler to run on, such as tcp://host:8786; `local` starts one here.",
        ),
    ] = None,
    recordings: Annotated[
        Path | None,
        typer.Option(
            metavar="MANIFEST",
            help="Use recordings instead of simulated scenes. MANIFEST is a CSV or YAML list "
            "(file, label, person, start, stop), a tree of class folders, or an .npz of images.",
        ),
    ] = None,
    overwrite: StartOver = False,
) -> None:
    """Build a labelled data set from a config file.

    Example:

      radhar generate paper/through_wall -o datasets/ttw_10dB --set snr_db=10 --jobs 2

    The same command resumes an interrupted build; it does nothing if the folder is complete.
    """
    with nullcontext() if dry_run else resumable(f"what is finished in {out}"):
        from radhar_cli.commands.terminal import print_plan
        from radhar_cli.config.data_set import Config, ConfigOfRecordings
        from radhar_cli.config.reading import load_config, load_radars
        from radhar_cli.dataset.parts import DataSetPart
        from radhar_cli.dataset.radar_folders import reserve_radars
        from radhar_cli.processes.worker_process import prepare_process

        prepare_process()
        overrides, factory = with_tolerance(set_, tolerance), None
        configs: dict[str, AnyConfig] = {}
        if recordings is not None:
            if shard is not None or cluster is not None:
                raise ConfigError("--recordings: cannot be combined with --shard or --cluster")
            loaded = load_config(config, overrides, ConfigOfRecordings)
            configs[""], factory = _config_of_recordings(loaded, recordings)
        else:
            configs |= load_radars(config, overrides, Config)
            if next(iter(configs.values())).recordings is not None:
                raise ConfigError(
                    f"{config}: recordings: --recordings MANIFEST should say where they lie"
                )
        if dry_run:
            for_each_radar(configs, lambda _, of_radar: print_plan(of_radar, jobs))
            return
        work = Work(jobs, batch, cluster, overwrite, factory)
        part = None if shard is None else DataSetPart.parse(shard)
        folders = {"": out} if [*configs] == [""] else reserve_radars(out, configs)

        def build_radar(name: str, of_radar: "AnyConfig") -> None:
            is_last = name == [*configs][-1]
            if part is None:
                work.build(of_radar, folders[name], is_last)
            else:
                work.build_part(of_radar, folders[name], part, out, is_last)

        for_each_radar(configs, build_radar)


@dataclass(frozen=True)
class Work:
    """Workers, batches and source of rows of a build of data sets.

    Attributes:
        jobs: number of worker processes; None for as many as pay.
        batch: number of samples that a worker makes before it writes them, or None.
        cluster: address of a Dask scheduler, or None.
        overwrite: whether a folder that holds another data set is started over.
        factory: makes the rows of a data set of recordings; None of simulated ones.
    """

    jobs: int | None
    batch: int | None
    cluster: str | None
    overwrite: bool
    factory: "RowFactory | None"

    @contextmanager
    def processes(self, config: "AnyConfig") -> "Iterator[int]":
        """Context in which so many processes work on a data set."""
        from radhar_cli.config.data_set import Config
        from radhar_cli.dataset.estimate import jobs_that_pay
        from radhar_cli.dataset.layout import Rows
        from radhar_cli.dataset.workers import cores, on_cluster

        jobs = self.jobs or (jobs_that_pay(config) if isinstance(config, Config) else cores())
        if self.cluster is None:
            yield jobs
            return
        with on_cluster(self.cluster, min(jobs, len(Rows.of(config)))) as workers:
            yield workers

    def build(self, config: "AnyConfig", out: Path, is_last: bool) -> None:
        """Build a data set, or resume it, and print a summary.

        Args:
            config: that of the data set.
            out: its folder.
            is_last: whether nothing is left to do after it.
        """
        from radhar_cli.commands.terminal import BarProgress, print_outcome
        from radhar_cli.dataset.build import build

        with BarProgress(radar=_radar_name(config)) as bars, self.processes(config) as jobs:
            outcome = build(config, out, jobs, bars, self.overwrite, self.batch, self.factory)
        if is_last:
            interrupts.complete(str(out))
        print_outcome(config, outcome)

    def build_part(
        self, config: "AnyConfig", out: Path, part: "DataSetPart", merged: Path, is_last: bool
    ) -> None:
        """Make a part of a data set, or resume it, and print a summary.

        Args:
            config: that of the data set.
            out: its folder.
            merged: folder that `radhar merge` takes: that one, or the one of several radars.
            is_last: whether nothing is left to do after it.
        """
        from radhar_cli.commands.terminal import BarProgress, print_part
        from radhar_cli.dataset.build import build_part

        with BarProgress(radar=_radar_name(config)) as bars, self.processes(config) as jobs:
            outcome = build_part(config, out, part, jobs, bars, self.overwrite, self.batch)
        if is_last:
            interrupts.complete(f"part {part} of {out}")
        print_part(outcome, merged, str(part))


def _radar_name(config: "AnyConfig") -> str | None:
    """Name of the radar of a config, of one of several; None of any other."""
    from radhar_cli.config.data_set import Config

    return config.radar_name if isinstance(config, Config) else None


def _config_of_recordings(config: "Config", manifest: Path) -> "tuple[AnyConfig, RowFactory]":
    """The config of a data set of recordings, and what makes its rows."""
    from radhar_cli.capture.windows import WindowFactory, warnings_of, with_recordings
    from radhar_cli.config.checks.unused_keys import unused_keys

    measured = with_recordings(config, manifest)
    unused = unused_keys(config)
    used = [one for one in unused if one.partition(".")[0] in type(measured).model_fields]
    for warning in (*used, *warnings_of(measured)):
        tell(f"warning: {warning}", err=True)
    folder = manifest if manifest.is_dir() else manifest.parent
    return measured, WindowFactory(folder.absolute())
