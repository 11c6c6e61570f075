"""Search for the end of the valid range: outward from a number within, then between two."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import log10
from typing import NamedTuple, TypeAlias

from radhar_cli.study.limits.judging import Judgement

WIDE = 20.0  # ratio of two numbers from which on the way between them is geometric
FAR = 1e3  # distance from which on steps of places grow with the distance
SMALLEST = 1e-9  # of a positive number, below which there is only 0
FIRST_STEP, GROWTH = 1 / 16, 1.6
MOST_HALVINGS = 14
BETWEEN = 8  # parts of the way to an end, between which it is looked for gaps
GAP = 0.01  # of a number, within which its end is found

Judge: TypeAlias = Callable[[float], Judgement]


class End(NamedTuple):
    """End of the valid range on one side of a number."""

    inside: float  # last number that is fine
    # first number beyond it that was tried and is not; None where all are fine up to the bound
    outside: float | None
    judgement: Judgement  # what happens outside; that of the bound's own where all are fine


@dataclass(frozen=True)
class Path:
    """Way from a number to a bound, in equal steps of its measure: ratio, distance or number."""

    start: float
    bound: float
    is_whole: bool = False

    @property
    def is_of_distances(self) -> bool:
        """Whether steps grow with the distance from the start, rather than with the number."""
        return self.decades > 0 and (self.start <= 0 or self.bound <= 0)

    @property
    def decades(self) -> float:
        """Powers of ten between the ends of a geometric way, 0 of a straight one."""
        if self.start > 0 and self.bound > 0:
            ratio = max(self.start, self.bound) / min(self.start, self.bound)
            return log10(ratio) if ratio > WIDE else 0.0
        distance = abs(self.bound - self.start)
        return log10(distance / self._first_distance) if distance > FAR else 0.0

    @property
    def _first_distance(self) -> float:
        """Distance at which a way of growing distances begins."""
        return 0.01 * max(1.0, abs(self.start))

    @property
    def first_step(self) -> float:
        """Share of the way of a first step: a sixteenth, or a factor of two."""
        return min(FIRST_STEP, log10(2) / self.decades) if self.decades else FIRST_STEP

    def number_between(self, share: float) -> float:
        """Number at a share of the distance, of three digits."""
        return float(f"{self.start + share * (self.bound - self.start):.3g}")

    def number(self, share: float) -> float:
        """Number at a share of the way, 0 to 1, of three digits."""
        if share <= 0 or share >= 1:
            return self.start if share <= 0 else self.bound
        distance = self.bound - self.start
        value = self.start + share * distance
        if self.is_of_distances:
            step = self._first_distance * (abs(distance) / self._first_distance) ** share
            value = self.start + (step if distance > 0 else -step)
        elif self.decades:
            value = self.start * (self.bound / self.start) ** share
        value = float(round(value)) if self.is_whole else float(f"{value:.3g}")
        low, high = sorted((self.start, self.bound))
        return min(max(value, low), high)


def find_end(judge: Judge, path: Path) -> End:
    """Find the end of the valid range on the way from a number within to a bound.

    The bound itself is tried first, with the middle of the way; otherwise the way is followed
    outward in growing steps to the first number that is not fine, and halved from there.
    """
    judgement = judge(path.bound)
    if judgement.is_clean:
        middle = path.number(0.5)
        at_middle = judgement if path.start == path.bound else judge(middle)
        if at_middle.is_clean:
            return End(path.bound, None, judgement)
        path, judgement = replace(path, bound=middle), at_middle  # as of angles, which come round
    inside, outside, step = 0.0, 1.0, path.first_step
    while inside + step < 1:
        tried = judge(path.number(inside + step))
        if not tried.is_clean:
            outside, judgement = inside + step, tried
            break
        inside, step = inside + step, step * GROWTH
    end = halve(judge, path, (inside, outside), judgement)
    # Growing steps of distance may pass over a gap, as of an antenna in a person.
    nearer = Path(path.start, end.inside)
    for part in range(1, BETWEEN if path.is_of_distances else 1):
        bound = nearer.number_between(part / BETWEEN)
        if not judge(bound).is_clean:
            return find_end(judge, Path(path.start, bound))
    return end


def halve(
    judge: Judge,
    path: Path,
    shares: tuple[float, float],
    judgement: Judgement,
    steps: int = MOST_HALVINGS,
) -> End:
    """Find an end between two shares of a way by halving it.

    Args:
        judge: judges a number.
        path: the way.
        shares: shares of the way of a number that is fine, and of one beyond that is not.
        judgement: judgement of the latter.
        steps: largest number of numbers that are judged.
    """
    inside, outside = shares
    for _ in range(steps):
        half = 0.5 * (inside + outside)
        near, number, far = (path.number(share) for share in (inside, half, outside))
        if number in (near, far) or abs(far - near) <= GAP * max(abs(far), abs(near)):
            break
        tried = judge(number)
        if tried.is_clean:
            inside = half
        else:
            outside, judgement = half, tried
    return End(path.number(inside), path.number(outside), judgement)


def find_end_at_zero(judge: Judge, path: Path) -> End:
    """Find the end of the valid range as `find_end` does, where a positive number may go to 0."""
    if path.start <= 0 or path.bound != 0 or path.is_whole:
        return find_end(judge, path)
    at_zero, tiny = judge(0.0), Path(path.start, SMALLEST * path.start)
    if at_zero.is_clean and judge(tiny.number(0.5)).is_clean:
        return End(0.0, None, at_zero)
    end = find_end(judge, tiny)
    return End(end.inside, 0.0, at_zero) if end.outside is None else end
