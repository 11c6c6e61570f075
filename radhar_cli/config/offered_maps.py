"""Which maps the radar of a config makes, and why not the others."""

from radhar_cli.config.checks.smallest_waveform import fewest_windows
from radhar_cli.config.first_level import AnyRequest, Request
from radhar_cli.config.maps import ANGLE_TIME_MAPS, CADENCE_MAPS, FRAME_MAPS, KNOWN_MAPS
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.processing.map_kind import MIN_CADENCE_WINDOWS, kind_of, treatment_of


def possible_maps(config: Request) -> tuple[str, ...]:
    """The maps that the radar of a config makes, and the cube of a board.

    Without those of a board whose frames are shorter than the filter of the denoised maps, and
    without cadences where recordings have too few windows for them.
    """
    radar = config.radar
    names = [*KNOWN_MAPS, "cube"]
    if isinstance(radar, ArrayRadar) and config.processing.savgol.frame > radar.timing.loops:
        names = [name for name in names if not treatment_of(name).denoised]
    if fewest_windows(config) < MIN_CADENCE_WINDOWS:
        names = [name for name in names if name not in CADENCE_MAPS]
    return tuple(name for name in names if why_no_map(config, name) is None)


def why_no_map(config: AnyRequest, name: str) -> str | None:
    """Return why the radar of a config cannot make a map or the cube; None if it can."""
    radar = config.radar
    if name in (*ANGLE_TIME_MAPS, *FRAME_MAPS, "cube"):
        why = radar.why_no_frames(name)
        if why is None and name == "points" and isinstance(radar, ArrayRadar):
            chain = config.cloud.chain if isinstance(config, Request) else "best"
            why = radar.why_no_points(chain)
        return why
    kind = kind_of(name)
    if kind is None:  # of a user's own
        return None
    return radar.why_no_map(kind, _gating(config))


def _gating(config: AnyRequest) -> str | None:
    """Name the key that makes Doppler maps those of a gate; None where none does."""
    processing = config.processing
    if processing.range_sum != "gated":
        return None
    by_default = "range_sum" not in processing.model_fields_set
    is_board = isinstance(config.radar, ArrayRadar)
    return "processing.range_sum: gated" + ", the default of boards," * (by_default and is_board)
