"""Recommendations of a sweep: a reason for each row, by its time and its changes, in a sentence.

A setting saves or costs time only where the whole interval of its ratio lies beyond what the config
as it is differs from itself.
"""

from collections.abc import Iterator
from enum import StrEnum
from math import inf
from typing import NamedTuple

from radhar_cli.config.engine import EngineConfig
from radhar_cli.echo.accuracy import target_error_db
from radhar_cli.study.tradeoff.differences import VISIBLE
from radhar_cli.study.tradeoff.settings import DEFAULT
from radhar_cli.study.tradeoff.sweep import LEAST_ROUNDS, Row, Sweep

MOST_SAVINGS, MOST_COSTS = 6, 3
MOST_LOST = 0.02  # of accuracy, that may be lost by what is recommended
COSTLY = 1.5  # times the time, from which on a setting is named as costly


class Verdict(StrEnum):
    """Verdict on the time of a row; the value is the sentence of it."""

    SAVES = "`{name}` saves {saved} of the time and {price}."
    SAME = "`{name}` is the same signal as the default's and saves nothing."
    SLOWER = "`{name}` takes {times} times the time and {price}."
    LEVEL = "`{name}` takes the same time within the blur and {price}."
    UNSURE = "`{name}` was timed too seldom to say what it takes; it {price}."


class Reason(NamedTuple):
    """Reason to take a setting, or not."""

    row: Row
    verdict: Verdict
    price: str  # what it changes, in words that follow the name
    is_free: bool  # whether that is not seen, or surely costs little accuracy

    @property
    def sentence(self) -> str:
        """The reason in words."""
        ratios = (self.row.ratio or 0, self.row.ratio_high or 0, self.row.ratio_low or 0)
        share, low, high = (100 * (1 - ratio) for ratio in ratios)
        return self.verdict.format(
            name=self.row.name,
            saved=f"{share:.0f} % ({low:.0f} to {high:.0f})",
            times=times_text(self.row),
            price=self.price,
        )


def reasons_of(sweep: Sweep, engine: EngineConfig) -> list[Reason]:
    """Reasons of all rows but that of the config as it is, in their order."""
    default = sweep.row_of(DEFAULT)
    return [
        Reason(row, verdict_of(row, sweep.blur, engine), *_price(row, default))
        for row in sweep.rows
        if not row.is_default
    ]


def recommend(sweep: Sweep, engine: EngineConfig, cores: int = 0) -> list[str]:
    """Sentences about what a config may save, at which price, and how sure that is.

    Args:
        sweep: rows, floors and pairs of a sweep.
        engine: engine of the config as it is.
        cores: cores of the machine, for the sentence on its load; 0 where nobody knows.
    """
    reasons, blur = reasons_of(sweep, engine), sweep.blur
    saving = [reason for reason in reasons if reason.verdict is Verdict.SAVES]
    saving.sort(key=lambda reason: reason.row.ratio or 1)
    others = [r for r in reasons if r.row.is_error and r.verdict is not Verdict.SAVES]
    costly = [r.row for r in reasons if r.verdict is Verdict.SLOWER and not r.row.is_error]
    costly = [row for row in costly if (row.ratio or 0) > COSTLY]
    costly = sorted(costly, key=lambda row: -(row.ratio or 0))[:MOST_COSTS]
    unsure = [r.row for r in reasons if r.verdict is Verdict.UNSURE and r.row.saves(blur, 1)]
    notes = {
        "Timed too seldom to say that it saves time, which more --minutes decide": [
            f"`{row.name}`" for row in unsure
        ],
        "What is left out and would cost most, times the time": [
            f"`{row.name}` {times_text(row)}" + f" of {row.base_name}" * (row.base_name != DEFAULT)
            for row in costly
        ],
        "Not measured for lack of time": [f"`{omission.name}`" for omission in sweep.unmeasured],
    }
    return [
        *_floor_sentences(sweep),
        *(reason.sentence for reason in (*others, *saving[:MOST_SAVINGS])),
        *_recommendation(saving),
        *(f"{words}: {', '.join(names)}." for words, names in notes.items() if names),
        *_blur_sentence(sweep, cores),
    ]


def verdict_of(row: Row, blur: float, engine: EngineConfig) -> Verdict:
    """Judge the time of a row."""
    if row.saves(blur):
        return Verdict.SAVES
    key, _, value = row.name.partition(": ")
    if (
        key == "engine.tolerance_db"
        and engine.fallback == "refuse"  # else the cube takes over what misses one of the two
        and target_error_db(float(value)) == target_error_db(engine.tolerance_db)
    ):
        return Verdict.SAME
    if row.rounds < LEAST_ROUNDS:
        return Verdict.UNSURE
    return Verdict.SLOWER if row.costs(blur) else Verdict.LEVEL


