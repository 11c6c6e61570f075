"""Which maps the radar of a config makes, and why not the others."""

from itertools import pairwise

from radhar_cli.config.maps import FRAME_MAPS, MAP_NAMES, MIN_LOOPS
from radhar_cli.config.processing import MIN_WINDOW
from radhar_cli.config.radar import RadarConfig
from radhar_cli.config.request import AnyRequest, Request
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.radar.board import MAX_SIDELOBE, Places, longest_rows, sidelobe


def possible_maps(config: Request) -> tuple[str, ...]:
    """The maps that the radar of a config makes, and the cube of a board.

    Without those of a board whose frames are shorter than the filter of the denoised maps.
    """
    names: tuple[str, ...] = (*MAP_NAMES, *FRAME_MAPS, "cube")
    if config.radar.cfg is not None and config.processing.savgol.frame > config.radar.header.loops:
        names = tuple(name for name in names if "denoised" not in name)
    return tuple(name for name in names if why_no_map(config, name) is None)


def why_no_map(config: "AnyRequest", name: str) -> str | None:
    """Why the radar of a config cannot make a map of that name, or the cube; None if it can."""
    radar, gated = config.radar, config.processing.range_sum == "gated"
    if name in (*FRAME_MAPS, "cube"):
        if radar.cfg is None:
            return f"{name} is of the frames of a board (radar.cfg, docs/guide/boards.md)"
        return _why_no_frames(config, name)
    if name not in MAP_NAMES:  # of a user's own
        return None
    if radar.cfg is not None and name != "rtm" and radar.header.loops < MIN_WINDOW:
        loops = f"{radar.header.loops} loop{'s' * (radar.header.loops > 1)}"
        return f"the {loops} of a frame (radar.cfg, frameCfg) are fewer than {MIN_WINDOW} pulses"
    if radar.waveform == "cw" and name == "rtm":
        return "radar.waveform: cw has no range"
    if radar.waveform == "cw" and radar.output == "real" and "compensated" in name:
        return "radar.output: real has no sign of the Doppler"
    if radar.waveform == "impulse" and name not in ("rtm", "stft"):
        return "radar.waveform: impulse takes real samples"
    if radar.waveform == "impulse" and name == "stft" and not gated:
        return (
            "the real samples of radar.waveform: impulse have no mean over range; "
            "stft needs processing.range_sum: gated"
        )
    if gated and name.startswith("fsst"):
        cause = "processing.range_sum: gated"
        if radar.cfg is not None and "range_sum" not in config.processing.model_fields_set:
            cause += ", the default of boards,"
        return f"{cause} adds up powers of bins, and the fsst moves coefficients by their phase"
    return None


def _why_no_frames(config: "AnyRequest", name: str) -> str | None:
    """Why a board cannot make the cube or a map of its frames; None if it can.

    A board that lacks elements which its .cfg names is refused elsewhere.
    """
    header, places = config.radar.header, _virtual_places(config.radar)
    if name in ("range_doppler", "points") and header.loops < MIN_LOOPS:
        loops = f"{header.loops} loop{'s' * (header.loops > 1)}"
        return f"the {loops} of a frame (radar.cfg, frameCfg) show no Doppler; {MIN_LOOPS} do"
    if not places:
        return None
    for axis, (of, line) in enumerate((("range_azimuth", "column"), ("range_elevation", "row"))):
        if name == of and len({round(place[axis], 6) for place in places}) == 1:
            return f"all elements of the array lie in one {line}"
    if name == "points" and isinstance(config, Request):
        return _why_no_points(config, places)
    return None


def _why_no_points(config: Request, places: Places) -> str | None:
    """Why the elements of a board do not tell where points are; None if they do.

    The firmware's chain takes the elements of a row for neighbours. The other knows their places,
    but takes high sidelobes of a sparse row for targets of their own.
    """
    row = [places[v][0] for v in longest_rows(places, 0)[0]]
    apart, chain = [after - before for before, after in pairwise(row)], config.cloud.chain
    if not apart:
        return None
    neighbours = min(apart) >= 0.8 and max(apart) <= 1.2
    if neighbours or (chain == "best" and min(apart) <= 1.2 and sidelobe(row) <= MAX_SIDELOBE):
        return None
    at = ", ".join(f"{place:g}" for place in row)
    return (
        f"the longest row of the array, with elements at {at} half wavelengths, does not tell "
        f"azimuths apart for the points of cloud.chain: {chain}"
    )


def _virtual_places(radar: RadarConfig) -> Places:
    """Places of a board's virtual elements, half wavelengths; none where elements are missing."""
    array, board = radar.elements, radar.header
    if array is None:
        return ()
    if max(board.order) >= len(array.tx) or max(board.receivers) >= len(array.rx):
        return ()
    scale = 1.0
    if radar.half_wavelength_m is not None:
        centre = board.carrier_hz + board.slope_hz * (board.samples - 1) / (2 * board.adc_rate_hz)
        scale = radar.half_wavelength_m * 2 * centre / SPEED_OF_LIGHT
    return tuple(
        (scale * (array.tx[t][0] + array.rx[r][0]), scale * (array.tx[t][1] + array.rx[r][1]))
        for t in board.order
        for r in board.receivers
    )
