"""Sections `motion` of configs, written flat."""

from collections.abc import Mapping
from typing import Any

from radhar_cli.config.motion import EARLIER_KEYS

_PLACES = {earlier.partition(".")[2]: key.split(".")[1:] for key, earlier in EARLIER_KEYS.items()}


def in_groups(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Put numbers of movements, such as `speed_mps`, into the groups of `motion`."""
    motion: dict[str, Any] = {}
    for name, number in numbers.items():
        if name in _PLACES:
            group, key = _PLACES[name]
            motion.setdefault(group, {})[key] = number
        else:
            motion[name] = number
    return motion
