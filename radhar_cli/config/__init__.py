"""Frozen, strict models of the YAML file, and how they are read."""

from radhar_cli.processes.start_up import without_collection

with without_collection():  # a sixth of the time that these take
    from radhar_cli.config.checks.doubts import timing_warnings, tone_warnings
    from radhar_cli.config.data_set import Config
    from radhar_cli.config.identity import config_hash, resolved
    from radhar_cli.config.maps import MAP_NAMES
    from radhar_cli.config.reading import load_config, load_radars

__all__ = [
    "MAP_NAMES",
    "Config",
    "config_hash",
    "load_config",
    "load_radars",
    "resolved",
    "timing_warnings",
    "tone_warnings",
]
