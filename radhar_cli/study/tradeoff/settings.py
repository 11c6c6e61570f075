"""Settings that a config may trade: overrides of it, in the order of their worth."""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum, StrEnum
from functools import partial
from typing import TypeAlias

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import (
    ArrayRadar,
    BoardRadar,
    ChirpFramesRadar,
    FmcwRadar,
    ImpulseRadar,
    Steps,
    SweptPulses,
)
from radhar_cli.processing.map_kind import kind_of
from radhar_cli.schema.number import nominal

Overrides: TypeAlias = tuple[str, ...]  # dotted `key=value` pairs
DEFAULT = "the config as it is"
CUBE: Overrides = ("engine.kind=cube",)
TOLERANCES_DB = (-60, -80, -100, -120)
CLUTTER = ("difference", "mean", "highpass", "none")
BODIES = ("points", "segments", "surfaces")
RAYS = ("straight", "plane", "refracted")
CORRIDOR = (
    "room.box_m={x: [-2, 1000], y: [-4, 4], height: 3}",
    "room.faces={floor: concrete, ceiling: concrete, left: concrete, right: concrete}",
)
BEAM = "radar.beam={azimuth_deg: 70, elevation_deg: 30}"
LEAST_PX = 8


class Change(StrEnum):
    """Kind of change that another setting makes to the data."""

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
    """A setting that is tried: overrides of a config, and what its data are compared with."""

    overrides: Overrides
    worth: Worth
    words: str = ""  # its name; "" names it by its first key and value
    base: Overrides = ()  # overrides of the data that it is compared with, in time and picture
    effect: Change = Change.PICTURE  # whether data differ by an error, or by design
    is_noisy: bool = False  # whether pictures are compared with the config's noise

    @property
    def name(self) -> str:
        """Its name in tables and sentences."""
        return self.words or self.overrides[0].replace("=", ": ", 1)

    @property
    def group(self) -> str:
        """Section of the config that its first key is in."""
        key = "".join(self.overrides[:1]).partition("=")[0]
        return key.partition(".")[0] or "default"

    @property
    def base_name(self) -> str:
        """Name of the setting that its data are compared with."""
        return ", ".join(one.replace("=", ": ", 1) for one in self.base) or DEFAULT


AS_IT_IS = Setting((), Worth.SAVES, DEFAULT, effect=Change.ERROR)


def settings_of(config: Config) -> list[Setting]:
    """Settings that may be tried on a config, in the order of their worth.

    Whether the config allows them shows when it is read with them.
    """
    parts = _engine, _maps, _body, _radar, _processing, _scene, _wall, _receiver
    settings = [setting for part in parts for setting in part(config)]
    return sorted(settings, key=lambda setting: setting.worth)


def _single(worth: Worth, *overrides: str) -> list[Setting]:
    """Settings of one key each."""
    return [Setting((override,), worth) for override in overrides]


def _engine(config: Config) -> Iterator[Setting]:
    """Yield other computations of the same physics; an impulse radar has but one."""
    engine, radar = config.engine, config.radar
    is_direct = engine.kind == "direct"
    if isinstance(radar, ImpulseRadar):
        return
    overrides = [f"engine.tolerance_db={db}" for db in TOLERANCES_DB if db != engine.tolerance_db]
    overrides = overrides if is_direct else []
    reflects = config.wall is not None and config.wall.echoes == "exact"  # which the cube alone can
    if not reflects:
        overrides.append(f"engine.kind={'cube' if is_direct else 'direct'}")
        if is_direct and engine.precision != "double":
            overrides.append("engine.precision=double")
    for override in overrides:
        yield Setting((override,), Worth.ENGINE, effect=Change.ERROR)
    if not reflects and not isinstance(radar, ArrayRadar) and not engine.motion_in_chirp:
        moving = (*CUBE, "engine.motion_in_chirp=true")
        yield Setting(moving, Worth.SLOW, "motion within the chirp", CUBE)


