"""Maps, windows, cancellers, gates and images that do not fit the signal."""

from collections.abc import Iterable, Iterator

from radhar_cli.config.checks.radar import MAX_PADDING, waveform_problems
from radhar_cli.config.checks.smallest_waveform import (
    ENDS,
    HIGHEST_F0,
    prf_in_words,
    waveform_at,
    window_pulses,
)
from radhar_cli.config.first_level import AnyRequest, Request
from radhar_cli.config.image import AbsoluteReference
from radhar_cli.config.maps import (
    ANGLE_TIME_MAPS,
    CADENCE_MAPS,
    FRAME_MAPS,
    KNOWN_MAPS,
    MAPS_OF_SAMPLES,
    without_cadences,
)
from radhar_cli.config.offered_maps import why_no_map
from radhar_cli.config.radar import MIN_WINDOW, ArrayRadar
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.numerics.rounding import show_beside
from radhar_cli.processing.map_kind import treatment_of
from radhar_cli.schema.number import support
from radhar_cli.schema.section import Problem

MAX_PULSES = 2**24
MAX_BIN_SAMPLES = 2**27  # of range bins in memory, 16 bytes each


MIN_CUTOFF = 1e-4  # of PRF/2; below, rounding spoils a filter of order 10 in float64


def map_problem(c: AnyRequest, names: Iterable[str]) -> Problem | None:
    """Find the maps that the radar of a config cannot make, and say why; None if it makes all."""
    reasons = {name: why for name in names if (why := why_no_map(c, name)) is not None}
    if not reasons:
        return None
    possible = [name for name in KNOWN_MAPS if why_no_map(c, name) is None]
    right = f"should be some of {', '.join(without_cadences(possible))}"
    return Problem("maps", list(reasons), f"{right}: {'; '.join(dict.fromkeys(reasons.values()))}")


def problems_of_maps(c: Request, names: tuple[str, ...]) -> list[Problem]:
    """Find problems of a config's radar and processing with maps of other names."""
    return list(processing_problems(c.model_copy(update={"maps": names})))


def processing_problems(c: AnyRequest) -> Iterator[Problem]:
    """Find the keys of the processing that do not fit the radar or the maps."""
    names = c.maps if isinstance(c, Request) else [n for n in c.maps if n in MAPS_OF_SAMPLES]
    if (of_maps := map_problem(c, names)) is not None:
        yield of_maps
    if not isinstance(c.radar, ArrayRadar):
        yield from waveform_problems(c)
        yield from _clutter_problems(c)
    yield from _signal_problems(c)
    yield from _range_window_problems(c)
    yield from _gate_problems(c)
    yield from _image_problems(c)


def _signal_problems(c: AnyRequest) -> Iterator[Problem]:
    processing, padding = c.processing, c.processing.stft_fft_length
    shortest, longest = waveform_at(c, *HIGHEST_F0), waveform_at(c, "duration_s", "prf_hz")
    pulses, most_pulses = shortest.n_pulses, longest.n_pulses
    window, longest_window = window_pulses(c, shortest), window_pulses(c, longest)
    usable_pulses = pulses - 1 if processing.clutter == "difference" else pulses
    pulses_meant = "pulses there are"
    board = c.radar if isinstance(c.radar, ArrayRadar) else None
    if board:  # frames are cancelled, filtered and windowed one by one
        usable_pulses = board.timing.loops
        pulses_meant = f"pulses of a frame, the loops of {board.named}"
    doppler = [name for name in c.maps if name not in ("rtm", *ANGLE_TIME_MAPS, *FRAME_MAPS)]
    denoised = [n for n in doppler if treatment_of(n).denoised]
    duration_entry: tuple[str, object] = ("duration_s", c.duration_s)
    window_is_given = "window_s" in processing.model_fields_set and processing.window_s is not None
    window_entry = (
        ("processing.window_s", processing.window_s) if window_is_given else duration_entry
    )
    if most_pulses > MAX_PULSES and not board:
        right = f"at most {MAX_PULSES} pulses (duration_s * prf_hz is {most_pulses})"
        yield Problem(*duration_entry, f"should give {right}: radar.prf_hz may be {longest.prf:g}")
    if pulses < 2 and not board:
        yield Problem(*duration_entry, f"should hold at least 2 pulses (it holds {pulses})")
    if doppler and window < min(MIN_WINDOW, usable_pulses if board else MIN_WINDOW):
        right = f"the window of window_s * prf_hz at least {MIN_WINDOW} pulses (it has {window})"
        yield Problem(*window_entry, f"should make {right}: {prf_in_words(c, shortest)}")
    if doppler and window > usable_pulses:
        right = (
            f"should make the window at most the {usable_pulses} {pulses_meant} (it has {window})"
        )
        yield Problem(*window_entry, right)
    if denoised and processing.savgol.frame > usable_pulses:
        right = f"should be at most the {usable_pulses} {pulses_meant}"
        yield Problem("processing.savgol.frame", processing.savgol.frame, right)
    if padding is not None and padding < longest_window:
        right = f"should be null or at least the window of {longest_window} pulses"
        yield Problem("processing.stft_fft_length", padding, right)
    if padding is not None and padding > MAX_PADDING * max(window, MIN_WINDOW):
        right = f"should be null or at most {MAX_PADDING} times the window of {window} pulses"
        yield Problem("processing.stft_fft_length", padding, right)


def _range_window_problems(c: AnyRequest) -> Iterator[Problem]:
    """A window that leaves nothing of the samples that the coherent sum over range reads."""
    processing = c.processing
    name, reads_ends = processing.range_window, processing.range_reference == "start"
    if reads_ends and name not in (None, "rectangular") and processing.range_sum == "coherent":
        right = (
            "should be rectangular with processing.range_reference: start, whose sum over range "
            "reads the ends of a chirp"
        )
        yield Problem("processing.range_window", name, right)


