"""Packets that a raw capture of the DCA1000 lacks, found by the static echoes in it.

The card sends 1456 bytes of samples in a packet. Software that leaves lost ones out, instead of
filling them with zeros, moves all that follows: receivers and transmitters are exchanged. Static
echoes are the same in every pulse, so that they show where a stream moves, and by how many packets.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from radhar_cli.numerics.arrays import Float

PACKET_WORDS = 728  # words of 16 bits
MEMORY = 16  # pulses of which the usual one is the mean
LIKENESS = 0.3  # least correlation of pulses with the usual one, by which losses can be found
ALIKE = 0.9  # share of the usual correlation of pulses about a loss whose place is sure
DROP = 0.75  # share of the usual correlation below which a pulse has moved
CLEAR = 0.02  # share of the usual correlation by which more packets have to be likelier
AFTER = 4  # pulses by which a move is told
MOST_LOST = 4096  # packets at a place


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


def fill_losses(words: WordStream, period: int) -> FilledWords | None:
    """Find the packets that a stream lacks, and put zeros there.

    The stream ends where static echoes cannot tell how many there are.

    Args:
        words: The stream.
        period: Words after which static echoes repeat.

    Returns:
        The stream; None where nothing in it is static.
    """
    scan = _Scan(words, period)
    if scan.usual < LIKENESS:
        return None
    losses, place = list[Loss](), 0
    if scan.likeness((words.count // period - 1) * period) > DROP * scan.usual:
        return FilledWords(words, losses, words.count)  # the end alone is cut
    while place + period <= words.count:
        if scan.likeness(place) > DROP * scan.usual:
            scan.learn(place)
            place += period
            continue
        packets, following = scan.find_move(place)
        if packets is None:
            has_moved = scan.fits_elsewhere(place)
            return FilledWords(words, losses, max(place - period, 0)) if has_moved else None
        last = losses[-1].resume if losses else -AFTER * period
        # A pulse that does not fit is a person's, or lies between two losses that are close.
        if packets or place - last < AFTER * period:
            losses.append(scan.find_loss(max(place - period, last, 0), place, following, packets))
        place = following
    return FilledWords(words, losses, words.count)


class _Scan:
    """A walk along a stream, pulse by pulse, with what the last pulses were like."""

    def __init__(self, words: WordStream, period: int) -> None:
        self.words, self.period = words, period
        first = [self._pulse(n * period) for n in range(min(MEMORY, words.count // period))]
        self.mean = first[0] if first else np.zeros(0)
        pairs = [_correlation(*pair) for pair in pairwise(first)]
        self.usual = float(np.median(pairs)) if pairs else 0.0  # correlation of pulses

    def _pulse(self, place: int) -> Float:
        """Words of the pulse at a place, as numbers; short at the end of the stream."""
        stop = min(place + self.period, self.words.count)
        return self.words[slice(place, stop)].view("<i2").astype(float)

    def likeness(self, place: int) -> float:
        """Correlation of the pulse at a place with the usual one."""
        return _correlation(self._pulse(place), self.mean)

    def learn(self, place: int) -> None:
        """Let the pulse at a place count in the mean, and in how alike pulses usually are."""
        self.usual += (self.likeness(place) - self.usual) / MEMORY
        self.mean = self.mean + (self._pulse(place) - self.mean) / MEMORY

    def find_move(self, place: int) -> tuple[int | None, int]:
        """Number of packets that are missing about a place, and where the next whole pulse begins.

        None where no number of them lets the pulses that follow be like the usual one.
        """
        best, best_likeness = (0, place + self.period), -1.0
        for packets in range(MOST_LOST):
            shift = -packets * PACKET_WORDS % self.period
            if packets and shift == 0:  # from here on shifts repeat
                break
            begin = place + self.period + shift
            ends = range(begin + self.period, self.words.count + 1, self.period)[:AFTER]
            pulses = [self.likeness(end - self.period) for end in ends]
            likeness = float(np.mean(pulses)) if pulses else -1.0
            if likeness > best_likeness + CLEAR * self.usual:
                best, best_likeness = (packets, begin), likeness
        return best if best_likeness > DROP * self.usual else (None, place)

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
        return Loss(low, following, packets)

    def fits_elsewhere(self, place: int) -> bool:
        """Whether pulses are like the usual one up to a place, and after it moved by some words."""
        before = place - 2 * self.period
        if before < MEMORY * self.period or self.likeness(before) < ALIKE * self.usual:
            return False  # they change by themselves
        places = range(place + self.period, self.words.count - self.period + 1, self.period)[:AFTER]
        if not places:
            return True  # what is left is less than a pulse
        pulse = np.mean([self._pulse(begin) for begin in places], axis=0)
        pulse, usual = pulse - pulse.mean(), self.mean - self.mean.mean()
        spectrum = np.fft.rfft(pulse) * np.conj(np.fft.rfft(usual))
        largest = float(np.fft.irfft(spectrum, self.period).max())
        return largest > DROP * self.usual * float(np.sqrt((pulse @ pulse) * (usual @ usual)))


def _correlation(first: Float, second: Float) -> float:
    """Correlation of two pulses, of which the shorter counts."""
    size = min(first.size, second.size)
    if size < 2:
        return 0.0
    a, b = first[:size] - first[:size].mean(), second[:size] - second[:size].mean()
    norm = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / norm if norm > 0 else 0.0
