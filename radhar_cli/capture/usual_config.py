"""The config by which a recording of slow time is processed where none is named."""

from collections.abc import Sequence
from pathlib import Path

from radhar_cli.capture.content import SlowTime
from radhar_cli.capture.fitted_radar import radar_of_recording
from radhar_cli.capture.recording import Recording
from radhar_cli.config.data_set import Config, ConfigOfRecordings
from radhar_cli.config.reading import validated, with_overrides


def has_usual_config(recording: Path) -> bool:
    """Whether a recording is slow time of one receiver, which has few ways to be processed."""
    if not recording.exists():
        return False
    with Recording(recording) as opened:
        return isinstance(opened.info.content, SlowTime) and opened.info.receivers == 1


def usual_config(recording: Path, overrides: Sequence[str]) -> Config:
    """Config of Doppler over time without static echoes.

    Args:
        recording: recording of slow time.
        overrides: KEY=VALUE of the config.

    Raises:
        ConfigError: an override cannot be used.
    """
    with Recording(recording) as opened:
        radar = radar_of_recording(opened, overrides)
    document = {"radar": radar, "maps": ["stft"], "processing": {"clutter": "mean"}}
    return validated(ConfigOfRecordings, with_overrides(document, overrides), "--set", {})
