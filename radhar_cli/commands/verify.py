"""`radhar verify`: check that a data set is what its config and seed determine."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.tell import counted, report, tell


def verify(
    out: Annotated[Path, typer.Argument(help="Folder that `radhar generate` wrote.")],
    samples: Annotated[
        int, typer.Option(min=0, help="Number of samples to synthesise again.")
    ] = 24,
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion",
            help="Folder of the motion files. Without it, samples that follow files are not "
            "synthesised again.",
        ),
    ] = None,
) -> None:
    """Check a data set, and synthesise some of its samples again.

    Compares checksums, labels and counts. The exit status is 0 if everything agrees, and 1 if
    something differs.

    Example:

      radhar verify datasets/quickstart --samples 24
    """
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.verify import verify as verify_folder

    with BarProgress() as bars:
        outcome = verify_folder(out, samples, motion, bars)
    report(**vars(outcome))
    if outcome.other_versions:
        tell("built with other versions, compared within one grey level:")
        for line in outcome.other_versions:
            tell(f"  {line}")
    for problem in outcome.problems[:20]:
        tell(f"WRONG {problem}")
    if len(outcome.problems) > 20:
        tell(f"... and {len(outcome.problems) - 20} more")
    if outcome.problems:
        raise typer.Exit(1)
    within = f"within {outcome.worst_level} grey level"
    anew = f"synthesised again and equal {within if outcome.other_versions else 'byte for byte'}"
    tell(
        f"{out}: {counted(outcome.samples, 'sample')}; checksums, labels and counts correct; "
        + (f"{outcome.resynthesised} {anew}" if outcome.resynthesised else "none synthesised again")
        + (f"; {outcome.pngs} PNG files show the same" if outcome.pngs else "")
    )
    if outcome.unmade:
        tell(f"{outcome.unmade} samples use motion files; --motion FOLDER checks them, too")
