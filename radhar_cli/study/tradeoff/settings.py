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
    FramesRadar,
    ImpulseRadar,
    SfcwRadar,
    StepFramesRadar,
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
    """A setting that is tried: overrides of a config, and what its data are compared with."""

    group: str  # part of radhar that it belongs to, in a word
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
    def base_name(self) -> str:
        """Name of what its data are compared with."""
        return ", ".join(one.replace("=", ": ", 1) for one in self.base) or DEFAULT


AS_IT_IS = Setting("default", (), Worth.SAVES, DEFAULT, effect=Change.ERROR)


def settings_of(config: Config) -> list[Setting]:
    """Settings that may be tried on a config, in the order of their worth.

    Whether the config allows them shows when it is read with them.
    """
    parts = _engine, _maps, _body, _radar, _processing, _people, _room, _wall, _receiver
    settings = [setting for part in parts for setting in part(config)]
    return sorted(settings, key=lambda setting: setting.worth)


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
        yield Setting("engine", (override,), Worth.ENGINE, effect=Change.ERROR)
    if not reflects and not isinstance(radar, ArrayRadar) and not engine.motion_in_chirp:
        moving = (*CUBE, "engine.motion_in_chirp=true")
        yield Setting("engine", moving, Worth.SLOW, "motion within the chirp", CUBE)


def _maps(config: Config) -> Iterator[Setting]:
    """Yield fewer maps, an FSST more, and other sizes of images."""
    for name in config.maps if len(config.maps) > 1 else ():
        remaining = ", ".join(other for other in config.maps if other != name)
        yield Setting("maps", (f"maps=[{remaining}]",), Worth.SAVES, f"maps without {name}")
    if _has_fsst(config):
        yield Setting("maps", ("processing.fsst_hop_pulses=1",), Worth.SLOW)
    elif not _is_other_receiver(config) and config.processing.range_sum == "coherent":
        maps = f"maps=[{', '.join((*config.maps, 'fsst'))}]"
        yield Setting("maps", (maps,), Worth.PROCESSING, "maps with fsst")
    height, width = config.image.size_px
    for parts, worth in ((2, Worth.SAVES), (4, Worth.PROCESSING)):
        if min(height, width) // parts >= LEAST_PX and config.stream is None:
            yield Setting("maps", (f"image.size_px=[{height // parts}, {width // parts}]",), worth)


def _is_other_receiver(config: Config) -> bool:
    """Whether the radar has frames, or real samples of impulses."""
    radar = config.radar
    return isinstance(radar, ArrayRadar) or (
        isinstance(radar, ImpulseRadar) and radar.output == "rf"
    )


def _has_fsst(config: Config) -> bool:
    """Whether an FSST is among the maps, compensated or not."""
    return any(name.startswith("fsst") for name in config.maps)


def _body(config: Config) -> Iterator[Setting]:
    """Yield other bodies, with fewer points or without shadows."""
    body = config.body
    for kind in BODIES:
        if kind != body.scatterers:
            worth = Worth.SAVES if kind == "points" else Worth.PHYSICS
            yield Setting("body", (f"body.scatterers={kind}",), worth)
    overrides = [
        f"body.points_per_segment={points}"
        for points in (10, 5)
        if body.scatterers != "points" and points < body.points_per_segment
    ]
    if body.scatterers == "segments" or config.people:
        overrides.append(f"body.shadowing={str(not body.shadowing).lower()}")
    yield from (Setting("body", (override,), Worth.SAVES) for override in overrides)


def _radar(config: Config) -> Iterator[Setting]:
    """Yield fewer pulses, samples, frames and antennas, other points, and other radar physics."""
    radar = config.radar
    if isinstance(radar, BoardRadar):
        yield from _board(radar)
    else:
        pulses = () if isinstance(radar, ArrayRadar) else (0.5, 0.75)
        overrides: list[Overrides] = [
            (f"radar.prf_hz={share * nominal(radar.prf_hz):g}",) for share in pulses
        ]
        if isinstance(radar, FramesRadar):
            header = radar.header
            overrides.append((f"radar.frame.period_s={2 * header.period_s:g}",))
            if header.loops > 1:
                overrides.append((f"radar.frame.chirps={header.loops // 2}",))
        if isinstance(radar, SfcwRadar | StepFramesRadar):  # each step twice as long
            dwell = f"radar.dwell_s={2 * radar.dwell_s:g}"
            overrides.append((f"radar.steps={radar.steps // 2}", dwell))
        elif isinstance(radar, FmcwRadar | ChirpFramesRadar):
            overrides.append((f"radar.adc_rate_hz={nominal(radar.adc_rate_hz) / 2:g}",))
        elif isinstance(radar, ImpulseRadar):
            overrides.append((f"radar.profile_samples={radar.profile_samples // 2}",))
        yield from (Setting("radar", override, Worth.SAVES) for override in overrides)
    if isinstance(radar, ArrayRadar):
        if "points" in config.maps:
            yield from _points(config)
        return
    if isinstance(radar, FmcwRadar | SfcwRadar) and not radar.residual_video_phase:
        yield Setting("radar", ("radar.residual_video_phase=true",), Worth.PHYSICS)
    if radar.beam is None:
        yield Setting("radar", (BEAM,), Worth.PHYSICS, "beams of 70 x 30 degrees")
    else:
        yield Setting("radar", ("radar.beam=null",), Worth.SAVES)


