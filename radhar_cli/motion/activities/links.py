"""Linking movements, which lead from one state of rest to another: standing up after sitting down.

Any movement of MOVEMENTS that ends in another state than it begins in is a link, but for falls,
which nobody makes on purpose; of several ways the shortest is taken, of equal ones that of the
movements that MOVEMENTS lists first.
"""

from functools import cache

from radhar_cli.motion.activities.activity import OR, state_after
from radhar_cli.motion.movements.catalogue import MOVEMENTS


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
            end = movement.states.get(state)
            if end is not None and end not in ways and is_link(name):
                ways[end] = (*ways[state], name)
                states.append(end)
    return None


def links_to(state: str, name: str) -> tuple[str, ...] | None:
    """Movements that lead from a state of rest to one in which a movement may begin.

    Args:
        state: the state, or several joined by `OR` of which one will do.
        name: the movement.
    """
    if state_after(name, state) is not None:
        return ()
    ends = [(one, begin) for one in state.split(OR) for begin in MOVEMENTS[name].states]
    ways = [way for way in (links_between(*both) for both in ends) if way is not None]
    return min(ways, key=len) if ways else None
