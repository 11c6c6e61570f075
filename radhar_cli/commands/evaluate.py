"""`radhar eval`: how good trained networks are, in numbers and figures."""

from pathlib import Path
from typing import Annotated, Any

import typer

from radhar_cli.commands.learning_options import Classes, Device, Resize, Split, TrainedMap
from radhar_cli.commands.options import ReplaceResults
from radhar_cli.commands.tell import report, tell
from radhar_cli.errors import FolderError
from radhar_cli.untrusted import read_json

SCORES = ("accuracy", "mean_average_precision", "mpjpe_cm")


def evaluate(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN... DATA...",
            help="Training runs, and the data to evaluate them on; one or more of each.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder of the report; default: RUN/eval.")
    ] = None,
    split: Split = "val",
    map_: TrainedMap = None,
    tsne: Annotated[
        bool, typer.Option("--tsne", help="Draw t-SNE plots of the maps and of the last features.")
    ] = False,
    filters: Annotated[
        bool,
        typer.Option("--filters", help="Draw the weights of the global filters (fftnet)."),
    ] = False,
    in_place_vs_moving: Annotated[
        bool,
        typer.Option("--in-place-vs-moving", help="Also report the groups S1 to S7 and S8 to S12."),
    ] = False,
    batch: Annotated[int, typer.Option(min=1, help="Batch size.")] = 32,
    resize: Resize = False,
    classes: Classes = None,
    device: Device = "auto",
    overwrite: ReplaceResults = False,
) -> None:
    """Evaluate trained networks on data sets.

    Example:

      radhar eval runs/quickstart datasets/quickstart --tsne

    Several runs or data sets give a comparison, such as training at one SNR and testing at all.
    """
    from radhar_cli.commands.learning_options import apart, needs_torch, runs_and_data

    needs_torch()
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.dataset.files import refuse_links
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.learning.images.image_set import check_split_name
    from radhar_cli.learning.machine import choose_device
    from radhar_cli.learning.report import evaluate as test
    from radhar_cli.learning.single_result import EvalOptions

    runs, data = runs_and_data(paths)
    names = read_classes(classes)
    options = EvalOptions(
        check_split_name(split), map_, tsne, in_place_vs_moving, batch, resize, names, filters
    )
    inside = runs[0] if runs[0].is_dir() else runs[0].parent
    folder = out or inside / "eval"
    if out is None:
        refuse_links(inside, folder)
    apart(folder, data)
    of_what = {"of": [str(path.resolve()) for path in (*runs, *data)]}
    _refuse_another_report(folder, of_what | {"split": options.split}, overwrite)
    with BarProgress("image") as bars:
        evaluation = test(runs, data, options, choose_device(device), bars)
    evaluation.numbers |= of_what
    evaluation.write(folder)
    found: dict[str, dict[str, dict[str, float]]] = {}
    for run, about in evaluation.numbers["runs"].items():
        for tested, numbers in about["data"].items():
            score = next(one for one in SCORES if one in numbers)
            found.setdefault(score, {}).setdefault(run, {})[tested] = numbers[score]
    report(page=folder / "report.html", numbers=folder / "report.json", **found)
    tell(f"{folder / 'report.html'}: {len(evaluation.figures)} figures; numbers in report.json")


def _refuse_another_report(folder: Path, about: dict[str, Any], replace: bool) -> None:
    """Refuse a folder that holds the report of other runs, data or another split."""
    path = folder / "report.json"
    if replace or not path.exists():
        return
    try:
        there = read_json(path)
    except FolderError:
        there = None
    if not isinstance(there, dict) or any(there.get(key) != about[key] for key in about):
        raise FolderError(
            f"{folder}: holds another report; --overwrite replaces it, -o names another folder"
        )
