"""`radhar audit`: how well classes can be told from what is not the movement."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from radhar_cli.commands.learning_options import AnyMap
from radhar_cli.commands.options import ReplaceResults, refuse_to_replace_results
from radhar_cli.commands.tell import counted, report, tell


def audit(
    data: Annotated[
        Path,
        typer.Argument(
            help="Data set: dataset.h5, a folder that `radhar generate` wrote, class folders with "
            "images, or a CSV table with a column `class`."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="Folder to write the audit to. The default is DATASET/audit, where `verify`, the "
            "data card and `eval` find it; of images and tables it has to be named.",
        ),
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="CSV file with what is known of each sample: a column file or sample, then "
            "person, recording, date, length or whatever there is.",
        ),
    ] = None,
    map_: AnyMap = None,
    per_class: Annotated[
        int | None,
        typer.Option(
            "--per-class",
            min=2,
            max=100_000,
            help="Largest number of samples of a class to guess from, drawn at random. The default "
            "is 300, with --quick 60.",
        ),
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer samples and smaller forests: wider intervals.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Seed of draws, folds and forests.")] = 1,
    fail_above: Annotated[
        float | None,
        typer.Option(
            "--fail-above",
            metavar="SHARE",
            min=0,
            max=1,
            help="End with status 1 if the class is told in more than that share, such as 0.15.",
        ),
    ] = None,
    judge: Annotated[
        Literal["numbers", "all"],
        typer.Option(
            help="What --fail-above looks at: numbers of scenes, recordings and tables; or all, "
            "images and clouds too."
        ),
    ] = "numbers",
    overwrite: ReplaceResults = False,
) -> None:
    """Find what tells the classes of a data set besides the movement.

    Guesses the class of samples from each number of the scene that is not the movement, from the
    margins of the images and from their noise, beside chance; and finds duplicates, and persons in
    several splits.

    Example:

      radhar audit datasets/quickstart --quick

      radhar audit measured --table recordings.csv -o out/audit --fail-above 0.3

    A share at chance says that a small forest found nothing, not that nothing is there.
    """
    from radhar_cli.commands.learning_options import needs

    needs("sklearn")
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.audited import AUDIT_NUMBERS
    from radhar_cli.study.audit.audit import QUICK, QUICK_SAMPLES
    from radhar_cli.study.audit.audit import audit as audit_data
    from radhar_cli.study.audit.card import add_to_card
    from radhar_cli.study.audit.evidence import EvidencePart
    from radhar_cli.study.audit.held_out import Effort
    from radhar_cli.study.audit.report import audit_numbers, terminal_lines, write_audit

    folder = _output_folder(data, out)
    refuse_to_replace_results(folder, (AUDIT_NUMBERS,), overwrite)
    effort = Effort(QUICK.trees, QUICK.folds, QUICK.permutations) if quick else Effort()
    effort = Effort(effort.trees, effort.folds, effort.permutations, seed)
    most_samples = per_class or (QUICK_SAMPLES if quick else 300)
    with BarProgress() as bars:
        result = audit_data(data, bars, map_, table, effort, most_samples)
    for warning in result.warnings:
        tell(f"warning: {warning}", err=True)
    files = write_audit(result, folder)
    card = add_to_card(data, folder)
    for line in terminal_lines(result):
        tell(line)
    parts = (
        list(EvidencePart) if judge == "all" else [EvidencePart.NUMBERS, EvidencePart.RECORDINGS]
    )
    too_high = [] if fail_above is None else result.lines_above(fail_above, parts)
    numbers = audit_numbers(result)
    failed = [line.evidence.name for line in too_high]
    report(files=[*files, *([card] if card else [])], **{**numbers, "above": failed})
    samples = f"{counted(result.rows.size, 'sample')}, {result.held_out}s held out"
    tell(f"{data}: {samples}; figure in {files[-1]}")
    if too_high:
        tell(f"above {fail_above:g}: {', '.join(failed)}", err=True)
        raise typer.Exit(1)


def _output_folder(data: Path, out: Path | None) -> Path:
    """Folder of the audit; the default is beside a dataset.h5.

    Raises:
        FolderError: none is named and there is no default, or it is data itself.
    """
    from radhar_cli.commands.learning_options import refuse_output_inside_data
    from radhar_cli.dataset.audited import audit_folder
    from radhar_cli.dataset.radar_folders import describe_missing, refuse_several_radars
    from radhar_cli.errors import FolderError
    from radhar_cli.files.replacing import refuse_links

    beside = audit_folder(data)
    if out is None and beside is not None:
        refuse_links(beside.parent, beside)
        return beside
    if not data.exists():
        raise FolderError(f"{data}: {describe_missing(data)}")
    refuse_several_radars(data)
    if out is None:
        raise FolderError(f"{data}: is no data set of `radhar generate`; -o should name a folder")
    if beside is None or out.resolve() != beside.resolve():
        refuse_output_inside_data(out, [data])
    return out
