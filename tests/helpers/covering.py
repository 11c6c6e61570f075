"""Covering arrays: rows of choices in which any few factors take all their combinations."""

from collections.abc import Iterator, Sequence
from itertools import combinations, product

Row = tuple[int, ...]


def covering_rows(sizes: Sequence[int], strength: int = 2) -> list[Row]:
    """Rows of one level a factor, such that any `strength` factors take all combinations.

    Greedy (Cohen et al., The AETG System, 1997) without its random draws: each row begins with the
    first combination that is missing and takes, factor by factor, the level that adds most.

    Args:
        sizes: numbers of levels of the factors.
    """
    missing = {
        (factors, levels)
        for factors in combinations(range(len(sizes)), strength)
        for levels in product(*(range(sizes[factor]) for factor in factors))
    }
    rows = list[Row]()
    while missing:
        row = dict(zip(*min(missing), strict=True))
        for factor in range(len(sizes)):
            if factor in row:
                continue
            gains = [
                sum(one in missing for one in _with(row, factor, level, strength))
                for level in range(sizes[factor])
            ]
            # Of equal gains the level that is used least: rows should not all be the defaults.
            used = [sum(done[factor] == level for done in rows) for level in range(sizes[factor])]
            row[factor] = max(range(sizes[factor]), key=lambda n: (gains[n], -used[n], -n))
        whole = tuple(row[factor] for factor in range(len(sizes)))
        missing -= set(combinations_of(whole, strength))
        rows.append(whole)
    return rows


def combinations_of(row: Row, strength: int) -> Iterator[tuple[Row, Row]]:
    """(factors, levels) of all combinations that a row has."""
    for factors in combinations(range(len(row)), strength):
        yield factors, tuple(row[factor] for factor in factors)


def _with(row: dict[int, int], factor: int, level: int, strength: int) -> Iterator[tuple[Row, Row]]:
    """(factors, levels) of the combinations of a partial row that take a factor at a level."""
    more = {**row, factor: level}
    for others in combinations(sorted(row), strength - 1):
        factors = tuple(sorted((*others, factor)))
        yield factors, tuple(more[one] for one in factors)
