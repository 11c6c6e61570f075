"""What a recording of acconeer's Exploration Tool (A121, HDF5) says of its frames.

`ENTRY/result/frame` holds [frame, sweep, point], integers `real` and `imag`; JSON texts are
`session_config` of the session, with sweeps and points of the sensor, and `ENTRY/metadata`
(acconeer, "File format reference - A121"). Point n lies at (start_point + n step_length) times
base_step_length_m.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from radhar_cli.capture.settings import AxisName
from radhar_cli.dataset.untrusted_hdf5 import UntrustedFile
from radhar_cli.errors import FolderError
from radhar_cli.files.untrusted import parse_json
from radhar_cli.numerics.constants import SPEED_OF_LIGHT

FRAME = "/result/frame"
CARRIER_HZ = 60.5e9
# Width of the pulse at half of its power, m, of profiles 1 to 5 (acconeer, "A121 handbook").
WIDTHS_M = (0.04, 0.07, 0.14, 0.19, 0.32)


class SparseIq(NamedTuple):
    """Frames of an acconeer recording.

    Attributes:
        axes: Names of the axes of its frames.
        settings: Fields of `CaptureSettings` that it contains.
        notes: What was found, in words.
    """

    axes: tuple[AxisName, ...]
    settings: Mapping[str, Any]
    notes: tuple[str, ...]


def read_sparse_iq(file: UntrustedFile, frame: str) -> SparseIq | None:
    """Read what a recording says of its frames.

    Args:
        file: the recording.
        frame: path of the frames.

    Returns:
        Axes and settings; None of a file that is of something else, or has several subsweeps,
        whose keys the user has to give.
    """
    entry = frame.removesuffix(FRAME)
    session = entry.rpartition("/group_")[0]
    try:
        config = parse_json(file.scalar_text(f"{session}/session_config"))
        metadata = parse_json(file.scalar_text(f"{entry}/metadata"))
    except (FolderError, ValueError):
        return None
    sensor = _find_sensor(config)
    if sensor is None or not isinstance(metadata, dict) or len(file.shape(frame)) != 3:
        return None
    subsweep, base = sensor["subsweeps"][0], metadata.get("base_step_length_m")
    numbers = [base, subsweep.get("start_point"), subsweep.get("step_length")]
    if not all(isinstance(number, int | float) for number in numbers):
        return None
    step, start = subsweep["step_length"] * base, subsweep["start_point"] * base
    settings = {
        "holds": "profiles",
        "carrier_hz": CARRIER_HZ,
        "range_step_m": step,
        **({"first_range_m": start} if start >= 0 else {}),
        **_band(subsweep.get("profile")),
    }
    is_single = file.shape(frame)[1] == 1
    rates = {
        "prf_hz": sensor.get("sweep_rate") or metadata.get("max_sweep_rate"),
        "frame_s": 1 / sensor["frame_rate"] if sensor.get("frame_rate") else None,
    }
    if is_single:  # a sweep a frame is slow time without frames
        rates = {"prf_hz": sensor.get("frame_rate") or config.get("update_rate"), "frame_s": None}
    known = {key: float(rate) for key, rate in rates.items() if rate}
    axes: tuple[AxisName, ...] = ("frame", "pulse", "sample")
    return SparseIq(
        ("pulse", "receiver", "sample") if is_single else axes,
        settings | known,
        (f"acconeer's recording: points every {step * 1e3:.4g} mm from {start:.4g} m",),
    )


def _find_sensor(config: object, depth: int = 0) -> dict[str, Any] | None:
    """Find the section of the first sensor with one subsweep in a config of a session."""
    if isinstance(config, dict) and isinstance(config.get("subsweeps"), list):
        is_plain = len(config["subsweeps"]) == 1 and isinstance(config["subsweeps"][0], dict)
        return config if is_plain else None
    if depth > 6 or not isinstance(config, dict | list):
        return None
    items = config.values() if isinstance(config, dict) else config
    sensors = [sensor for item in items if (sensor := _find_sensor(item, depth + 1))]
    return sensors[0] if sensors else None


def _band(profile: object) -> dict[str, float]:
    """Bandwidth whose resolution is the width of the pulse of a profile, 1 to 5."""
    number = profile if isinstance(profile, int) else 0
    if not 1 <= number <= len(WIDTHS_M):
        return {}
    return {"bandwidth_hz": SPEED_OF_LIGHT / (2 * WIDTHS_M[number - 1])}
