"""Options and checks shared by the learning commands."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from radhar_cli.errors import FolderError, MachineError, how_to_install

Run: TypeAlias = Annotated[
    Path, typer.Argument(help="Folder of a training run, or its .safetensors file.")
]
TrainedMap: TypeAlias = Annotated[
    str | None,
    typer.Option("--map", help="Map to use instead of the one that the network was trained on."),
]
AnyMap: TypeAlias = Annotated[
    str | None, typer.Option("--map", help="Name of the map. The default is the first one.")
]
Split: TypeAlias = Annotated[
    str, typer.Option(help="Split to use: train, val (or validation), test or all.")
]
Device: TypeAlias = Annotated[
    str, typer.Option(help="Device to compute on: auto, cpu, cuda or mps.")
]
Resize: TypeAlias = Annotated[
    bool, typer.Option("--resize", help="Resize images to the size used in training.")
]
Classes: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="YAML file that renames classes of the data, `old_name: new_name`; null leaves a "
        "class out.",
    ),
]


def needs_torch() -> None:
    """Check that PyTorch and the other packages that training needs are installed.

    Raises:
        MachineError: one is not.
    """
    needs("torch", "safetensors", "sklearn")


def needs(*modules: str) -> None:
    """Check that modules of an extra are installed.

    Args:
        modules: names to import.

    Raises:
        MachineError: one is not installed.
    """
    from importlib.util import find_spec

    missing = [module for module in modules if find_spec(module) is None]
    if missing:
        raise MachineError(
            f"this command needs {', '.join(missing)}, which "
            f"{'is' if len(missing) == 1 else 'are'} not installed: {how_to_install(*missing)}"
        )


def split_runs_and_data(paths: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """Split paths into (trained networks, data): a run holds best.safetensors or run.json.

    Raises:
        FolderError: a path is missing or given twice, or there are no runs or no data.
    """
    from radhar_cli.dataset.radar_folders import describe_missing
    from radhar_cli.learning.run_files import is_run

    for path in paths:
        if not path.exists():
            raise FolderError(f"{path}: {describe_missing(path)}")
        if sum(other.resolve() == path.resolve() for other in paths) > 1:
            raise FolderError(f"{path}: is given twice")
    runs = [path for path in paths if is_run(path)]
    data = [path for path in paths if not is_run(path)]
    if not runs:
        raise FolderError(f"{paths[0]}: is not a training run; give one that `radhar train` wrote")
    if not data:
        raise FolderError(f"{paths[-1]}: is a training run; give a data set after it")
    return runs, data


def refuse_output_inside_data(out: Path, data: Sequence[Path]) -> None:
    """Refuse an output that is a file, or a folder that is data or lies inside data."""
    from radhar_cli.dataset.folder import refuse_file

    for path in data:
        if path.is_dir() and out.resolve().is_relative_to(path.resolve()):
            raise FolderError(f"{out}: lies in the data {path}; -o should name a folder of its own")
    refuse_file(out)
