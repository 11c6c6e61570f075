"""Conditions under which a key acts that several sections share."""

from radhar_cli.processing.angle_time import ANGLE_TIME_KINDS
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, RANGE
from radhar_cli.processing.map_kind import CADENCE_KINDS, MAP_KINDS, RTM, Transform
from radhar_cli.schema.annotations import OfRadar, OnlyMaps, Unless

FRAMES = "board", "frames", "sfcw_frames", "cw_frames"  # kinds of radars with frames
BOARD = OfRadar(*FRAMES)
NO_BOARD = OfRadar("fmcw", "sfcw", "cw", "impulse")
CHIRPS = OfRadar("fmcw", "sfcw", "board", "frames", "sfcw_frames")
RANGES = OfRadar("fmcw", "sfcw", "impulse", "board", "frames", "sfcw_frames")
NO_IMPULSE = OfRadar("fmcw", "sfcw", "cw", *FRAMES)
EVEN = Unless("radar.frames_apart", "the pauses between frames (radar.cfg or radar.frame)")
RANGE_TIME = OnlyMaps((str(RTM),))
SIGNAL_MAPS = OnlyMaps((*MAP_KINDS, *CADENCE_KINDS))
CADENCES = OnlyMaps(tuple(CADENCE_KINDS))
OVER_RANGE = OnlyMaps(
    (
        str(RTM),
        *(kind.name for kind in FRAME_MAP_KINDS.values() if kind.rows is RANGE),
        *ANGLE_TIME_KINDS,
    )
)
_DOPPLER = {n: k for n, k in (MAP_KINDS | CADENCE_KINDS).items() if k.is_doppler_time}
SPECTRA = OnlyMaps(tuple(_DOPPLER))
STFTS, FSSTS = (
    OnlyMaps(tuple(name for name, kind in _DOPPLER.items() if kind.transform is transform))
    for transform in (Transform.STFT, Transform.FSST)
)
DENOISED = OnlyMaps(tuple(name for name, kind in _DOPPLER.items() if kind.treatment.denoised))
