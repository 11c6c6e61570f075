"""`radhar limits`: how far each number of a config may go, and what happens beyond."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import Overrides, ReplaceResults, refuse_to_replace_results
from radhar_cli.commands.tell import report, tell


def limits(
    config: Annotated[Path, typer.Argument(help="YAML config whose numbers are tried.")],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="Folder for limits.md and limits.json; none without it."),
    ] = None,
    key: Annotated[
        list[str] | None,
        typer.Option(
            "--key",
            metavar="KEY",
            help="Dotted key or section that is looked at, such as radar.prf_hz or motion; may be "
            "repeated. The default is every number that has an effect.",
        ),
    ] = None,
    minutes: Annotated[
        float, typer.Option(min=0.01, max=1440, help="Time for all of it; what is found counts.")
    ] = 1.0,
    set_: Overrides = None,
    overwrite: ReplaceResults = False,
) -> None:
    """Find how far each number of a config may go.

    Each number is put in place of what is drawn, farther and farther, until the config is refused,
    something new is warned of, scenes can no longer be drawn, the fast engine misses its
    tolerance, a map is black, or a sample is ten times the work.

    Example:

      radhar limits quickstart --key radar.prf_hz --key motion.walking.speed_mps

      radhar limits quickstart -o out/limits --minutes 5

    What there was no time for is named at the end.
    """
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.folder import refuse_file
    from radhar_cli.processes.worker_process import prepare_process
    from radhar_cli.study.limits.judging import ConfigTrial
    from radhar_cli.study.limits.report import (
        FILES,
        limits_numbers,
        terminal_lines,
        unfinished_lines,
        write_report,
    )
    from radhar_cli.study.limits.study import study_limits

    if out is not None:
        refuse_file(out)
        refuse_to_replace_results(out, FILES, overwrite)
    prepare_process()
    trial = ConfigTrial.of_file(config, set_ or ())
    with BarProgress("limit") as progress:
        study = study_limits(trial, key, 60 * minutes, progress)
    for line in terminal_lines(study):
        tell(line)
    for line in unfinished_lines(study):
        tell(line, err=True)
    words = ["radhar limits", str(config), *(f"--key {name}" for name in key or ())]
    words += [f"--minutes {minutes:g}", *(f"--set {one}" for one in set_ or ())]
    written = []
    if out is not None:
        written = write_report(out, config.stem, " ".join(words), study)
    report(files=written, **limits_numbers(study))
