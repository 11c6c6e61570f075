"""The header of a capture with a TI radar: mmWave Studio's JSON, or the .cfg of the SDK's demos."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from radhar_cli.config.built_in_radars import device_of
from radhar_cli.config.documents import RADARS
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import read_json, text_of
from radhar_cli.radar.frame_timing import FrameTiming
from radhar_cli.readers.captures.infineon_header import is_infineon, read_infineon
from radhar_cli.readers.ti.lvds_format import LvdsFormat, read_lvds_format, sends_samples
from radhar_cli.readers.ti.ti_cfg import MAX_CFG, parse_frames
from radhar_cli.readers.ti.ti_lua import read_lua
from radhar_cli.readers.ti.ti_studio import read_studio


def read_ti_settings(path: Path) -> dict[int, dict[str, Any]]:
    """Read the settings of a capture (fields of `CaptureSettings`) from a TI header.

    Args:
        path: mmWave Studio's JSON or script, the JSON of Infineon's SDK, or a .cfg of TI's demos.

    Returns:
        {number: settings} of each subframe in the order of the stream; 0 of a frame without.

    Raises:
        CaptureError: The file cannot be read, or describes what is not supported; names file,
            field, value and what would be right.
    """
    if path.suffix.lower() == ".json":
        document = read_json(path)
        if is_infineon(document):
            return {0: read_infineon(document, path)}
    readers = {".json": read_studio, ".lua": read_lua}
    if reader := readers.get(path.suffix.lower()):
        timing, stream = reader(path)
        return {0: settings_of_frames(timing) | _settings_of_stream(stream)}
    built_in = {"device": device_of(path.stem)} if path in RADARS.values() else {}
    return read_cfg_settings(text_of(path, MAX_CFG, CaptureError), str(path), built_in)


def read_cfg_settings(
    text: str, where: str, radar: Mapping[str, Any] = MappingProxyType({})
) -> dict[int, dict[str, Any]]:
    """Read the settings of a capture from the text of a .cfg.

    Args:
        text: the .cfg.
        where: its path, for messages.
        radar: keys of a config's section `radar` that are known besides it, such as the device.

    Returns:
        {number: settings} of each subframe in the order of the stream; 0 of a frame without.

    Raises:
        CaptureError: as `read_ti_settings`.
    """
    settings = dict[int, dict[str, Any]]()
    for timing, stream in _read_cfg(text, where):
        section = {"cfg": text, **radar} | (
            {"subframe": timing.subframe} if timing.subframe else {}
        )
        settings[timing.subframe] = {
            **settings_of_frames(timing),
            **_settings_of_stream(stream),
            "radar": section,
        }
    return settings


def settings_of_frames(timing: FrameTiming) -> dict[str, Any]:
    """Settings of a frame, or of a subframe of it, whatever holds its samples."""
    return {
        "carrier_hz": timing.carrier_hz,
        "bandwidth_hz": timing.bandwidth_hz,
        "adc_rate_hz": timing.adc_rate_hz,
        "prf_hz": timing.prf_hz,
        "samples": timing.samples,
        "transmitters": len(timing.masks),
        "frame_pulses": timing.loops,
        "frame_s": timing.period_s,
        "frame_delay_s": timing.delay_s,
        "receivers": len(timing.receivers),
        "receiver_lanes": list(timing.receivers),
        "complex": not timing.is_real,
        "adc_bits": timing.adc_bits,
    }


def _settings_of_stream(stream: LvdsFormat) -> dict[str, Any]:
    """Settings of TI's stream of words."""
    return {
        "lanes": stream.lanes,
        "interleaved": stream.is_interleaved,
        "iq": "qi" if stream.is_q_first else "iq",
    }


def _read_cfg(text: str, where: str) -> list[tuple[FrameTiming, LvdsFormat]]:
    """Read the subframes that are in the stream: all, where the file sends none of them."""
    timings, lines = parse_frames(text, where)
    sent = [timing for timing in timings if sends_samples(lines, timing.subframe)]
    return [(timing, read_lvds_format(lines, timing.subframe)) for timing in sent or timings]
