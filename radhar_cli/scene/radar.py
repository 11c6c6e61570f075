"""Waveform, antennas, board and detection of a scene's radar."""

from dataclasses import replace
from math import log, radians, sqrt
from typing import TypeAlias

import numpy as np

from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.config.radar import (
    ArrayRadar,
    BeamConfig,
    BoardRadar,
    FramesRadar,
    SweptPulses,
)
from radhar_cli.radar.board import DEVICES, Board
from radhar_cli.radar.detection import Detection
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.propagation import Aim, Antennas, boresight_axes
from radhar_cli.scene.scene import Scene

Vector: TypeAlias = tuple[float, float, float]


def board_of(radar: ArrayRadar[float], seconds: float = 0.0) -> Board:
    """Make the board of a radar with frames, as many as so many seconds have, at least one."""
    timing, array = radar.timing, radar.elements
    assert array is not None  # refused where the config is read
    ends = ends_of(radar)
    of_frames = vars(timing) | {"frames": timing.frames_in(seconds)}
    return Board(
        **of_frames,
        array=array,
        position=radar.position_m if ends is None else middle_of(*ends),
        yaw=radians(radar.yaw_deg),
        tilt=radians(radar.tilt_deg),
        roll=radians(radar.roll_deg),
        half_power_deg=radar.half_power_deg,
        half_wavelength=radar.half_wavelength_m,
        gain=10 ** (radar.antenna_gain_dbi / 10),
        ends=ends,
    )


def ends_of(radar: ArrayRadar[float]) -> tuple[Vector, Vector] | None:
    """Places of transmitter and receiver that stand in the scene; None for those of an array."""
    if not isinstance(radar, FramesRadar) or radar.tx_m is None or radar.rx_m is None:
        return None
    return radar.tx_m, radar.rx_m


def middle_of(tx: Vector, rx: Vector) -> Vector:
    """Middle between two places, m."""
    x, y, z = (np.array(tx) + np.array(rx)) / 2
    return float(x), float(y), float(z)


def detection_of(radar: ArrayRadar, processing: ProcessingConfig) -> Detection:
    """Read detection from the .cfg, as far as the board heeds it; clutter is the config's.

    A radar without a file of its own has the settings that hold without one.
    """
    remove_mean = processing.clutter == "mean"
    if not isinstance(radar, BoardRadar):
        return Detection(remove_mean=remove_mean)
    detection = replace(radar.header.detection, remove_mean=remove_mean)
    device = DEVICES.get(str(radar.device))
    return detection if device is None or device.heeds_limits else detection.without_limits()


def waveform_of(scene: Scene) -> Waveform:
    """Make the waveform of a scene."""
    radar, processing = scene.radar, scene.config.processing
    if isinstance(radar, ArrayRadar):
        waveform = board_of(radar, scene.seconds).waveform
        return replace(waveform, window=processing.make_chirp_window())
    centred = processing.range_reference == "centre" and radar.has_range
    waveform = radar.make_waveform(scene.seconds, processing.range_fft_length, centred)
    if not isinstance(radar, SweptPulses):
        return waveform
    return replace(
        waveform,
        residual_video_phase=radar.residual_video_phase,
        window=processing.make_chirp_window(),
    )


def antennas_of(scene: Scene) -> Antennas:
    """Make the antennas of a scene; for a board those of its first channel."""
    radar = scene.radar
    if isinstance(radar, ArrayRadar):
        board = board_of(radar)
        return board.antennas(*board.pairs[0])
    return Antennas(
        tx=radar.tx_m,
        rx=radar.rx_m,
        gain=10 ** (radar.antenna_gain_dbi / 10),
        isolation_db=radar.antenna_isolation_db,
        aim=None if radar.beam is None else aim_of(radar.beam, radar.tx_m, radar.rx_m),
    )


def aim_of(beam: BeamConfig[float], tx: Vector, rx: Vector) -> Aim:
    """Make the aim of two antennas with a beam of -min(12 (az/bw)^2 + 12 (el/bw)^2, most_db) dB.

    Args:
        beam: widths, boresight and least gain.
        tx: place of the transmitter, m.
        rx: place of the receiver, m.
    """
    x, y, z = (np.array(tx) + np.array(rx)) / 2
    half = sqrt(log(2) * 20 / (6 * log(10))) / 2  # -3 dB there, and not a half
    widths = half * beam.azimuth_deg, half * beam.elevation_deg
    axes = boresight_axes(radians(beam.pan_deg), radians(beam.tilt_deg))
    return Aim((x, y, z), axes, widths, 10 ** (-beam.most_db / 10), of_each=True)
