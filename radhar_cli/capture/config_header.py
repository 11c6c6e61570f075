"""The header of a capture in YAML: keys of radhar, or a config with the radar that was recorded."""

from pathlib import Path
from typing import Any, assert_never

from radhar_cli.capture.ti_header import read_cfg_settings, settings_of_frames
from radhar_cli.config.data_set import Config, ConfigOfRecordings
from radhar_cli.config.documents import BASE, read_document
from radhar_cli.config.identity import resolved
from radhar_cli.config.radar import (
    BoardRadar,
    CwRadar,
    FmcwRadar,
    FramesRadar,
    ImpulseRadar,
    SfcwRadar,
)
from radhar_cli.config.reading import load_config
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.rounding import half_up
from radhar_cli.readers.captures.settings import CaptureSettings
from radhar_cli.schema.number import nominal


def read_yaml_settings(path: Path) -> dict[int, dict[str, Any]]:
    """Read the settings of a capture from YAML.

    Args:
        path: file of radhar's keys, or a config.

    Returns:
        {number: settings} of each subframe, which boards alone have; else {0: settings}.

    Raises:
        CaptureError: it is a config that says no radar.
        ConfigError: it cannot be read, or is no such config.
    """
    document = read_document(path)[0]
    names = {str(name) for name in document}
    header_keys = names & (CaptureSettings.model_fields.keys() - {"radar"})
    if header_keys or not names & {*Config.model_fields, BASE}:
        return {0: document}
    if not names & {"radar", BASE}:
        raise CaptureError(
            f"{path}: is a config without `radar`, and says nothing of a capture; should have the "
            "keys of a header, such as carrier_hz, or a section radar"
        )
    config = load_config(path, kind=ConfigOfRecordings).filled()
    radar, note = config.radar, radar_note(config)
    if isinstance(radar, BoardRadar):
        more = {key: value for key, value in note.items() if key not in ("cfg", "subframe")}
        return read_cfg_settings(radar.cfg, f"{path}: radar.cfg", more)
    return {0: _settings_of(radar) | {"radar": note}}


def radar_note(config: Config) -> dict[str, Any]:
    """Section `radar` of a config as a recording keeps it: plain values, without nulls."""
    section = resolved(config)["radar"]
    return {key: value for key, value in section.items() if value is not None}


def _settings_of(
    radar: FmcwRadar | SfcwRadar | CwRadar | ImpulseRadar | FramesRadar,
) -> dict[str, Any]:
    """Settings of a capture of a radar, whose numbers are taken at their middle."""
    if isinstance(radar, FramesRadar):
        settings = settings_of_frames(radar.timing)
        of_chirps = () if radar.has_range else ("bandwidth_hz", "adc_rate_hz", "samples")
        return {key: value for key, value in settings.items() if key not in of_chirps}
    carrier, prf = nominal(radar.carrier_hz), nominal(radar.prf_hz)
    settings = {"carrier_hz": carrier, "prf_hz": prf}
    match radar:
        case CwRadar():
            return settings
        case ImpulseRadar():
            first, last = map(float, radar.profile_m)
            band = nominal(radar.bandwidth_hz)
            return settings | {
                "carrier_hz": carrier + band / 2,
                "bandwidth_hz": band,
                "samples": radar.profile_samples,
                "first_range_m": first,
                "range_step_m": (last - first) / radar.profile_samples,
            }
        case SfcwRadar():
            samples, rate, share = radar.steps, radar.adc_rate_hz, 1.0
        case FmcwRadar():
            rate = nominal(radar.adc_rate_hz)
            samples = half_up(rate, nominal(radar.chirp_s))
            share = samples / rate / nominal(radar.chirp_s)  # of the sweep that is sampled
        case _:
            assert_never(radar)
    band = nominal(radar.bandwidth_hz) * share
    return settings | {"bandwidth_hz": band, "adc_rate_hz": rate, "samples": samples}
