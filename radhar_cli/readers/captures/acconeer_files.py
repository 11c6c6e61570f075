"""Frames of recordings of acconeer's Exploration Tool (A121, HDF5), by their own settings.

`ENTRY/result/frame` holds [frame, sweep, point], integers `real` and `imag`; JSON texts are
`session_config` of the session, with sweeps and points of the sensor, and `ENTRY/metadata`
(acconeer, "File format reference - A121"). Point n lies at (start_point + n step_length) times
base_step_length_m.
"""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from radhar_cli.errors import CaptureError, FolderError
from radhar_cli.files.untrusted import parse_json
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.readers.captures.settings import AxisName
from radhar_cli.readers.untrusted_hdf5 import UntrustedFile

FRAME = "/result/frame"
CARRIER_HZ = 60.5e9
# Width of the pulse at half of its power, m, of profiles 1 to 5 (acconeer, "A121 handbook").
WIDTHS_M = (0.04, 0.07, 0.14, 0.19, 0.32)
_PROFILE = re.compile(r"(?:\w*\.)?(?:profile)?[ _-]?([1-5])(?:\.0)?", re.IGNORECASE)
_ENTRY = re.compile(r"group_(\d+)/entry_(\d+)$")


class SparseIq(NamedTuple):
    """Frames of an acconeer recording.

    Attributes:
        axes: Names of the axes of its frames.
        settings: Fields of `CaptureSettings` that it contains.
        notes: What was found, in words.
        points: Points of a sweep that are read.
    """

    axes: tuple[AxisName, ...]
    settings: Mapping[str, Any]
    notes: tuple[str, ...]
    points: slice


def read_sparse_iq(file: UntrustedFile, frame: str, subsweep: int | None) -> SparseIq | None:
    """Read what a recording says of its frames.

    Args:
        file: the recording.
        frame: path of the frames.
        subsweep: number of the subsweep that is read; None of a recording of one.

    Returns:
        Axes and settings; None of a file that is of something else.

    Raises:
        CaptureError: it has several subsweeps, and none of them, or no such, is chosen.
    """
    entry = frame.removesuffix(FRAME)
    session = entry.rpartition("/group_")[0]
    try:
        config = parse_json(file.scalar_text(f"{session}/session_config"))
        metadata = parse_json(file.scalar_text(f"{entry}/metadata"))
    except (FolderError, ValueError):
        return None
    sensor = _find_sensor(config, entry)
    shape = file.shape(frame)
    if sensor is None or not isinstance(metadata, dict) or len(shape) != 3:
        return None
    subsweeps = _read_subsweeps(sensor["subsweeps"], metadata)
    if subsweeps is None:
        return None
    if subsweeps[-1].offset + subsweeps[-1].points != shape[2]:
        return None
    chosen = _choose_subsweep(subsweeps, subsweep, str(file.path))
    settings = {
        "holds": "profiles",
        "carrier_hz": CARRIER_HZ,
        "range_step_m": chosen.step_m,
        **({"first_range_m": chosen.start_m} if chosen.start_m >= 0 else {}),
        **_band(chosen.profile),
    }
    is_single = shape[1] == 1
    rates = {
        "prf_hz": sensor.get("sweep_rate") or metadata.get("max_sweep_rate"),
        "frame_s": 1 / sensor["frame_rate"] if sensor.get("frame_rate") else None,
    }
    if is_single:  # a sweep a frame is slow time without frames
        rates = {"prf_hz": sensor.get("frame_rate") or config.get("update_rate"), "frame_s": None}
    known = {key: float(rate) for key, rate in rates.items() if rate}
    axes: tuple[AxisName, ...] = ("frame", "pulse", "sample")
    several = f"subsweep {subsweep} of {len(subsweeps)}, " * (len(subsweeps) > 1)
    return SparseIq(
        ("pulse", "receiver", "sample") if is_single else axes,
        settings | known,
        (f"acconeer's recording: {several}points every {chosen.text}",),
        slice(chosen.offset, chosen.offset + chosen.points),
    )


class Subsweep(NamedTuple):
    """Points of a sweep that have one profile.

    Attributes:
        start_m: Range of the first point, m.
        step_m: Step to the next, m.
        points: Number of points.
        profile: Profile of the pulse, as it stands in the file.
        offset: Number of the first point within a sweep.
    """

    start_m: float
    step_m: float
    points: int
    profile: object
    offset: int

    @property
    def text(self) -> str:
        """Words for its points."""
        return f"{self.step_m * 1e3:.4g} mm from {self.start_m:.4g} m"


def _read_subsweeps(items: list[Any], metadata: dict[str, Any]) -> list[Subsweep] | None:
    """Subsweeps of a sensor, one after the other; None where numbers are missing."""
    base, offset = metadata.get("base_step_length_m"), 0
    subsweeps = list[Subsweep]()
    for item in items:
        keys = ("start_point", "step_length", "num_points")
        values = [base, *(item.get(key) if isinstance(item, dict) else None for key in keys)]
        numbers = [float(value) for value in values if isinstance(value, int | float)]
        if len(numbers) < len(values):
            return None
        base_m, start, step, points = numbers
        profile = item.get("profile")
        subsweeps.append(Subsweep(start * base_m, step * base_m, int(points), profile, offset))
        offset += int(points)
    return subsweeps


def _choose_subsweep(subsweeps: list[Subsweep], number: int | None, where: str) -> Subsweep:
    """The subsweep that is read.

    Raises:
        CaptureError: there are several, and none of them, or no such, is chosen.
    """
    if number is None and len(subsweeps) == 1:
        return subsweeps[0]
    if number is None or number >= len(subsweeps):
        ranges = "; ".join(
            f"{n}: {s.points} points every {s.text}" for n, s in enumerate(subsweeps)
        )
        last = len(subsweeps) - 1
        several = f"{last + 1} subsweeps" if last else "1 subsweep"
        advice = f"say which is read, from 0 to {last}" if last else "be 0 or left out"
        raise CaptureError(
            f"{where}: is an acconeer recording of {several} ({ranges}); --set subsweep=N should "
            + advice
        )
    return subsweeps[number]


def _find_sensor(config: object, entry: str) -> dict[str, Any] | None:
    """Find the section of the sensor of an entry, such as .../group_0/entry_1, in a config."""
    place = _ENTRY.search(entry)
    groups = config.get("groups") if isinstance(config, dict) else None
    if isinstance(groups, list) and place is not None and int(place[1]) < len(groups):
        group = groups[int(place[1])]
        sensors = [*group.values()] if isinstance(group, dict) else []
        config = sensors[int(place[2])] if int(place[2]) < len(sensors) else group
    return _find_subsweeps(config)


def _find_subsweeps(config: object, depth: int = 0) -> dict[str, Any] | None:
    """Find the first section with subsweeps in a config."""
    if isinstance(config, dict) and isinstance(config.get("subsweeps"), list):
        return config if config["subsweeps"] else None
    if depth > 6 or not isinstance(config, dict | list):
        return None
    items = config.values() if isinstance(config, dict) else config
    return next((s for item in items if (s := _find_subsweeps(item, depth + 1))), None)


def _band(profile: object) -> dict[str, float]:
    """Bandwidth whose resolution is the width of the pulse of a profile.

    A profile is a number from 1 to 5, or a word that ends in it, such as PROFILE_3.
    """
    word = _PROFILE.fullmatch(str(profile))
    if word is None or isinstance(profile, bool):
        return {}
    return {"bandwidth_hz": SPEED_OF_LIGHT / (2 * WIDTHS_M[int(word[1]) - 1])}
