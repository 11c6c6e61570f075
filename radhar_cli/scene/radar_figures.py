"""Resolutions and limits of a radar by its config, the figures that data sheets have."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.config.radar import ArrayRadar
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.board import Board
from radhar_cli.scene.radar import board_of, waveform_of
from radhar_cli.scene.scene import Scene

HALF_POWER = 0.5
BEAM_STEPS = 20_000  # sines of angles, from 0 to 1, at which the pattern of a row is computed


@dataclass(frozen=True)
class RadarFigures:
    """Figures of a radar with its processing.

    Attributes:
        range_step_m: Spacing of the range bins, m; None of a radar without range.
        last_range_m: Range at which they end, m; None of a radar without range.
        speed_limit_mps: Radial speed at which the Doppler folds, m/s; None where there is no
            Doppler.
        speed_step_mps: Spacing of the Doppler bins, m/s; None where there is no Doppler.
        rate_hz: Frames per second, or pulses of a radar without frames.
        has_frames: Whether the rate is that of frames.
        transmitters: Number of transmitters.
        receivers: Number of receivers.
        elements: Number of virtual elements at places of their own.
        azimuth_deg: Half-power width of a beam of the longest row, degrees; None without a row.
        elevation_deg: Half-power width of a beam of the longest column; None without a column.
    """

    range_step_m: float | None
    last_range_m: float | None
    speed_limit_mps: float | None
    speed_step_mps: float | None
    rate_hz: float
    has_frames: bool
    transmitters: int = 1
    receivers: int = 1
    elements: int = 1
    azimuth_deg: float | None = None
    elevation_deg: float | None = None


def figures_of(scene: Scene) -> RadarFigures:
    """Work out the figures of the radar of a scene, with the processing of its config."""
    has_range = scene.radar.has_range
    if isinstance(scene.radar, ArrayRadar):
        return _figures_of_board(board_of(scene.radar), has_range)
    waveform = waveform_of(scene)
    window = scene.config.processing.make_frames(scene.seconds, waveform.prf, waveform.f0).length
    return RadarFigures(
        range_step_m=waveform.range_step if has_range else None,
        last_range_m=waveform.half_band_range if has_range else None,
        speed_limit_mps=waveform.highest_speed,
        speed_step_mps=2 * waveform.highest_speed / window,
        rate_hz=waveform.prf,
        has_frames=False,
    )


def _figures_of_board(board: Board, has_range: bool) -> RadarFigures:
    """Work out the figures of a radar with frames, whose Doppler is that of a frame."""
    has_doppler = board.n_doppler > 1
    step = board.doppler_step_mps()
    return RadarFigures(
        range_step_m=board.range_step_m if has_range else None,
        last_range_m=board.n_bins * board.range_step_m if has_range else None,
        speed_limit_mps=step * board.n_doppler / 2 if has_doppler else None,
        speed_step_mps=step if has_doppler else None,
        rate_hz=1 / board.period_s,
        has_frames=True,
        transmitters=len(set(board.order)),
        receivers=len(board.receivers),
        elements=len({(round(x, 2), round(y, 2)) for x, y in board.places}),
        azimuth_deg=_beam_width_along(board, 0),
        elevation_deg=_beam_width_along(board, 1),
    )


def _beam_width_along(board: Board, axis: int) -> float | None:
    """Half-power width of a beam of the longest row along an axis (0 left, 1 up), degrees."""
    rows, places = board.rows_along(axis)
    return beam_width_deg(places[rows[0]]) if rows else None


def beam_width_deg(places: Float) -> float | None:
    """Half-power width, degrees, of a beam straight ahead of a row with equal weights.

    Args:
        places: Places of the elements along the row, half wavelengths.

    Returns:
        Width between the angles at which |mean exp(j pi x sin)|^2 is a half; None where it is
        nowhere, as of one element.
    """
    sines = np.linspace(0, 1, BEAM_STEPS + 1)
    pattern = np.abs(np.exp(1j * np.pi * np.outer(sines, places)).mean(axis=1)) ** 2
    below = np.flatnonzero(pattern < HALF_POWER)
    return float(2 * np.degrees(np.arcsin(sines[below[0]]))) if below.size else None


def describe_figures(figures: RadarFigures) -> str:
    """Describe the figures of a radar in a line."""
    parts = [f"{figures.rate_hz:.5g} {'frames' if figures.has_frames else 'pulses'} a second"]
    if figures.range_step_m is not None and figures.last_range_m is not None:
        step_cm = 100 * figures.range_step_m
        parts.append(f"ranges to {figures.last_range_m:.3g} m in steps of {step_cm:.2g} cm")
    if figures.speed_limit_mps is not None and figures.speed_step_mps is not None:
        limit, step = figures.speed_limit_mps, figures.speed_step_mps
        parts.append(f"+-{limit:.2g} m/s in steps of {step:.2g} m/s")
    return ", ".join(parts)
