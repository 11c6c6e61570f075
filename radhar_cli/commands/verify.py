"""`radhar verify`: is a data set what its config and seed say?"""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.tell import tell


def verify(
    out: Annotated[Path, typer.Argument(help="Folder that `radhar generate` wrote.")],
    samples: Annotated[int, typer.Option(min=0, help="Samples to synthesise anew.")] = 24,
) -> None:
    """Check a data set: checksums, labels, counts, and samples synthesised anew.

    Exit status 0 if all is well, 1 if something differs.

    Example:

      radhar verify datasets/quickstart --samples 24
    """
    from radhar_cli.dataset.verify import verify as verify_folder

    report = verify_folder(out, samples)
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
        f"{report.resynthesised} synthesised anew and equal"
        + (
            f" within {report.worst_level} grey level"
            if report.other_versions
            else " byte for byte"
        )
        + (f"; {report.pngs} PNG files show the same" if report.pngs else "")
    )
