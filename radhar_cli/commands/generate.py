"""`radhar generate`: a YAML file becomes a labelled data set."""

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import Overrides, StartOver, Tolerance, resumable, with_tolerance
from radhar_cli.commands.tell import tell
from radhar_cli.errors import ConfigError
from radhar_cli.processes import interrupts

if TYPE_CHECKING:
    from radhar_cli.config.data_set import AnyConfig, Config
    from radhar_cli.dataset.sample import RowFactory


def generate(
    config: Annotated[Path, typer.Argument(help="YAML file that describes the data set.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to write the data set to.")],
    set_: Overrides = None,
    tolerance: Tolerance = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            "--jobs",
            "-j",
            min=1,
            help="Number of worker processes. The default is one for each core, fewer for data "
            "sets too small to gain from as many.",
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

      radhar generate configs/paper/through_wall.yaml -o datasets/ttw_10dB --set snr_db=10 --jobs 2

    The same command resumes an interrupted build; it does nothing if the folder is complete.
    """
    with resumable(f"what is finished in {out}"):
        from radhar_cli.commands.terminal import BarProgress, print_outcome, print_part, print_plan
        from radhar_cli.config.data_set import Config, ConfigOfRecordings
        from radhar_cli.config.reading import load_config
        from radhar_cli.dataset.build import build, build_part
        from radhar_cli.dataset.estimate import jobs_that_pay
        from radhar_cli.dataset.layout import Rows
        from radhar_cli.dataset.parts import DataSetPart
        from radhar_cli.dataset.workers import cores, on_cluster
        from radhar_cli.processes.worker_process import prepare_process

        prepare_process()
        kind = Config if recordings is None else ConfigOfRecordings
        loaded, factory = load_config(config, with_tolerance(set_, tolerance), kind), None
        data_config: AnyConfig = loaded
        if recordings is not None:
            if shard is not None or cluster is not None:
                raise ConfigError("--recordings: cannot be combined with --shard or --cluster")
            data_config, factory = _config_of_recordings(loaded, recordings)
        elif loaded.recordings is not None:
            raise ConfigError(
                f"{config}: recordings: --recordings MANIFEST should say where they lie"
            )
        if dry_run:
            print_plan(data_config, jobs)
            return
        jobs = jobs or (cores() if factory else jobs_that_pay(loaded))
        workers = min(jobs, len(Rows.of(data_config)))
        processes = nullcontext(jobs) if cluster is None else on_cluster(cluster, workers)
        if shard is not None:
            part = DataSetPart.parse(shard)
            with BarProgress() as bars, processes as jobs:
                outcome = build_part(data_config, out, part, jobs, bars, overwrite, batch)
            interrupts.complete(f"part {part} of {out}")
            print_part(outcome, out, str(part))
            return
        with BarProgress() as bars, processes as jobs:
            outcome = build(data_config, out, jobs, bars, overwrite, batch, factory)
        interrupts.complete(str(out))
        print_outcome(data_config, outcome)


def _config_of_recordings(config: "Config", manifest: Path) -> "tuple[AnyConfig, RowFactory]":
    """The config of a data set of recordings, and what makes its rows."""
    from radhar_cli.capture.windows import WindowFactory, warnings_of, with_recordings
    from radhar_cli.scene_checks.unused_keys import unused_keys

    measured = with_recordings(config, manifest)
    unused = unused_keys(config)
    used = [one for one in unused if one.partition(".")[0] in type(measured).model_fields]
    for warning in (*used, *warnings_of(measured)):
        tell(f"warning: {warning}", err=True)
    folder = manifest if manifest.is_dir() else manifest.parent
    return measured, WindowFactory(folder.absolute())
