"""`radhar verify`: is a data set what its config and seed say?"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.tell import report, tell

if TYPE_CHECKING:
    from radhar_cli.dataset.verify import Report


def verify(
    out: Annotated[Path, typer.Argument(help="Folder that `radhar generate` wrote.")],
    samples: Annotated[int, typer.Option(min=0, help="Samples to synthesise anew.")] = 24,
    motion: Annotated[
        Path | None,
        typer.Option("--motion", help="Folder that the paths of motion files are relative to."),
    ] = None,
) -> None:
    """Check a data set: checksums, labels, counts, and samples synthesised anew.

    Exit status 0 if all is well, 1 if something differs.

    Example:

      radhar verify datasets/quickstart --samples 24
    """
    from radhar_cli.dataset.verify import verify as verify_folder

    found = verify_folder(out, samples, motion)
    report(**vars(found))
    if found.other_versions:
        tell("built with other versions, compared within one grey level:")
        for line in found.other_versions:
            tell(f"  {line}")
    for problem in found.problems[:20]:
        tell(f"WRONG {problem}")
    if len(found.problems) > 20:
        tell(f"... and {len(found.problems) - 20} more")
    if found.problems:
        raise typer.Exit(1)
    tell(
        f"{out}: {found.samples} samples; checksums, labels and counts right; "
        + (_anew(found) if found.resynthesised else "none made anew")
        + (f"; {found.pngs} PNG files show the same" if found.pngs else "")
    )
    if found.unmade:
        tell(f"{found.unmade} samples use motion files; --motion FOLDER synthesises them anew too")


def _anew(found: "Report") -> str:
    within = f"within {found.worst_level} grey level" if found.other_versions else "byte for byte"
    return f"{found.resynthesised} synthesised anew and equal {within}"
