"""Options that several commands share."""

from typing import Annotated, TypeAlias

import typer

Overrides: TypeAlias = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change one dotted key; may repeat."),
]
Tolerance: TypeAlias = Annotated[
    float | None,
    typer.Option(metavar="DB", help="Error budget of the direct engine, instead of the config's."),
]


def with_tolerance(overrides: list[str] | None, tolerance: float | None) -> list[str]:
    """The overrides, and --tolerance as one of them."""
    named = [] if tolerance is None else [f"engine.tolerance_db={tolerance!r}"]
    return [*(overrides or []), *named]
