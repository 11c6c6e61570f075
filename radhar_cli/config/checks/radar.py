"""Keys of the radar that do not fit together, or not with others."""

from collections.abc import Iterator
from math import ceil
from typing import assert_never

from radhar_cli.config.checks.smallest_waveform import ENDS, waveform_at
from radhar_cli.config.first_level import AnyRequest, Request
from radhar_cli.config.maps import FRAME_MAPS, OF_FRAMES, OF_POINTS
from radhar_cli.config.offered_maps import why_no_map
from radhar_cli.config.radar import (
    ArrayRadar,
    BoardRadar,
    CwRadar,
    FmcwRadar,
    FramesRadar,
    ImpulseRadar,
    SfcwRadar,
    Steps,
)
from radhar_cli.numerics.rounding import half_up, show_beside
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.impulse import impulse
from radhar_cli.radar.ti_family import Family
from radhar_cli.schema.annotations import at
from radhar_cli.schema.number import support
from radhar_cli.schema.section import Problem

MAX_CUBE = 2**27  # samples of all channels
MAX_PADDING = 64
CLOSEST = 0.1  # half wavelengths; elements that all lie within are places in another unit
MAX_SAMPLES = 2**16  # of a chirp of a radar with frames
EQUAL = 1e-6  # relative difference of a rate and an interval that are the same
ROUNDING = 1 + 1e-9  # of a sweep without a pause, whose length is 1/prf_hz


NEEDED_COMMANDS = {
    "people_tracking": "dynamicRACfarCfg and dynamicRangeAngleCfg",
    "people_counting": "doaCfg and a cfarCfg of 12 numbers",
}  # which tell the chains of people, as cfarCfg of 7 to 9 tells those of the out-of-box demo
BOARD_PRODUCTS = (*FRAME_MAPS, *OF_POINTS, "points_kind", *OF_FRAMES, "cube")


def radar_problems(c: Request) -> Iterator[Problem]:
    """Find the keys that do not go with the kind of radar of a request."""
    match c.radar:
        case BoardRadar():
            yield from board_problems(c, c.radar)
            return
        case FramesRadar():
            yield from frames_problems(c, c.radar)
            return
        case CwRadar():
            yield from _cw_problems(c)
        case ImpulseRadar():
            yield from _impulse_problems(c, c.radar)
        case FmcwRadar() | SfcwRadar():
            pass
        case _:
            assert_never(c.radar)
    if of_boards := [name for name in c.output.products if name in BOARD_PRODUCTS]:
        right = "should have a radar with frames that makes them: radar.cfg or radar.frame"
        yield Problem("output.products", of_boards, right)
    yield from profile_problems(c)


def _cw_problems(c: Request) -> Iterator[Problem]:
    if c.processing.range_sum == "gated":
        right = "should be coherent with radar.waveform: cw, which has no range"
        yield Problem("processing.range_sum", "gated", right)
    if c.engine.motion_in_chirp:
        right = "should be false with radar.waveform: cw, which has no chirp"
        yield Problem("engine.motion_in_chirp", True, right)


def _cw_frames_problems(radar: FramesRadar) -> Iterator[Problem]:
    """Find the keys that need both channels of the mixers."""
    if radar.output == "real":
        right = (
            "should be iq with radar.waveform: cw and radar.frame: one channel of a mixer has no "
            "phase, by which receivers tell directions"
        )
        yield Problem("radar.output", radar.output, right)


def _impulse_problems(c: Request, radar: ImpulseRadar) -> Iterator[Problem]:
    of = "with radar.waveform: impulse"
    if c.engine.kind == "cube":
        yield Problem("engine.kind", "cube", f"should be direct {of}, which has no beat")
    if c.snr_db is None and c.receiver.noise_figure_db is not None:
        right = f"should be null {of}: how many pulses its samples are means of is not said; snr_db"
        yield Problem("receiver.noise_figure_db", c.receiver.noise_figure_db, right)
    if radar.output == "iq":
        return
    if c.output.slow_time:
        right = f"should be false {of} of real samples, which have no sum over range"
        yield Problem("output.slow_time", True, right)
    for key in ("receiver.noise_corner_hz", "receiver.tones"):
        if at(c, key) not in (0, ()):
            right = f"should be left out {of}, whose samples are real unless radar.output is iq"
            yield Problem(key, at(c, key), right)


def profile_problems(c: AnyRequest) -> Iterator[Problem]:
    """Find the keys that do not fit range profiles, or chirps, simulated or recorded."""
    radar = c.radar
    if not isinstance(radar, ImpulseRadar):
        if c.image.kind == "signed":
            right = "should be decibel or cfar without radar.waveform: impulse"
            yield Problem("image.kind", "signed", right)
        return
    yield from _step_problems(radar)
    if c.image.kind == "signed" and c.maps != ("rtm",):
        yield Problem("maps", list(c.maps), "should be [rtm] with image.kind: signed")
    if c.image.kind == "signed" and radar.output == "iq":
        right = "should be decibel or cfar with radar.output: iq, whose samples are complex"
        yield Problem("image.kind", "signed", right)


