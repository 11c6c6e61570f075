"""Options and checks shared by the learning commands."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from radhar_cli.errors import FolderError, MachineError

Run: TypeAlias = Annotated[Path, typer.Argument(help="Folder of a run, or its .safetensors file.")]
TrainedMap: TypeAlias = Annotated[
    str | None, typer.Option("--map", help="Another map than the one trained on.")
]
AnyMap: TypeAlias = Annotated[
    str | None, typer.Option("--map", help="Which map; default: the first one.")
]
Split: TypeAlias = Annotated[str, typer.Option(help="train, val, test or all.")]
Device: TypeAlias = Annotated[str, typer.Option(help="auto, cpu, cuda or mps.")]
Resize: TypeAlias = Annotated[
    bool, typer.Option("--resize", help="Resize images to the size used in training.")
]
Classes: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="YAML that renames classes, `theirs: ours`; null leaves a class out."
    ),
]


def needs_torch() -> None:
    """Check that PyTorch and what else training needs are installed."""
    needs("train", ("torch", "safetensors", "sklearn", "jinja2"))


def needs(extra: str, modules: Sequence[str]) -> None:
    """Check that the modules of an extra are installed."""
    from importlib.util import find_spec

    for module in modules:
        if find_spec(module) is None:
            raise MachineError(
                f"this command needs {module}, which is not installed: "
                f"pip install 'radhar[{extra}]'"
            )


def runs_and_data(paths: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """Tell trained networks from data: a run holds best.safetensors or run.json."""
    from radhar_cli.learning.run_files import is_run

    for path in paths:
        if not path.exists():
            raise FolderError(f"{path}: no such file or folder")
        if sum(other.resolve() == path.resolve() for other in paths) > 1:
            raise FolderError(f"{path}: is given twice")
    runs = [path for path in paths if is_run(path)]
    data = [path for path in paths if not is_run(path)]
    if not runs:
        raise FolderError(f"{paths[0]}: is not a training run; give one that `radhar train` wrote")
    if not data:
        raise FolderError(f"{paths[-1]}: is a training run; give a data set after it")
    return runs, data


def apart(out: Path, data: Sequence[Path]) -> None:
    """Refuse an output folder that lies in the data, or that is data."""
    from radhar_cli.dataset.folder import refuse_file

    for path in data:
        if path.is_dir() and out.resolve().is_relative_to(path.resolve()):
            raise FolderError(f"{out}: lies in the data {path}; -o should name a folder of its own")
    refuse_file(out)
