"""`radhar compare`: how far two data sets of maps or clouds are apart, class by class."""

from pathlib import Path
from typing import Annotated, Any

import typer

from radhar_cli.commands.learning_options import AnyMap, Classes
from radhar_cli.commands.options import ReplaceResults, refuse_to_replace_results
from radhar_cli.commands.tell import report, tell

SHOWN = 3  # statistics of a class that are printed, the largest differences


def compare(
    simulated: Annotated[
        Path,
        typer.Argument(
            help="Simulated data set: a folder that `generate` wrote, or class folders."
        ),
    ],
    measured: Annotated[Path, typer.Argument(help="Measured data set, in either form.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to write the report to.")],
    map_: AnyMap = None,
    classes: Classes = None,
    per_class: Annotated[
        int,
        typer.Option(
            min=2, max=5000, help="Largest number of maps per class and data set, a random subset."
        ),
    ] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random subset.")] = 1,
    overwrite: ReplaceResults = False,
) -> None:
    """Measure how much simulated maps or clouds differ from measured.

    Prints statistics, their distances, and the result of a two-sample test.

    Example:

      radhar compare datasets/like_measured datasets/measured -o out/compared

      radhar compare datasets/boards datasets/mars -o out/clouds --map points

    The test trains a classifier: 50 % means that it cannot tell simulated from measured maps.
    """
    from radhar_cli.commands.learning_options import needs, refuse_output_inside_data

    needs("sklearn")
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.figures.report.report import NUMBERS
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.study.two_sample.comparison import compare as compare_maps
    from radhar_cli.study.two_sample.report import write

    refuse_output_inside_data(out, [simulated, measured])
    refuse_to_replace_results(out, (NUMBERS,), overwrite)
    names = read_classes(classes)
    with BarProgress("map") as progress:
        comparison = compare_maps(simulated, measured, progress, map_, names, per_class, seed)
    for warning in comparison.warnings:
        tell(f"warning: {warning}", err=True)
    files = write(comparison, out)
    numbers = comparison.numbers()
    for name, of_class in numbers["classes"].items():
        tell(f"{name}: {_accuracy_text(of_class['test'])}")
        for statistic in [*of_class["statistics"].values()][:SHOWN]:
            tell(f"  {_difference_text(statistic)}")
    tell(f"all classes: {_accuracy_text(numbers['test'])}")
    report(files=files, **{key: numbers[key] for key in ("test", "classes", "warnings")})


def _difference_text(statistic: dict[str, Any]) -> str:
    """Means of a statistic on either side, and the distance of the two, as text."""
    simulated, measured = statistic["simulated"]["mean"], statistic["measured"]["mean"]
    return (
        f"{statistic['words']}: {simulated:.3g} simulated, {measured:.3g} measured "
        f"{statistic['unit']}".rstrip()
        + f"; distance {statistic['distance']:.2f}"
    )


def _accuracy_text(test: dict[str, Any] | None) -> str:
    """Accuracy of a two-sample test with its 95 % interval, as text."""
    if test is None:
        return "not tested"
    low, high = test["accuracy_95"]
    return (
        f"{100 * test['accuracy']:.1f} % told apart ({100 * low:.1f} to {100 * high:.1f} %, "
        f"n = {test['images']})"
    )
