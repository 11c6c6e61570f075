"""What a sweep recommends, in sentences that follow from its rows and their uncertainty.

A setting saves or costs time only where the whole interval of its ratio lies beyond what the config
as it is differs from itself.
"""

from collections.abc import Iterator, Sequence
from math import inf, isfinite

from radhar_cli.config.engine import EngineConfig
from radhar_cli.echo.accuracy import target_error_db
from radhar_cli.study.tradeoff.floor import VISIBLE
from radhar_cli.study.tradeoff.intervals import Interval, paired_difference
from radhar_cli.study.tradeoff.row import Row
from radhar_cli.study.tradeoff.setting import DEFAULT
from radhar_cli.study.tradeoff.sweep import Sweep
from radhar_cli.study.tradeoff.timing import LEAST_ROUNDS

MOST_SAVINGS, MOST_COSTS = 6, 3
MOST_LOST = 0.02  # of accuracy, that may be lost by what is recommended
COSTLY = 1.5  # times the time, from which on a setting is named as costly
NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
TOLERANCE = "engine.tolerance_db"


def recommend(sweep: Sweep, engine: EngineConfig, cores: int = 0) -> list[str]:
    """Sentences about what a config may save, at which price, and how sure that is.

    Args:
        sweep: rows, floors and pairs of a sweep.
        engine: engine of the config as it is.
        cores: cores of the machine, for the sentence on its load; 0 where nobody knows.
    """
    return [
        *_floor_sentences(sweep),
        *_engine_sentences(sweep, engine),
        *_saving_sentences(sweep),
        *_cost_sentences(sweep),
        *_blur_sentences(sweep, cores),
    ]


def saves(row: Row, blur: float, least_rounds: int = LEAST_ROUNDS) -> bool:
    """Whether a row takes less time than the config as it is, beyond its own interval and the blur.

    Args:
        row: the row.
        blur: share by which the config as it is differs from itself.
        least_rounds: rounds of timing without which nothing is concluded.
    """
    is_comparable = row.base_name == DEFAULT and not row.is_default and row.rounds >= least_rounds
    return is_comparable and row.ratio_high is not None and row.ratio_high < 1 - blur


def _costs(row: Row, blur: float) -> bool:
    """Whether a row takes more time, beyond its own interval and the blur."""
    is_timed = not row.is_default and row.rounds >= LEAST_ROUNDS
    return is_timed and row.ratio_low is not None and row.ratio_low > 1 + blur


def _floor_sentences(sweep: Sweep) -> Iterator[str]:
    """Yield what 8 bits show at least, and where the config's own error lies."""
    floors = sorted(sweep.floors.items(), key=lambda item: item[1])
    maps = [item for item in floors if item[0] != "points"]
    if maps:
        (visible, map_floor), *others = maps
        listed = "".join(f", {key} {value} dB" for key, value in others).replace(",", ";", 1)
        yield (
            f"At this config 8 bits cannot show an error of less than {map_floor} dB of the signal "
            f"({visible}{listed}): below it fewer than {_percent(VISIBLE)} of the pixels differ by "
            "more than a level."
        )
    if "points" in sweep.floors:
        yield (
            f"{_percent(VISIBLE)} of the points move by more than 1 cm from an error of "
            f"{sweep.floors['points']} dB on."
        )
    row = sweep.row_of(DEFAULT)
    if not floors or row is None or row.error_db is None:
        return
    (name, floor_db), scenes = floors[0], f"worst of {_counted(row.scenes, 'scene')}"
    own_error = f"Its own error, {row.error_db:.0f} dB of {row.error_of} ({scenes}),"
    if row.error_db == -inf:
        yield f"The config as it is makes no error of computation ({scenes})."
    elif row.error_db < floor_db:
        yield f"{own_error} is {floor_db - row.error_db:.0f} dB below that."
    else:
        yield f"{own_error} shows in {name}: a tighter engine.tolerance_db is worth its time."


