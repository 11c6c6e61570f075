"""Margins: the fastest, farthest and nearest that a config draws, beside what its radar tells."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.radar.propagation import bistatic_delay, leg
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.scene.checks.validity import MIN_DISTANCE_M
from radhar_cli.scene.motion import moving
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.scene import Scene

CHECKS_PER_S = 200.0
MOST_CHECKS = 4000
MOST_CYCLES = 1e10  # of phase, beyond which float64 is off by 1e-6 of a cycle


@dataclass(frozen=True)
class Reach:
    """How far and how fast the joints of a scene are."""

    farthest: float  # largest bistatic range, half of the way from antenna to antenna, m
    nearest: float  # least distance of a joint from an antenna, m
    fastest: float  # largest speed along the way, m/s


@dataclass(frozen=True)
class Margin:
    """What a config draws beside where its radar, or the arithmetic, ends."""

    name: str
    drawn: float  # the extreme of all scenes that were drawn
    limit: float  # where it ends
    unit: str  # unit of both
    source: str  # what ends there: model or arithmetic
    beyond: str  # what happens beyond


def reach_of(scene: Scene) -> Reach:
    """Find how far and how fast the joints of everybody in a scene are."""
    antennas = antennas_of(scene)
    count = min(max(int(CHECKS_PER_S * scene.seconds), 2), MOST_CHECKS)
    t = np.linspace(0, scene.seconds, count)
    farthest, nearest, fastest = 0.0, np.inf, 0.0
    for person in scene.people:
        p = moving(person).positions(t)
        legs = leg(p, antennas.tx), leg(p, antennas.rx)
        r = bistatic_delay(*legs) * (SPEED_OF_LIGHT / 2)
        farthest = max(farthest, float(r.max()))
        nearest = min(nearest, float(legs[0].min()), float(legs[1].min()))
        fastest = max(fastest, float(np.abs(np.diff(r)).max() / (t[1] - t[0])))
    return Reach(farthest, nearest, fastest)


def margins_of(scenes: Sequence[Scene], reaches: Sequence[Reach]) -> list[Margin]:
    """Compare what scenes of a config draw with what its radar tells apart."""
    waveforms = [waveform_of(scene) for scene in scenes]
    fastest = max(reach.fastest for reach in reaches)
    farthest = max(reach.farthest for reach in reaches)
    nearest = min(reach.nearest for reach in reaches)
    highest_speed = min(w.highest_speed for w in waveforms)
    range_end = min(w.half_band_range for w in waveforms)
    shortest_wave = min(w.wavelength for w in waveforms)
    margins = [
        Margin(
            *("fastest joint, along the line of sight", fastest, highest_speed, "m/s", "model"),
            "its Doppler folds: warned",
        ),
        Margin(
            *("nearest joint to an antenna", nearest, MIN_DISTANCE_M, "m", "model"),
            "the far field ends: drawn again, or refused",
        ),
        Margin(
            *("cycles of phase of the farthest echo", 2 * farthest / shortest_wave, MOST_CYCLES),
            *("", "arithmetic", "float64 is off by 1e-6 of a cycle: nothing says so"),
        ),
    ]
    if not scenes[0].radar.has_range:
        return margins
    reach_margin = Margin(
        *("farthest joint", farthest, range_end, "m", "model"),
        "its echo leaves the range axis: on_invalid decides, or warned",
    )
    return [margins[0], reach_margin, *margins[1:]]