def _step_problems(radar: ImpulseRadar) -> Iterator[Problem]:
    """Find samples of a profile that are too far apart for the band."""
    fc, band = support(radar.carrier_hz)[1], support(radar.bandwidth_hz)[1]
    first, last = radar.profile_m
    step = (last - first) / radar.profile_samples
    is_iq = radar.output == "iq"
    widest = impulse(fc, band, 1.0, 1.0, (first, last), radar.profile_samples, is_iq).coarsest_step
    if step <= widest * (1 + 1e-9):
        return
    fewest = ceil((last - first) / widest * (1 - 1e-9))
    steps = show_beside(step, widest, digits=4), show_beside(widest, step, digits=4)
    right = f"should be {fewest} or more: steps of {steps[0]} m are coarser than {steps[1]} m"
    if not is_iq:
        right += ", which real samples need; or radar.output: iq"
    yield Problem("radar.profile_samples", radar.profile_samples, right)


def board_problems(c: Request, radar: BoardRadar) -> Iterator[Problem]:
    """Find the keys that a board cannot have, or that are not simulated for boards."""
    board, timing = radar.header, radar.timing
    if radar.elements is None:
        right = (
            f"should name the board that radar.cfg runs on: {', '.join(DEVICES)}; or radar.array"
        )
        yield Problem("radar.device", radar.device, right)
        return
    if radar.subframe >= timing.subframes:
        right = f"should be below {timing.subframes}, the number of subframes of radar.cfg"
        yield Problem("radar.subframe", radar.subframe, right)
    device = DEVICES.get(str(radar.device))
    if device is not None and board.family not in (Family.ANY, *device.families):
        others = [name for name, other in DEVICES.items() if board.family in other.families]
        right = f"should be {' or '.join(others)}: radar.cfg is of {board.family.value}"
        yield Problem("radar.device", radar.device, right)
        return
    tx, rx = len(radar.elements.tx), len(radar.elements.rx)
    if max(timing.order) >= tx or max(timing.receivers) >= rx:
        masks = [1 << n for n in timing.order]
        right = (
            f"should name transmitters and receivers of the array, {tx} and {rx}: it has the "
            f"masks {masks} and receivers {[n + 1 for n in timing.receivers]}"
        )
        yield Problem("radar.cfg", "chirpCfg, channelCfg", right)
        return
    yield from _unit_problems(radar)
    yield from _frame_problems(c, radar)
    yield from _detection_problems(c, radar)
    yield from _output_problems_of_board(c)
    yield from _missing_on_board(c)


def frames_problems(c: Request, radar: FramesRadar) -> Iterator[Problem]:
    """Find keys that a radar with frames cannot have, or numbers that do not fit together."""
    yield from _place_problems(radar)
    if not radar.has_range:
        yield from _cw_problems(c)
        yield from _cw_frames_problems(radar)
    transmitters, samples = len(radar.array.tx), half_up(radar.adc_rate_hz, radar.chirp_s)
    if radar.has_range and not 2 <= samples <= MAX_SAMPLES:
        yield _problem_of_samples(radar, samples)
        return
    interval = radar.interval_s
    given_rate = None if radar.prf_hz is None else radar.prf_hz * transmitters
    if given_rate is not None and abs(interval * given_rate - 1) > EQUAL:
        turns = f" times the {transmitters} transmitters" if transmitters > 1 else ""
        rate = show_beside(1 / (interval * transmitters), radar.prf_hz or 0)
        right = f"should be 1/(frame.interval_s{turns}) = {rate} Hz"
        yield Problem("radar.prf_hz", radar.prf_hz, f"{right}, or be left out")
        return
    if radar.chirp_s > interval * ROUNDING:
        longest = show_beside(interval, radar.chirp_s)
        right = f"should be at most the time from chirp to chirp, {longest} s"
        yield _problem_of_length(radar, radar.chirp_s, interval, right)
        return
    chirps = radar.frame.chirps * transmitters
    if radar.frame.period_s is not None and chirps * interval > radar.frame.period_s * ROUNDING:
        least = show_beside(chirps * interval, radar.frame.period_s)
        right = f"should be at least {least} s, {chirps} chirps of {interval:g} s"
        yield Problem("radar.frame.period_s", radar.frame.period_s, right)
        return
    yield from _unit_problems(radar)
    yield from _frame_problems(c, radar)
    yield from _firmware_problems(c, radar)
    yield from _output_problems_of_board(c)
    yield from _missing_on_board(c)