def _board(radar: BoardRadar) -> Iterator[Setting]:
    """Yield settings of a board's .cfg: numbers of its lines, by command and place."""
    header = radar.header
    transmitters, receivers = len(header.masks), len(header.receivers)
    mask = sum(1 << receiver for receiver in header.receivers[: receivers // 2])
    changes: dict[str, tuple[str, dict[int, float | int]]] = {
        "half as many frames": ("frameCfg", {5: 2.0}),
        f"{header.loops // 2} loops a frame": ("frameCfg", {3: 0.5}),
        "half as many samples a chirp": ("profileCfg", {10: 0.5, 11: 0.5}),
    }
    for count in range(transmitters - 1, 0, -1):
        changes[f"{count} transmitter{'s' * (count > 1)}"] = ("frameCfg", {2: count - 1})
    if receivers > 2:
        changes[f"{receivers // 2} receivers"] = ("channelCfg", {1: mask})
    for name, (command, numbers) in changes.items():
        change = partial(_with_numbers, numbers)
        text = re.sub(rf"^{command}\b.*$", change, radar.cfg, flags=re.MULTILINE)
        if text != radar.cfg:
            yield Setting("board", (f"radar.cfg={json.dumps(text)}",), Worth.SAVES, name)


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
    yield Setting("points", (f"cloud.chain={'board' if is_best else 'best'}",), Worth.SAVES)
    override = "cloud.pfa=0.001" if is_best else f"cloud.quantise={quantise}"
    yield Setting("points", (override,), Worth.PROCESSING)


def _processing(config: Config) -> Iterator[Setting]:
    """Yield other overlaps, cancellers and sums over range."""
    processing, is_array = config.processing, isinstance(config.radar, ArrayRadar)
    has_doppler = any(kind_of(name) is not None and name != "rtm" for name in config.maps)
    for share, worth in ((2, Worth.SAVES), (5, Worth.PROCESSING)):
        overlap = 1 - share * (1 - processing.overlap_fraction)
        if has_doppler and not is_array and overlap > 0:
            yield Setting("processing", (f"processing.overlap_fraction={overlap:.3g}",), worth)
    for kind in ("mean", "none") if is_array else CLUTTER:
        if kind != processing.clutter:
            yield Setting("processing", (f"processing.clutter={kind}",), Worth.PROCESSING)
    if "stft" in config.maps and config.radar.has_range:
        kind = "gated" if processing.range_sum == "coherent" else "coherent"
        base: Overrides = ("maps=[stft]",) if _has_fsst(config) else ()  # a gate has no fsst
        name = f"processing.range_sum: {kind}"
        worth = Worth.PROCESSING if kind == "gated" else Worth.SAVES
        yield Setting("processing", (*base, f"processing.range_sum={kind}"), worth, name, base)


def _people(config: Config) -> Iterator[Setting]:
    """Yield nobody else, or another person."""
    if config.people:
        yield Setting("people", ("people=[]",), Worth.SAVES)
    elif config.motion.model == "human":
        yield Setting("people", ("people=[{}]",), Worth.PHYSICS, "another person, who walks")


def _room(config: Config) -> Iterator[Setting]:
    """Yield an emptier room, or a corridor and things in it."""
    room = config.room
    if room.faces is not None:
        yield Setting("room", ("room.faces=null",), Worth.SAVES)
        for order in (1, 2):
            if order != room.order:
                worth = Worth.SAVES if order < room.order else Worth.SLOW
                yield Setting("room", (f"room.order={order}",), worth)
    elif room.back_wall_m is None and config.stream is None:
        corridor = "a corridor of concrete, 8 m wide"
        yield Setting("room", CORRIDOR, Worth.PHYSICS, corridor)
        twice = (*CORRIDOR, "room.order=2")
        yield Setting("room", twice, Worth.SLOW, "the corridor with two bounces")
    if room.back_wall_m is not None:
        yield Setting("room", ("room.back_wall_m=null",), Worth.SAVES)
    if room.reflectors:
        yield Setting("room", ("room.reflectors=[]",), Worth.SAVES)
    else:
        three = ("room.reflectors=[{}, {}, {}]",)
        yield Setting("room", three, Worth.PHYSICS, "3 reflectors in the room")


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
        if config.engine.kind == "direct":
            yield Setting("wall", plain, Worth.SAVES)
        else:
            name = "wall.echoes: none, engine.kind: direct"
            yield Setting("wall", (*plain, "engine.kind=direct"), Worth.SAVES, name)
        return
    for key, kinds in (("rays", RAYS), ("fresnel", ("perpendicular", "parallel"))):
        for kind in kinds:
            if kind != getattr(wall, key):
                worth = Worth.SAVES if kind == "straight" else Worth.PHYSICS
                yield Setting("wall", (f"wall.{key}={kind}",), worth)
    is_impulse = isinstance(config.radar, ImpulseRadar)
    base: Overrides = () if is_impulse else (*CUBE, "wall.rays=plane")
    exact = (*base, "wall.echoes=exact")
    yield Setting("wall", exact, Worth.SLOW, "wall.echoes: exact", base)


def _receiver(config: Config) -> Iterator[Setting]:
    """Yield coloured noise and interference, or none of them."""
    if not config.has_noise or _is_other_receiver(config):  # whose noise is white alone
        return
    prf, worth = nominal(config.radar.prf_hz), Worth.PROCESSING
    if nominal(config.receiver.noise_corner_hz) > 0:
        yield Setting("receiver", ("receiver.noise_corner_hz=0",), worth)
    else:
        corner, name = f"receiver.noise_corner_hz={prf / 20:g}", "a noise corner at PRF/20"
        yield Setting("receiver", (corner,), worth, name, is_noisy=True)
    if config.receiver.tones:
        yield Setting("receiver", ("receiver.tones=[]",), worth, is_noisy=True)
    else:
        tone = f"receiver.tones=[{{doppler_hz: {prf / 8:g}}}]"
        name = "an interference line at PRF/8"
        yield Setting("receiver", (tone,), worth, name, is_noisy=True)
