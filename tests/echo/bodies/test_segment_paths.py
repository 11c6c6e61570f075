"""Paths of a body of segments: ranges, powers, counts, shadows; and both engines agree on them."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from helpers import reference as ref
from helpers.slow import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.echo import compiled
from radhar_cli.echo.bodies.segment_paths import (
    REFLECTANCE,
    Body,
    Points,
    SegmentPaths,
    draw_points,
    frame_of,
    point_counts,
    positions,
)
from radhar_cli.errors import SceneError
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.motion.protocol import ScattererSubset
from radhar_cli.motion.segments import SEGMENTS, Segment, segments_between
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.accelerators import installed
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.propagation import Aim, Antennas, boresight_axes
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.checks.warnings import scene_warnings
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.paths import Link, make_body_paths
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene
from radhar_cli.scene.single.simulate import simulate

FC = 77e9
AT_ORIGIN = Antennas((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0, 10.0)
APART = Antennas((0.0, -0.7, 0.1), (0.2, 0.7, -0.2), 2.0, 10.0)
MIDDLE = Points(np.zeros(1), np.zeros((2, 1)), np.ones(1))


@dataclass(frozen=True)
class Stick:
    """Two points whose places are any functions of time."""

    start: object
    end: object

    names = ("right_elbow", "right_knee")
    parents = (None, 0)
    breakpoints = phases = ()
    highest_frequency = 1.0

    def positions(self, t: Float) -> Float:
        ends = [np.array(end(t)) + np.zeros((3, t.size)) for end in (self.start, self.end)]
        return np.stack(ends, axis=1)

    def cross_sections(self, t: Float) -> Float:
        return np.ones((2, 1))

    torso = positions


def stick(start: object, end: object, radius: float = 0.05) -> Body:
    segment = Segment("stick", *Stick.names, radius, "right_elbow")
    return Body(Stick(start, end), (segment,), 1.75, 1.0)


def fixed(*p: float) -> object:
    return lambda t: [np.full_like(t, one) for one in p]


def paths_of(body: Body, points: Points, antennas: Antennas = AT_ORIGIN) -> SegmentPaths:
    return SegmentPaths(body, (points,), antennas, FC, None, False, (0,))


def surface(centre: Float, axis: Float, half: float, radius: float, count: int = 700) -> Float:
    """Points [3, count^2] of an ellipsoid of revolution."""
    axis = axis / np.linalg.norm(axis)
    one = np.cross(axis, [0.3, -0.5, 0.81])
    one /= np.linalg.norm(one)
    two = np.cross(axis, one)
    u, v = np.meshgrid(np.linspace(0, np.pi, count), np.linspace(0, 2 * np.pi, count))
    across = radius * np.sin(u) * (one[:, None, None] * np.cos(v) + two[:, None, None] * np.sin(v))
    p = centre[:, None, None] + axis[:, None, None] * half * np.cos(u) + across
    return p.reshape(3, -1)


@pytest.mark.parametrize("antennas", [AT_ORIGIN, APART], ids=["monostatic", "bistatic"])
@pytest.mark.parametrize("end", [(4.0, 0.3, 0.2), (4.4, 0.05, 0.0), (4.0, -0.4, -0.3)])
def test_a_single_point_is_the_nearest_of_the_surface(antennas, end):
    """To the curvature of the wave fronts: the tangent plane neglects half^2/2R."""
    start = np.array([4.0, 0.0, 0.0])
    found = paths_of(stick(fixed(*start), fixed(*end)), MIDDLE, antennas)(np.zeros(1))
    way = np.array(end) - start
    half = np.linalg.norm(way) / 2
    p = surface(start + way / 2, way, half, 0.05)
    legs = sum(
        np.linalg.norm(p - np.array(one)[:, None], axis=0) for one in (antennas.tx, antennas.rx)
    )
    assert found.delay[0, 0] * SPEED_OF_LIGHT == pytest.approx(legs.min(), abs=2 * half**2 / 4)


def test_amplitudes_are_those_of_the_cross_section():
    """Broadside at 5 m: A = lambda sqrt(sigma)/(4 pi)^1.5/R^2, sigma = |Gamma|^2 pi c^2."""
    body = stick(fixed(5, 0, -0.2), fixed(5, 0, 0.2))
    found = paths_of(body, MIDDLE)(np.zeros(1))
    sigma = REFLECTANCE * np.pi * 0.2**2
    expected = SPEED_OF_LIGHT / FC * np.sqrt(sigma) / (4 * np.pi) ** 1.5 / 25
    assert found.amplitude[0, 0] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("start", "end", "clear"),
    [((5, 0, 0), (5.4, 0, 0), 5.0), ((5, 0, -0.2), (5, 0, 0.2), 4.95)],
    ids=["end on", "broadside"],
)
def test_an_antenna_is_clear_of_a_limb_by_its_distance_less_a_semi_axis(start, end, clear):
    body = stick(fixed(*start), fixed(*end))
    assert body.clearance(AT_ORIGIN.tx, np.zeros(1))[0, 0] == pytest.approx(clear)


def test_a_limb_flashes_when_it_is_broadside():
    """A swing from pointing at the radar to broadside: 20 log (c/r)^2 = 24 dB."""
    angle = lambda t: np.pi / 2 * t  # noqa: E731
    body = stick(
        lambda t: [5 - 0.2 * np.cos(angle(t)), 0 * t, -0.2 * np.sin(angle(t))],
        lambda t: [5 + 0.2 * np.cos(angle(t)), 0 * t, 0.2 * np.sin(angle(t))],
    )
    amplitude = paths_of(body, MIDDLE)(np.linspace(0, 1, 50)).amplitude[0]
    assert (np.diff(amplitude) > 0).all()
    assert 20 * np.log10(amplitude[-1] / amplitude[0]) == pytest.approx(24.1, abs=0.1)


def test_points_lie_where_a_rigid_body_has_them():
    """Ranges from vectors, against the products that the package uses."""
    rng = np.random.default_rng(0)
    points = draw_points(20, rng)
    turn = lambda t: np.stack([np.cos(2 * t), np.sin(3 * t), np.sin(t) * np.cos(t)])  # noqa: E731
    place = np.array([[4.0], [0.2], [0.0]])
    body = stick(lambda t: place + turn(t), lambda t: place + 1.3 * turn(t))
    source, t = paths_of(body, points, APART), np.linspace(0, 2, 40)
    frame = frame_of(body.at(t))
    p = positions(frame, 0, points)
    legs = sum(
        np.linalg.norm(p - np.array(one)[:, None, None], axis=0) for one in (APART.tx, APART.rx)
    )
    apart = legs - source(t).delay * SPEED_OF_LIGHT  # the same for all: the surface is nearer
    assert np.abs(apart - apart[:1]).max() < 1e-13
    assert apart.min() > 0
    centre, axis = (np.stack(part)[:, 0] for part in (frame.centre, frame.axis))
    along = np.einsum("inm,im->nm", p - centre[:, None], axis)
    assert np.abs(np.diff(along, axis=0)).max() < 2 * np.ptp(points.along) / 19


class TestPoints:
    @pytest.mark.parametrize("count", [1, 2, 7, 20])
    def test_points_share_the_power_and_cover_the_length(self, count):
        points = draw_points(count, np.random.default_rng(1))
        assert (points.share**2).sum() == pytest.approx(1)
        assert (np.diff(points.along) > 0).all()
        edges = np.linspace(-0.5, 0.5, count + 1)
        assert ((points.along >= edges[:-1]) & (points.along <= edges[1:])).all()
        assert np.abs(points.across).max() <= 0.04

    def test_a_single_point_is_the_middle(self):
        assert all(np.array_equal(*both) for both in zip(draw_points(1, None), MIDDLE, strict=True))


@dataclass(frozen=True)
class Loose:
    """Joints that each move about on their own; the first ones stand still."""

    seed: int
    still: int

    names = JOINTS
    parents = (None,) * len(JOINTS)
    breakpoints = phases = ()
    highest_frequency = 1.0

    def positions(self, t: Float) -> Float:
        rng = np.random.default_rng(self.seed)
        place = rng.uniform([[2], [-1], [-1]], [[5], [1], [1]], (3, len(JOINTS)))
        moved = rng.uniform(-0.3, 0.3, (3, len(JOINTS)))
        moved[:, : self.still] = 0
        return place[..., None] + moved[..., None] * np.sin(2 * np.pi * t)

    def cross_sections(self, t: Float) -> Float:
        return np.ones((len(JOINTS), 1))

    torso = positions


PLACES = st.tuples(*(st.floats(-1, 1) for _ in range(3)))


@st.composite
def loose_bodies(draw) -> SegmentPaths:
    motion = Loose(draw(st.integers(0, 2**32 - 1)), draw(st.sampled_from([0, 5, len(JOINTS)])))
    segments = segments_between(JOINTS)
    rng = np.random.default_rng(motion.seed)
    points = tuple(draw_points(int(count), rng) for count in rng.integers(1, 21, len(segments)))
    tx = draw(PLACES)
    array = Antennas(tx, draw(st.sampled_from([tx, draw(PLACES)])), 2.0, 10.0)
    if draw(st.booleans()):
        array = replace(array, aim=Aim(tx, boresight_axes(0.2, 0.1), (40.0, 20.0)))
    kept = draw(st.sets(st.integers(0, len(segments) - 1), min_size=1))
    body, fc = (
        Body(motion, segments, 1.75, draw(st.floats(0.7, 1.5))),
        draw(st.sampled_from([2e9, FC])),
    )
    return SegmentPaths(body, points, array, fc, None, draw(st.booleans()), tuple(sorted(kept)))


@pytest.mark.skipif(installed("numba") is None, reason="needs radhar[fast]")
class TestCompiled:
    @given(source=loose_bodies(), count=st.integers(1, 300))
    @settings(max_examples=examples(60))
    def test_paths_are_those_of_numpy(self, source, count):
        """Delays to rounding; amplitudes to 1e-8 of what is there without shadows."""
        t = np.linspace(0, 1, count)
        right, found = source(t), replace(source, compiled=True)(t)
        assert np.abs(found.delay - right.delay).max() < 1e-6 / FC
        lit = replace(source, shadowing=False)(t).amplitude
        assert (np.abs(found.amplitude - right.amplitude) < 1e-8 * lit).all()

    @given(source=loose_bodies(), count=st.integers(1, 300), seed=st.integers(0, 1000))
    @settings(max_examples=examples(30))
    def test_no_instant_depends_on_others(self, source, count, seed):
        """So that what stands still does so to the last digit."""
        source, t = replace(source, compiled=True), np.linspace(0, 1, 300)
        some = np.random.default_rng(seed).choice(300, count)
        every, alone = source(t), source(t[some])
        assert np.array_equal(every.delay[:, some], alone.delay)
        assert np.array_equal(every.amplitude[:, some], alone.amplitude)
        if source.body.motion.still == len(JOINTS):
            assert (every.delay == every.delay[:, :1]).all()

    def test_is_used_for_large_recordings(self, monkeypatch):
        for terms in (2**10, 2**30):
            monkeypatch.setattr(compiled, "MIN_TERMS", terms)
            source = record(scene_of("walking"), ["paths"])["paths"]
            assert source.compiled == (terms == 2**10)


class TestCounts:
    WAVELENGTH, WINDOW = SPEED_OF_LIGHT / FC, 0.06

    def counts(self, speed: float, most: int = 1000) -> int:
        body = stick(fixed(5, 0, 0), lambda t: [5.3 + speed * t, 0 * t, 0 * t])
        found = point_counts(body, AT_ORIGIN, self.WAVELENGTH, self.WINDOW, 2.0, most)
        return found[0]

    @pytest.mark.parametrize("speed", [0.0, 0.02, 0.5, 2.0])
    def test_one_point_a_doppler_cell(self, speed):
        cells = 2 * speed * self.WINDOW / self.WAVELENGTH
        assert self.counts(speed) == max(1, int(np.ceil(cells)))

    def test_no_more_points_than_allowed(self):
        assert self.counts(2.0, 20) == 20


def config_of(**more: object) -> Config:
    document = {
        "snr_db": None,
        "duration_s": 1.5,
        "body": {"scatterers": "segments"},
        "radar": {"bandwidth_hz": 1e9, "prf_hz": 4000},
        "motion": {"range_m": 4.0, "angle_deg": 170.0},
        "processing": {"window_s": 0.06},
    }
    return Config.model_validate(document | more)


def scene_of(slug: str, **more: object) -> Scene:
    return draw_scene(config_of(**more), activity_named(slug), 0)


PAPER = {"motion": {"model": "paper", "range_m": 3.0, "angle_deg": 170.0}}
GHZ2 = {"radar": {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 400}}
CUBE = {"engine": {"kind": "cube"}}
CASES = {
    "walking": {},
    "kicking": {},
    "walking_to_falling": {"duration_s": 2.0, "timing": {"walk_stop_s": 0.5}},
    "body_rotating": PAPER,
    "sitting_down": GHZ2 | {"wall": {}},
}


@pytest.mark.parametrize(
    ("slug", "tolerance_db"),
    [("walking", -40), ("walking", -110), *((slug, -80) for slug in CASES)],
)
def test_the_direct_engine_keeps_its_tolerance(slug, tolerance_db):
    """Sigmoids of shadows and flashes of limbs included. 48 pulses may miss a burst of errors, but
    not one that comes near the tolerance."""
    more = CASES[slug]
    right = record(scene_of(slug, **more, **CUBE), ["signal"])["signal"].x[0, 0]
    engine = {"engine": {"tolerance_db": tolerance_db}}
    found = record(scene_of(slug, **more, **engine), ["signal", "accuracy"])
    error_db = ref.error_db(found["signal"].x[0, 0], right)
    assert error_db < tolerance_db
    assert error_db <= found["accuracy"].error_db < error_db + 16


def test_a_motionless_person_cancels_exactly():
    """The paper's S1 has no sway: in neither engine is anything left."""
    for engine in ({}, CUBE):
        scene = scene_of("stationary", **PAPER, **engine)
        assert not record(scene, ["signal"])["signal"].x[0, 0].any()


