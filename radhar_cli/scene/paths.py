"""A scene and a motion -> paths, from joints or from segments as `body:` has it."""

from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from radhar_cli.echo import compiled
from radhar_cli.echo.bodies.motion_paths import (
    MotionPaths,
    NothingPath,
    Shade,
    ShadowedPaths,
    SumOfPaths,
)
from radhar_cli.echo.bodies.person_boxes import JOINTS, box_of_stature, boxes_of_body
from radhar_cli.echo.bodies.segment_paths import Points, SegmentPaths, draw_points, point_counts
from radhar_cli.echo.bodies.surface_paths import FACING_DBSM, SurfacePaths, draw_surface
from radhar_cli.echo.paths import PathSource
from radhar_cli.motion.protocol import Motion, ScattererSubset, cache_motion, cached_result
from radhar_cli.motion.reflectors import Reflectors
from radhar_cli.motion.segments import (
    Landmarks,
    Segment,
    landmark_names,
    segments_between,
    segments_of_joint,
    thickness,
)
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.person_shadow import BodyBox
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.room import Leg
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.motion import body_of
from radhar_cli.scene.room import ways_of
from radhar_cli.scene.scene import Person, Scene

POINTS = 14  # of a surface


class OwnedPaths(NamedTuple):
    """Paths, and whose echo they are.

    Attributes:
        source: the paths.
        person: number of the person; 0 is the sample's own, -1 the things in the room.
        legs: ways of the transmitter's leg and of the receiver's leg.
    """

    source: PathSource
    person: int
    legs: tuple[Leg, Leg]


class Link(NamedTuple):
    """Antennas, wall and waveform of the paths of one channel.

    Attributes:
        antennas: antennas between which they run.
        wall: wall between, or None.
        waveform: waveform of the radar; its duration and window say how many points segments have.
        first: antennas of the first channel of an array, all channels of which see the same points
            of a body; None where there is one channel.
    """

    antennas: Antennas
    wall: Wall | None
    waveform: Waveform
    first: Antennas | None = None

    def trace_motion(self, motion: Motion | Reflectors) -> MotionPaths:
        """Make the paths of the scatterers of a motion."""
        return MotionPaths(motion, self.antennas, self.waveform.fc, self.wall)


def sum_of_paths(sources: list[OwnedPaths]) -> PathSource:
    """Combine the paths of several sources into one source."""
    if len(sources) == 1:
        return sources[0].source
    return SumOfPaths(tuple(owned.source for owned in sources))


def make_path_sources(
    scene: Scene,
    motions: tuple[Motion, ...],
    link: Link,
    room: Reflectors | None = None,
) -> list[OwnedPaths]:
    """Make the paths of everything in a scene: of people, and of the things in the room.

    Where there are none, as in an empty scene without reflectors, there is a path of no power.
    """
    sources = [] if scene.is_empty else trace_people(scene, motions, link)
    if room is not None:
        sources.append(OwnedPaths(link.trace_motion(room), -1, link.antennas.legs))
    if not sources:
        sources.append(OwnedPaths(NothingPath(link.antennas), -1, link.antennas.legs))
    return sources


def trace_people(
    scene: Scene, motions: tuple[Motion, ...], link: Link, mirrored: bool = True
) -> list[OwnedPaths]:
    """Make the paths of people.

    They shadow each other, unless `body.shadowing` is false. By way of a room's faces they are
    there again, unshadowed, unless not `mirrored`.

    Args:
        motions: motions of its people, or of parts of one.
        link: antennas, wall and waveform of a channel.
        mirrored: whether people are there again by way of the room's faces.
    """
    antennas, people = link.antennas, scene.people
    images = [antennas.by_way(*legs) for legs in ways_of(scene)] if mirrored else []
    one_motion_per_person = len(people) == len(motions)  # not so where one body is seen in parts
    several = one_motion_per_person and len(people) > 1 and scene.config.body.shadowing
    if several or images:  # asked for the same times again and again
        motions = tuple(map(cache_motion, motions))
    shades = list(map(make_shade, people, motions)) if several else []
    sources: list[OwnedPaths] = []
    for number, motion in enumerate(motions):
        mover = people[min(number, len(people) - 1)]
        stream_number = 0 if one_motion_per_person else number  # streams are the person's own
        body_sources = _trace_body(mover, motion, link, stream_number)
        shades_of_others = tuple(s for place, s in enumerate(shades) if place != number)
        owner = people[number].number if one_motion_per_person else number
        for source in body_sources:
            seen_past: PathSource = source
            if shades_of_others:
                seen_past = ShadowedPaths(source, shades_of_others, link.waveform.fc)
            sources.append(OwnedPaths(seen_past, owner, antennas.legs))
        sources += [
            OwnedPaths(replace(source, antennas=image), owner, image.legs)
            for image in images
            for source in body_sources
        ]
    return sources


