"""The header of a capture with a TI radar: mmWave Studio's JSON, or the .cfg of the SDK's demos."""

from pathlib import Path
from typing import Any

from radhar_cli.capture.lvds_format import LvdsFormat, read_lvds_format
from radhar_cli.capture.ti_lua import read_lua
from radhar_cli.capture.ti_studio import read_studio
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import text_of
from radhar_cli.radar.frame_header import FrameHeader, Sampling
from radhar_cli.radar.ti_cfg import MAX_CFG, parse_frames


def read_ti_settings(path: Path) -> dict[str, Any]:
    """Read the settings of a capture (fields of `CaptureSettings`) from a TI header.

    Args:
        path: mmWave Studio's JSON, or a .cfg of the SDK's demos.

    Raises:
        CaptureError: The file cannot be read, or describes what is not supported; names file,
            field, value and what would be right.
    """
    readers = {".json": read_studio, ".lua": read_lua}
    header, stream = readers.get(path.suffix.lower(), _read_cfg)(path)
    return {
        "carrier_hz": header.carrier_hz,
        "bandwidth_hz": header.bandwidth_hz,
        "adc_rate_hz": header.adc_rate_hz,
        "prf_hz": header.prf_hz,
        "samples": header.samples,
        "transmitters": len(header.masks),
        "frame_pulses": header.loops,
        "frame_s": header.period_s,
        "receivers": len(header.receivers),
        "receiver_lanes": list(header.receivers),
        "complex": header.sampling is not Sampling.REAL,
        "adc_bits": header.adc_bits,
        "lanes": stream.lanes,
        "interleaved": stream.is_interleaved,
        "iq": "qi" if stream.is_q_first else "iq",
    }


def _read_cfg(path: Path) -> tuple[FrameHeader, LvdsFormat]:
    header, lines = parse_frames(text_of(path, MAX_CFG, CaptureError), str(path))
    return header, read_lvds_format(lines)
