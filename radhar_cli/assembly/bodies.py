"""A scene and a motion -> paths, from joints or from segments as `body:` has it."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from radhar_cli.assembly.physics import body_of, frames_of, ways_of
from radhar_cli.bodies.motion_paths import MotionPaths, Shade, ShadowedPaths, SumOfPaths
from radhar_cli.bodies.segment_paths import Points, SegmentPaths, draw_points, point_counts
from radhar_cli.bodies.surface_paths import SurfacePaths, draw_surface
from radhar_cli.echo import compiled
from radhar_cli.echo.paths import PathSource
from radhar_cli.motion.protocol import Motion, ScattererSubset, cache_motion
from radhar_cli.motion.reflectors import Reflectors
from radhar_cli.motion.segments import (
    landmark_names,
    segments_between,
    segments_of_joint,
    thickness,
)
from radhar_cli.radar.person_shadow import HALF_WIDTH_M
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.room import Leg
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scene import Person, Scene

POINTS = 14  # of a surface


class OwnedPaths(NamedTuple):
    """Paths, and whose echo they are.

    Attributes:
        source: the paths.
        person: number of the person; 0 is the sample's own, -1 what stands in the room.
        legs: ways of the transmitter's leg and of the receiver's leg.
    """

    source: PathSource
    person: int
    legs: tuple[Leg, Leg]


def sum_of_paths(sources: list[OwnedPaths]) -> PathSource:
    """Combine the paths of several sources into one source."""
    if len(sources) == 1:
        return sources[0].source
    return SumOfPaths(tuple(owned.source for owned in sources))


def sources_of(
    scene: Scene,
    motions: tuple[Motion, ...],
    antennas: Antennas,
    wall: Wall | None,
    waveform: Waveform,
    room: Reflectors | None = None,
    mirrored: bool = True,
    first: Antennas | None = None,
) -> list[OwnedPaths]:
    """Make the paths of everything in a scene: of who moves, and of what stands in the room.

    People shadow each other, unless `body.shadowing` is false. By way of a room's faces they are
    there again, unshadowed, unless not `mirrored`.

    Args:
        scene: what is simulated.
        motions: motions of its people, or of parts of one.
        antennas: antennas between which the paths run.
        wall: wall between, or None.
        waveform: waveform whose duration and window say how many points segments have.
        room: what stands in the room.
        mirrored: whether people are there again by way of the room's faces.
        first: antennas of the first channel of an array, all channels of which see the same points
            of a body; None where there is one channel.
    """
    sources: list[OwnedPaths] = []
    images = [antennas.by_way(*way) for way in ways_of(scene)] if mirrored else []
    people = scene.people
    one_motion_per_person = len(people) == len(motions)  # not so where one body is seen in parts
    several = one_motion_per_person and len(people) > 1 and scene.config.body.shadowing
    if several or images:  # asked for the same times again and again
        motions = tuple(map(cache_motion, motions))
    shades = [shade_of(*one) for one in zip(people, motions, strict=True)] if several else []
    for number, motion in enumerate(motions):
        body_sources: list[SegmentPaths | SurfacePaths | MotionPaths] = []
        other_joints: Motion | None = motion
        if scene.config.body.scatterers != "points":
            mover = people[min(number, len(people) - 1)]
            stream_number = 0 if one_motion_per_person else number  # streams are the person's own
            parts = body_paths(mover, motion, antennas, wall, waveform, stream_number, first)
            body_sources += [parts] if parts else []
            other_joints = _without_segments(motion)
        if other_joints is not None:
            body_sources.append(MotionPaths(other_joints, antennas, waveform.fc, wall))
        others = tuple(shade for place, shade in enumerate(shades) if place != number)
        person = people[number].number if one_motion_per_person else number
        straight = [
            ShadowedPaths(source, others, waveform.fc) if others else source
            for source in body_sources
        ]
        sources += [OwnedPaths(source, person, antennas.legs) for source in straight]
        sources += [
            OwnedPaths(replace(source, antennas=image), person, image.legs)
            for image in images
            for source in body_sources
        ]
    if room is not None:
        sources.append(
            OwnedPaths(MotionPaths(room, antennas, waveform.fc, wall), -1, antennas.legs)
        )
    return sources


def shade_of(person: Person, motion: Motion) -> Shade:
    """Make the shade with which a person hides others."""
    stature, weight = person.subject.height_m, person.subject.weight_kg
    of_points = person.scene.config.body.scatterers == "points"
    joints = motion.positions if of_points else getattr(motion, "landmark_positions", None)
    place = motion.torso
    if joints is not None and "torso" in motion.names:  # which their own echo asks for too
        torso = motion.names.index("torso")
        place = lambda t: joints(t)[:, torso : torso + 1]  # noqa: E731
    return Shade(motion, place, HALF_WIDTH_M * thickness(stature, weight), stature)


def body_paths(
    person: Person,
    motion: Motion,
    antennas: Antennas,
    wall: Wall | None,
    waveform: Waveform,
    number: int = 0,
    first: Antennas | None = None,
) -> SegmentPaths | SurfacePaths | None:
    """Make the paths of the segments of a motion, or of their surfaces (`body.scatterers`).

    Args:
        person: person who moves.
        motion: their motion, or a `ScattererSubset` of it.
        antennas: antennas between which the paths run.
        wall: wall between, or None.
        waveform: waveform whose duration and window say how many points segments have.
        number: number of the motion among several, which names random streams.
        first: antennas of the first channel of an array, which say how many points segments have;
            None for `antennas`.

    Returns:
        The paths, or None where no segment belongs to the joints.
    """
    body, config = body_of(person, motion), person.scene.config
    kept = tuple(
        sorted({n for joint in motion.names for n in segments_of_joint(joint, body.segments)})
    )
    if not kept:
        return None
    most, seen = config.body.points_per_segment, (antennas, waveform.fc, wall)
    if config.body.scatterers == "surfaces":
        rng = person.stream(f"surface/{number}")
        return SurfacePaths(
            body, draw_surface(len(body.segments), min(most, POINTS), rng), *seen, kept
        )
    duration, prf = waveform.duration, waveform.prf
    window = frames_of(config, duration, prf, waveform.f0).length / prf
    counts = point_counts(body, first or antennas, waveform.wavelength, window, duration, most)
    points = tuple(
        _tapered(draw_points(count, person.own_stream(f"body/{number}/{one.name}")))
        for one, count in zip(body.segments, counts, strict=True)
    )
    fast = compiled.pays(sum(counts[s] for s in kept) * waveform.n_pulses)
    return SegmentPaths(body, points, *seen, config.body.shadowing, kept, fast)


def _tapered(points: Points) -> Points:
    """Points whose powers go with the width of the ellipsoid at their place, 0 at its ends."""
    share = points.share * (1 - 4 * points.along * points.along) ** 0.25
    return points._replace(share=share / np.sqrt((share * share).sum()))


def _without_segments(motion: Motion) -> Motion | None:
    """Keep the joints of a motion that no segment stands for, which go on being points."""
    whole = motion.motion if isinstance(motion, ScattererSubset) else motion
    segments = segments_between(landmark_names(whole))
    alone = tuple(
        whole.names.index(name) for name in motion.names if not segments_of_joint(name, segments)
    )
    if len(alone) == len(whole.names):
        return motion
    return ScattererSubset(whole, alone) if alone else None
