"""`radhar preview`: a contact sheet of a data set, by class."""

from pathlib import Path
from typing import Annotated

import typer


def preview(
    dataset: Annotated[Path, typer.Argument(help="Folder that `generate` wrote, or a dataset.h5.")],
    map_: Annotated[
        str | None, typer.Option("--map", help="Which map; the first if not given.")
    ] = None,
    per_class: Annotated[int, typer.Option(min=1, max=50, help="Samples a class.")] = 4,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="PNG; preview_<map>.png beside the data.")
    ] = None,
) -> None:
    """Draw a contact sheet of a data set by class, from dataset.h5 alone.

    Example:

      radhar preview datasets/quickstart --map stft --per-class 4
    """
    from radhar_cli.dataset.files import refuse_links
    from radhar_cli.dataset.reading import open_dataset
    from radhar_cli.figures.contact_sheet import draw_contact_sheet

    with open_dataset(dataset) as data:
        name = data.map_name(map_)
        path = out or data.path.parent / f"preview_{name}.png"
        refuse_links(path.parent, path)
        draw_contact_sheet(data, name, per_class, path)
    typer.echo(str(path))
