"""Draw scenes inside the model: `on_invalid`, redraws, and room for everybody."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar, ImpulseRadar
from radhar_cli.errors import SceneError
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.motion.human.two_link import OutOfReachError
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.checks.check_grid import GRID_HZ
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.checks.validity import (
    HALF_BAND,
    RadarChecks,
    SceneCheck,
    check_by_each_radar,
)
from radhar_cli.scene.motion import moving
from radhar_cli.scene.scene import MAX_PLACES, Person, Redrawn, Scene, draw_scene, redrawn

MAX_ATTEMPTS = 1000
# Draws after which there are no more where none comes near, without and with lists to choose from.
FAR_DRAWS, FAR_CHOICES = 50, 200
TORSOS_APART_M = 0.5
CROWDED = "their motion.place, or motion.range_m and cross_range_m, should leave room"
# Draws after which `is_hopeless` looks at them, by what is redrawn.
DRAWS_OF = {Redrawn.NOTHING: 1, Redrawn.NUMBERS: FAR_DRAWS, Redrawn.CHOICES: FAR_CHOICES}


def draw_valid_scene(
    config: Config, activity: Activity, index: int, attempts: int | None = None
) -> tuple[Scene, Flags]:
    """Draw one sample, check it and apply `on_invalid`; return it and its warnings.

    Args:
        config: config of the data set.
        activity: class of the sample.
        index: number of the sample within its class.
        attempts: most draws of the sample's own person; None for MAX_ATTEMPTS.

    Raises:
        SceneError: a scatterer too close to an antenna (unless redrawn), any scene outside the
            model under `on_invalid: error`, no valid scene in 1000 redraws, or as many as
            `is_hopeless` takes, or no place for one of `people`.
    """
    misses = list[tuple[str, float]]()
    draws = DRAWS_OF[redrawn(config, activity)]
    limit = MAX_ATTEMPTS if attempts is None else attempts
    while True:
        scene = draw_scene(config, activity, index, len(misses))
        checks = check_by_each_radar(scene, scene.people[:1])
        check = checks.decisive
        if check.invalid is None or (config.on_invalid == "keep" and not check.too_close):
            flags = checks.by_radar.flags
            if any(kind == HALF_BAND for kind, _ in misses):
                flags |= _redrawn_for(config)
            return _add_others(config, scene, flags)
        misses.append(check.miss)
        if len(misses) >= limit or config.on_invalid != "redraw" or is_hopeless(misses, draws):
            break
    reason = f"{checks.invalid}{_describe_place(scene.people[0])}"
    cure = suggest_cure(checks.scene.people[0], check)
    if config.on_invalid == "redraw":
        counted = "1 draw, and nothing is drawn again" if draws == 1 else f"{len(misses)} draws"
        raise SceneError(
            f"sample {activity.slug}/{index}: no scene inside the model in {counted} "
            f"(on_invalid: redraw); the last: {reason}; {cure}"
        )
    raise SceneError(
        f"sample {activity.slug}/{index}: {reason} (on_invalid: {config.on_invalid}); {cure}"
    )


def is_hopeless(misses: Sequence[tuple[str, float]], draws: int) -> bool:
    """Whether further draws of a scene are no use, as none so far came near the model.

    So it is after some draws that are invalid by the same check, the best of which misses by more
    than all of them differ; and at once where nothing is drawn again.

    Args:
        misses: of all draws, as `SceneCheck.miss` has them.
        draws: so many, and multiples of it, are looked at.
    """
    if len(misses) % draws:
        return False
    sizes = [size for _, size in misses]
    alike = len({kind for kind, _ in misses}) == 1
    return draws == 1 or (alike and min(sizes) > max(sizes) - min(sizes))


class _Refusal(NamedTuple):
    """Reason why a person cannot be at the place that was drawn, and its remedy."""

    reason: str | None  # None where only somebody else is too near
    cure: str


def _add_others(config: Config, scene: Scene, flags: Flags) -> tuple[Scene, Flags]:
    """Draw others to an own person who stays, one by one, until they fit."""
    redraws = [0] * len(config.people)
    for number in range(1, len(config.people) + 1):
        refusal = _Refusal(None, CROWDED)
        for redraws[number - 1] in range(MAX_PLACES):
            scene = draw_scene(config, scene.activity, scene.index, scene.attempt, tuple(redraws))
            person = next((one for one in scene.people if one.number == number), None)
            if person is None:
                break
            checks = check_by_each_radar(scene, (person,))
            refusal = _refuse_place(config, person, checks)
            if refusal.reason is None and find_crowded(scene, number) is None:
                flags |= (
                    checks.by_radar.flags & ~Flags.GATE
                )  # which follows the sample's own person
                break
            if refusal.reason is not None and checks.decisive.miss[0] == HALF_BAND:
                flags |= _redrawn_for(config)
            if refusal.reason is not None and config.on_invalid != "redraw":
                reason = f"people.{number - 1}: {refusal.reason}"
                raise SceneError(f"{scene.name}: {reason}; {refusal.cure}")
        else:
            reason = describe_crowd(number)
            if refusal.reason is not None:
                reason = f"people.{number - 1}: {refusal.reason}"
            raise SceneError(f"{scene.name}: {reason} in {MAX_PLACES} draws; {refusal.cure}")
    return scene, flags


def _redrawn_for(config: Config) -> Flags:
    """Flag of a scene that is drawn again for one radar alone; none where it is for all radars."""
    return Flags(0) if config.other_radars else Flags.REDRAWN


def _refuse_place(config: Config, person: Person, checks: RadarChecks) -> _Refusal:
    """Find why one of the people is outside the model, unless such scenes are kept."""
    invalid, check = checks.invalid, checks.decisive
    if invalid is None or (config.on_invalid == "keep" and not check.too_close):
        return _Refusal(None, CROWDED)
    return _Refusal(invalid + _describe_place(person), _suggest_room(person, check))


def find_crowded(scene: Scene, last: int | None = None) -> int | None:
    """Find the first of `people` whose torso comes within TORSOS_APART_M of another's.

    Torsos are compared horizontally, 50 times a second.

    Args:
        last: number of the last one who is compared; None for all.

    Returns:
        The person's number; None where nobody does, or where no body can do what is drawn.
    """
    if len(scene.people) == 1:
        return None
    seconds = scene.people[0].seconds
    t, torsos = np.linspace(0, seconds, int(GRID_HZ * seconds) + 2), list[Float]()
    for person in scene.people:
        if last is not None and person.number > last:
            break
        try:
            torso = moving(person).torso(t)[:2, 0]
        except OutOfReachError:
            return None
        if any(np.hypot(*(torso - other)).min() < TORSOS_APART_M for other in torsos):
            return person.number
        torsos.append(torso)
    return None


def _key_prefix(person: Person) -> str:
    """Return the prefix of a person's keys in the config; "" for the first person."""
    return f"people.{person.number - 1}." if person.number else ""


