"""`radhar preview`: a contact sheet of a data set, by class."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import AnyMap
from radhar_cli.commands.tell import report, tell

MAX_CLASSES = 40


def preview(
    dataset: Annotated[
        Path,
        typer.Argument(
            help="Folder that `generate` wrote, dataset.h5, or a tree of class folders."
        ),
    ],
    map_: AnyMap = None,
    per_class: Annotated[int, typer.Option(min=1, max=50, help="Samples a class.")] = 4,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="PNG; preview_<map>.png next to the data.")
    ] = None,
) -> None:
    """Draw a contact sheet of a data set or a tree of images.

    Example:

      radhar preview datasets/quickstart --map stft --per-class 4
    """
    from radhar_cli.dataset.contact_sheet import draw_contact_sheet
    from radhar_cli.dataset.files import refuse_links
    from radhar_cli.dataset.reading import open_dataset
    from radhar_cli.learning.images.opening import is_tree

    if is_tree(dataset):
        _tell(_draw_tree(dataset, map_, per_class, out))
        return
    with open_dataset(dataset) as data:
        name = data.map_name(map_)
        path = out or data.path.parent / f"preview_{name}.png"
        refuse_links(path.parent, path)
        draw_contact_sheet(data, name, per_class, path)
    _tell(path)


def _tell(path: Path) -> None:
    report(file=path)
    tell(str(path))


def _draw_tree(root: Path, map_name: str | None, per_class: int, out: Path | None) -> Path:
    """Draw next to the tree, not in it: its files are data."""
    from radhar_cli.dataset.contact_sheet import draw_image_sheet
    from radhar_cli.learning.images.folder import folder_images
    from radhar_cli.learning.images.opening import first_of_each

    images = folder_images(root, map_name, "rgb", any_size=True)
    whole = root.resolve()
    path = out or whole.parent / f"preview_{whole.name}.png"
    title = f"{whole.name}: {len(images)} images of {len(images.classes)} classes"
    if len(images.classes) > MAX_CLASSES:
        title += f", the first {MAX_CLASSES} shown"
    draw_image_sheet(first_of_each(images, per_class, MAX_CLASSES), title, path)
    return path