def _price(row: Row, default: Row | None) -> tuple[str, bool]:
    """Describe the changes of a row, as the end of a sentence; return whether they are free."""
    over_one = row.over_one
    if row.accuracy is not None and default is not None and default.accuracy is not None:
        lost = default.accuracy.loss_of(row.accuracy)
        amount = f"costs {100 * lost.mean:.0f} points"
        if lost.low <= 0:
            is_little = lost.high <= MOST_LOST
            amount = (
                "costs at most 2 points" if is_little else f"may cost {100 * lost.high:.0f} points"
            )
        test = ", tested on its own images" * (row.accuracy.tested_on == "own")
        means = f"{100 * default.accuracy.mean:.0f} to {100 * row.accuracy.mean:.0f}"
        seeds = f"{len(row.accuracy.by_seed)} seeds{test}"
        return f"{amount} of accuracy ({means}, {seeds})", lost.high <= MOST_LOST
    if over_one is None:
        return f"was not compared{': ' * bool(row.note)}{row.note}", False
    if over_one == 0:
        staying = "of the maps that stay" if row.drops_map else "that is shown"
        return f"changes nothing {staying}", not row.drops_map
    if row.is_error or over_one <= VISIBLE:
        is_free = over_one <= VISIBLE and not row.drops_map
        return f"changes {percent_text(over_one)} of the pixels by more than a level", is_free
    return f"gives another picture ({'; '.join(_picture_words(row))})", False


def _picture_words(row: Row) -> Iterator[str]:
    """Yield how much another picture differs, in words."""
    if row.maps:
        name, numbers = max(row.maps.items(), key=lambda item: item[1].over_one_median)
        over_one, size = numbers.shown(is_worst=False)
        yield f"{name}: {percent_text(over_one)} of the pixels, {size}"
    if row.points is not None:
        number = f"{row.points.per_frame:.1f} a frame instead of {row.points.base_per_frame:.1f}"
        yield f"{percent_text(row.points.moved)} of the points, {number}"


def _recommendation(saving: list[Reason]) -> Iterator[str]:
    """Yield what to take, and that networks were not asked."""
    free = [f"`{reason.row.name}`" for reason in saving if reason.is_free]
    if free:
        yield f"Recommended: {' or '.join(free)}."
    elif saving:
        yield (
            "Recommended: the config as it is; what saves time gives other pictures, which are "
            "worth it only if a network learns as well from them."
        )
    else:
        yield "Recommended: the config as it is; nothing that was tried saves time beyond the blur."
    if saving and not any(reason.row.accuracy for reason in saving):
        yield (
            "The effect on a network was not measured; `--accuracy 5` trains networks on data of "
            "each of them."
        )


def _floor_sentences(sweep: Sweep) -> Iterator[str]:
    """Yield what 8 bits show at least, and where the config's own error lies."""
    floors = sorted(sweep.floors_db.items(), key=lambda item: item[1])
    row = sweep.row_of(DEFAULT)
    if not floors or row is None:
        return
    name, floor_db = floors[0]
    yield (
        "8 bits show an error of the signal from "
        f"{', '.join(f'{db} dB ({key})' for key, db in floors)} on: more than "
        f"{percent_text(VISIBLE)} of the pixels are then more than a level off, or of the points "
        "more than 1 cm."
    )
    if row.error_db is not None:
        error = "none" if row.error_db == -inf else f"{row.error_db:.0f} dB of {row.error_of}"
        below = f"{floor_db - row.error_db:.0f} dB below that"
        if row.error_db >= floor_db:
            below = f"and shows in {name}: a tighter engine.tolerance_db is worth its time"
        yield f"The config's own error, worst of {row.scenes} scenes, is {error}, {below}."


def _blur_sentence(sweep: Sweep, cores: int) -> Iterator[str]:
    """Yield how sure the times are."""
    loads = [load for load in sweep.loads if load is not None]
    load = f", load {min(loads):.1f} to {max(loads):.1f}" if loads else ""
    load += f" on {cores} cores" if loads and cores else ""
    if sweep.pairs:
        yield (
            f"The config differs from itself by up to {percent_text(sweep.blur)} in time "
            f"({len(sweep.pairs)} comparisons{load}): smaller differences say nothing."
        )


def times_text(row: Row) -> str:
    """Format the time of a row over the default's: 1.52, 19."""
    ratio = row.ratio or 0.0
    return f"{ratio:.0f}" if ratio >= 10 else f"{ratio:.2f}"


def percent_text(share: float) -> str:
    """A share in percent, with two digits where it is small."""
    percent = 100 * share
    if 0 < percent < 0.01:
        return "less than 0.01 %"
    return f"{percent:.0f} %" if percent >= 10 or percent == 0 else f"{percent:.2g} %"
