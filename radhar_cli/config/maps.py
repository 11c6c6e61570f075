"""Names of the maps that a data set may hold."""

from collections.abc import Sequence
from typing import Annotated

from pydantic import AfterValidator

from radhar_cli.extensions import is_known, own_products
from radhar_cli.processing.angle_time import ANGLE_TIME_KINDS
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS
from radhar_cli.processing.map_kind import CADENCE_KINDS, MAP_KINDS
from radhar_cli.schema.number import value_error

MAP_NAMES = tuple(MAP_KINDS)

# Cadence-velocity diagrams of Doppler-time maps.
CADENCE_MAPS = tuple(CADENCE_KINDS)
ANY_CADENCE = "<Doppler-time map>_cadence"  # all of them in a message

# Maps over time that frames of an array make.
ANGLE_TIME_MAPS = tuple(ANGLE_TIME_KINDS)

# Maps of a board, frame by frame: data sets hold them as arrays, and sheets of frames as images.
MIN_LOOPS = 4  # of a frame: of 2 or fewer, a Hann window keeps one


FRAME_MAPS = (*FRAME_MAP_KINDS, "points")


# Every map that radhar makes, in the order of data sets.
KNOWN_MAPS = (*MAP_NAMES, *CADENCE_MAPS, *ANGLE_TIME_MAPS, *FRAME_MAPS)


# Those that data sets of recordings of samples may have.
MAPS_OF_SAMPLES = tuple(name for name in KNOWN_MAPS if name != "points")


# What comes with the points, and with any of these maps.
OF_POINTS = ("points", "points_start", "points_person")


OF_FRAMES = ("skeleton", "skeleton_velocity")


def without_cadences(names: Sequence[str]) -> list[str]:
    """Shorten a list of maps for a message: diagrams of cadences are one entry, the last."""
    others = [name for name in names if name not in CADENCE_MAPS]
    return others + [ANY_CADENCE] * (len(others) < len(names))


def _known_map(name: str) -> str:
    if name not in KNOWN_MAPS and not is_known(name):
        names = (*without_cadences(KNOWN_MAPS), *(product.name for product in own_products()))
        right = " or ".join(filter(None, (", ".join(map(repr, names[:-1])), repr(names[-1]))))
        raise value_error(f"should be {right}")
    return name


MapName = Annotated[str, AfterValidator(_known_map)]


def _maps_in_order(value: tuple[str, ...]) -> tuple[str, ...]:
    if not value:
        raise value_error("should name at least 1 map")
    if len(set(value)) != len(value):
        raise value_error("should name each map once")
    extensions = [name for name in value if name not in KNOWN_MAPS]
    return (*sorted(set(value) - set(extensions), key=KNOWN_MAPS.index), *extensions)


Maps = Annotated[tuple[MapName, ...], AfterValidator(_maps_in_order)]
