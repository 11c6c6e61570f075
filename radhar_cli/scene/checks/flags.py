"""Flags of a scene: warnings, and their wording."""

from collections.abc import Mapping
from enum import IntFlag
from typing import Any

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.motion.recorded.gaps import BRIDGED_S
from radhar_cli.motion.recorded.motion import SEAM
from radhar_cli.scene.checks.sweep import describe_slow_sweep

BODY_RADIUS_M = 0.2  # of the upper body about the torso, horizontally
BEHIND_M = 1.0  # this far behind the radar nobody is meant to be
FLAG_TYPE = np.uint16


class Flags(IntFlag):
    """Warnings of a scene; FLAG_TYPE in the files of a build."""

    WALL = 1
    HALF_BAND = 2
    ALIASING = 4
    FALLBACK = 8
    FLOOR = 16
    GATE = 32
    RUNS_OUT = 64
    BLACK = 128
    SEAM = 256
    RADAR = 512
    BEHIND = 1024
    SWEEP = 2048
    BRIDGED = 4096
    MARCHES = 8192
    REDRAWN = 16384
    WHITE = 32768


BLACK = (
    "a map is black: nothing is left of the echo (after canceller, wall and distance), or nothing "
    "above the CFAR's threshold or level 0 (image.reference.dbm), or a cloud has no point"
)
ANGLES_ALIAS = (
    "; transmitters take turns, so that its angles are wrong, too, by the phase of the wrong speed"
)
WORDING = {
    Flags.WALL: "the body passes through the wall, or leaves room.box_m",
    Flags.HALF_BAND: "a scatterer leaves the range half-band and its echo the kept bins",
    Flags.ALIASING: "a joint moves faster than the Doppler PRF/2 and aliases",
    Flags.FALLBACK: "computed by the cube (engine.fallback)",
    Flags.FLOOR: "a scatterer goes below the floor",
    Flags.GATE: "the torso leaves the ranges of processing.gate_m",
    Flags.RUNS_OUT: "the motion file ends before the recording while a joint moves: the person "
    "stops within half a second and stays (past_end: loop goes on; duration_s, section_s)",
    Flags.SEAM: f"the motion file is repeated though its end is unlike its beginning: joints slide "
    f"more than {SEAM:g} m from one to the other (past_end: rest; section_s)",
    Flags.BLACK: BLACK,
    Flags.WHITE: "a map is white: all its powers exceed level 255; image.reference.dbm should be "
    "larger",
    Flags.RADAR: "a person walks through the radar: the torso comes within "
    f"{BODY_RADIUS_M:g} m of an antenna (motion.range_m, motion.angle_deg, duration_s)",
    Flags.BEHIND: f"a person walks past the radar, to more than {BEHIND_M:g} m behind it "
    "(motion.range_m, motion.angle_deg, duration_s)",
    Flags.BRIDGED: f"the motion file has gaps of up to {BRIDGED_S:g} s, in which a joint is lost; "
    "they are bridged",
    Flags.MARCHES: "the hips of the motion file stay where they are while the feet step, as in "
    "poses relative to the hips (MediaPipe's world landmarks, Human3.6M): the body marches on the "
    "spot and has no speed; add the path of the hips to all positions, or let the feet tell it: "
    "travel: feet of the class (--travel feet)",
    Flags.REDRAWN: "drawn again, as somebody left the range half-band of this radar: a data set of "
    "the same seed with another radar has other people in these scenes (`radars:` gives several "
    "radars the same people, docs/guide/several_radars.md; so do nearer places, motion.place or "
    "motion.range_m, or on_invalid: keep)",
    Flags.SWEEP: "positions are frozen during a sweep, in which a joint is so fast that its echo "
    "belongs more than a range cell elsewhere",
}


def describe_flag(flag: Flags, config: Config | None) -> str:
    """Describe the warning of a flag, for scenes of a config where there is one."""
    radar = None if config is None else config.radar
    if flag is Flags.ALIASING and isinstance(radar, ArrayRadar):
        turns = len(radar.timing.order) > 1
        return WORDING[flag] + ANGLES_ALIAS * turns
    if flag is Flags.SWEEP and config is not None:
        return f"{WORDING[flag]}: {describe_slow_sweep(config)}"
    return WORDING[flag]


def describe_flags(
    counts: Mapping[Flags, int], recordings: int, config: Config | None = None
) -> list[dict[str, Any]]:
    """Describe the warnings of flags: [{kind, recordings, message}].

    Args:
        counts: number of recordings with each flag.
        recordings: number of all recordings.
        config: their config, or None.
    """
    return [
        {
            "kind": str(flag.name).lower(),
            "recordings": n,
            "message": f"{n} of {recordings} recordings: {describe_flag(flag, config)}",
        }
        for flag, n in counts.items()
        if n
    ]
