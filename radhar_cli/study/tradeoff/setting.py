"""A setting that is tried: overrides of a config, and what its data are compared with."""

from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import TypeAlias

Overrides: TypeAlias = tuple[str, ...]  # dotted `key=value` pairs
DEFAULT = "the config as it is"


class Change(StrEnum):
    """What another setting does to the data."""

    ERROR = "error"  # another computation of the same physics
    PICTURE = "another picture"  # other physics, or other parameters


class Worth(IntEnum):
    """Order in which settings are tried where there is no time for all: the smallest first."""

    SAVES = 1  # settings that may save time
    ENGINE = 2
    PROCESSING = 3
    PHYSICS = 4  # physics that the config leaves out
    SLOW = 5  # settings that may take many times as long


@dataclass(frozen=True)
class Setting:
    """One row of the table."""

    group: str  # part of radhar that it belongs to, in a word
    name: str  # key and value, or what is changed in words
    overrides: Overrides = ()
    base: Overrides = ()  # overrides of the data that it is compared with, in time and picture
    base_name: str = DEFAULT  # name of those data
    effect: Change = Change.PICTURE  # whether data differ by an error, or by design
    is_noisy: bool = False  # whether pictures are compared with the config's noise
    worth: Worth = Worth.PROCESSING  # order in which it is tried


def keyed(group: str, override: str, worth: Worth, effect: Change = Change.PICTURE) -> Setting:
    """Setting of one key, which names it."""
    key, _, value = override.partition("=")
    return Setting(group, f"{key}: {value}", (override,), effect=effect, worth=worth)
