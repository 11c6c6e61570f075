"""Linking movements, which lead from one state of rest to another: standing up after sitting down.

Any movement of MOVEMENTS that ends in another state than it begins in is a link, but for falls,
which nobody makes on purpose; of several ways the shortest is taken, of equal ones that of the
movements that MOVEMENTS lists first.
"""

from functools import cache

from radhar_cli.activities.activity import MOVEMENTS


def is_link(name: str) -> bool:
    """Whether a movement may be put in to lead from one state to another."""
    movement = MOVEMENTS[name]
    changes = movement.before != movement.after and movement.seconds is not None
    return changes and not name.startswith("falling")


@cache
def links_between(before: str, after: str) -> tuple[str, ...] | None:
    """Movements that lead from a state of rest to another; none for the same, None for no way."""
    ways: dict[str, tuple[str, ...]] = {before: ()}
    states = [before]
    for state in states:  # which grows: the nearest states first
        if state == after:
            return ways[state]
        for name, movement in MOVEMENTS.items():
            if movement.before == state and movement.after not in ways and is_link(name):
                ways[movement.after] = (*ways[state], name)
                states.append(movement.after)
    return None
