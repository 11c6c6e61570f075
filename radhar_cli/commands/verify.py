"""`radhar verify`: is a data set what its config and seed say?"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.tell import tell

if TYPE_CHECKING:
    from radhar_cli.dataset.verify import Report


def verify(
    out: Annotated[Path, typer.Argument(help="Folder that `radhar generate` wrote.")],
    samples: Annotated[int, typer.Option(min=0, help="Samples to synthesise anew.")] = 24,
    motion: Annotated[
        Path | None,
        typer.Option("--motion", help="Folder from which the paths of motion files go."),
    ] = None,
) -> None:
    """Check a data set: checksums, labels, counts, and samples synthesised anew.

    Exit status 0 if all is well, 1 if something differs.

    Example:

      radhar verify datasets/quickstart --samples 24
    """
    from radhar_cli.dataset.verify import verify as verify_folder

    report = verify_folder(out, samples, motion)
    if report.other_versions:
        tell("built with other versions, compared within one grey level:")
        for line in report.other_versions:
            tell(f"  {line}")
    for problem in report.problems[:20]:
        tell(f"WRONG {problem}")
    if len(report.problems) > 20:
        tell(f"... and {len(report.problems) - 20} more")
    if report.problems:
        raise typer.Exit(1)
    tell(
        f"{out}: {report.samples} samples; checksums, labels and counts right; "
        + (_anew(report) if report.resynthesised else "none made anew")
        + (f"; {report.pngs} PNG files show the same" if report.pngs else "")
    )
    if report.unmade:
        tell(f"{report.unmade} samples move by files: --motion FOLDER would make them anew too")


def _anew(report: "Report") -> str:
    within = f"within {report.worst_level} grey level" if report.other_versions else "byte for byte"
    return f"{report.resynthesised} synthesised anew and equal {within}"
