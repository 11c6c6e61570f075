"""Packets that a raw capture of the DCA1000 lacks, found by the static echoes in it.

The card sends 1456 bytes of samples in a packet. Software that leaves lost ones out, instead of
filling them with zeros, moves all that follows: receivers and transmitters are exchanged. Static
echoes are the same in every pulse, so that they show where a stream moves, and by how many packets.
The size confirms it: with those packets it has to be a whole number of frames. Otherwise the stream
ends before the first loss, or cannot be used, as packets may be missing at its beginning.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import gcd
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from radhar_cli.numerics.arrays import Float

PACKET_WORDS = 728  # words of 16 bits
MEMORY = 16  # pulses of which the usual one is the mean
LIKENESS = 0.3  # least correlation of pulses with the usual one, by which losses can be found
ALIKE = 0.9  # share of the usual correlation of pulses about a loss whose place is sure
DROP = 0.75  # share of the usual correlation below which a pulse has moved
CLEAR = 0.02  # share of the usual correlation by which a number of packets has to be likelier
AFTER = 4  # pulses by which a move is told
MOST_BY_SIZE = 128  # packets that a size tells, of
FEWEST_SIZES = 8  # times as many, so that a size fits seldom by chance


class WordStream(Protocol):
    """Words that are read by slices."""

    @property
    def count(self) -> int:
        """Number of words."""
        ...

    @property
    def bytes(self) -> int:
        """Number of bytes."""
        ...

    def __getitem__(self, key: slice) -> NDArray[np.uint16]:
        """Read words from key.start to key.stop - 1."""
        ...


class Loss(NamedTuple):
    """Packets that are missing.

    Attributes:
        begin: Number of the first stored word that is not used: the first after the loss, or the
            first of pulses in which nothing tells where it is.
        resume: Number of the first stored word that is used again.
        packets: Number of packets.
    """

    begin: int
    resume: int
    packets: int


@dataclass(frozen=True)
class FilledWords:
    """Words of a stream, with zeros for the packets that it lacks.

    Attributes:
        words: The words as stored.
        losses: Packets that are missing, in order.
        stop: Number of stored words that are used.
    """

    words: WordStream
    losses: Sequence[Loss]
    stop: int

    @property
    def count(self) -> int:
        """Number of words, with those of lost packets."""
        return self.stop + PACKET_WORDS * sum(loss.packets for loss in self.losses)

    @property
    def bytes(self) -> int:
        """Number of bytes, with those of lost packets."""
        return self.count * 2

    def __getitem__(self, key: slice) -> NDArray[np.uint16]:
        """Read words from key.start to key.stop - 1."""
        out = np.zeros(key.stop - key.start, np.uint16)
        begin, moved = 0, 0  # first stored word of a stretch, and how much farther on it belongs
        for loss in [*self.losses, Loss(self.stop, self.stop, 0)]:
            first, stop = max(key.start - moved, begin), min(key.stop - moved, loss.begin)
            if first < stop:
                place = first + moved - key.start
                out[place : place + stop - first] = self.words[slice(first, stop)]
            begin, moved = loss.resume, moved + PACKET_WORDS * loss.packets
        return out


def missing_packets(size: int, frame: int) -> int | None:
    """Number of packets, by which a size is a whole number of frames; None where no few are.

    Args:
        size: Bytes of a capture.
        frame: Bytes of a frame.
    """
    packet = 2 * PACKET_WORDS
    largest_count = min(MOST_BY_SIZE, frame // gcd(frame, packet) // FEWEST_SIZES)
    return next((n for n in range(largest_count + 1) if (size + n * packet) % frame == 0), None)


def fill_losses(words: WordStream, period: int, missing: int | None) -> FilledWords | None:
    """Find the packets that a stream lacks, and put zeros there.

    The stream ends before the first loss where its size does not tell how many are missing. Fewer
    packets than these are found where static echoes do not show them all.

    Args:
        words: The stream.
        period: Words after which static echoes repeat.
        missing: Number of packets that are missing by the size; None where it does not tell.

    Returns:
        The stream; None where nothing in it is static.
    """
    scan = _Scan(words, period)
    if scan.usual < LIKENESS or scan.static_share() < LIKENESS:
        return None
    if missing is None:
        return FilledWords(words, [], _sure_words(words, period))
    losses, place, left = list[Loss](), 0, missing
    while place + period <= words.count and left:
        if scan.likeness(place) > DROP * scan.usual:
            scan.learn(place)
            place += period
            continue
        packets, following = scan.find_move(place, left)
        if packets is None:
            break
        last = losses[-1].resume if losses else -AFTER * period
        # A pulse that does not fit is a person's, or lies between two losses that are close.
        if packets or place - last < AFTER * period:
            low = min(max(place - period, last, 0), following)
            losses.append(scan.find_loss(low, place, following, packets))
        place = max(following, losses[-1].resume if losses else 0)
        left -= packets
    if len(losses) > 1 and scan.least_alike_move() <= missing:
        losses = []  # one of them may lack that many more, and another as many less
    return FilledWords(words, losses, words.count)


def _sure_words(words: WordStream, period: int) -> int:
    """Number of words up to which pulses fit the first ones where they are.

    The mean of some pulses has little of what moves. Packets may be missing in one before that,
    which does not show it yet.
    """
    usual, pulses = _mean_pulse(words, 0, period, MEMORY), words.count // period
    blocks = [(0, 1), *((n, MEMORY) for n in range(MEMORY, pulses - MEMORY, MEMORY))]
    blocks += [(max(pulses - count, 0), count) for count in (MEMORY, AFTER, 1)]
    for first, count in blocks:
        likeness = _likeness_by_packets(_mean_pulse(words, first * period, period, count), usual)
        if likeness[0] < ALIKE * likeness.max():
            return max(first - MEMORY, 0) * period
    return words.count


def _mean_pulse(words: WordStream, begin: int, period: int, count: int) -> Float:
    """Mean of pulses from a place on [period]."""
    count = min(count, (words.count - begin) // period)
    pulses = words[slice(begin, begin + count * period)].view("<i2").reshape(count, period)
    return np.asarray(pulses.astype(float).mean(axis=0))


def _likeness_by_packets(pulse: Float, usual: Float) -> Float:
    """Likeness of a pulse to the usual one, moved by each number of packets [number]."""
    spectrum = np.fft.rfft(pulse - pulse.mean()) * np.conj(np.fft.rfft(usual - usual.mean()))
    numbers = np.arange(pulse.size // gcd(pulse.size, PACKET_WORDS))
    likeness = np.fft.irfft(spectrum, pulse.size)[numbers * PACKET_WORDS % pulse.size]
    return np.asarray(likeness)


class _Scan:
    """A walk along a stream, pulse by pulse, with what the last pulses were like."""

    def __init__(self, words: WordStream, period: int) -> None:
        self.words, self.period = words, period
        first = [self._pulse(n * period) for n in range(min(MEMORY, words.count // period))]
        self.mean = first[0] if first else np.zeros(0)
        pairs = [_correlation(*pair) for pair in pairwise(first)]
        self.usual = float(np.median(pairs)) if pairs else 0.0  # correlation of pulses
        self.first = np.array(first)  # [pulse, word]

    def _pulse(self, place: int) -> Float:
        """Words of the pulse at a place, as numbers; short at the end of the stream."""
        stop = min(place + self.period, self.words.count)
        return self.words[slice(place, stop)].view("<i2").astype(float)

    def likeness(self, place: int) -> float:
        """Correlation of the pulse at a place with the usual one."""
        return _correlation(self._pulse(place), self.mean)

    def static_share(self) -> float:
        """Share of the power of the first pulses that is in their mean."""
        power = float(np.mean(np.var(self.first, axis=1)))
        return float(np.var(self.first.mean(axis=0))) / power if power > 0 else 0.0

    def learn(self, place: int) -> None:
        """Let the pulse at a place count in the mean, and in how alike pulses usually are."""
        self.usual += (self.likeness(place) - self.usual) / MEMORY
        self.mean = self.mean + (self._pulse(place) - self.mean) / MEMORY

    def find_move(self, place: int, left: int) -> tuple[int | None, int]:
        """Number of packets that are missing about a place, and where the next whole pulse begins.

        None where no number of them lets the pulses that follow be like the usual one, or several
        do, of which none is all that are left.

        Args:
            place: Beginning of a pulse.
            left: Number of packets that are missing from there on.
        """
        likeness = dict[tuple[int, int], float]()
        for packets in range(left + 1):
            shift = -packets * PACKET_WORDS % self.period
            if packets and shift == 0:  # from here on shifts repeat
                break
            begin = place + self.period + shift
            ends = range(begin + self.period, self.words.count + 1, self.period)[:AFTER]
            pulses = [self.likeness(end - self.period) for end in ends]
            likeness[packets, begin] = float(np.mean(pulses)) if pulses else -1.0
        best = max(likeness.values())
        likely = [move for move, value in likeness.items() if value >= best - CLEAR * self.usual]
        if len(likely) > 1 and likely[0][0] != 0:
            likely = [move for move in likely if move[0] == left]
        if best <= DROP * self.usual or len(likely) != 1:
            return None, place
        return likely[0]

    def least_alike_move(self) -> int:
        """Least number of packets that may be missing without pulses looking otherwise."""
        likeness = _likeness_by_packets(self.mean, self.mean)
        numbers = np.flatnonzero(likeness > DROP * likeness[0])
        return int(numbers[1]) if numbers.size > 1 else likeness.size

    def find_loss(self, low: int, place: int, following: int, packets: int) -> Loss:
        """Find where a loss is: packets before it fit the usual pulse as it was.

        Args:
            low: Word before which none is missing.
            place: Beginning of a pulse that does not fit.
            following: Beginning of the next whole pulse after the loss.
            packets: Number of packets that are missing.
        """
        stored = self.words[slice(low, following)].view("<i2").astype(float)
        before = np.resize(np.roll(self.mean, place - low), stored.size)
        after = np.resize(np.roll(self.mean, following - low), stored.size)
        # Squared error if all words from n on come after the loss.
        error = np.concatenate([[0.0], np.cumsum((stored - before) ** 2 - (stored - after) ** 2)])
        places = np.arange(-(-low // PACKET_WORDS) * PACKET_WORDS, following + 1, PACKET_WORDS)
        begin = int(places[np.argmin(error[places - low])]) if places.size else place
        fitted = np.concatenate([before[: begin - low], after[begin - low :]])
        if packets and _correlation(stored, fitted) > ALIKE * self.usual:
            return Loss(begin, begin, packets)
        # Others may be missing in the pulses by which this is told.
        return Loss(low, min(following + AFTER * self.period, self.words.count), packets)


def _correlation(first: Float, second: Float) -> float:
    """Correlation of two pulses, of which the shorter counts."""
    size = min(first.size, second.size)
    if size < 2:
        return 0.0
    a, b = first[:size] - first[:size].mean(), second[:size] - second[:size].mean()
    norm = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / norm if norm > 0 else 0.0
