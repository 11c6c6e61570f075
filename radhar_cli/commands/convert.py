"""`radhar convert`: a data set in a format that other tools read."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.tell import counted, report, tell


def convert(
    dataset: Annotated[Path, typer.Argument(help="Folder that `generate` wrote, or dataset.h5.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to create.")],
    to: Annotated[
        str,
        typer.Option(metavar="FORMAT", help="parquet, webdataset; for point clouds mars, ros, ti."),
    ],
) -> None:
    """Convert a data set, or its point clouds, for other tools.

    Example:

      radhar convert datasets/quickstart -o shared/quickstart --to parquet

      radhar convert datasets/quickstart -o shared/tars --to webdataset

      radhar convert datasets/boards -o shared/mars --to mars

    Labels and splits are included; with images also a data card and the random numbers of each
    scene. The folder appears when it is complete. Parquet needs `pip install pyarrow`.
    """
    from radhar_cli.commands.learning_options import needs
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.formats.convert import FORMATS
    from radhar_cli.dataset.formats.convert import convert as write
    from radhar_cli.errors import RadharError, did_you_mean

    if to not in FORMATS:
        hint = did_you_mean(to, FORMATS, f"should be one of {', '.join(FORMATS)}")
        raise RadharError(f"--to {to}: is not a format; {hint}")
    if to == "parquet":
        needs("pyarrow")
    with BarProgress() as progress:
        samples = write(dataset, out, to, progress)
    report(folder=out, samples=samples, format=to)
    tell(f"{out}: {counted(samples, 'sample')} as {to}; {out / 'README.md'} says how to read them")