def test_points_are_as_strong_as_the_ellipsoid_is_wide():
    """Powers add up to 1; towards the ends of a segment there is less to scatter."""
    powers = {True: [], False: []}
    for index in range(6):
        scene = draw_scene(config_of(), activity_named("walking"), index)
        for points in record(scene, ["paths"])["paths"].points:
            assert (points.share**2).sum() == pytest.approx(1)
            if points.share.size > 10:
                for end in (True, False):
                    these = (np.abs(points.along) > 0.45) == end
                    powers[end] += list(points.share[these] ** 2 * points.share.size)
    # The mean width beyond 0.45 and within, over the mean of all: sqrt(1 - 4 x^2), x up to 1/2.
    assert np.mean(powers[True]) == pytest.approx(0.37, abs=0.1)
    assert np.mean(powers[False]) == pytest.approx(1.07, abs=0.05)


class TestDeterminism:
    def test_the_same_scene_has_the_same_points(self):
        first, second = (
            record(scene_of("walking"), ["signal"])["signal"].x[0, 0] for _ in range(2)
        )
        assert np.array_equal(first, second)

    def test_points_are_the_persons_and_differ_between_samples(self):
        split = {"split": {"by": "subject", "subjects": 2}}
        activity = activity_named("walking")

        def shares(index: int, **more: object) -> Float:
            scene = draw_scene(config_of(**more), activity, index)
            return record(scene, ["paths"])["paths"].points[5].share

        assert np.array_equal(shares(0, **split), shares(2, **split))
        assert not np.array_equal(shares(0, **split), shares(1, **split))
        assert not np.array_equal(shares(0), shares(2))

    def test_paths_do_not_depend_on_earlier_calls(self):
        source, t = record(scene_of("walking"), ["paths"])["paths"], np.linspace(0, 1.5, 33)
        whole = source(t)
        assert np.abs(source(t[5:9]).delay - whole.delay[:, 5:9]).max() < 1e-22
        assert source(t[5:9]).amplitude == pytest.approx(whole.amplitude[:, 5:9])


