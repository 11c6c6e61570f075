"""`radhar compare`: how far two data sets of maps are apart, class by class."""

from math import isfinite
from pathlib import Path
from typing import Annotated, Any

import typer

from radhar_cli.commands.learning_options import AnyMap, Classes
from radhar_cli.commands.tell import report, tell

SHOWN = 6  # statistics of a class on the terminal


def compare(
    simulated: Annotated[
        Path, typer.Argument(help="Data set: a folder of `generate`, or a tree of class folders.")
    ],
    measured: Annotated[Path, typer.Argument(help="Another, of measured maps.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the report.")],
    map_: AnyMap = None,
    classes: Classes = None,
    per_class: Annotated[
        int,
        typer.Option(
            min=2, max=5000, help="Maximum maps per class and data set (a random subset)."
        ),
    ] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Of what is drawn.")] = 1,
) -> None:
    """Say how far simulated maps are from measured ones.

    Statistics, their distances, and a two-sample test.

    Example:

      radhar compare datasets/like_measured datasets/measured -o out/compared

    50 % told apart: nobody can tell simulated from measured.
    """
    from radhar_cli.commands.learning_options import apart, needs

    needs("train", ("sklearn",))
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.two_sample.comparison import compare as compared
    from radhar_cli.two_sample.report import write

    apart(out, [simulated, measured])
    names = read_classes(classes) if classes else {}
    with BarProgress("map") as progress:
        comparison = compared(simulated, measured, progress, map_, names, per_class, seed)
    for warning in comparison.warnings:
        tell(f"warning: {warning}", err=True)
    files = write(comparison, out)
    numbers = comparison.numbers()
    report(files=files, **{key: numbers[key] for key in ("test", "classes", "warnings")})
    for name, one in numbers["classes"].items():
        _tell_class(name, one)
    tell(f"\nall classes: {_test(numbers['test'])}")
    for path in files:
        tell(f"  {path}")


def _test(test: dict[str, Any] | None) -> str:
    if test is None:
        return "not tested"
    low, high = test["accuracy_95"]
    return (
        f"{100 * test['accuracy']:.1f} % told apart ({100 * low:.1f} to {100 * high:.1f} %, "
        f"n = {test['images']})"
    )


def _tell_class(name: str, numbers: dict[str, Any]) -> None:
    tell(f"\n{name}: {_test(numbers['test'])}")
    columns = f"{'simulated':>24} {'measured':>24} {'distance':>9} {'p':>7}"
    tell(f"  {'mean (standard deviation)':<38} {columns}")
    known = [one for one in numbers["statistics"].values() if isfinite(one["distance"])]
    for one in known[:SHOWN]:
        words = one["words"] + (f", {one['unit']}" if one["unit"] else "")
        cells = []
        for of in (one["simulated"], one["measured"]):
            fewer = f" n={of['known']}" if of["known"] < numbers["maps"] else ""  # noise hides it
            cells.append(f"{of['mean']:.4g} ({of['sd']:.2g}){fewer}".rjust(24))
        tell(f"  {words:<38} {' '.join(cells)} {one['distance']:>9.2f} {one['p']:>7.1g}")