def _clutter_problems(c: AnyRequest) -> Iterator[Problem]:
    processing, prf = c.processing, support(c.radar.prf_hz)
    cutoff_hz = processing.highpass.cutoff_hz
    if processing.clutter == "highpass" and cutoff_hz is not None:
        smallest, largest = 2 * cutoff_hz / prf[1], 2 * cutoff_hz / prf[0]
        if largest >= 1 or smallest < MIN_CUTOFF:
            right = (
                f"should be from {MIN_CUTOFF:g} times PRF/2 to below PRF/2 in every scene "
                f"(it is {smallest:g} to {largest:g} times PRF/2)"
            )
            yield Problem("processing.highpass.cutoff_hz", cutoff_hz, right)
    if "rtm" in c.maps and processing.clutter in ("mean", "highpass"):
        yield from _bin_problems(c, "processing.clutter", processing.clutter, "the rtm")


def _gate_problems(c: AnyRequest) -> Iterator[Problem]:
    processing = c.processing
    if processing.range_sum != "gated":
        return
    within = processing.gate_m
    half_band = waveform_at(c, "bandwidth_hz").half_band_range  # the least
    if isinstance(c.radar, ArrayRadar):
        half_band = c.radar.timing.farthest_m
    if isinstance(within, tuple):
        if within[1] >= half_band:
            end = show_beside(half_band, within[1], digits=4)
            right = f"should end before the range half-band does, at {end} m"
            yield Problem("processing.gate_m", list(within), right)
    elif 2 * within >= half_band:
        end = show_beside(half_band, 2 * within, digits=4)
        right = f"should be less than half the range half-band of {end} m"
        yield Problem("processing.gate_m", within, right)
    if not isinstance(c.radar, ArrayRadar):
        yield from _bin_problems(c, "processing.range_sum", "gated", "the gate")


def _bin_problems(c: AnyRequest, key: str, value: object, purpose: str) -> Iterator[Problem]:
    """A request for which more range bins of all pulses than memory allows have to be held.

    Args:
        c: the config, whose largest recording counts.
        key: dotted key that asks for them.
        purpose: purpose for which they are held, in words.
    """
    w = waveform_at(c, *ENDS)
    bins, pulses = w.n_bins, w.n_pulses
    if bins * pulses > MAX_BIN_SAMPLES:
        right = (
            f"should not go with {pulses} pulses of {bins} range bins: for {purpose} they are held "
            f"at once, {MAX_BIN_SAMPLES} samples at most"
        )
        yield Problem(key, value, right)


def _image_problems(c: AnyRequest) -> Iterator[Problem]:
    cfar, size = c.image.cfar, c.image.size_px
    reach = [2 * (g + t) + 1 for g, t in zip(cfar.guard, cfar.training, strict=True)]
    if c.image.kind == "cfar" and not any(cfar.training):
        yield Problem("image.cfar.training", list(cfar.training), "should be 1 or more of a side")
    if c.image.kind == "cfar" and any(r > px for r, px in zip(reach, size, strict=True)):
        right = (
            f"should fit into the image of {size[0]} x {size[1]} pixels: with the guard cells "
            f"{list(cfar.guard)} on each side it takes {reach[0]} x {reach[1]}"
        )
        yield Problem("image.cfar.training", list(cfar.training), right)
    if isinstance(c.image.reference, AbsoluteReference) and not isinstance(c, Request):
        right = "should be noise or peak: powers of recordings have no unit"
        yield Problem("image.reference.dbm", c.image.reference.dbm, right)
    cadences = [name for name in c.maps if name in CADENCE_MAPS]
    if c.output.column_labels and cadences:
        right = f"should be false with {', '.join(cadences)}, whose columns are no times"
        yield Problem("output.column_labels", True, right)
    yield from _range_limit_problems(c)
    limits = c.image.doppler_limits_mps
    if limits is None or not set(c.maps) - {"rtm", *ANGLE_TIME_MAPS, *FRAME_MAPS}:
        return
    shortest = waveform_at(c, *HIGHEST_F0)
    fastest = shortest.highest_speed
    if max(-limits[0], limits[1]) > fastest * (1 + 1e-9):
        limit = show_beside(fastest, -limits[0], limits[1])
        right = (
            f"should be within the unambiguous band, -{limit} to {limit} m/s "
            f"(c prf_hz / 4 f0: {prf_in_words(c, shortest)})"
        )
        yield Problem("image.doppler_limits_mps", list(limits), right)
    step = (
        SPEED_OF_LIGHT * shortest.prf / (2 * waveform_at(c).f0 * max(window_pulses(c, shortest), 1))
    )
    if limits[1] - limits[0] < 2 * step:
        right = f"should hold at least 2 Doppler bins (one has {step:.3g} m/s)"
        yield Problem("image.doppler_limits_mps", list(limits), right)


def _range_limit_problems(c: AnyRequest) -> Iterator[Problem]:
    """Limits of the range of which a radar shows less than two bins."""
    limits = c.image.range_limits_m
    if limits is None or "rtm" not in c.maps or "range_limits_m" not in c.image.model_fields_set:
        return
    shortest, longest = waveform_at(c, "bandwidth_hz"), waveform_at(c, "adc_rate_hz", "chirp_s")
    farthest, step = shortest.half_band_range, longest.range_step
    if limits[1] - limits[0] < 2 * step or limits[0] > max(farthest - step, 0.0):
        right = (
            f"should hold at least 2 range bins (one has {step:.3g} m) within the "
            f"{farthest:.4g} m that the radar sees"
        )
        yield Problem("image.range_limits_m", list(limits), right)
