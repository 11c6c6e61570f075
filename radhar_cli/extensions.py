"""Extensions of a user: products of their own, in the plan of every scene and data set.

    from radhar_cli.extensions import add_product

A product of a new name is a further map, if it makes a `PowerMap` and `maps:` names it, or an array
of any shape that `output.products` stores. One with the name of a row of the table takes its place:
`antennas`, `receiver` (a tuple of impairments), `canceller`, `motions` and so on. The commands
import the modules that RADHAR_EXTENSIONS names (`my_radar,my_maps`) before they read a config.
"""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib import import_module
from typing import Any

from radhar_cli.errors import RadharError

VARIABLE = "RADHAR_EXTENSIONS"
_PRODUCTS: dict[str, Any] = {}
_ANY: ContextVar[bool] = ContextVar("any", default=False)


def add_product(product: Any) -> None:
    """Add a row (`products.plan.Product`) to the table of products, or replace one.

    Raises:
        ValueError: its name is no identifier.
    """
    if not product.name.isidentifier():
        raise ValueError(f"{product.name!r} should be a name of letters, digits and _")
    _PRODUCTS[product.name] = product


def own_products() -> tuple[Any, ...]:
    """Products that were added, here or in a module of RADHAR_EXTENSIONS."""
    load_extensions()
    return tuple(_PRODUCTS.values())


def know_products(products: Iterable[Any]) -> None:
    """Replace the products that were added here by those of another process."""
    by_name = {product.name: product for product in products}
    _PRODUCTS.clear()
    _PRODUCTS.update(by_name)


@contextmanager
def any_name() -> Iterator[None]:
    """Accept maps of any name within the block, as of a data set made with other extensions."""
    token = _ANY.set(True)
    try:
        yield
    finally:
        _ANY.reset(token)


def is_known(name: str) -> bool:
    """Whether a product of that name was added, or any name is accepted."""
    return _ANY.get() or any(product.name == name for product in own_products())


def extensions() -> tuple[str, ...]:
    """Names of the modules in the environment variable RADHAR_EXTENSIONS."""
    names = (name.strip() for name in os.environ.get(VARIABLE, "").split(","))
    return tuple(filter(None, names))


@cache
def load_extensions() -> None:
    """Import the modules that RADHAR_EXTENSIONS names, once, which add products and activities.

    Readers of their tables call it first, so that no config is read without them.

    Raises:
        RadharError: one cannot be imported.
    """
    for name in extensions():
        try:
            import_module(name)
        except Exception as error:
            why = f"{type(error).__name__}: {error}"
            raise RadharError(f"{VARIABLE}: {name} cannot be imported ({why})") from None
