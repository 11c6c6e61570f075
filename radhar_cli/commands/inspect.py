"""`radhar inspect`: what is in a data set, a scene, a recording, or a tree of images."""

from pathlib import Path
from typing import Annotated, Any

import typer

from radhar_cli.commands.tell import report, tell


def inspect(
    path: Annotated[
        Path, typer.Argument(help="Folder or file that radhar wrote, or a tree of class folders.")
    ],
) -> None:
    """Summarise a data set, a scene, a recording or a tree of images.

    Example:

      radhar inspect datasets/quickstart
    """
    from radhar_cli.capture.point_recording import is_point_recording, summarise_point_recording
    from radhar_cli.capture.recording import is_recording, summarise_recording
    from radhar_cli.dataset.summary import summarise
    from radhar_cli.learning.images.opening import is_tree, summarise_tree

    if path.is_file() and is_recording(path):
        summary = summarise_recording(path)
    elif path.is_file() and is_point_recording(path):
        summary = summarise_point_recording(path)
    else:
        foreign = is_tree(path) and not (path / "scene.h5").exists()
        summary = summarise_tree(path) if foreign else summarise(path)
    report(**summary)
    print_summary(summary)


def print_summary(summary: dict[str, Any]) -> None:
    """Print a summary, which is plain values, as YAML with six significant digits."""
    from radhar_cli.config.identity import yaml_text

    tell(yaml_text(_round_values(summary)), nl=False)


def _round_values(value: Any) -> Any:
    """Plain values, every float of which is rounded to six significant digits."""
    if isinstance(value, dict):
        return {key: _round_values(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_round_values(inner) for inner in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value