def test_a_walker_has_hundreds_of_points_at_77_GHz_and_few_at_2():
    def count(**more: object) -> int:
        return record(scene_of("walking", duration_s=3.0, **more), ["paths"])["paths"](
            np.zeros(1)
        ).delay.shape[0]

    assert 180 < count() <= 280
    assert 14 <= count(**GHZ2) < 40
    assert count(body={"scatterers": "segments", "points_per_segment": 1}) == 14


class TestRadarCrossSection:
    """Of a whole body: about -5 to 0 dBsm, whatever the number of points."""

    def dbsm(self, angle: float, **body: object) -> float:
        motion = {"motion": {"range_m": 30.0, "angle_deg": angle}}
        scene = scene_of("stationary", **motion, body={"scatterers": "segments"} | body)
        source = record(scene, ["paths"])["paths"]
        paths = source(np.linspace(0, 1, 20))
        wavelength = SPEED_OF_LIGHT / FC
        r = paths.delay * SPEED_OF_LIGHT / 2
        gain = source.antennas.gain
        sigma = (paths.amplitude * r**2 / gain / wavelength) ** 2 * (4 * np.pi) ** 3
        return 10 * np.log10(sigma.sum(axis=0).mean())

    @pytest.mark.parametrize("angle", [0.0, 90.0, 180.0])
    def test_it_is_that_of_a_person(self, angle):
        assert -7 < self.dbsm(angle) < 0

    def test_it_does_not_depend_on_the_number_of_points(self):
        one, many = (self.dbsm(180.0, points_per_segment=n) for n in (1, 40))
        assert one == pytest.approx(many, abs=0.1)

    def test_from_the_side_half_the_body_is_hidden(self):
        lit, shaded = (self.dbsm(90.0, shadowing=flag) for flag in (False, True))
        assert 0.5 < lit - shaded < 6


