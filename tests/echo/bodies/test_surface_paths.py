"""Surfaces of a body that face the radar: where their points lie, and how strong they are."""

from dataclasses import replace

import numpy as np
import pytest

from radhar_cli.config.data_set import Config
from radhar_cli.echo.bodies.motion_paths import leg
from radhar_cli.echo.bodies.surface_paths import DEPTH, FACING_DBSM, SurfacePaths, draw_surface
from radhar_cli.motion.protocol import cache_motion
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.paths import Link, make_body_paths
from radhar_cli.scene.products.run import record
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.scene import Scene, draw_scene

T = np.linspace(0, 1, 7)


def scene(seed: int = 1, **body: object) -> Scene:
    document = {
        "seed": seed,
        "activities": ["stationary"],
        "body": {"scatterers": "surfaces"} | body,
        "motion": {"range_m": 3, "angle_deg": 180},
        "subject": {"height_m": 1.75},
    }
    config = Config.model_validate(document)
    return draw_scene(config, config.chosen_activities[0], 0)


def source(seed: int = 1) -> SurfacePaths:
    one = scene(seed)
    motion = motion_of(one.people[0])
    made = make_body_paths(one.people[0], motion, Link(antennas_of(one), None, waveform_of(one)))
    assert made is not None
    return made


def test_points_lie_on_the_side_that_faces_the_radar() -> None:
    paths = source()
    p, _ = paths.scatter(T, paths._centre(), paths._centre())
    placed = paths.body.at(T)
    s = paths.drawn.segment
    along = placed.start + paths.drawn.along.mean() * (placed.end - placed.start)
    way = p - (placed.start[:, s] + paths.drawn.along[:, None] * (placed.end - placed.start)[:, s])
    radius = np.linalg.norm(way, axis=0)
    np.testing.assert_allclose(radius, (DEPTH * paths.body.radii[s]) + 0 * radius, atol=2e-3)
    sight = np.array(paths._centre())[:, None, None] - along[:, s]
    assert ((way * sight).sum(axis=0) > 0).mean() > 0.99


def test_a_facing_segment_has_its_cross_section() -> None:
    """The mean over draws of the summed powers of a trunk at right angles to the sight."""
    found = []
    for seed in range(60):
        paths = source(seed + 1)
        drawn = draw_surface(len(paths.body.segments), 14, np.random.default_rng(seed))
        _, strength = replace(paths, drawn=drawn).scatter(T[:1], paths._centre(), paths._centre())
        trunk = [one.name for one in paths.body.segments].index("trunk")
        found.append((strength[drawn.segment == trunk] ** 2).sum())
    size = paths.body.thickness
    assert 10 * np.log10(np.mean(found) / size) == pytest.approx(FACING_DBSM["trunk"], abs=1)


def test_the_trunk_outshines_shanks() -> None:
    paths = source()
    powers = (paths(T).amplitude ** 2).sum(axis=1)
    by_name = dict.fromkeys((one.name for one in paths.body.segments), 0.0)
    for segment, power in zip(paths.drawn.segment, powers, strict=True):
        by_name[paths.body.segments[segment].name] += power
    assert by_name["trunk"] > 20 * max(by_name["right_shank"], by_name["left_shank"])


def test_delays_are_those_of_the_points_but_for_a_wavelength() -> None:
    paths = source()
    p, _ = paths.scatter(T, paths._centre(), paths._centre())
    ways = leg(p, paths.antennas.tx) + leg(p, paths.antennas.rx)
    off = np.abs(paths(T).delay * 299792458.0 - ways)
    assert off.max() <= 299792458.0 / paths.fc / 2


@pytest.mark.parametrize("scatterers", ["segments", "surfaces"])
def test_cross_sections_are_drawn_by_a_stream_of_their_own(scatterers: str) -> None:
    """Points stay; both sides of a kind are as much brighter at all times, scenes differ by sd."""
    levels = []
    for seed in range(1, 16):
        usual, drawn = (
            record(scene(seed, scatterers=scatterers, cross_section_sd_db=sd), ["paths"])["paths"]
            for sd in (0.0, 3.0)
        )
        before, after = usual(T), drawn(T)
        np.testing.assert_array_equal(after.delay, before.delay)
        seen = before.amplitude > 0
        level = 20 * np.log10(after.amplitude[seen] / before.amplitude[seen])
        kinds = np.unique(level.round(6))
        assert kinds.size == len(FACING_DBSM)
        levels.append(kinds)
    assert np.std(levels) == pytest.approx(3, abs=0.8)
    assert np.mean(levels) == pytest.approx(0, abs=0.9)


def test_the_same_stream_gives_the_same_paths_and_time_goes_on_smoothly() -> None:
    one, other = source()(T), source()(T)
    np.testing.assert_array_equal(one.delay, other.delay)
    assert not np.array_equal(source(2)(T).delay, one.delay)
    fine = source()(np.arange(2000) * 1e-4)
    speed = np.abs(np.diff(fine.delay, axis=1)).max() * 299792458.0 / 2 / 1e-4
    assert speed < 0.2  # a standing person; nothing jumps


def test_several_channels_evaluate_a_body_once() -> None:
    one = scene()
    asked: list[int] = []
    motion = motion_of(one.people[0])

    class Counting:
        def __getattr__(self, name: str) -> object:
            return getattr(motion, name)

        def landmark_positions(self, t: np.ndarray) -> np.ndarray:
            asked.append(t.size)
            return motion.landmark_positions(t)  # type: ignore[attr-defined]

    held = cache_motion(Counting())  # type: ignore[arg-type]
    antennas, w = antennas_of(one), waveform_of(one)
    for shift in (0.0, 0.01, 0.02):
        moved = replace(antennas, tx=(0.4, -0.1 + shift, 1.5), rx=(0.4, 0.1 - shift, 1.5))
        made = make_body_paths(one.people[0], held, Link(moved, None, w))
        assert made is not None
        made(T)
    assert len(asked) == 1
