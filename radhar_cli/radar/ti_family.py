"""Families of TI's software, whose .cfg files differ."""

from enum import Enum


class Family(Enum):
    """Software whose .cfg has a command; `ANY` where all that have it agree."""

    ANY = "all"
    SDK_1_TO_3 = "SDK 1 to 3"
    SDK_1 = "SDK 1"
    SDK_2 = "SDK 2"
    SDK_3 = "SDK 3"
    MCU_PLUS = "MCU+ SDK"
    L_SDK = "MMWAVE-L-SDK"
    PEOPLE = "people counting"
    PEOPLE_3D = "3D people tracking"
    OBSTACLES = "obstacle detection"