def _describe_place(person: Person) -> str:
    """Describe where a person was drawn, as the end of a sentence."""
    section = f"{_key_prefix(person)}motion.{_place_section(person)}"
    keys = zip(("range_m", "cross_range_m"), person.place, strict=True)
    return f", with {', '.join(f'{section}{key} = {x:.4g}' for key, x in keys)}"


def _place_section(person: Person) -> str:
    """Section of `motion` that says where a person is, with a dot; "" for `motion` itself."""
    return "place." if person.motion.range_m is None else ""


def describe_crowd(number: int) -> str:
    """Describe the collision of one of `people` with somebody."""
    return f"people.{number - 1} comes within {TORSOS_APART_M} m of another person"


def _suggest_room(person: Person, check: SceneCheck) -> str:
    """Name the keys that would give a person room to move."""
    prefix, section = _key_prefix(person), f"motion.{_place_section(person)}"
    keys = f"{prefix}{section}range_m and {prefix}{section}cross_range_m"
    if not check.outside[1]:
        return f"{keys} should leave room"
    human = person.number or person.config.motion.model == "human"
    turns = human and "walking" in person.activity.movements and not person.motion.walking.lane_m
    turn = f"{prefix}motion.walking.lane_m lets people turn round; " if turns else ""
    return f"{turn}{keys}, room.box_m and duration_s should leave room"


def suggest_cure(person: Person, check: SceneCheck) -> str:
    """Name the keys that would make another scene of this one."""
    config = person.config
    if check.outside[1] and not check.too_close:
        return _suggest_room(person, check)
    if check.too_close and check.closest.joint.startswith("reflector "):
        return "room.reflectors should be elsewhere"
    is_board = isinstance(config.radar, ArrayRadar)
    range_key = f"motion.{_place_section(person)}range_m"
    if check.flags & Flags.HALF_BAND and is_board and not check.too_close:
        return f"a smaller {range_key} stays in the range that the board's .cfg sees"
    if config.on_invalid == "redraw" and check.flags & Flags.HALF_BAND and not check.too_close:
        impulse = isinstance(config.radar, ImpulseRadar)
        longer = "radar.profile_m that ends later" if impulse else "smaller radar.bandwidth_hz"
        return f"a {longer} reaches farther, a smaller {range_key} leaves room"
    if config.on_invalid == "redraw":
        return f"{range_key} and motion.angle_deg should leave people room"
    return "on_invalid: redraw draws such scenes again"
