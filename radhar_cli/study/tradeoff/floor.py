"""How small an error of the signal is that images still show, found by adding errors to it."""

from collections.abc import Iterator

import numpy as np

from radhar_cli.config.radar import CwRadar, ImpulseRadar
from radhar_cli.numerics.arrays import Complex
from radhar_cli.study.tradeoff.differences import compare_pictures, compare_points
from radhar_cli.study.tradeoff.pictures import Raw, Shown, draw_shown, shown_names

LOWEST_DB, HIGHEST_DB = -140, 0
VISIBLE = 0.01  # share of the pixels that differ by more than a level, or of points that move
SEED = 48


def visible_errors(raw: Raw) -> Iterator[tuple[str, int]]:
    """Yield the error of the signal, dB, from which on more than VISIBLE of a map changes.

    White errors of known size are added to the raw products of a sample with its noise; a bisection
    finds the least whole number of dB that shows. Of points it is the share that moves.

    Yields:
        Map and dB; HIGHEST_DB + 1 where none shows.
    """
    error = _unit_error(raw)
    for name in shown_names(raw.scene.config):
        base = draw_shown(raw, raw.noise, only=name)
        low, high = LOWEST_DB, HIGHEST_DB + 1
        while high - low > 1:
            middle = (low + high) // 2
            values = {key: x + 10 ** (middle / 20) * error[key] for key, x in raw.values.items()}
            visible = draw_shown(raw, raw.noise, values, name)
            if _changed_share(visible, base, name) > VISIBLE:
                high = middle
            else:
                low = middle
        yield name, high


def _changed_share(visible: Shown, base: Shown, name: str) -> float:
    """Share of a map's pixels that differ by more than a level, or of the points that moved."""
    if visible.cloud is not None and base.cloud is not None:
        return compare_points(visible.cloud, base.cloud).moved
    return compare_pictures(visible.pictures[name], base.pictures[name]).over_one


def _unit_error(raw: Raw) -> dict[str, Complex]:
    """White error of the same L2 norm as each raw product; real where samples are."""
    rng, radar = np.random.default_rng(SEED), raw.scene.config.radar
    is_real = isinstance(radar, ImpulseRadar | CwRadar) and radar.output in ("rf", "real")
    errors = dict[str, Complex]()
    for name, x in raw.values.items():
        imaginary = np.zeros(x.shape) if is_real else rng.standard_normal(x.shape)
        error: Complex = rng.standard_normal(x.shape) + 1j * imaginary
        norm = float(np.linalg.norm(error))
        errors[name] = error * (float(np.linalg.norm(x)) / norm)
    return errors
