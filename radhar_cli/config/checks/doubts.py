"""Warnings of values that are valid but hardly meant, as sentences for the user."""

from collections.abc import Iterable, Iterator

from radhar_cli.config.engine import EngineConfig
from radhar_cli.config.first_level import Request
from radhar_cli.config.radar import ImpulseRadar
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.schema.number import nominal, support
from radhar_cli.schema.section import for_activity

MIDDLES = 7.29e9, 8.748e9  # Hz, as data sheets of Novelda's X4 name its two bands


def word_warnings(c: Request) -> list[str]:
    """Warn, in one line, of words of a config that are taken for names of ours."""
    if not c.other_words:
        return []
    pairs = ", ".join(f"{word} is taken for {slug}" for word, slug in c.other_words.items())
    renamed = {*c.activities} - {NOBODY}  # of which there is no class by another name
    classes = [pair for pair in c.other_words.items() if pair[1] in renamed]
    advice = ""
    if classes:
        word, slug = classes[0]
        advice = f"; a class called {word} would be classes: {{{word}: {{sequence: [{slug}]}}}}"
    return [pairs + advice]


def band_warnings(c: Request) -> list[str]:
    """Warn that `radar.carrier_hz` of an impulse radar is the middle of a known chip's band."""
    if not isinstance(c.radar, ImpulseRadar) or c.radar.output != "iq":
        return []
    carrier, width = nominal(c.radar.carrier_hz), nominal(c.radar.bandwidth_hz)
    if carrier not in MIDDLES:
        return []
    return [
        f"radar.carrier_hz: {carrier:g} is the middle of an X4's band, but is taken as its lower "
        f"end: the radar's middle is {carrier + width / 2:g} (should be {carrier - width / 2:g})"
    ]


def tone_warnings(c: Request) -> list[str]:
    """Warn of interference tones that alias, a sentence for each."""
    highest = support(c.radar.prf_hz)[0] / 2
    return [
        f"receiver.tones.{number}.doppler_hz reaches beyond PRF/2 = {highest:g} Hz: the tone "
        "aliases, to that frequency less a multiple of the PRF"
        for number, tone in enumerate(c.receiver.tones)
        if max(map(abs, support(tone.doppler_hz))) > highest
    ]


def tolerance_warnings(c: Request) -> Iterator[str]:
    """Warn that a tolerance looser than the default runs as the default."""
    tolerance_db, usual_db = c.engine.tolerance_db, EngineConfig().tolerance_db
    computed = c.engine.kind == "direct" and not isinstance(c.radar, ImpulseRadar)
    if computed and tolerance_db > usual_db:
        yield (
            f"engine.tolerance_db: {tolerance_db:g} is looser than the default and runs as "
            f"{usual_db:g}: a larger error would save less than a tenth of a sample's time"
        )


def timing_warnings(c: Request, activities: Iterable[Activity] | None = None) -> list[str]:
    """Warn of movements that begin after the end of the recording, a sentence for each.

    Args:
        c: the config; numbers that are drawn are taken at their middle.
        activities: activities that are looked at; None for all of the config.
    """
    length = nominal(c.duration_s)
    warnings = []
    for activity in c.chosen_activities if activities is None else activities:
        for key in ("seat_start_s", "walk_begin_s", "walk_start_s", "walk_stop_s"):
            number = for_activity(getattr(c.timing, key), activity)
            if number is None or not c.depends_on(activity, f"timing.{key}"):
                continue
            start = nominal(number)
            if start >= length:
                warnings.append(
                    f"{activity.label} {activity.slug}: timing.{key} = {start:g} s is not before "
                    f"the end of the recording, {length:g} s: what begins then is never seen"
                )
    return warnings