def _problem_of_samples(radar: FramesRadar, samples: int) -> Problem:
    """Return the problem that a chirp of a radar with frames has too few samples, or too many."""
    if isinstance(radar, Steps):
        right = f"should be at most {MAX_SAMPLES} with radar.frame"
        return Problem("radar.steps", radar.steps, right)
    right = (
        f"should give 2 to {MAX_SAMPLES} ADC samples per chirp (adc_rate_hz * chirp_s is {samples})"
    )
    return Problem("radar.adc_rate_hz", radar.adc_rate_hz, right)


def _problem_of_length(
    radar: FmcwRadar | SfcwRadar | FramesRadar, longest: float, interval: float, right: str
) -> Problem:
    """Return the problem that a chirp, or a sweep of steps, is too long.

    Args:
        radar: the radar that sends it.
        longest: its longest duration, s.
        interval: the shortest time to the next one, s.
        right: range of its duration, in words.
    """
    if isinstance(radar, Steps):
        right = f"{right} (steps * dwell_s is {show_beside(longest, interval)} s)"
        return Problem("radar.steps", radar.steps, right)
    return Problem("radar.chirp_s", radar.chirp_s, right)


def _place_problems(radar: FramesRadar) -> Iterator[Problem]:
    """Find places of antennas that are said twice, or by half."""
    for name, other in (("tx_m", "rx_m"), ("rx_m", "tx_m")):
        if getattr(radar, name) is None and getattr(radar, other) is not None:
            yield Problem(f"radar.{name}", None, f"should be given with radar.{other}")
    if radar.tx_m is None or radar.rx_m is None:
        return
    written = [name for name in ("array", "position_m") if name in radar.model_fields_set]
    for name in written:
        if getattr(radar, name) != type(radar).model_fields[name].default:
            right = "should be left out with radar.tx_m and radar.rx_m, which are the antennas"
            value = getattr(radar, name)
            value = value if name == "position_m" else value.model_dump(mode="json")
            yield Problem(f"radar.{name}", value, right)


def _unit_problems(radar: ArrayRadar) -> Iterator[Problem]:
    """Find places of an array that are one, or in another unit than they are read in."""
    sides = [*zip(*radar.virtual_places, strict=True)]  # of all elements, to the left and upwards
    extent = max((max(side) - min(side) for side in sides), default=0.0)
    array = radar.elements
    if array is None:
        return
    used = [array.rx[r] for r in radar.timing.receivers if r < len(array.rx)]
    if len({*used}) < len(used) or (extent == 0 and len(radar.virtual_places) > 1):
        count = len(radar.virtual_places)
        nouns = f"all {count} elements" if extent == 0 else "two receivers"
        right = f"should be places apart: {nouns} lie at one place, and see no direction between"
        yield Problem("radar.array", {"tx": array.tx, "rx": array.rx}, right)
    elif 0 < extent < CLOSEST:
        unit = "radar.half_wavelength_m: 1 makes the unit of places a metre, 0.001 a millimetre"
        right = (
            f"should be half wavelengths: all elements lie within {extent:.2g} of one, and see no "
            f"direction; {unit}"
        )
        yield Problem("radar.array", {"tx": array.tx, "rx": array.rx}, right)


def _frame_problems(c: Request, radar: ArrayRadar) -> Iterator[Problem]:
    """Find the keys that do not fit frames: durations, clutter."""
    clutter, timing = c.processing.clutter, radar.timing
    if support(c.duration_s)[0] < timing.period_s:
        frame = show_beside(timing.period_s, support(c.duration_s)[0])
        right = f"should hold a frame of {frame} s"
        yield Problem("duration_s", c.duration_s, right)
    elif timing.loops == 1 and support(c.duration_s)[0] < 2 * timing.period_s:
        frames = show_beside(2 * timing.period_s, support(c.duration_s)[0])
        right = f"should hold two frames of a loop, {frames} s"
        yield Problem("duration_s", c.duration_s, right)
    chirps = support(c.duration_s)[1] / timing.period_s * timing.loops * len(timing.masks)
    samples = chirps * len(timing.receivers) * timing.samples
    if samples > MAX_CUBE:
        seconds = support(c.duration_s)[1] * MAX_CUBE / samples
        right = f"should be at most {seconds:.3g} s: a cube of {MAX_CUBE} samples is held at once"
        yield Problem("duration_s", c.duration_s, right)
    if clutter not in ("mean", "none"):
        right = f"should be mean (of each frame) or none with {radar.named}"
        yield Problem("processing.clutter", clutter, right)


