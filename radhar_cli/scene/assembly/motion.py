"""Motion and body of a person in a scene."""

from dataclasses import fields
from math import radians

from radhar_cli.echo.bodies.segment_paths import Body
from radhar_cli.motion.activities.activity import STREAM
from radhar_cli.motion.paper.activities import Timing
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.motion.protocol import Motion, ScattererSubset, cache_motion
from radhar_cli.motion.segments import landmark_names, segments_between, thickness
from radhar_cli.scene.scene import Person


def motion_of(person: Person) -> Motion:
    """Make a person's motion: by the activity's own function, its files, or the model of `motion`.

    Raises:
        MotionFileError: a motion file cannot be used.
    """
    if person.activity.motion is not None:
        return person.activity.motion(person)
    if person.config.files_of(person.activity) is not None:
        from radhar_cli.scene.assembly.motion_files import file_motion

        return file_motion(person)
    if person.activity.is_nobody and person.motion.model != "human":
        return _stand_still(person)
    if person.activity.slug == STREAM:
        from radhar_cli.scene.assembly.streams import stream_motion

        return stream_motion(person)
    if person.motion.model == "human":
        from radhar_cli.scene.assembly.people import human_motion  # slow to import

        return human_motion(person)
    return _paper_body(person)


def moving(person: Person) -> Motion:
    """`motion_of`, built once a person; its positions are remembered."""
    if "motion" not in person.held:
        person.held["motion"] = cache_motion(motion_of(person))
    motion: Motion = person.held["motion"]
    return motion


def body_of(person: Person, motion: Motion) -> Body:
    """Make the body of a person, with the segments that the joints of their motion have."""
    body_motion = motion.motion if isinstance(motion, ScattererSubset) else motion
    stature, weight = person.subject.height_m, person.subject.weight_kg
    return Body(
        body_motion,
        segments_between(landmark_names(body_motion)),
        stature,
        thickness(stature, weight),
    )


def _stand_still(person: Person) -> Motion:
    """Motion of a person who stands still: noise and gates of an empty scene refer to it."""
    from radhar_cli.motion.human.idle import Idle
    from radhar_cli.motion.human.motion import HumanMotion
    from radhar_cli.motion.human.physique import Physique
    from radhar_cli.motion.movements.standing import Stand

    motion, physique = person.motion, Physique(person.subject.height_m)
    start, heading = person.place, radians(motion.angle_deg)
    return HumanMotion(physique, (Stand(),), start, heading, 0.0, person.seconds, Idle(physique))


def _paper_body(person: Person) -> PaperBody:
    subject, motion, timing = person.subject, person.motion, person.timing
    return PaperBody(
        activity=person.activity.usual_slug,
        height=subject.height_m,
        weight=subject.weight_kg,
        start=person.place,
        angle=radians(motion.angle_deg),
        gait=motion.paper.make_gait(motion.rotating.turn_deg, motion.walking.speed_mps),
        timing=Timing(**{one.name: getattr(timing, f"{one.name}_s") for one in fields(Timing)}),
    )