def _engine_sentences(sweep: Sweep, engine: EngineConfig) -> Iterator[str]:
    """Yield what other computations of the same physics cost, and whether they show.

    Those that save time are named among what saves.
    """
    for row in sweep.rows:
        is_other = row.is_error and not row.is_default and row.ratio is not None
        if not is_other or saves(row, sweep.blur):
            continue
        if _is_same_signal(row, engine):
            time = f" ({_times(row)} the time)" if row.rounds >= LEAST_ROUNDS else ""
            yield f"`{row.name}` is the same signal as the default's and saves nothing{time}."
            continue
        words = "takes the same time within the blur"
        if row.rounds < LEAST_ROUNDS:
            words = "was timed too seldom to say what it takes"
        elif _costs(row, sweep.blur):
            words = f"takes {_times(row)} the time"
        yield f"`{row.name}` {words}; {_shown_error(row)}."


def _is_same_signal(row: Row, engine: EngineConfig) -> bool:
    """Whether a row has another tolerance, for which the engine computes as for the config's.

    Scenes that miss one tolerance and not the other are refused, unless the cube takes them over.
    """
    key, _, value = row.name.partition(": ")
    is_tolerance = key == TOLERANCE and engine.fallback == "refuse"
    target_db = target_error_db(engine.tolerance_db)
    return is_tolerance and target_error_db(float(value)) == target_db


def _shown_error(row: Row) -> str:
    """Whether an error of a row shows in pictures, in words."""
    if row.over_one is None:
        return "what it shows was not compared"
    if row.over_one == 0:
        return "no pixel is more than a level from the exact one"
    return f"{_percent(row.over_one)} of the pixels are more than a level from the exact ones"


def _saving_sentences(sweep: Sweep) -> Iterator[str]:
    """Yield what saves time, at what price, and what to take."""
    saving = [row for row in sweep.rows if saves(row, sweep.blur)]
    saving.sort(key=lambda row: row.ratio or 1)
    default = sweep.row_of(DEFAULT)
    for row in saving[:MOST_SAVINGS]:
        yield f"`{row.name}` saves {_saved(row)} of the time{_price(row, default)}."
    if len(saving) > MOST_SAVINGS:
        yield f"Others that save less: {_names(saving[MOST_SAVINGS:])}."
    free = [row for row in saving if _is_free(row, default)]
    if free:
        yield f"Recommended: {_names(free, ' or ')}."
    elif saving:
        yield (
            "Recommended: the config as it is; what saves time gives other pictures, which are "
            "worth it only if a network learns as well from them."
        )
    else:
        yield "Recommended: the config as it is; nothing that was tried saves time beyond the blur."
    undecided = [
        row
        for row in sweep.rows
        if row.rounds < LEAST_ROUNDS and saves(row, sweep.blur, least_rounds=1)
    ]
    if undecided:
        listed = _names(undecided)
        yield f"Timed too seldom to say that it saves time: {listed}; more --minutes decide."
    if saving and not any(row.accuracy for row in saving):
        yield (
            "The effect on a network was not measured; `--accuracy 5` trains networks on data of "
            "each of them."
        )


def _is_free(row: Row, default: Row | None) -> bool:
    """Whether a row that saves time costs nothing that is shown, or surely little accuracy."""
    lost = _lost(row, default)
    if lost is not None:
        return lost.high <= MOST_LOST
    return bool(row.maps or row.points) and (row.over_one or 0) <= VISIBLE and not drops_map(row)


def drops_map(row: Row) -> bool:
    """Whether a row has fewer maps than the config, so that what stays is not all."""
    return row.name.startswith("maps without ")


def _price(row: Row, default: Row | None) -> str:
    """What a row that saves time changes, as the end of a sentence."""
    lost, over_one = _lost(row, default), row.over_one or 0
    if lost is not None:
        assert row.accuracy is not None
        assert default is not None
        assert default.accuracy is not None
        seeds = _counted(len(row.accuracy.by_seed), "seed")
        means = f"{100 * default.accuracy.mean:.0f} to {100 * row.accuracy.mean:.0f}, {seeds}"
        if row.accuracy.tested_on == "own":
            means += ", tested on its own images"
        if lost.low > 0:
            return f" and costs {_counted(round(100 * lost.mean), 'point')} of accuracy ({means})"
        if lost.high <= MOST_LOST:
            return f" and costs at most {100 * MOST_LOST:.0f} points of accuracy ({means})"
        return f" and may cost up to {100 * lost.high:.0f} points of accuracy, or none ({means})"
    if not row.maps and row.points is None:
        return f"; {row.note}" if row.note else ""
    if over_one == 0:
        staying = "of the maps that stay" if drops_map(row) else "that is shown"
        return f" and changes nothing {staying}"
    if row.is_error or over_one <= VISIBLE:
        return f" and changes {_percent(over_one)} of the pixels by more than a level"
    return f" and gives another picture ({'; '.join(_picture_words(row))})"


