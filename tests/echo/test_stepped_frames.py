"""Frames of stepped-frequency and CW arrays against a sum of phases that is written out here."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.motion.protocol import ScattererSubset
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, nominal_scene

C = 299792458.0
TX, RX = [[0.0, 0.0], [4.0, 1.0]], [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]
POSITION, GAIN = (0.0, 0.1, 1.2), 10**0.9  # 9 dBi of each antenna
CROSS_SECTIONS = 0.04, 0.5
STEPS: dict[str, Any] = {
    "waveform": "sfcw",
    "frame": {"chirps": 16, "interval_s": 1.5e-3, "period_s": 0.06},
    "carrier_hz": 2.0e9,
    "bandwidth_hz": 1.0e9,
    "steps": 100,
    "dwell_s": 12e-6,
    "array": {"tx": TX, "rx": RX},
    "position_m": POSITION,
}
TONE = {key: STEPS[key] for key in ("array", "position_m", "frame")} | {
    "waveform": "cw",
    "carrier_hz": 24.125e9,
}


@dataclass(frozen=True)
class Balls:
    """Two balls in straight motion."""

    names, parents = ("ball", "other"), (None, None)
    breakpoints = phases = ()
    highest_frequency = 0.5

    def positions(self, t: Float) -> Float:
        one = np.stack([3.0 - 1.1 * t, 1.2 + 0.3 * t, 1.5 + 0 * t])
        other = np.stack([4.0 + 0.4 * t, -0.8 - 0.5 * t, 0.9 + 0.2 * t])
        return np.stack([one, other], axis=1)

    def cross_sections(self, t: Float) -> Float:
        return np.array(CROSS_SECTIONS)[:, None]

    def torso(self, t: Float) -> Float:
        return self.positions(t)[:, :1]


def scene_of(radar: dict[str, Any], **keys: Any) -> Scene:
    usual: dict[str, Any] = {"maps": ["doppler_azimuth"], "duration_s": 0.2}
    quiet = {"receiver": {"noise_figure_db": None}, "motion": {"range_m": 3}}
    config = Config.model_validate({"radar": radar} | usual | quiet | keys)
    return nominal_scene(config, config.chosen_activities[0])


def sum_of_phases(radar: dict[str, Any], frames: int, balls: tuple[int, ...]) -> Complex:
    """Samples [frame, sweep, transmitter and receiver, step]: a exp(-j 2 pi f_n tau) of balls.

    The elements stand in the plane x = 0 of the array, the first number of a place to the left.
    """
    frame, steps = radar["frame"], radar.get("steps", 1)
    f = radar["carrier_hz"] + radar.get("bandwidth_hz", 0) / steps * np.arange(steps)
    middle = (f[0] + f[-1]) / 2
    half_wave = C / middle / 2
    cube = np.zeros((frames, frame["chirps"], len(TX) * len(RX), steps), complex)
    for number in range(frames):
        for sweep in range(frame["chirps"]):
            for k, tx in enumerate(TX):
                turn = sweep * len(TX) + k
                t = number * frame["period_s"] + turn * frame["interval_s"]
                places = Balls().positions(np.array([t]))[:, :, 0].T
                for r, rx in enumerate(RX):
                    for p, rcs in [(places[i], CROSS_SECTIONS[i]) for i in balls]:
                        legs = [
                            np.linalg.norm(
                                p - POSITION - np.array([0, left * half_wave, up * half_wave])
                            )
                            for left, up in (tx, rx)
                        ]
                        a = GAIN * C / middle * np.sqrt(rcs) / (4 * np.pi) ** 1.5
                        a /= legs[0] * legs[1]
                        phases = np.exp(-2j * np.pi * f * sum(legs) / C)
                        cube[number, sweep, k * len(RX) + r] += a * phases
    return cube


@pytest.mark.parametrize("engine", ["cube", "direct"])
@pytest.mark.parametrize("radar", [STEPS, STEPS | {"output": "real"}, TONE])
def test_samples_are_the_sum_of_phases(engine: str, radar: dict[str, Any]) -> None:
    """An element without a pattern has one of 1000 degrees, which takes 0.002 dB."""
    scene = scene_of(radar, engine={"kind": engine})
    cube = record(scene, ["cube"], motions=(Balls(),)).products["cube"]
    expected = sum_of_phases(radar, 3, (0, 1))
    if radar.get("output") == "real":
        expected = expected.real
    assert cube.shape == expected.shape
    assert cube.dtype.kind == expected.dtype.kind
    assert np.linalg.norm(cube - expected) < 3e-4 * np.linalg.norm(expected)


@pytest.mark.parametrize("radar", [STEPS, TONE])
def test_phases_of_one_ball_are_exact(radar: dict[str, Any]) -> None:
    scene = scene_of(radar, engine={"kind": "cube"})
    cube = record(scene, ["cube"], motions=(ScattererSubset(Balls(), (1,)),)).products["cube"]
    ratio = cube / sum_of_phases(radar, 3, (1,))
    assert np.abs(np.angle(ratio)).max() < 1e-8
    assert np.abs(np.abs(ratio) - 1).max() < 3e-4


def test_maps_have_the_balls_where_they_are() -> None:
    """Bins of c/(2 B), padded to 128, until they repeat at c N/(2 B); approaching is positive."""
    names = ["range_doppler", "range_azimuth", "doppler_azimuth"]
    ball = ScattererSubset(Balls(), (0,))
    results = record(scene_of(STEPS), names, motions=(ball,)).products
    p, v = np.array([3.0, 1.2, 1.5]) - POSITION, np.array([-1.1, 0.3, 0.0])
    distance = np.linalg.norm(p)
    ranges = results["range_doppler"]
    assert ranges.rows.values[1] == pytest.approx(C / 2e9 * 100 / 128)
    assert ranges.rows.edges[1] == pytest.approx(C / 2e9 * 100, rel=0.01)
    row, column = np.unravel_index(ranges.power[0].argmax(), ranges.power[0].shape)
    assert ranges.rows.values[row] == pytest.approx(distance, abs=0.12)
    assert ranges.columns.values[column] == pytest.approx(-p @ v / distance, abs=0.7)
    angles = results["range_azimuth"]
    row, column = np.unravel_index(angles.power[0].argmax(), angles.power[0].shape)
    expected = np.degrees(np.arcsin(p[1] / distance))
    assert angles.columns.values[column] == pytest.approx(expected, abs=3)


def test_two_receivers_of_a_tone_tell_the_direction_of_what_moves() -> None:
    """The phase between them is pi sin(azimuth), at the Doppler of the ball."""
    array = {"rx": [[-0.5, 0.0], [0.5, 0.0]]}
    radar = TONE | {"array": array, "frame": {"chirps": 64}, "prf_hz": 1000}
    ball = ScattererSubset(Balls(), (0,))
    maps = record(scene_of(radar), ["doppler_azimuth"], motions=(ball,)).products["doppler_azimuth"]
    p, v = np.array([3.0, 1.2, 1.5]) - POSITION, np.array([-1.1, 0.3, 0.0])
    distance = np.linalg.norm(p)
    row, column = np.unravel_index(maps.power[0].argmax(), maps.power[0].shape)
    assert maps.rows.values[row] == pytest.approx(-p @ v / distance, abs=0.1)
    direction = np.degrees(np.arcsin(p[1] / distance))
    assert maps.columns.values[column] == pytest.approx(direction, abs=2)


def test_noise_of_a_tone_is_of_the_rate_of_its_samples() -> None:
    """Thermal noise of kT F times the samples of a receiver per second, in turns or not."""
    powers = [
        record(
            scene_of(TONE | {"frame": frame}, receiver={"noise_figure_db": 20}), ["noise_sigma"]
        ).products["noise_sigma"]
        ** 2
        for frame in ({"chirps": 16, "interval_s": 1e-3}, {"chirps": 16, "interval_s": 5e-4})
    ]
    assert powers[1] / powers[0] == pytest.approx(2)
    assert powers[0] * 10**1.2 * 1e-3 == pytest.approx(1.380649e-23 * 290 * 100 * 1e3, rel=1e-3)