class TestOneJoint:
    def test_one_joint_echoes_alone_in_the_shadow_of_the_whole_body(self):
        scene = scene_of("walking")
        whole = record(scene, ["paths"])["paths"]
        person = motion_of(scene.people[0])
        one = ScattererSubset(person, (JOINTS.index("right_ankle"),))
        kept = record(scene, ["paths"], motions=(one,))["paths"]
        names = [part.name for part in SEGMENTS]
        assert [names[n] for n in kept.scattering] == ["right_shank", "right_foot"]
        t = np.linspace(0, 1.5, 40)
        sizes = [points.share.size for points in whole.points]
        first = sum(sizes[: names.index("right_shank")])
        some = slice(first, first + kept(t).delay.shape[0])
        # To rounding: few points are not worth compiling.
        assert kept(t).amplitude == pytest.approx(whole(t).amplitude[some], 1e-8)

    def test_echoes_of_all_joints_sum_to_the_body(self):
        """Echoes of single limbs sum to that of the body; hip and shoulders belong to the trunk."""
        config = config_of(duration_s=0.5)
        joints = [one for one in JOINTS if "shoulder" not in one and one != "hip"]
        parts = [simulate(config, "walking", joint=one, maps=()) for one in joints]
        whole = simulate(config, "walking", maps=())
        total = sum(part.signals["raw"].x for part in parts)
        assert ref.error_db(total, whole.signals["raw"].x) < -70
        assert np.array_equal(whole.truth.positions, parts[0].truth.positions)
        assert whole.truth.positions.shape[1:] == (13, 3)


