"""Raw samples of every virtual channel of a board: the fast sum, and the exact reference.

    s[f, l, v, n] = sum_i A_i exp(-j 2 pi (fc tau_i + K tau_i n/fs))

with tau_i and A_i of the channel's own transmitter and receiver (spherical waves), frozen when its
chirp begins.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, inf, pi
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.echo import compiled
from radhar_cli.echo.accuracy import GOLDEN, SPARE_DB, AccuracyError, Probes, target_error_db
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.chebyshev import coefficients
from radhar_cli.echo.dispersion import beat_of
from radhar_cli.echo.gridded_sum import POWERS, Chirps, gridded_sum, powers_from_nodes
from radhar_cli.echo.interpolation import lagrange_basis
from radhar_cli.echo.paths import Paths, PathSource, Through
from radhar_cli.echo.phase_recurrence import nodes
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.radar.board import Board

BLOCK_FRAMES = 16
SINGLE_DB = -100.0  # tolerances below need double precision
PROBES = 96
NODES, MORE_NODES = 6, 16
MARGIN_DB = 20.0
MAX_TERMS = 24
# Polynomials of turns of up to x radians number x + c (x + 15)^(1/3), as the coefficients J_p(x)
# fall off beyond p = x; c in double and in single precision.
CUBE_ROOTS = 12.5, 5.0
# Least turn, rad; and by how many times the largest change within a frame the polynomials reach
# beyond the turns, as derivatives grow towards the ends.
LEAST_TURN, MARGIN = 1e-9, 5


@dataclass(frozen=True)
class SumOfTwo:
    """Paths of a chirp in which two transmitters send.

    Attributes:
        lower: Paths of the first.
        higher: Paths of the second, as many.
        factors: Factors of the two fields: 1; -1 of a transmitter that is turned by 180 degrees, or
            fed so; 0 of one that does not send.
    """

    lower: PathSource
    higher: PathSource
    factors: tuple[float, float]

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which a path is not smooth, in order."""
        return self.lower.breakpoints

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest motion, Hz."""
        return self.lower.highest_frequency

    @property
    def smooth(self) -> bool:
        """Whether paths are smooth between the breakpoints."""
        return self.lower.smooth and self.higher.smooth

    def __call__(self, t: Float) -> Paths:
        """Return the paths at times t [M] (s), those of the first transmitter first."""
        first = self.lower(t)
        second = self.higher(t) if self.factors[1] else first
        fields = self.factors[0] * first.amplitude, self.factors[1] * second.amplitude
        return Paths(
            np.concatenate([first.delay, second.delay]),
            np.concatenate(fields),
            Through.joined([first.through, second.through]),
        )


def combine_transmitters(channels: Sequence[PathSource], board: Board) -> list[PathSource]:
    """Make the paths of the chirps as sent from those of every single transmitter.

    Args:
        channels: Paths of each pair of transmitter and receiver, in the order of `board.pairs`.
        board: The board; where its transmitters take turns, the paths are returned as they are.

    Returns:
        The paths of each virtual channel of the cube, as many paths in each.
    """
    if board.bpm is None:
        return list(channels)
    combined: list[PathSource] = [SumOfTwo(channel, channel, (1.0, 0.0)) for channel in channels]
    a, b = board.signs_of_two
    for lower, higher in zip(board.sums.tolist(), board.differences.tolist(), strict=True):
        combined[lower] = SumOfTwo(channels[lower], channels[higher], (a, b))
        combined[higher] = SumOfTwo(channels[lower], channels[higher], (a, -b))
    return combined


def exact_cube(channels: Sequence[PathSource], board: Board) -> tuple[Complex, float]:
    """Exact samples of a board in double precision.

    Args:
        channels: Paths of each virtual channel [V].

    Returns:
        Samples [frame, loop, virtual, sample], and P_s, the mean over frames, loops and channels of
        sum_i A_i^2.
    """
    cube = np.empty((board.frames, board.loops, board.channels, board.samples), complex)
    power = 0.0
    for v, (source, (k, _)) in enumerate(zip(channels, board.pairs, strict=True)):
        for first in range(0, board.frames, BLOCK_FRAMES):
            block = slice(first, first + BLOCK_FRAMES)
            paths = source(board.chirp_times(block)[..., k].ravel())
            power += float((paths.amplitude**2).sum())
            s = beat_matrix(paths.delay, paths.amplitude, board.waveform).T * board.signs[v]
            frames = s.reshape(-1, board.loops, board.samples)
            shape = (len(paths.delay), len(frames), board.loops)
            for frame, samples in enumerate(frames):
                parts = (part.reshape(shape)[:, frame] for part in paths[:2])
                if _still(*parts):
                    samples[1:] = samples[0]
            cube[block, :, v] = frames
    return cube, power / (board.frames * board.loops * board.channels)


def fast_cube(
    channels: Sequence[PathSource], board: Board, tolerance_db: float
) -> tuple[Complex, float, float]:
    """Samples of a board within a tolerance, P_s, and the measured relative error in dB.

    In half a chirp a beat turns by y = 2 pi K (tau - tau_m) u_N/fs, tau_m the middle of a frame's
    delays, u_N = (N - 1)/2. With x = y/Y, Y the largest of all, and u = n - u_N it is a sum of few
    Chebyshev polynomials, and those change little while a path is near its mean place x_0:

        exp(-j Y x u/u_N) = sum_p c_p(u) T_p(x),
        T_p(x) = sum_q T_p^(q)(x_0) (x - x_0)^q/q!,

    so that the sum over the paths is two products of matrices a frame, the larger one with real
    numbers. The number of terms q follows from the spread of x and the tolerance. Paths are asked
    for at NODES instants of a frame, some milliseconds, and are polynomials between them; some
    chirps are compared with the exact sum. Unless the error is SPARE_DB below the tolerance, or
    the default where that is tighter, frames are made again in double precision, from MORE_NODES
    instants and then from those of all loops. The samples that are returned have the precision
    that the tolerance asks for, however they were made, so that those of all scenes agree; the
    measured error has their rounding in it.

    Raises:
        AccuracyError: The tolerance is missed all the same.
    """
    target_db = target_error_db(tolerance_db)
    attempts = _attempts(channels, board, target_db)
    cube, power, error = min(attempts, key=lambda attempt: attempt[2])
    if error > tolerance_db - SPARE_DB:
        raise AccuracyError(error + SPARE_DB)
    return cube, power, error


def _attempts(
    channels: Sequence[PathSource], board: Board, target_db: float
) -> Iterator[tuple[Complex, float, float]]:
    """Samples, P_s and the measured error of ever finer settings, until one will do."""
    precise = target_db < SINGLE_DB
    precision = np.complex128 if precise else np.complex64
    for count, double in ((NODES, precise), (MORE_NODES, True), (board.loops, True)):
        cube, power, roughness = _summed(channels, board, target_db, count, double)
        cube = cube.astype(precision, copy=False)  # before its error is measured, rounding too
        error = measured_db(cube, channels, board, roughness)
        yield cube, power, error
        if not error > target_db - SPARE_DB:  # NaN of a signal that is no number
            return


def _summed(
    channels: Sequence[PathSource], board: Board, tolerance_db: float, count: int, precise: bool
) -> tuple[Complex, float, Float]:
    """Samples of paths at so many nodes a frame, in single precision or a precise one.

    Returns:
        Samples, P_s, and how large the squared error of each frame may be [frames], up to a factor.
    """
    single, roughness = not precise, np.empty(board.frames)
    dtype = np.complex64 if single else np.complex128
    shape = board.loops, board.channels, board.samples
    cube = np.empty((board.frames, *shape), dtype)
    power, nodes_of = 0.0, FrameNodes.of(board, count)
    for frame, (delay, amplitude, rough) in enumerate(_frame_paths(channels, board, nodes_of)):
        roughness[frame] = rough
        a = amplitude * board.signs[:, None]
        terms = delay.shape[0] * board.frames * board.loops * board.channels
        if single and nodes_of.instants.size == POWERS and compiled.pays(terms):
            s, squares = gridded_sum(delay, a, _chirps_of(board, nodes_of))
        else:
            tau, between = nodes_of.at_loops(delay), nodes_of.at_loops(a)
            squares = float(np.einsum("im,im->", between, between))
            in_precision = between.astype(np.float32 if single else float)
            s = _frame_sum(tau, in_precision, board, tolerance_db)
            s = s.reshape(board.channels, board.loops, -1)
        power += squares
        cube[frame] = s.swapaxes(0, 1)
        if _still(delay, amplitude):
            cube[frame, 1:] = cube[frame, 0]
    return cube, power / (board.frames * board.loops * board.channels), roughness


def still_samples(channels: Sequence[PathSource], board: Board) -> Complex:
    """Exact samples [virtual, sample] of paths that do not move, the same in every loop.

    Args:
        channels: Paths of each virtual channel [V].
    """
    samples = np.empty((board.channels, board.samples), complex)
    for v, source in enumerate(channels):
        samples[v] = beat_of(source(np.zeros(1)), board.waveform)[:, 0] * board.signs[v]
    return samples


def mean_power(channels: Sequence[PathSource], board: Board) -> float:
    """Mean P_s over frames, loops and channels of sum_i A_i^2, without making the echo."""
    total, nodes_of = 0.0, FrameNodes.of(board, NODES)
    for _, amplitude, _ in _frame_paths(channels, board, nodes_of):
        a = nodes_of.at_loops(amplitude)
        total += float(np.einsum("im,im->", a, a))
    return total / (board.frames * board.loops * board.channels)


class FrameNodes(NamedTuple):
    """Instants of a frame at which paths are asked for, to be polynomials between them.

    All channels are asked for the same ones, so that what they share is computed once, unless
    these are as many as loops: then each is at the chirps of its own transmitter.

    Attributes:
        instants: Instants [nodes], in loops since the first chirp of the frame, or of the channel.
        places: Chirps of each channel [V, L] on the same scale.
        basis: Weights [V, nodes, L] of the values at the nodes.
    """

    instants: Float
    places: Float
    basis: Float

    @classmethod
    def of(cls, board: Board, count: int) -> "FrameNodes":
        """Choose so many instants, or those of all loops where these are as few."""
        instants, loops = nodes(count - 1, board.loops), np.arange(float(board.loops))
        later = board.delays[[k for k, _ in board.pairs]] / board.loop_s
        if instants.size == loops.size:
            later *= 0
        else:
            instants *= (board.loops - 1 + later.max()) / (board.loops - 1)
        places = loops + later[:, None]
        basis = [lagrange_basis(instants, of_channel) for of_channel in places]
        return cls(instants, places, np.array(basis))

    @property
    def is_exact(self) -> bool:
        """Whether there is a node at every chirp."""
        return bool(self.instants.size == self.places.shape[1])

    def at_loops(self, values: Float) -> Float:
        """Polynomials of values [I, V, nodes] at all loops [I, V L]."""
        between = np.empty((*values.shape[:2], self.places.shape[1]))
        for v, basis in enumerate(self.basis):
            between[:, v] = _between_nodes(values[:, v], basis)
        return between.reshape(len(values), -1)


def _chirps_of(board: Board, nodes_of: FrameNodes) -> Chirps:
    """Chirps of a frame for `gridded_sum`."""
    reach, rate = nodes_of.places.max(), board.slope_hz / board.adc_rate_hz
    instants, places = (2 * part / reach - 1 for part in nodes_of[:2])
    frequency = board.waveform.fc + rate * (board.samples // 2)
    return Chirps(places, powers_from_nodes(instants), frequency, rate, board.samples)


def _frame_paths(
    channels: Sequence[PathSource], board: Board, nodes_of: FrameNodes
) -> Iterator[tuple[Float, Float, float]]:
    """Delays (s), amplitudes [I, virtual, node], and the roughness of each frame.

    Roughness is the sum over the paths of the squared coefficients of the highest of their
    Chebyshev polynomials, of 2 pi fc tau A and of A: the next one is what interpolation leaves out.
    """
    instants = nodes_of.instants
    order = np.arange(instants.size) + 0.5
    highest = (
        0 * instants
        if nodes_of.is_exact
        else np.cos((instants.size - 1) * np.pi * order / instants.size)
    )
    for first in range(0, board.frames, BLOCK_FRAMES):
        begin = board.chirp_times(slice(first, first + BLOCK_FRAMES))[:, 0]
        sampled = [
            source((begin[:, k * nodes_of.is_exact, None] + board.loop_s * instants).ravel())
            for source, (k, _) in zip(channels, board.pairs, strict=True)
        ]
        shape = (-1, len(begin), instants.size)
        delay = np.stack([paths.delay.reshape(shape) for paths in sampled], axis=2)
        amplitude = np.stack([paths.amplitude.reshape(shape) for paths in sampled], axis=2)
        for frame in range(len(begin)):
            tau, a = delay[:, frame], amplitude[:, frame]
            bend = 2 * pi * board.waveform.fc * (tau @ highest) * a[..., 0], a @ highest
            rough = sum(float(np.einsum("iv,iv->", part, part)) for part in bend)
            yield tau, a, rough


def _between_nodes(values: Float, basis: Float) -> Float:
    """Polynomials of values [.., node] at all loops; a constant stays so to the last digit."""
    between: Float = values @ basis
    constant = values[..., -1] == values[..., 0]
    if constant.any():
        constant &= (values == values[..., :1]).all(axis=-1)
        between[constant] = values[constant][:, :1]
    return between


def _still(delay: Float, amplitude: Float) -> bool:
    """Whether all paths [.., loop] of a frame stand still.

    Their samples then are those of the first loop to the last digit, so that a canceller leaves
    nothing, and not the rounding of sums.
    """
    parts = delay, amplitude
    if any((part[:1] != part[:1, ..., :1]).any() for part in parts):
        return False  # the first path shows it: usual, and cheap
    return all(bool((part == part[..., :1]).all()) for part in parts)


def _frame_sum(tau: Float, a: Float, board: Board, tolerance_db: float) -> Complex:
    """Samples [virtual loop, N] of the paths of a frame, in the precision of their amplitudes.

    Paths have delays (s) and amplitudes [I, virtual loop].
    """
    dtype, half = np.result_type(a.dtype, np.complex64), max(board.samples - 1, 1) / 2
    rate, u = board.slope_hz / board.adc_rate_hz, np.arange(board.samples) - (board.samples - 1) / 2
    middle = (tau.max() + tau.min()) / 2
    turn = (2 * pi * rate * half) * (tau - middle)
    mean = turn.mean(axis=1, keepdims=True)
    turn -= mean
    cycles = np.rint(mean / (2 * pi * half))  # cycles a sample, which no sample shows
    mean -= 2 * pi * half * cycles
    change = max(float(np.abs(turn).max()), LEAST_TURN)
    terms = _terms(turn[:, ::16], tolerance_db)
    x = (turn / change).astype(a.dtype)
    change = min(change, MAX_TERMS)  # beyond which the error shows
    reach = float(np.abs(mean).max()) + MARGIN * change
    left = np.empty((terms, *tau.shape), dtype)
    left[0] = unit_phasor(board.centre_hz * tau - half * cycles, dtype)
    left[0] *= a
    for q in range(1, terms):
        np.multiply(left[q - 1], x, out=left[q])
    polynomials, right = _expanded(mean[:, 0], change, reach, terms, u / half, dtype)
    right = right * unit_phasor(rate * middle * u)
    polynomials = polynomials.astype(a.dtype).reshape(len(right), -1)
    sums = polynomials @ left.reshape(-1, tau.shape[1]).view(a.dtype)
    samples: Complex = sums.view(dtype).T @ right.astype(dtype)
    return samples


def _expanded(
    turn: Float, change: float, reach: float, terms: int, v: Float, dtype: Any
) -> tuple[Float, Complex]:
    """Factors (change/reach)^q T_p^(q)(turn/reach)/q! [P, q, I]; c_p [P, N] of exp(-j turn v)."""
    count = ceil(reach + CUBE_ROOTS[dtype == np.complex64] * (reach + 15) ** (1 / 3))
    x, scale = turn / reach, change / reach
    factors = np.zeros((count, terms, x.size))
    factors[0, 0], factors[1, 0], factors[1, 1:2] = 1, x, scale
    for p in range(2, count):  # T_p = 2 x T_(p-1) - T_(p-2), and its derivatives
        np.multiply(2 * x, factors[p - 1], out=factors[p])
        factors[p] -= factors[p - 2]
        factors[p, 1:] += 2 * scale * factors[p - 1, :-1]
    cycles = reach / (2 * pi) * v
    return factors, coefficients(lambda x: unit_phasor(x[:, None] * cycles, dtype), count)


def _terms(y: Float, tolerance_db: float) -> int:
    """Fewest terms of exp(-j y) whose remainder y^Q/Q! has an rms below the tolerance."""
    rest = np.ones_like(y)
    for q in range(1, MAX_TERMS):
        rest *= y / q
        if float(np.mean(rest**2)) < 10 ** ((tolerance_db - MARGIN_DB) / 10):
            return q
    return MAX_TERMS


def measured_db(
    cube: Complex, channels: Sequence[PathSource], board: Board, roughness: Float | None = None
) -> float:
    """Bound of the relative L2 error (dB) of a cube, from PROBES chirps.

    Half of them are spread evenly over frames, a quarter by the power of frames, a quarter by their
    roughness; over loops and channels evenly. The bound is that of `Probes`.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        channels: Paths of each virtual channel [V].
        roughness: Likely squared error of each frame [frames], up to a factor.
    """
    powers = np.array([float(np.vdot(frame, frame).real) for frame in cube])
    total = float(powers.sum())
    share = np.full(board.frames, 1 / board.frames)
    for part in (powers, roughness):
        if part is not None and 0 < part.sum() < inf:
            share = 0.75 * share + 0.25 * part / part.sum()
    probe = np.arange(PROBES)
    ends = np.cumsum(share / share.sum())
    frame = np.searchsorted(ends, (probe + 0.5) / PROBES).clip(max=board.frames - 1)
    loop = (probe * GOLDEN % 1 * board.loops).astype(np.intp)
    virtual, sender = probe * 5 % board.channels, np.array([k for k, _ in board.pairs])
    times, squares = board.chirp_times(), np.zeros(PROBES)
    for k in np.unique(sender):  # channels of one transmitter are asked for the same times
        of_sender = sender[virtual] == k
        for v in np.unique(virtual[of_sender]):
            paths = channels[v](times[frame[of_sender], loop[of_sender], k])
            of_channel = virtual[of_sender] == v
            probes = np.flatnonzero(of_sender)[of_channel]
            delay, a = (part[:, of_channel] for part in paths[:2])
            exact = beat_matrix(delay, a, board.waveform).T * board.signs[v]
            squares[probes] = np.sum(
                np.abs(cube[frame[probes], loop[probes], v] - exact) ** 2, axis=1
            )
    if total == 0:
        return inf if squares.any() else -inf
    density = share[frame] * PROBES / (board.loops * board.channels)
    return Probes(probe, density, total).bound_db(squares)
