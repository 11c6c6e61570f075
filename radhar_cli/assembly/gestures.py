"""Movements of the arms of a person in a scene of `motion.model: human`: `motion.gestures`."""

from dataclasses import replace
from math import pi, radians

import numpy as np

from radhar_cli.config.motion import GesturesConfig
from radhar_cli.motion.human.gesturing import AT_TABLE, Clap, Drink, Wave, Write
from radhar_cli.motion.human.idle import Waves
from radhar_cli.motion.human.repertoire import Gestures
from radhar_cli.motion.human.sitting import Seat
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene import Person

# Rates of strokes up and across over the usual one, of no common measure; letters are no sines.
STROKES_UP, STROKES_ACROSS = (0.53, 1.0, 1.27), (0.41, 0.79, 1.11)
# Duration of a drink from a cup in the hand over that from one on a table: without reaching for the
# cup and returning, medians of de los Reyes-Guzman et al. (2010).
CUP_IN_HAND = 0.65
ON_BOARD = 0.7  # rate of strokes at a board, where letters are larger, over that on paper


def draw_gestures(person: Person, seat: Seat, paces: Float, sizes: Float, place: int) -> Gestures:
    """Draw how a person drinks, writes, waves and claps.

    Args:
        person: Person of the scene.
        seat: Seat of who sits.
        paces: Duration of each repetition over the usual one.
        sizes: Size of each over the usual one.
        place: Place of the movement in its sequence, which names its random streams.
    """
    config = person.motion.gestures
    left, each = config.left_handed >= 0.5, (tuple(paces.tolist()), tuple(sizes.tolist()))
    drink = Drink(
        period=CUP_IN_HAND * config.drink_s,
        left=left,
        held=config.cup_held >= 0.5,
        paces=each[0],
        sizes=each[1],
    )
    rng = person.stream(f"motion.gestures.strokes/{place}")
    phases = (2 * pi * rng.random((2, len(STROKES_UP)))).tolist()
    write, at_table = (
        replace(
            usual,
            left=left,
            stroke=config.size * usual.stroke,
            word=config.size * usual.word,
            up=_strokes(rate, STROKES_UP, phases[0]),
            across=_strokes(rate, STROKES_ACROSS, phases[1]),
            paces=each[0],
            sizes=each[1],
        )
        for usual, rate in ((Write(), ON_BOARD * config.strokes_hz), (AT_TABLE, config.strokes_hz))
    )
    return Gestures(
        drink,
        replace(drink, seat=seat, period=config.drink_s),
        write,
        replace(at_table, seat=seat),
        _wave(config, left, *each),
        Clap(
            period=1 / config.clapping_hz,
            left=left,
            opening=config.size * Clap.opening,
            paces=each[0],
            sizes=each[1],
        ),
    )


def _wave(
    config: GesturesConfig[float], left: bool, paces: tuple[float, ...], sizes: tuple[float, ...]
) -> Wave:
    """How a person waves."""
    return Wave(
        period=1 / config.waving_hz,
        left=left,
        both=config.both_hands >= 0.5,
        flexion=radians(config.raise_deg),
        swing=config.size * Wave.swing,
        bend=config.size * Wave.bend,
        paces=paces,
        sizes=sizes,
    )


def _strokes(rate: float, rates: tuple[float, ...], phases: list[float]) -> Waves:
    """Strokes of standard deviation 1, about `rate` a second, with phases in rad."""
    amplitude = (2 / len(rates)) ** 0.5
    return Waves((amplitude,) * len(rates), tuple((rate * np.array(rates)).tolist()), tuple(phases))