@dataclass(frozen=True)
class WithSword(Stick):
    """A leg, and a point that no body has."""

    names = ("right_hip", "right_knee", "right_ankle", "sword")
    parents = (None, 0, 1, 0)

    def positions(self, t: Float) -> Float:
        x = 3 + 0.2 * np.sin(3 * t)
        return np.stack([np.stack([x + k / 9, 0 * t, 1 - k / 3 + 0 * t]) for k in range(4)], 1)

    def cross_sections(self, t: Float) -> Float:
        return np.array([[1.0], [1.0], [1.0], [7.0]])


def test_joints_without_a_segment_stay_points():
    scene = scene_of("walking")
    source = record(scene, ["paths"], motions=(WithSword(None, None),))["paths"]
    segments, points = source.sources
    assert [one.name for one in segments.body.segments] == ["right_thigh", "right_shank"]
    assert points.motion.names == ("sword",)
    assert points.motion.cross_sections(np.zeros(1)) == np.array([[7.0]])


def test_two_people_do_not_have_the_same_points():
    scene = scene_of("walking")
    one = motion_of(scene.people[0])
    both = record(scene, ["paths"], motions=(one, replace(one, start=(6.0, 1.0))))["paths"]
    assert len(both.sources) == 2
    shares = [source.points[6].share for source in both.sources]
    assert not np.array_equal(*shares)