def _maps(config: Config) -> Iterator[Setting]:
    """Yield fewer maps, an FSST more, and other sizes of images."""
    for name in config.maps if len(config.maps) > 1 else ():
        remaining = ", ".join(other for other in config.maps if other != name)
        yield Setting((f"maps=[{remaining}]",), Worth.SAVES, f"maps without {name}")
    if _has_fsst(config):
        yield from _single(Worth.SLOW, "processing.fsst_hop_pulses=1")
    elif not _is_other_receiver(config) and config.processing.range_sum == "coherent":
        maps = f"maps=[{', '.join((*config.maps, 'fsst'))}]"
        yield Setting((maps,), Worth.PROCESSING, "maps with fsst")
    for parts, worth in ((2, Worth.SAVES), (4, Worth.PROCESSING)):
        height, width = (side // parts for side in config.image.size_px)
        if min(height, width) >= LEAST_PX and config.stream is None:
            yield from _single(worth, f"image.size_px=[{height}, {width}]")


def _is_other_receiver(config: Config) -> bool:
    """Whether the radar has frames, or real samples of impulses."""
    radar = config.radar
    is_real = isinstance(radar, ImpulseRadar) and radar.output == "rf"
    return is_real or isinstance(radar, ArrayRadar)


def _has_fsst(config: Config) -> bool:
    """Whether an FSST is among the maps, compensated or not."""
    return any(name.startswith("fsst") for name in config.maps)


def _body(config: Config) -> Iterator[Setting]:
    """Yield other bodies, with fewer points or without shadows."""
    body = config.body
    for kind in BODIES:
        if kind != body.scatterers:
            worth = Worth.SAVES if kind == "points" else Worth.PHYSICS
            yield from _single(worth, f"body.scatterers={kind}")
    for points in (10, 5) if body.scatterers != "points" else ():
        if points < body.points_per_segment:
            yield from _single(Worth.SAVES, f"body.points_per_segment={points}")
    if body.scatterers == "segments" or config.people:
        yield from _single(Worth.SAVES, f"body.shadowing={str(not body.shadowing).lower()}")


def _radar(config: Config) -> Iterator[Setting]:
    """Yield fewer pulses, samples, frames and antennas, other points, and other radar physics."""
    radar = config.radar
    if isinstance(radar, Steps):  # each step twice as long
        steps = (f"radar.steps={radar.steps // 2}", f"radar.dwell_s={2 * radar.dwell_s:g}")
        yield Setting(steps, Worth.SAVES)
    elif isinstance(radar, FmcwRadar | ChirpFramesRadar):
        yield from _single(Worth.SAVES, f"radar.adc_rate_hz={nominal(radar.adc_rate_hz) / 2:g}")
    elif isinstance(radar, ImpulseRadar):
        yield from _single(Worth.SAVES, f"radar.profile_samples={radar.profile_samples // 2}")
    if isinstance(radar, ArrayRadar):
        yield from _frames(radar)
        if "points" in config.maps:
            yield from _points(config)
        return
    for share in (0.5, 0.75):
        yield from _single(Worth.SAVES, f"radar.prf_hz={share * nominal(radar.prf_hz):g}")
    if isinstance(radar, SweptPulses) and not radar.residual_video_phase:
        yield from _single(Worth.PHYSICS, "radar.residual_video_phase=true")
    if radar.beam is None:
        yield Setting((BEAM,), Worth.PHYSICS, "beams of 70 x 30 degrees")
    else:
        yield from _single(Worth.SAVES, "radar.beam=null")


def _frames(radar: ArrayRadar) -> Iterator[Setting]:
    """Yield fewer frames and chirps; of a board's .cfg numbers of its lines, command and place."""
    timing = radar.timing
    if not isinstance(radar, BoardRadar):
        yield from _single(Worth.SAVES, f"radar.frame.period_s={2 * timing.period_s:g}")
        if timing.loops > 1:
            yield from _single(Worth.SAVES, f"radar.frame.chirps={timing.loops // 2}")
        return
    receivers = len(timing.receivers)
    mask = sum(1 << receiver for receiver in timing.receivers[: receivers // 2])
    changes: dict[str, tuple[str, dict[int, float | int]]] = {
        "half as many frames": ("frameCfg", {5: 2.0}),
        f"{timing.loops // 2} loops a frame": ("frameCfg", {3: 0.5}),
        "half as many samples a chirp": ("profileCfg", {10: 0.5, 11: 0.5}),
    }
    for count in range(len(timing.masks) - 1, 0, -1):
        changes[f"{count} transmitter{'s' * (count > 1)}"] = ("frameCfg", {2: count - 1})
    if receivers > 2:
        changes[f"{receivers // 2} receivers"] = ("channelCfg", {1: mask})
    for name, (command, numbers) in changes.items():
        change = partial(_with_numbers, numbers)
        text = re.sub(rf"^{command}\b.*$", change, radar.cfg, flags=re.MULTILINE)
        if text != radar.cfg:
            yield Setting((f"radar.cfg={json.dumps(text)}",), Worth.SAVES, name)


def _with_numbers(numbers: Mapping[int, float | int], line: re.Match[str]) -> str:
    """Line of a .cfg with other numbers by place: whole ones replace, others are factors."""
    words = line[0].split()
    try:
        for place, number in numbers.items():
            value = number if isinstance(number, int) else float(words[place]) * number
            is_whole = "." not in words[place] and number != 2.0
            words[place] = f"{int(value)}" if is_whole else f"{value:g}"
    except (IndexError, ValueError):  # a line of another form, which reading refuses
        return line[0]
    return " ".join(words)


def _points(config: Config) -> Iterator[Setting]:
    """Yield other ways to find points."""
    is_best, quantise = config.cloud.chain == "best", str(not config.cloud.quantise).lower()
    yield from _single(Worth.SAVES, f"cloud.chain={'board' if is_best else 'best'}")
    override = "cloud.pfa=0.001" if is_best else f"cloud.quantise={quantise}"
    yield from _single(Worth.PROCESSING, override)


def _processing(config: Config) -> Iterator[Setting]:
    """Yield other overlaps, cancellers and sums over range."""
    processing, is_array = config.processing, isinstance(config.radar, ArrayRadar)
    has_doppler = any(kind_of(name) is not None and name != "rtm" for name in config.maps)
    for share, worth in ((2, Worth.SAVES), (5, Worth.PROCESSING)):
        overlap = 1 - share * (1 - processing.overlap_fraction)
        if has_doppler and not is_array and overlap > 0:
            yield from _single(worth, f"processing.overlap_fraction={overlap:.3g}")
    kinds = [
        kind for kind in (CLUTTER[1::2] if is_array else CLUTTER) if kind != processing.clutter
    ]
    yield from _single(Worth.PROCESSING, *(f"processing.clutter={kind}" for kind in kinds))
    if "stft" in config.maps and config.radar.has_range:
        kind = "gated" if processing.range_sum == "coherent" else "coherent"
        base: Overrides = ("maps=[stft]",) if _has_fsst(config) else ()  # a gate has no fsst
        override = f"processing.range_sum={kind}"
        worth = Worth.PROCESSING if kind == "gated" else Worth.SAVES
        yield Setting((*base, override), worth, override.replace("=", ": "), base)


def _scene(config: Config) -> Iterator[Setting]:
    """Yield nobody else or another person, an emptier room, or a corridor and things in it."""
    room = config.room
    removals = {
        "people=[]": config.people,
        "room.faces=null": room.faces,
        "room.back_wall_m=null": room.back_wall_m,
        "room.reflectors=[]": room.reflectors,
    }
    yield from _single(
        Worth.SAVES, *(key for key, has in removals.items() if has not in (None, ()))
    )
    if not config.people and config.motion.model == "human":
        yield Setting(("people=[{}]",), Worth.PHYSICS, "another person, who walks")
    for order in (1, 2) if room.faces is not None else ():
        if order != room.order:
            worth = Worth.SAVES if order < room.order else Worth.SLOW
            yield from _single(worth, f"room.order={order}")
    if room.faces is None and room.back_wall_m is None and config.stream is None:
        yield Setting(CORRIDOR, Worth.PHYSICS, "a corridor of concrete, 8 m wide")
        twice = (*CORRIDOR, "room.order=2")
        yield Setting(twice, Worth.SLOW, "the corridor with two bounces")
    if not room.reflectors:
        three = ("room.reflectors=[{}, {}, {}]",)
        yield Setting(three, Worth.PHYSICS, "3 reflectors in the room")


def _wall(config: Config) -> Iterator[Setting]:
    """Yield other rays through the wall, and what reflects in it."""
    wall = config.wall
    if wall is None:
        return
    if wall.echoes == "exact":  # one as thick that only delays and weakens
        layers = wall.layers or ()
        thickness = sum(nominal(layer.thickness_m) for layer in layers) or nominal(wall.size_m[0])
        sides = ", ".join(f"{nominal(side):g}" for side in wall.size_m[1:])
        size = f"wall.size_m=[{thickness:g}, {sides}]"
        plain = ("wall.echoes=none", "wall.layers=null", size)
        name = "wall.echoes: none"
        if config.engine.kind != "direct":
            yield Setting(
                (*plain, "engine.kind=direct"), Worth.SAVES, f"{name}, engine.kind: direct"
            )
            return
        yield Setting(plain, Worth.SAVES, name)
        return
    for key, kinds in (("rays", RAYS), ("fresnel", ("perpendicular", "parallel"))):
        for kind in kinds:
            if kind != getattr(wall, key):
                worth = Worth.SAVES if kind == "straight" else Worth.PHYSICS
                yield from _single(worth, f"wall.{key}={kind}")
    is_impulse = isinstance(config.radar, ImpulseRadar)
    base: Overrides = () if is_impulse else (*CUBE, "wall.rays=plane")
    yield Setting((*base, "wall.echoes=exact"), Worth.SLOW, "wall.echoes: exact", base)


def _receiver(config: Config) -> Iterator[Setting]:
    """Yield coloured noise and interference, or none of them."""
    if not config.has_noise or _is_other_receiver(config):  # whose noise is white alone
        return
    prf, worth = nominal(config.radar.prf_hz), Worth.PROCESSING
    if nominal(config.receiver.noise_corner_hz) > 0:
        yield from _single(worth, "receiver.noise_corner_hz=0")
    else:
        corner, name = f"receiver.noise_corner_hz={prf / 20:g}", "a noise corner at PRF/20"
        yield Setting((corner,), worth, name, is_noisy=True)
    tones, name = "receiver.tones=[]", ""
    if not config.receiver.tones:
        tones = f"receiver.tones=[{{doppler_hz: {prf / 8:g}}}]"
        name = "an interference line at PRF/8"
    yield Setting((tones,), worth, name, is_noisy=True)
