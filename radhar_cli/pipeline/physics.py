"""Unpack a scene into the objects of the physics: here alone are keys and units of scenes read."""

from dataclasses import fields
from math import radians
from typing import Any

import numpy as np

from radhar_cli.config.schema import Config
from radhar_cli.motion.paper.activities import Gait, Timing
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.motion.protocol import Motion
from radhar_cli.pipeline.people import human_motion
from radhar_cli.processing.canceller import FIRST_DIFFERENCE, NO_CANCELLER, Canceller
from radhar_cli.processing.frames import Frames
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.randomness import NOISE, stream
from radhar_cli.scene import Scene


def _fixed(number: Any) -> float:
    """A number of a scene's config.

    Raises:
        TypeError: it is still to be drawn.
    """
    if not isinstance(number, (int, float)):
        raise TypeError(f"{number!r} should have been drawn; this config is no scene's")
    return float(number)


def _vector(numbers: tuple[Any, Any, Any]) -> tuple[float, float, float]:
    x, y, z = numbers
    return _fixed(x), _fixed(y), _fixed(z)


def waveform_of(config: Config) -> Waveform:
    """The waveform of a scene's config."""
    radar = config.radar
    return Waveform(
        fc=_fixed(radar.carrier_hz),
        bandwidth=_fixed(radar.bandwidth_hz),
        chirp=_fixed(radar.chirp_s),
        adc_rate=_fixed(radar.adc_rate_hz),
        prf=_fixed(radar.prf_hz),
        duration=_fixed(config.duration_s),
        fft_length=config.processing.range_fft_length,
        centred=config.processing.range_reference == "centre",
        residual_video_phase=radar.residual_video_phase,
    )


def antennas_of(config: Config) -> Antennas:
    """The antennas of a scene's config."""
    radar = config.radar
    return Antennas(
        tx=_vector(radar.tx_m),
        rx=_vector(radar.rx_m),
        gain=10 ** (_fixed(radar.antenna_gain_dbi) / 10),
        isolation_db=_fixed(radar.antenna_isolation_db),
    )


def wall_of(config: Config) -> Wall | None:
    """The wall of a scene's config, if there is one."""
    wall = config.wall
    if wall is None:
        return None
    return Wall(
        center=_vector(wall.center_m),
        size=_vector(wall.size_m),
        eps_r=_fixed(wall.eps_r),
        loss_tangent=_fixed(wall.loss_tangent),
        rays=wall.rays,
        fresnel=wall.fresnel,
    )


def motion_of(scene: Scene) -> Motion:
    """The motion of a scene: the activity's own, or that of the model in `motion:`."""
    if scene.activity.motion is not None:
        return scene.activity.motion(scene)
    return human_motion(scene) if scene.config.motion.model == "human" else _paper_body(scene)


def _paper_body(scene: Scene) -> PaperBody:
    subject, motion, timing = scene.config.subject, scene.config.motion, scene.config.timing
    return PaperBody(
        activity=scene.activity.slug,
        height=_fixed(subject.height_m),
        weight=_fixed(subject.weight_kg),
        start=(_fixed(motion.range_m), _fixed(motion.cross_range_m)),
        angle=radians(_fixed(motion.angle_deg)),
        gait=Gait(
            frequency=_fixed(motion.gait_hz),
            thigh=radians(_fixed(motion.thigh_deg)),
            calf=radians(_fixed(motion.calf_deg)),
            arm=radians(_fixed(motion.arm_deg)),
            turn=radians(_fixed(motion.turn_deg)),
            speed=_fixed(motion.speed_mps),
        ),
        timing=Timing(
            **{field.name: _fixed(getattr(timing, f"{field.name}_s")) for field in fields(Timing)}
        ),
    )


def canceller_of(config: Config) -> Canceller:
    """The canceller of a config."""
    return FIRST_DIFFERENCE if config.processing.mti else NO_CANCELLER


def frames_of(config: Config, duration: float, prf: float) -> Frames:
    """The frames of the STFT, whose window is a share of the recording (s, pulses per s)."""
    share, overlap = config.processing.window_fraction, config.processing.overlap_fraction
    return Frames.of(share, overlap, duration, prf)


def fsst_frames_of(config: Config, duration: float, prf: float) -> Frames:
    """`frames_of`, with the hop of the FSST where it has its own."""
    frames, hop = frames_of(config, duration, prf), config.processing.fsst_hop_pulses
    return frames if hop is None else Frames(frames.length, hop)


def noise_stream(scene: Scene, name: str) -> np.random.Generator:
    """The stream of unit noise of a scene with that name."""
    key = (scene.activity.index, scene.index)
    return stream(scene.config.seed, NOISE, *key, name=name)