WALL = Wall((1.5, 0, 1.25), (0.24, 5, 2.5), 6.0, 0.03)


def test_a_wall_delays_and_dims_every_point():
    scene = scene_of("walking")
    clear = record(scene, ["paths"])["paths"]
    walled = replace(clear, wall=WALL)
    t = np.linspace(0, 0.5, 5)
    extra = (walled(t).delay - clear(t).delay) * SPEED_OF_LIGHT
    # Two legs through 0.24 m of index 2.45, at up to some 30 degrees.
    assert 2 * 0.24 * 1.449 - 1e-3 <= extra.min() <= extra.max() < 2 * 0.24 * 1.449 * 1.25
    assert (walled(t).amplitude < clear(t).amplitude).all()
    assert not walled.smooth


class TestTooNear:
    def test_an_antenna_in_a_body_is_refused_by_name(self):
        scene = scene_of("stationary", motion={"range_m": 0.5, "angle_deg": 180.0})
        inside = scene.config.model_copy(
            update={"radar": scene.config.radar.model_copy(update={"tx_m": (0.5, 0.0, 1.2)})}
        )
        with pytest.raises(SceneError, match=r"trunk comes to 0 cm from the transmitter"):
            scene_warnings(replace(scene, config=inside))

    def test_an_antenna_in_a_body_has_finite_paths(self):
        scene = scene_of("stationary", motion={"range_m": 0.5, "angle_deg": 180.0})
        for place in ((0.5, 0.0, 1.2), (0.5, 0.0, -3.0)):  # inside; along the axes of the legs
            antennas = Antennas(place, place, 1.0, 10.0)
            source = record(scene, ["paths"], antennas=antennas)["paths"]
            assert all(np.isfinite(part).all() for part in source(np.linspace(0, 1, 9))[:2])


@pytest.mark.parametrize("activity", ACTIVITIES, ids=lambda one: one.slug)
def test_shadows_never_add_amplitude(activity):
    config = config_of(duration_s=3.0, motion={"range_m": 6.0, "angle_deg": 150.0})
    scene = nominal_scene(config, activity)
    source = record(scene, ["paths"])["paths"]
    t = np.linspace(0, 3, 50)
    dark, light = source(t).amplitude, replace(source, shadowing=False)(t).amplitude
    left = dark / light
    assert 0.03**3 <= left.min() <= left.max() <= 1
    assert np.array_equal(source(t).delay, replace(source, shadowing=False)(t).delay)


def test_no_segments_no_paths():
    scene = scene_of("walking")
    found = record(scene, ["antennas", "waveform"])
    ball = replace(WithSword(None, None))
    only = ScattererSubset(ball, (3,))
    link = Link(found["antennas"], None, found["waveform"])
    assert make_body_paths(scene.people[0], only, link) is None
