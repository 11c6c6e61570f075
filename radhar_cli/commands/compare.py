"""`radhar compare`: how far two data sets of maps are apart, class by class."""

from collections import defaultdict
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from radhar_cli.commands.learning_options import AnyMap, Classes
from radhar_cli.commands.tell import report, tell

if TYPE_CHECKING:
    from radhar_cli.two_sample.comparison import ClassCompared, Comparison

SHOWN = 6  # statistics of a class on the terminal


def compare(
    simulated: Annotated[
        Path, typer.Argument(help="Data set: a folder of `generate`, or a tree of class folders.")
    ],
    measured: Annotated[Path, typer.Argument(help="Another, of measured maps.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the report.")],
    map_: AnyMap = None,
    classes: Classes = None,
    resize: Annotated[
        bool, typer.Option("--resize", help="Bring images to the size of the measured ones.")
    ] = False,
    per_class: Annotated[
        int,
        typer.Option(
            min=2, max=5000, help="Maximum maps per class and data set (a random subset)."
        ),
    ] = 200,
    zero: Annotated[
        float | None,
        typer.Option(
            min=0,
            help="Half-width of the zero-Doppler line, Hz (default: 5 % of the largest Doppler).",
        ),
    ] = None,
    pictures: Annotated[int, typer.Option(min=1, max=20, help="Maps in a row of a figure.")] = 6,
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
    from radhar_cli.two_sample.comparison import Options
    from radhar_cli.two_sample.comparison import compare as compared
    from radhar_cli.two_sample.report import write

    apart(out, [simulated, measured])
    names = read_classes(classes) if classes else {}
    options = Options(map_, names, resize, per_class, seed, zero, pictures)
    with BarProgress("map") as progress:
        comparison = compared(simulated, measured, options, progress)
    for warning in comparison.warnings:
        tell(f"warning: {warning}", err=True)
    files = write(comparison, out)
    numbers = comparison.numbers()
    report(
        files=files,
        test=numbers["test"],
        coverage=numbers["coverage"],
        classes=numbers["classes"],
        warnings=numbers["warnings"],
    )
    for one in comparison.classes:
        _tell_class(comparison, one, numbers["classes"][one.name])
    if numbers["test"]:
        tell(f"\nall classes: {_test(numbers['test'])}; {100 * numbers['coverage']:.0f} % covered")
    tell(f"{files[0]}: {len(files) - 2} figures beside it")


def _test(test: dict[str, Any]) -> str:
    low, high = test["accuracy_95"]
    return (
        f"{100 * test['accuracy']:.1f} % told apart ({100 * low:.1f} to {100 * high:.1f} %, "
        f"n = {test['images']})"
    )


def _tell_class(comparison: "Comparison", one: "ClassCompared", numbers: dict[str, Any]) -> None:
    from radhar_cli.two_sample.map_statistics import STATISTICS

    test = numbers["test"]
    outcome = _test(test) if isinstance(test, dict) else "not tested"
    tell(f"\n{one.name}: {outcome}; {100 * float((one.uncovered <= 1).mean()):.0f} % covered")
    tell(
        f"  {'mean (standard deviation)':<38} {'simulated':>18} {'measured':>18} {'distance':>9}"
        f" {'KS':>5} {'p':>7}"
    )
    compared = {name: d for name, d in one.differences.items() if isfinite(d.distance)}
    for name, difference in list(compared.items())[:SHOWN]:
        unit = comparison.scale.unit(name)
        words = STATISTICS[name].words + (f", {unit}" if unit else "")
        cells = [
            f"{side.mean:.4g} ({side.sd:.2g})"
            for side in (difference.simulated, difference.measured)
        ]
        tell(
            f"  {words:<38} {cells[0]:>18} {cells[1]:>18} {difference.distance:>9.2f}"
            f" {difference.ks:>5.2f} {difference.p:>7.1g}"
        )
    counts = len(one.simulated.rows), len(one.measured.rows)
    hidden = defaultdict[tuple[int, int], list[str]](list)
    for name, difference in one.differences.items():
        known = difference.simulated.known, difference.measured.known
        if known != counts:
            hidden[known].append(STATISTICS[name].words)
    for known, names in hidden.items():
        missing = [f"{n - k} of {n}" for n, k in zip(counts, known, strict=True)]
        tell(
            f"  left out in {missing[0]} simulated and {missing[1]} measured maps, as nothing "
            f"moves or noise hides it: {'; '.join(names)}"
        )