def _picture_words(row: Row) -> Iterator[str]:
    """Yield how much another picture differs, in words."""
    if row.maps:
        name, worst = max(row.maps.items(), key=lambda item: item[1].over_one_median)
        size = f"{worst.rms_levels_median:.0f} levels"
        if worst.rms_median_db is not None:
            size = f"{worst.rms_median_db:.1f} dB rms"
        yield f"{name}: {_percent(worst.over_one_median)} of the pixels, {size}"
    if row.points is not None:
        yield (
            f"{_percent(row.points.moved)} of the points, {row.points.per_frame:.1f} a frame "
            f"instead of {row.points.base_per_frame:.1f}"
        )


def _lost(row: Row, default: Row | None) -> Interval | None:
    """Accuracy that a row loses against the default, paired by seed; None where not measured."""
    if row.accuracy is None or default is None or default.accuracy is None:
        return None
    return paired_difference(default.accuracy.by_seed, row.accuracy.by_seed)


def _cost_sentences(sweep: Sweep) -> Iterator[str]:
    """Yield what costs many times the time: physics and transforms that the config leaves out."""
    costly = [row for row in sweep.rows if _costs(row, sweep.blur) and not row.is_error]
    costly = [row for row in costly if (row.ratio or 0) > COSTLY]
    costly.sort(key=lambda row: -(row.ratio or 0))
    if costly:
        listed = "; ".join(
            f"`{row.name}` {_times(row)}"
            + ("" if row.base_name == DEFAULT else f" (of {row.base_name})")
            for row in costly[:MOST_COSTS]
        )
        yield f"What is left out and would cost most: {listed} the time."


def _blur_sentences(sweep: Sweep, cores: int) -> Iterator[str]:
    """Yield how sure the times are, and what was not measured."""
    loads = [load for load in sweep.loads if isfinite(load)]
    load = ""
    if loads:
        on = f" on {_counted(cores, 'core')}" if cores else ""
        load = f", load {min(loads):.1f} to {max(loads):.1f}{on}"
    if sweep.pairs:
        pairs = _counted(len(sweep.pairs), "comparison")
        yield (
            f"The config differs from itself by up to {_percent(sweep.blur)} in time ({pairs}"
            f"{load}): smaller differences say nothing."
        )
    if sweep.unmeasured:
        names = ", ".join(f"`{name}`" for name, _ in sweep.unmeasured)
        yield f"Not measured for lack of time: {names}."


def _names(rows: Sequence[Row], between: str = ", ") -> str:
    return between.join(f"`{row.name}`" for row in rows)


def _saved(row: Row) -> str:
    """Share of the time that a row saves, with its interval: 18 % (16 to 20)."""
    ratios = (row.ratio or 0, row.ratio_high or 0, row.ratio_low or 0)
    share, low, high = (100 * (1 - ratio) for ratio in ratios)
    return f"{share:.0f} % ({low:.0f} to {high:.0f})"


def _times(row: Row) -> str:
    """How many times the time a row takes: 1.52 times, 19 times."""
    ratio = row.ratio or 0.0
    return f"{ratio:.0f} times" if ratio >= 10 else f"{ratio:.2f} times"


def _percent(share: float) -> str:
    """A share in percent, with two digits where it is small."""
    percent = 100 * share
    if 0 < percent < 0.01:
        return "less than 0.01 %"
    return f"{percent:.0f} %" if percent >= 10 or percent == 0 else f"{percent:.2g} %"


def _counted(count: int, noun: str) -> str:
    """A number in words and its noun: five seeds."""
    number = NUMBERS[count] if count < len(NUMBERS) else str(count)
    return f"{number} {noun}{'s' * (count != 1)}"
