"""Frozen, strict models of the YAML file, and how they are read."""

from radhar_cli.config.checks import timing_warnings, tone_warnings
from radhar_cli.config.identity import config_hash, resolved
from radhar_cli.config.reading import load_config
from radhar_cli.config.schema import MAP_NAMES, Config

__all__ = [
    "MAP_NAMES",
    "Config",
    "config_hash",
    "load_config",
    "resolved",
    "timing_warnings",
    "tone_warnings",
]
