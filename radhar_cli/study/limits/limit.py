"""A limit: how far a number of a config may go on one side, and what happens beyond."""

from dataclasses import dataclass
from enum import Enum


class RangeSide(Enum):
    """RangeSide of the range of a number."""

    LOW = "below"
    HIGH = "above"


class Consequence(Enum):
    """What happens beyond a limit."""

    REFUSED = "refused"
    WARNED = "warned"
    REDRAWN = "drawn again, in vain"
    SLOWER = "slower"
    EXACT_ENGINE = "computed by the exact engine"
    BLACK = "a map is black"
    INEXACT = "numbers end"


class Origin(Enum):
    """What ends at a limit."""

    KEY = "bounds of the key"
    MODEL = "model"
    NOISE = "noise"
    ENGINE = "engine"
    ARITHMETIC = "arithmetic"
    TIME = "time"


@dataclass(frozen=True)
class Judgement:
    """What a config with another number comes to."""

    effect: Consequence | None = None  # what happens; None where it is as with the present number
    source: Origin = Origin.MODEL  # what has ended
    reason: str = ""

    @property
    def is_clean(self) -> bool:
        """Whether nothing happens that does not happen with the present number."""
        return self.effect is None

    @property
    def sentence(self) -> str:
        """What happens, and why, as it stands in brackets."""
        assert self.effect is not None
        return f"{self.reason}: {self.effect.value}" if self.reason else self.effect.value


NOTED = 1.5  # times as slow, from which on it is said
AS_FAR = "as far as the key goes"
CLEAN = Judgement()
KEY_ENDS = Judgement(Consequence.REFUSED, Origin.KEY, AS_FAR)


@dataclass(frozen=True)
class Limit:
    """Limit of a number on one side."""

    key: str
    side: RangeSide
    # last number, of three digits, of which nothing new happens; None where there is none, not even
    # that of the config
    value: float | None
    beyond: Judgement
    # last number that is not refused, where farther numbers are but warned of; None where the next
    # is refused, or none is known
    last_accepted: float | None = None
    refusal: Judgement | None = None  # what happens beyond that
    # duration of a sample there over that of the config's own; None if it was not timed
    times: float | None = None
    simulated: bool = False  # whether a sample was simulated there

    @property
    def sentence(self) -> str:
        """The limit in words: "up to 7.4 (a joint is faster than the Doppler PRF/2: warned)"."""
        if self.value is None:
            return f"no number fits ({self.beyond.sentence})"
        words = "up to" if self.side is RangeSide.HIGH else "down to"
        text = f"{words} {number_text(self.value)} ({self.beyond.sentence}"
        if self.times is not None and self.times >= NOTED:
            text += f"; there {self.times:.2g} times as slow"
        if self.refusal is not None and self.last_accepted is not None:
            beyond = "beyond" if self.side is RangeSide.HIGH else "below"
            text += f"; {beyond} {number_text(self.last_accepted)} {self.refusal.sentence}"
        return f"{text})"


def number_text(value: float) -> str:
    """Text of a number of three digits, whole up to a million."""
    if value == int(value) and abs(value) < 1e6:
        return str(int(value))
    return f"{value:.6g}"
