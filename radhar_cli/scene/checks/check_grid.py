"""Times at which the motion of a person is checked."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.accuracy import LOOSEST_DB, first_aim, settings
from radhar_cli.echo.bodies.motion_paths import OfMotion
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.interpolation import BEFORE
from radhar_cli.echo.knots import CHUNK_KNOTS, knots_of, widest_step
from radhar_cli.echo.paths import Paths
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.radar.fmcw import Waveform

GRID_HZ = 50.0
GRID_PER_CYCLE = 40
GRID_CHUNK = 16384


class CheckGrid(NamedTuple):
    """Times of a part of a recording.

    Attributes:
        times: times at which to evaluate a motion, s.
        checked: indices of those that are checked.
        pulses: pulses of those that are checked; the last may come after the last pulse.
    """

    times: Float
    checked: Index | slice
    pulses: Index

    def of_checked(self, values: Float) -> Float:
        """Values [..., times] at the times that are checked, one after the other in memory."""
        if isinstance(self.checked, slice):
            return values[..., self.checked]
        return np.take(values, self.checked, axis=-1)


class RecordsTimes(OfMotion):
    """A source without paths that records the times at which it is evaluated."""

    wall = None
    t: Float

    def __init__(self, motion: Motion) -> None:
        self.motion = motion

    def __call__(self, t: Float) -> Paths:
        """Record times [M] (s); there are no paths."""
        self.t = t
        return Paths(*np.empty((2, 0, t.size)))


def check_grids(motion: Motion, waveform: Waveform, is_shared: bool) -> Iterator[CheckGrid]:
    """Yield grids of times that are dense enough for a motion.

    Args:
        motion: motion that is checked.
        is_shared: whether times are those at which the direct engine evaluates the motion, too,
            whatever the engine, so that the same scenes are drawn.
    """
    step = max(1, int(waveform.prf / max(GRID_HZ, GRID_PER_CYCLE * motion.highest_frequency)))
    usual = settings(first_aim(LOOSEST_DB), waveform, motion.highest_frequency)
    knots = widest_step(waveform, usual.spacing.per_second)
    is_short = waveform.n_pulses <= CHUNK_KNOTS * knots
    if is_shared and GatedEcho.min_step <= knots <= step and is_short:
        source = RecordsTimes(motion)
        count = knots_of(source, waveform, knots, (0, waveform.n_pulses)).shift.size
        each = np.append(np.arange(0, count, step // knots), count)
        yield CheckGrid(source.t, BEFORE + each, knots * each)
        return
    pulses = np.append(np.arange(0, waveform.n_pulses - 1, step), waveform.n_pulses - 1)
    for first in range(0, pulses.size - 1, GRID_CHUNK):
        # Consecutive ones share a pulse, so that no step between two is missed.
        chunk = pulses[first : first + GRID_CHUNK + 1]
        yield CheckGrid(waveform.times(chunk.astype(float)), slice(None), chunk)
