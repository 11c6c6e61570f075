"""Options that several commands share."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, TypeAlias

import typer

Overrides: TypeAlias = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change one dotted key; may repeat."),
]
Tolerance: TypeAlias = Annotated[
    float | None,
    typer.Option(metavar="DB", help="Tolerance of the direct engine, instead of the config's."),
]


@contextmanager
def resumable(kept: str) -> Iterator[None]:
    """Turn Ctrl-C into a line that says what is kept, and status 130."""
    try:
        yield
    except KeyboardInterrupt:
        typer.echo(f"\ninterrupted: {kept} is kept; the same command goes on", err=True)
        raise typer.Exit(130) from None


def with_tolerance(overrides: list[str] | None, tolerance: float | None) -> list[str]:
    """The overrides, and --tolerance as one of them."""
    named = [] if tolerance is None else [f"engine.tolerance_db={tolerance!r}"]
    return [*(overrides or []), *named]