def _detection_problems(c: Request, radar: BoardRadar) -> Iterator[Problem]:
    """Find settings of `cloud` that the .cfg of a board does not have."""
    board, chain = radar.header, c.cloud.chain
    if c.cloud.boundary_box and board.box is None:
        yield _boundary_problem(radar)
    if board.firmware is None and chain != "best":
        reason = (*board.why_no_chain, "cfarCfg is missing")[0]
        if chain in NEEDED_COMMANDS and not board.why_no_chain:
            reason = f"{NEEDED_COMMANDS[chain]} are missing"
        yield Problem("cloud.chain", chain, f"should be best: radar.cfg: {reason}")
    elif chain not in ("best", "board", board.firmware):
        right = f"should be {board.firmware} or best: radar.cfg has the commands of that firmware"
        yield Problem("cloud.chain", chain, right)


def _firmware_problems(c: Request, radar: FramesRadar) -> Iterator[Problem]:
    """Find settings of `cloud` that no radar has without the file of its firmware."""
    if c.cloud.boundary_box:
        yield _boundary_problem(radar)
    if c.cloud.chain != "best":
        yield Problem("cloud.chain", c.cloud.chain, "should be best: no firmware is known")


def _boundary_problem(radar: ArrayRadar) -> Problem:
    """Return the problem that a radar has no box of the room that points could be cropped to."""
    right = f"should be false: {radar.named} has no boundaryBox"
    return Problem("cloud.boundary_box", True, right)


def _output_problems_of_board(c: Request) -> Iterator[Problem]:
    """Find images and products that a board does not have."""
    if c.image.kind == "signed":
        right = "should be decibel or cfar without radar.waveform: impulse"
        yield Problem("image.kind", "signed", right)
    sheets = [name for name in c.maps if name in FRAME_MAPS]
    for key in ("power", "column_labels") if sheets else ():
        if value := getattr(c.output, key):
            right = (
                f"should be left out with {', '.join(sheets)}, whose images are sheets of frames"
            )
            yield Problem(f"output.{key}", value, right)
    products = [name for name in c.output.products if name in FRAME_MAPS]
    if reasons := [why for name in products if (why := why_no_map(c, name)) is not None]:
        yield Problem("output.products", products, f"should not have these: {reasons[0]}")
    if c.output.slow_time:
        right = f"should be false with {c.radar.named}; output.products: [cube] stores raw samples"
        yield Problem("output.slow_time", True, right)


def _missing_on_board(c: Request) -> Iterator[Problem]:
    """Find the keys that are simulated for one channel alone."""
    corner = c.receiver.noise_corner_hz
    for name, value in (
        ("tones", [one.model_dump(mode="json") for one in c.receiver.tones]),
        ("noise_corner_hz", corner if support(corner)[1] > 0 else None),
    ):
        if value:
            right = f"should be left out with {c.radar.named}: it is of one channel"
            yield Problem(f"receiver.{name}", value, right)
    if c.engine.motion_in_chirp:
        right = f"should be false with {c.radar.named}: positions are frozen when a chirp begins"
        yield Problem("engine.motion_in_chirp", True, right)


def waveform_problems(c: AnyRequest) -> Iterator[Problem]:
    """Find the keys that do not fit the pulses: chirps too long, FFTs too short."""
    radar, fft_length = c.radar, c.processing.range_fft_length
    if not radar.sweeps:
        right = f"should be left out with {radar.named}, which has no chirp"
        for key in ("processing.range_fft_length", "processing.range_reference"):
            if at(c, key) not in (None, "centre"):
                yield Problem(key, at(c, key), right)
        return
    smallest_count, largest_count = waveform_at(c).n_adc, waveform_at(c, *ENDS).n_adc
    shortest_interval = 1 / support(radar.prf_hz)[1]
    samples = "ADC samples per chirp (adc_rate_hz * chirp_s is"
    if support(radar.chirp_s)[1] > shortest_interval * ROUNDING:
        longest = support(radar.chirp_s)[1]
        interval = show_beside(shortest_interval, longest)
        right = f"should be at most the pulse interval 1/prf_hz = {interval} s"
        assert isinstance(radar, FmcwRadar | SfcwRadar | FramesRadar)
        yield _problem_of_length(radar, longest, shortest_interval, right)
    if smallest_count < 2:
        right = f"should give at least 2 {samples} {smallest_count})"
        yield Problem("radar.adc_rate_hz", radar.adc_rate_hz, right)
    if largest_count > 2**20:
        right = f"should give at most {2**20} {samples} {largest_count})"
        yield Problem("radar.adc_rate_hz", radar.adc_rate_hz, right)
    key = "processing.range_fft_length"
    if fft_length is not None and fft_length < largest_count:
        right = f"should be null or an even number of at least the {largest_count} ADC samples"
        yield Problem(key, fft_length, right)
    if fft_length is not None and fft_length > MAX_PADDING * smallest_count:
        right = f"should be null or at most {MAX_PADDING} times the {smallest_count} ADC samples"
        yield Problem(key, fft_length, right)
