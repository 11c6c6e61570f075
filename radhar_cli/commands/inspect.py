"""`radhar inspect`: what is in a data set, a scene, a recording, or a tree of images."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.tell import report, talks


def inspect(
    path: Annotated[Path, typer.Argument(help="What radhar wrote, or a tree of class folders.")],
) -> None:
    """Summarise a data set, a scene, a recording or a tree of images.

    Example:

      radhar inspect datasets/quickstart
    """
    from radhar_cli.capture.recording import is_recording, summarise_recording
    from radhar_cli.dataset.summary import summarise
    from radhar_cli.learning.images.opening import is_tree, summarise_tree

    if path.is_file() and is_recording(path):
        summary = summarise_recording(path)
    else:
        foreign = is_tree(path) and not (path / "scene.h5").exists()
        summary = summarise_tree(path) if foreign else summarise(path)
    report(**summary)
    if talks():
        from radhar_cli.commands.summary_view import print_summary

        print_summary(summary)
