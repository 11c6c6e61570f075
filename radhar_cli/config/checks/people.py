"""People, classes and movements that do not fit together."""

from collections.abc import Iterator

from radhar_cli.config.first_level import Request
from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.motion.activities.activity import ACTIVITIES, STREAM, activity_named, own_activities
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.numerics.rounding import show_beside
from radhar_cli.schema.annotations import Limits, People, annotations, at, of_kind
from radhar_cli.schema.number import MAX_NUMBER, support
from radhar_cli.schema.section import PerActivity, Problem, for_activity
from radhar_cli.schema.twelve import DEFAULT, TWELVE


def people_problems(c: Request) -> Iterator[Problem]:
    """Keys of `people` that other people in a scene cannot have."""
    if c.people and c.motion.model == "paper":
        right = "should be empty with motion.model: paper, where one person is the sample"
        yield Problem("people", len(c.people), right)
        return
    for number, person in enumerate(c.people, 1):
        key = f"people.{number - 1}"
        if person.motion.model != "human":
            yield Problem(f"{key}.motion.model", person.motion.model, "should be human")
            continue
        try:
            activities = c.activities_of(number)
        except ValueError as error:
            yield Problem(f"{key}.activity", ", ".join(person.names), str(error))
            continue
        if any(a.is_nobody for a in activities):
            right = f"should be what somebody does; {key}.share is how often they are there"
            yield Problem(f"{key}.activity", NOBODY, right)
            continue
        files = [a.slug for a in activities if c.files_of(a) is not None]
        if files:
            yield Problem(f"{key}.activity", files[0], "should be a movement, not motion files")
            continue
        for config in _configs_of_person(c, number, [a.slug for a in activities]):
            for problem in human_problems(config):
                yield problem._replace(key=f"{key}.{problem.key}")


def _configs_of_person(c: Request, number: int, slugs: list[str]) -> Iterator[Request]:
    """Yield configs of one of `people`: of their streams, and of their other activities."""
    config = c.of_person(number)
    if STREAM in slugs:
        yield config
    if others := tuple(slug for slug in slugs if slug != STREAM):
        yield config.model_copy(update={"activities": others, "stream": None})


def class_problems(c: Request) -> Iterator[Problem]:
    """Classes that the model of motion cannot make."""
    model = c.motion.model
    for slug, section in c.classes.items():
        is_nobody = isinstance(section, SequenceConfig) and section.sequence == (NOBODY,)
        if model != "human" and isinstance(section, SequenceConfig) and not is_nobody:
            right = f"should have files with motion.model: {model}; sequences are of people (human)"
            yield Problem(f"classes.{slug}", list(section.written), right)
    if model == "paper":
        for activity in c.chosen_activities:
            known = (NOBODY, *c.classes, *TWELVE)
            if activity.slug in MOVEMENTS and activity.slug not in known:
                right = "is a movement of people, which motion.model: human makes"
                yield Problem("activities", activity.slug, right)
    if model != "file":
        return
    for activity in c.chosen_activities:
        if activity.is_nobody:
            continue
        if activity.motion is None and activity.slug not in c.classes:
            right = "should have files of it under classes, or motion.model: human makes it"
            yield Problem("activities", activity.slug, right)


def unknown_activities(c: Request) -> Iterator[Problem]:
    """Names under `per_activity` that are neither an activity nor a user-defined class."""
    classes = c.own_activities
    activities = (*ACTIVITIES, *classes.values(), *own_activities())
    chosen = {activity.slug for activity in c.chosen_activities}
    names = {DEFAULT, *MOVEMENTS, *chosen, *(activity.slug for activity in activities)}
    keys = ["samples_per_class"]
    of_people = [f"people.{n}." for n in range(len(c.people))]
    of_movement = [key for key in annotations(Request) if key.startswith(("motion.", "timing."))]
    keys += [f"{whose}{key}" for whose in ("", *of_people) for key in of_movement]
    for key in keys:
        value = at(c, key)
        for slug, number in value.per_activity.items() if isinstance(value, PerActivity) else ():
            if slug in names:
                continue
            try:
                meant = activity_named(slug, classes).slug
                named = meant in value.per_activity
                advice = f"is {meant}, named here, too" if named else f"should be called {meant}"
            except ValueError as error:
                advice = str(error)
            yield Problem(f"{key}.per_activity.{slug}", number, advice)


# Where the motion of people holds, {key: (least, most)}; beyond, legs would be too short.
_limits: tuple[tuple[str, Limits | People], ...] = (
    *of_kind(Request, Limits),
    *of_kind(Request, People),
)


HUMAN_LIMITS = {key: (one.low, one.high) for key, one in _limits if one.high < MAX_NUMBER}


def human_problems(c: Request) -> Iterator[Problem]:
    """Numbers beyond the abilities of people, of the activities that depend on them."""
    for key, (low, high) in HUMAN_LIMITS.items():
        number = at(c, key)
        users = [one for one in c.chosen_activities if c.depends_on(one, key)]
        if number is None or not users:
            continue
        ends = [support(for_activity(number, one)) for one in users]
        smallest, largest = min(end[0] for end in ends), max(end[1] for end in ends)
        if smallest < low or largest > high:
            right = f"should be from {low:g} to {high:g} with motion.model: human"
            reach = f"{show_beside(smallest, low)} to {show_beside(largest, high)}"
            right = f"{right} (this one reaches from {reach})"
            yield Problem(key, number, right)
