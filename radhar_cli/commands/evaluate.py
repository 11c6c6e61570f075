"""`radhar eval`: how good trained networks are, in numbers and figures."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.learning_options import Classes, Resize
from radhar_cli.commands.options import Overrides, resumable
from radhar_cli.commands.tell import report, tell
from radhar_cli.errors import RadharError

if TYPE_CHECKING:
    from radhar_cli.learning.shots import ShotCurve, ShotOptions
    from radhar_cli.learning.single_result import EvalOptions


def evaluate(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN... DATA...",
            help="Folders that train wrote, and the data to evaluate them on; one or more of each.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="Folder of the report; RUN/eval if none, or RUN/shots."),
    ] = None,
    split: Annotated[
        str | None, typer.Option(help="train, val, test or all; val, with --shots all.")
    ] = None,
    map_: Annotated[
        str | None, typer.Option("--map", help="Another map than the one it was trained on.")
    ] = None,
    tsne: Annotated[
        bool, typer.Option("--tsne", help="Draw t-SNE of the maps and of the last features.")
    ] = False,
    filters: Annotated[
        bool, typer.Option("--filters", help="Draw the weights of the global filters.")
    ] = False,
    in_place_vs_moving: Annotated[
        bool,
        typer.Option("--in-place-vs-moving", help="Also the two groups S1 to S7 and S8 to S12."),
    ] = False,
    batch: Annotated[int, typer.Option(min=1, help="Images at once.")] = 32,
    resize: Resize = False,
    classes: Classes = None,
    shots: Annotated[
        str | None,
        typer.Option(
            metavar="K,K,...",
            help="Accuracy after learning from so many labelled images of each class: fine-tuned "
            "from RUN, and from scratch. 0: RUN as it is.",
        ),
    ] = None,
    repeats: Annotated[
        int | None,
        typer.Option(min=1, max=1000, help="Of --shots: draws of the labelled images; 5 if none."),
    ] = None,
    mix: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DATA",
            help="Of --shots: data that RUN learned from, shown on while it is fine-tuned, as "
            "often as labelled images; may repeat.",
        ),
    ] = None,
    set_: Overrides = None,
    tune: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUE",
            help="Of --shots: change a setting of fine-tuning alone (--set: of both; RUN's own "
            "hold, to fine-tune half of its epochs and warm-up).",
        ),
    ] = None,
    adapt: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=1000,
            metavar="EPOCHS",
            help="Of --shots: also adapt the run to all maps of DATA without their labels, as "
            "radhar adapt --epochs does, with the labelled ones and those of --mix shown beside.",
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Of --shots: start again, with other settings.")
    ] = False,
    device: Annotated[str, typer.Option(help="auto, cpu, cuda or mps.")] = "auto",
) -> None:
    """Evaluate trained networks on data sets.

    Example:

      radhar eval runs/quickstart datasets/quickstart --tsne --filters

      radhar eval runs/simulated datasets/measured --shots 0,1,5,20 --mix datasets/simulated

    Several runs or data sets give the comparison: train at one SNR, test at all.
    """
    from radhar_cli.commands.learning_options import (
        apart,
        known_device,
        needs_torch,
        runs_and_data,
    )

    needs_torch()
    from radhar_cli.dataset.files import refuse_links
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.learning.images.image_set import split_named
    from radhar_cli.learning.shots import ShotOptions
    from radhar_cli.learning.single_result import EvalOptions

    of_shots = {
        "--repeats": repeats,
        "--mix": mix,
        "--set": set_,
        "--tune": tune,
        "--adapt": adapt,
        "--overwrite": overwrite or None,
    }
    figures = {
        "--tsne": tsne,
        "--filters": filters,
        "--in-place-vs-moving": in_place_vs_moving,
    }
    for name, given in of_shots.items() if shots is None else ():
        if given is not None:
            raise RadharError(f"{name}: belongs to --shots, which is missing")
    for name, drawn in figures.items() if shots is not None else ():
        if drawn:
            raise RadharError(f"{name}: is not drawn with --shots; leave one of them out")
    runs, data = runs_and_data(paths)
    options = EvalOptions(
        split_named(split or ("all" if shots else "val")),
        map_,
        tsne,
        filters,
        in_place_vs_moving,
        batch,
        resize,
        read_classes(classes) if classes else {},
    )
    inside = runs[0] if runs[0].is_dir() else runs[0].parent
    folder = out or inside / ("eval" if shots is None else "shots")
    if out is None:
        refuse_links(inside, folder)
    apart(folder, [*data, *(mix or [])])
    known_device(device)
    if shots is None:
        _report(runs, data, folder, options, device)
        return
    if len(runs) > 1 or len(data) > 1:
        raise RadharError(
            f"--shots: has {len(runs)} runs and {len(data)} data sets; should have one of each"
        )
    wanted = ShotOptions(
        _numbers(shots),
        5 if repeats is None else repeats,
        tuple(mix or ()),
        tuple(set_ or ()),
        tuple(tune or ()),
        adapt or 0,
        overwrite,
    )
    _few_shots(runs[0], data[0], folder, wanted, options, device)


def _report(
    runs: list[Path], data: list[Path], folder: Path, options: "EvalOptions", device: str
) -> None:
    """Test every run on every data set, and write the report."""
    from radhar_cli.commands.learning_options import StderrLog
    from radhar_cli.learning.machine import choose_device
    from radhar_cli.learning.report import evaluate

    evaluation = evaluate(runs, data, options, choose_device(device), StderrLog())
    evaluation.write(folder)
    accuracies = {
        run: {data: numbers["accuracy"] for data, numbers in about["data"].items()}
        for run, about in evaluation.numbers["runs"].items()
    }
    report(page=folder / "report.html", numbers=folder / "report.json", accuracy=accuracies)
    tell(f"{folder / 'report.html'}: {len(evaluation.figures)} figures; numbers in report.json")


def _few_shots(
    run: Path,
    data: Path,
    folder: Path,
    wanted: "ShotOptions",
    options: "EvalOptions",
    device: str,
) -> None:
    """Learn from a few labelled images, write the curve and print it."""
    from radhar_cli.commands.learning_options import StderrLog
    from radhar_cli.learning.machine import choose_device
    from radhar_cli.learning.shots import few_shots

    with resumable(f"what is finished in {folder}"):
        curve = few_shots(run, data, folder, wanted, options, choose_device(device), StderrLog())
    curve.write(folder)
    _print_curve(curve, folder)


def _numbers(text: str) -> tuple[int, ...]:
    """The numbers of --shots, ascending.

    Raises:
        RadharError: they are none.
    """
    parts = [part.strip() for part in text.split(",")]
    if not all(part.isdecimal() and len(part) < 7 for part in parts):
        raise RadharError(
            f"--shots {text}: should be whole numbers with commas between them, such as 0,1,5,20"
        )
    return tuple(sorted({int(part) for part in parts}))


def _print_curve(curve: "ShotCurve", folder: Path) -> None:
    """Print the table, and where it lies."""
    from radhar_cli.learning.shots import FIGURE, NUMBERS, TABLE, WAYS

    ways = [how for how in WAYS if curve.of(how)]
    report(
        numbers=folder / NUMBERS,
        table=folder / TABLE,
        figure=folder / FIGURE,
        accuracy={how: {p.shots: [p.accuracy, *p.interval] for p in curve.of(how)} for how in ways},
        left_out=curve.left_out,
    )
    tell("  ".join([f"{'labelled a class':>16}", *(f"{how:24}" for how in ways)]).rstrip())
    for k in dict.fromkeys(point.shots for point in curve.points):
        cells = {
            p.how: "{:5.1f} % ({:.1f} to {:.1f})".format(
                *(100 * share for share in (p.accuracy, *p.interval))
            )
            for p in curve.points
            if p.shots == k
        }
        tell("  ".join([f"{k:16d}", *(f"{cells.get(how, ''):24}" for how in ways)]).rstrip())
    for line in curve.shortfalls():
        tell(line)
    tell(f"{folder / FIGURE}; numbers in {NUMBERS} and {TABLE}")
