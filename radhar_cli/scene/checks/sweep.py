"""Positions that are frozen during a sweep: how far they leave echoes from where they belong."""

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar, BoardRadar, Steps
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.scene.radar import waveform_of
from radhar_cli.scene.scene import nominal_scene


def sweep_shift(waveform: Waveform) -> float:
    """Compute the shift of the echo of 1 m/s by motion within a sweep, m (that is, s): (fc + B)/K.

    The beat of tau + 2 v t/c at the middle of the sweep, t = T/2, is that of the range where the
    sweep begins and v (fc + K T)/K: the Doppler of the mid frequency, v (fc + B/2)/K, and v T/2
    that is walked by then. Positions that are frozen where a sweep begins have neither.
    """
    return (waveform.fc + waveform.bandwidth) / waveform.slope


def describe_slow_sweep(config: Config) -> str:
    """Describe the shift of echoes in sweeps with frozen positions, and its remedies."""
    radar = config.radar
    w = waveform_of(nominal_scene(config, config.chosen_activities[0]))
    has_steps = isinstance(radar, Steps)
    shorter = "radar.dwell_s or radar.steps" if has_steps else "radar.chirp_s"
    within = "engine.motion_in_chirp: true with engine.kind: cube has it, "
    if isinstance(radar, ArrayRadar):
        within = ""
    if isinstance(radar, BoardRadar):
        shorter = "a ramp of radar.cfg"
    return (
        f"by {sweep_shift(w):.2g} m at 1 m/s, with {w.chirp:.2g} s a sweep and cells of "
        f"{SPEED_OF_LIGHT / (2 * w.bandwidth):.2g} m ({within}a smaller {shorter} leaves less)"
    )
