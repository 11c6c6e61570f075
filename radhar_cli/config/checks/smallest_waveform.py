"""Waveforms at the ends of the laws of a config."""

from typing import cast

from radhar_cli.config.first_level import AnyRequest
from radhar_cli.config.radar import ArrayRadar, SceneRadar
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.schema.number import support

ENDS = ("carrier_hz", "bandwidth_hz", "chirp_s", "adc_rate_hz", "prf_hz", "duration_s")


def waveform_at(c: AnyRequest, *largest: str) -> Waveform:
    """Waveform of the smallest numbers that a config draws, and of the largest of those named."""
    radar, processing = c.radar, c.processing
    keys = [key for key in ENDS if key in type(radar).model_fields]
    numbers = {key: support(getattr(radar, key))[key in largest] for key in keys}
    fixed = cast(SceneRadar, radar.model_copy(update=numbers))
    seconds = support(c.duration_s)["duration_s" in largest]
    centred = processing.range_reference == "centre"
    return fixed.make_waveform(seconds, processing.range_fft_length, centred)


def window_pulses(c: AnyRequest, w: Waveform) -> int:
    """Pulses of the STFT's window of a waveform, at most those of a board's frame."""
    length = c.processing.window_pulses(w.duration, w.prf, w.f0)
    return min(length, c.radar.timing.loops) if isinstance(c.radar, ArrayRadar) else length


def fewest_windows(c: AnyRequest) -> int:
    """Fewest windows of a Doppler-time map of a config: of radars that pause, one a frame."""
    w = waveform_at(c)
    if isinstance(c.radar, ArrayRadar) and c.radar.frames_apart:
        timing = c.radar.timing
        fitting = int(w.duration / timing.period_s + 1e-9)
        return min(timing.frames, fitting) if timing.frames else fitting
    windows = c.processing.make_frames(w.duration, w.prf, w.f0)
    if isinstance(c.radar, ArrayRadar):
        windows = windows.within(c.radar.timing.loops, are_apart=False)
    pulses = w.n_pulses - (c.processing.clutter == "difference")
    return max(0, (pulses - windows.length) // windows.hop + 1)


def prf_in_words(c: AnyRequest, w: Waveform) -> str:
    """The pulse rate of a waveform, and the key that one would change it by."""
    has_frames = isinstance(c.radar, ArrayRadar)
    why = f"{c.radar.named} has a PRF of {w.prf:g} Hz"
    return why if has_frames else f"radar.prf_hz may be {w.prf:g}"


HIGHEST_F0 = ("carrier_hz", "bandwidth_hz", "chirp_s", "adc_rate_hz")
