"""Motion, body and aspect of a person in a scene."""

from dataclasses import fields
from math import radians

import numpy as np

from radhar_cli.echo.bodies.segment_paths import Body
from radhar_cli.motion.activities.activity import STREAM
from radhar_cli.motion.paper.activities import Timing
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.motion.protocol import Motion, ScattererSubset, cache_motion
from radhar_cli.motion.segments import landmark_names, segments_between, thickness
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.propagation import Antennas
from radhar_cli.scene.radar import antennas_of
from radhar_cli.scene.scene import Person, Scene

SHOULDERS = ("right_shoulder", "left_shoulder")


def motion_of(person: Person) -> Motion:
    """Make a person's motion: by the activity's own function, its files, or the model of `motion`.

    Raises:
        MotionFileError: a motion file cannot be used.
    """
    if person.activity.motion is not None:
        return person.activity.motion(person)
    if person.config.files_of(person.activity) is not None:
        from radhar_cli.scene.motion_files import file_motion

        return file_motion(person)
    if person.activity.is_nobody and person.motion.model != "human":
        return _stand_still(person)
    if person.activity.slug == STREAM:
        from radhar_cli.scene.streams import stream_motion

        return stream_motion(person)
    if person.motion.model == "human":
        from radhar_cli.scene.people import human_motion  # slow to import

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


def aspect_of(motion: Motion, antennas: Antennas, t: Float) -> Float:
    """Angle from where a person faces to the middle of the antennas, in the horizontal plane, rad.

    A person faces square to the line of the shoulders, their left being to the left. Someone at
    aspect 0 faces the radar, at pi or -pi has their back to it; it is positive where the radar is
    to their left.

    Args:
        t: times [M], s.

    Returns:
        Angles [M] from -pi to pi; NaN where no shoulders are known.
    """
    if not set(SHOULDERS) <= set(motion.names):
        return np.full(t.size, np.nan)
    positions, torso = motion.positions(t), motion.torso(t)[:2, 0]
    right, left = (positions[:2, motion.names.index(name)] for name in SHOULDERS)
    to_left = left - right
    facing = np.arctan2(-to_left[0], to_left[1])
    to_radar = np.mean(antennas.places, axis=0)[:2, None] - torso
    angle = np.arctan2(to_radar[1], to_radar[0]) - facing
    wrapped: Float = np.arctan2(np.sin(angle), np.cos(angle))
    return wrapped


def aspect_at_middle(scene: Scene, person: Person) -> float:
    """Aspect of a person of a scene to its radar in the middle of the recording, rad."""
    t = np.array([scene.seconds / 2])
    return float(aspect_of(moving(person), antennas_of(scene), t)[0])
