"""Canceller, gate, windows and detector that a config asks for."""

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.numerics.rounding import half_up
from radhar_cli.processing import canceller
from radhar_cli.processing.cfar import CellAveraging
from radhar_cli.processing.frames import Frames
from radhar_cli.radar.chirp_window import ChirpWindow
from radhar_cli.schema.number import nominal, support


def canceller_of(config: AnyConfig, prf: float) -> canceller.Canceller:
    """Make the canceller of a config, for `prf` pulses per second."""
    highpass = config.processing.highpass
    match config.processing.clutter:
        case "difference":
            return canceller.FIRST_DIFFERENCE
        case "mean":
            return canceller.MeanRemoval()
        case "none":
            return canceller.NO_CANCELLER
    return canceller.HighPass(
        highpass.order, highpass.cutoff(prf), highpass.zero_phase, highpass.remove_mean
    )


def max_samples(config: AnyConfig) -> int:
    """Length of the longest slow-time signal after the canceller that a config draws."""
    pulses = half_up(support(config.duration_s)[1], support(config.radar.prf_hz)[1])
    return pulses - 1 if config.processing.clutter == "difference" else pulses


def cfar_of(config: AnyConfig) -> CellAveraging:
    """Make the CFAR of a config; numbers that are still to be drawn are taken at their middle."""
    cfar = config.image.cfar
    return CellAveraging(
        guard=cfar.guard,
        training=cfar.training,
        pfa=nominal(cfar.pfa),
        decibel=cfar.domain == "decibel",
        floor_db=nominal(cfar.floor_db),
        wrap=cfar.edges == "wrap",
    )


def chirp_window_of(processing: ProcessingConfig) -> ChirpWindow:
    """Make the window before range compression."""
    assert processing.range_window is not None  # filled in where the config was read
    return ChirpWindow(processing.range_window, processing.range_sidelobes_db)


def frames_of(config: AnyConfig, duration: float, prf: float, f0: float) -> Frames:
    """Make the windows of the STFT of a recording.

    Args:
        config: length and overlap of the windows.
        duration: duration of the recording, s.
        prf: pulses per second.
        f0: frequency that Dopplers refer to, Hz, from which a default length follows.
    """
    processing = config.processing
    length = processing.window_pulses(duration, prf, f0)
    return Frames.of(length, processing.overlap_fraction)


def fsst_frames_of(config: AnyConfig, duration: float, prf: float, f0: float) -> Frames:
    """Make the windows of the FSST: `frames_of`, with a hop of its own if the config has one."""
    frames, hop = frames_of(config, duration, prf, f0), config.processing.fsst_hop_pulses
    return frames if hop is None else Frames(frames.length, hop)