def _trace_body(
    person: Person, motion: Motion, link: Link, number: int
) -> list[SegmentPaths | SurfacePaths | MotionPaths]:
    """Make the paths of a body: of its segments or surfaces, and of joints without a segment."""
    if person.scene.config.body.scatterers == "points":
        return [link.trace_motion(motion)]
    sources: list[SegmentPaths | SurfacePaths | MotionPaths] = []
    segments = make_body_paths(person, motion, link, number)
    if segments is not None:
        sources.append(segments)
    other_joints = _without_segments(motion)
    if other_joints is not None:
        sources.append(link.trace_motion(other_joints))
    return sources


def make_shade(person: Person, motion: Motion) -> Shade:
    """Make the shade with which a person hides others."""
    return Shade(motion, partial(_boxes_at, motion, person))


def _boxes_at(motion: Motion, person: Person, t: Float) -> tuple[BodyBox, ...]:
    """Boxes of a person at times t [M] (s)."""
    stature = person.subject.height_m
    width = thickness(stature, person.subject.weight_kg)

    def make_boxes() -> tuple[BodyBox, ...]:
        positions, names = motion.positions, motion.names
        if person.scene.config.body.scatterers != "points" and isinstance(motion, Landmarks):
            # Their own echo asks for these, too.
            positions, names = motion.landmark_positions, motion.landmarks
        if not set(JOINTS) <= set(names):
            return (box_of_stature(motion.torso(t)[:, 0], stature, width),)
        p = positions(t)
        points = {name: p[:, names.index(name)] for name in JOINTS}
        return boxes_of_body(points, stature, width)

    return cached_result(motion, "boxes", t, make_boxes)


def make_body_paths(
    person: Person, motion: Motion, link: Link, number: int = 0
) -> SegmentPaths | SurfacePaths | None:
    """Make the paths of the segments of a motion, or of their surfaces (`body.scatterers`).

    Args:
        person: person who moves.
        motion: their motion, or a `ScattererSubset` of it.
        link: antennas, wall and waveform of a channel.
        number: number of the motion among several, which names random streams.

    Returns:
        The paths, or None where no segment belongs to the joints.
    """
    body, config = body_of(person, motion), person.scene.config
    segments = sorted(
        {n for joint in motion.names for n in segments_of_joint(joint, body.segments)}
    )
    if not segments:
        return None
    largest_count, numbers = config.body.points_per_segment, tuple(segments)
    antennas, wall, waveform, first = link
    fields = _draw_fields(person, body.segments)
    if config.body.scatterers == "surfaces":
        rng = person.stream(f"surface/{number}")
        surface = draw_surface(len(body.segments), min(largest_count, POINTS), rng)
        if fields is not None:
            surface = surface._replace(weight=surface.weight * fields[surface.segment])
        return SurfacePaths(body, surface, antennas, waveform.fc, wall, numbers)
    duration, prf = waveform.duration, waveform.prf
    window = config.processing.make_frames(duration, prf, waveform.f0).length / prf
    counts = point_counts(
        body, first or antennas, waveform.wavelength, window, duration, largest_count
    )
    points = tuple(
        _taper(draw_points(count, person.own_stream(f"body/{number}/{segment.name}")))
        for segment, count in zip(body.segments, counts, strict=True)
    )
    if fields is not None:
        points = tuple(
            one._replace(share=one.share * field) for one, field in zip(points, fields, strict=True)
        )
    fast = compiled.pays(sum(counts[s] for s in numbers) * waveform.n_pulses)
    return SegmentPaths(
        body, points, antennas, waveform.fc, wall, config.body.shadowing, numbers, fast
    )


def _draw_fields(person: Person, segments: tuple[Segment, ...]) -> Float | None:
    """Draw the fields [S] of a person's segments relative to the usual; None if all are usual.

    Left and right are alike.
    """
    sd = person.scene.config.body.cross_section_sd_db
    if not sd:
        return None
    kinds = [segment.name.split("_")[-1] for segment in segments]
    rng = person.own_stream("body/cross_sections")
    level = dict(zip(FACING_DBSM, sd * rng.standard_normal(len(FACING_DBSM)), strict=True))
    return 10 ** (np.array([level[kind] for kind in kinds]) / 20)


def _taper(points: Points) -> Points:
    """Points whose powers go with the width of the ellipsoid at their place, 0 at its ends."""
    share = points.share * (1 - 4 * points.along * points.along) ** 0.25
    return points._replace(share=share / np.sqrt((share * share).sum()))


def _without_segments(motion: Motion) -> Motion | None:
    """Keep the joints of a motion that no segment stands for, which go on being points."""
    body_motion = motion.motion if isinstance(motion, ScattererSubset) else motion
    segments = segments_between(landmark_names(body_motion))
    alone = tuple(
        body_motion.names.index(name)
        for name in motion.names
        if not segments_of_joint(name, segments)
    )
    if len(alone) == len(body_motion.names):
        return motion
    return ScattererSubset(body_motion, alone) if alone else None
