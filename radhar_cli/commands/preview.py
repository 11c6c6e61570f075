"""`radhar preview`: a contact sheet of a data set, by class."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import AnyMap
from radhar_cli.commands.options import Replace, refuse_to_replace
from radhar_cli.commands.tell import report, tell


def preview(
    dataset: Annotated[Path, typer.Argument(help="Folder that `generate` wrote, or dataset.h5.")],
    map_: AnyMap = None,
    per_class: Annotated[int, typer.Option(min=1, max=50, help="Number of samples per class.")] = 4,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="PNG file to write, which should be new. The default is preview_<map>.png beside "
            "the data; the one of an earlier preview is replaced.",
        ),
    ] = None,
    overwrite: Replace = False,
) -> None:
    """Draw a contact sheet of a data set: samples of every class.

    Example:

      radhar preview datasets/quickstart --map stft --per-class 4
    """
    from radhar_cli.dataset.contact_sheet import draw_contact_sheet
    from radhar_cli.dataset.reading import open_dataset
    from radhar_cli.dataset.stream_files import draw_streams
    from radhar_cli.figures.page import DPI, write_figure
    from radhar_cli.files.replacing import refuse_links

    if out is not None:
        refuse_to_replace(out, overwrite, "sheet.png")
    with open_dataset(dataset) as data:
        name = data.map_name(map_)
        path = out or data.path.parent / f"preview_{name}.png"
        refuse_links(path.parent, path)
        if data.frame_label:
            write_figure(draw_streams(data, name, per_class), path, DPI)
        else:
            draw_contact_sheet(data, name, per_class, path)
    report(file=path)
    tell(str(path))
