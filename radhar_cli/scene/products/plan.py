"""Which products a request needs: model only what a scene requires.

Every product names what it needs; a plan is the closure of what was asked for, in running order.
Nothing else runs: `run.py` walks the plan and has no other way to make a product.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from radhar_cli.errors import RadharError


@dataclass(frozen=True)
class Product:
    """One row of the table of products.

    Attributes:
        name: ``kind`` or ``kind:variant``.
        needs: names of the products that it is made from.
        make: makes it; called with those products, in that order.
        does: one line for people.
        is_array: whether it is an array, or a map or signal that holds one, so that
            `output.products` can store it. One of a user's own is checked when it is made.
    """

    name: str
    needs: tuple[str, ...]
    make: Callable[..., Any]
    does: str
    is_array: bool = False


@dataclass(frozen=True)
class Plan:
    """The products of one request, each after everything it needs.

    Attributes:
        products: the products, in running order.
        requested: names of those that were asked for, which are not released.
    """

    products: tuple[Product, ...]
    requested: tuple[str, ...]

    def __contains__(self, name: str) -> bool:
        return any(product.name == name for product in self.products)

    @cached_property
    def released_after(self) -> dict[str, tuple[str, ...]]:
        """Products that are read for the last time when a product is made, {product: those}."""
        last = {need: product.name for product in self.products for need in product.needs}
        return {
            product.name: tuple(
                need
                for need in product.needs
                if last[need] == product.name and need not in self.requested
            )
            for product in self.products
        }


def plan(
    table: Mapping[str, Product], requested: Iterable[str], available: Iterable[str] = ()
) -> Plan:
    """Plan a request: the products that it needs, in running order.

    Args:
        table: every product there is, {name: product}.
        requested: names of the products that are asked for.
        available: names of products that exist already.

    Raises:
        RadharError: a product is neither in the table nor available.
    """
    names, existing = tuple(requested), set(available)
    ordered: dict[str, Product] = {}

    def visit(name: str) -> None:
        if name in existing or name in ordered:
            return
        if name not in table:
            users = ", ".join(row.name for row in table.values() if name in row.needs)
            raise RadharError(
                f"product {name!r}: is unknown" + (f"; {users} needs it" if users else "")
            )
        for need in table[name].needs:
            visit(need)
        ordered[name] = table[name]

    for name in names:
        visit(name)
    return Plan(tuple(ordered.values()), names)
