"""Settings of radars of one channel, of scenes and of processing that a config may trade."""

from collections.abc import Iterator

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import (
    ArrayRadar,
    BoardRadar,
    CwRadar,
    FmcwRadar,
    ImpulseRadar,
    SfcwRadar,
    SweptPulses,
)
from radhar_cli.config.room import WallConfig
from radhar_cli.processing.map_kind import kind_of
from radhar_cli.schema.number import nominal
from radhar_cli.study.tradeoff.board_settings import (
    board_settings,
    frame_settings,
    half_as_many_steps,
)
from radhar_cli.study.tradeoff.setting import DEFAULT, Change, Overrides, Setting, Worth, keyed

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


def settings_of(config: Config) -> list[Setting]:
    """Settings that may be tried on a config, in the order of their worth.

    Whether the config allows them shows when it is read with them.
    """
    settings = [
        *engine_settings(config),
        *map_settings(config),
        *body_settings(config),
        *radar_settings(config),
        *processing_settings(config),
        *people_settings(config),
        *room_settings(config),
        *wall_settings(config),
        *receiver_settings(config),
    ]
    return sorted(settings, key=lambda setting: setting.worth)


def engine_settings(config: Config) -> Iterator[Setting]:
    """Yield other computations of the same physics; an impulse radar has but one."""
    if isinstance(config.radar, ImpulseRadar):
        return
    engine = config.engine
    for tolerance_db in TOLERANCES_DB:
        if engine.kind == "direct" and tolerance_db != engine.tolerance_db:
            override = f"engine.tolerance_db={tolerance_db}"
            yield keyed("engine", override, Worth.ENGINE, Change.ERROR)
    reflects = config.wall is not None and config.wall.echoes == "exact"
    if reflects:  # which the cube alone can
        return
    other_kind = "cube" if engine.kind == "direct" else "direct"
    yield keyed("engine", f"engine.kind={other_kind}", Worth.ENGINE, Change.ERROR)
    if engine.kind == "direct" and engine.precision != "double":
        yield keyed("engine", "engine.precision=double", Worth.ENGINE, Change.ERROR)
    if not isinstance(config.radar, ArrayRadar) and not engine.motion_in_chirp:
        cube = ("engine.kind=cube",)
        moving = (*cube, "engine.motion_in_chirp=true")
        name = "motion within the chirp"
        yield Setting("engine", name, moving, cube, "engine.kind: cube", worth=Worth.SLOW)


def map_settings(config: Config) -> Iterator[Setting]:
    """Yield fewer maps, an FSST more, and other sizes of images."""
    for name in config.maps:
        if len(config.maps) > 1:
            remaining_maps = [other for other in config.maps if other != name]
            overrides = (f"maps=[{', '.join(remaining_maps)}]",)
            yield Setting("maps", f"maps without {name}", overrides, worth=Worth.SAVES)
    is_other = isinstance(config.radar, ArrayRadar) or _has_real_samples(config)
    allows_fsst = not is_other and config.processing.range_sum == "coherent"
    if allows_fsst and not _has_fsst(config):
        overrides = (f"maps=[{', '.join((*config.maps, 'fsst'))}]",)
        yield Setting("maps", "maps with fsst", overrides)
    if _has_fsst(config):
        yield keyed("maps", "processing.fsst_hop_pulses=1", Worth.SLOW)
    height, width = config.image.size_px
    for parts, worth in ((2, Worth.SAVES), (4, Worth.PROCESSING)):
        if min(height, width) // parts >= LEAST_PX and config.stream is None:
            size = f"[{height // parts}, {width // parts}]"
            yield keyed("maps", f"image.size_px={size}", worth)


def _has_real_samples(config: Config) -> bool:
    """Whether the radar is one of impulses whose samples are real."""
    return isinstance(config.radar, ImpulseRadar) and config.radar.output == "rf"


def _has_fsst(config: Config) -> bool:
    """Whether an FSST is among the maps, compensated or not."""
    return any(name.startswith("fsst") for name in config.maps)


def body_settings(config: Config) -> Iterator[Setting]:
    """Yield other bodies, with fewer points or without shadows."""
    body = config.body
    for kind in BODIES:
        if kind != body.scatterers:
            worth = Worth.SAVES if kind == "points" else Worth.PHYSICS
            yield keyed("body", f"body.scatterers={kind}", worth)
    if body.scatterers != "points":
        for points in (10, 5):
            if points < body.points_per_segment:
                yield keyed("body", f"body.points_per_segment={points}", Worth.SAVES)
    if body.scatterers == "segments" or config.people:
        shadowing = str(not body.shadowing).lower()
        yield keyed("body", f"body.shadowing={shadowing}", Worth.SAVES)


def radar_settings(config: Config) -> Iterator[Setting]:
    """Yield fewer pulses, fewer samples of each, and other radar physics."""
    radar = config.radar
    if isinstance(radar, ArrayRadar):
        if isinstance(radar, BoardRadar):
            yield from board_settings(radar, config)
        else:
            yield from frame_settings(radar, config)
        return
    prf = nominal(radar.prf_hz)
    for share in (0.5, 0.75):
        yield keyed("radar", f"radar.prf_hz={share * prf:g}", Worth.SAVES)
    match radar:
        case FmcwRadar():
            rate = nominal(radar.adc_rate_hz) / 2
            yield keyed("radar", f"radar.adc_rate_hz={rate:g}", Worth.SAVES)
        case SfcwRadar():
            yield half_as_many_steps(radar)
        case ImpulseRadar():
            samples = radar.profile_samples // 2
            yield keyed("radar", f"radar.profile_samples={samples}", Worth.SAVES)
        case CwRadar():
            pass
    if isinstance(radar, SweptPulses) and not radar.residual_video_phase:
        yield keyed("radar", "radar.residual_video_phase=true", Worth.PHYSICS)
    if radar.beam is None:
        yield Setting("radar", "beams of 70 x 30 degrees", (BEAM,), worth=Worth.PHYSICS)
    else:
        yield keyed("radar", "radar.beam=null", Worth.SAVES)


def processing_settings(config: Config) -> Iterator[Setting]:
    """Yield other overlaps, cancellers and sums over range."""
    processing = config.processing
    has_doppler = any(kind_of(name) is not None and name != "rtm" for name in config.maps)
    if has_doppler and not isinstance(config.radar, ArrayRadar):
        for share, worth in ((2, Worth.SAVES), (5, Worth.PROCESSING)):
            overlap = 1 - share * (1 - processing.overlap_fraction)
            if overlap > 0:
                yield keyed("processing", f"processing.overlap_fraction={overlap:.3g}", worth)
    is_board = isinstance(config.radar, ArrayRadar)
    for kind in ("mean", "none") if is_board else CLUTTER:
        if kind != processing.clutter:
            yield keyed("processing", f"processing.clutter={kind}", Worth.PROCESSING)
    if "stft" not in config.maps or not config.radar.has_range:
        return
    kind = "gated" if processing.range_sum == "coherent" else "coherent"
    base: Overrides = ("maps=[stft]",) if _has_fsst(config) else ()  # a gate has no fsst
    base_name = "maps: [stft]" if base else DEFAULT
    name, overrides = f"processing.range_sum: {kind}", (*base, f"processing.range_sum={kind}")
    worth = Worth.PROCESSING if kind == "gated" else Worth.SAVES
    yield Setting("processing", name, overrides, base, base_name, worth=worth)


def people_settings(config: Config) -> Iterator[Setting]:
    """Yield nobody else, or another person."""
    if config.people:
        yield keyed("people", "people=[]", Worth.SAVES)
    elif config.motion.model == "human":
        yield Setting("people", "another person, who walks", ("people=[{}]",), worth=Worth.PHYSICS)


def room_settings(config: Config) -> Iterator[Setting]:
    """Yield an emptier room, or a corridor and things in it."""
    room = config.room
    if room.faces is not None:
        yield keyed("room", "room.faces=null", Worth.SAVES)
        for order in (1, 2):
            if order != room.order:
                worth = Worth.SAVES if order < room.order else Worth.SLOW
                yield keyed("room", f"room.order={order}", worth)
    elif room.back_wall_m is None and config.stream is None:
        corridor = "a corridor of concrete, 8 m wide"
        yield Setting("room", corridor, CORRIDOR, worth=Worth.PHYSICS)
        twice = (*CORRIDOR, "room.order=2")
        yield Setting("room", "the corridor with two bounces", twice, worth=Worth.SLOW)
    if room.back_wall_m is not None:
        yield keyed("room", "room.back_wall_m=null", Worth.SAVES)
    if room.reflectors:
        yield keyed("room", "room.reflectors=[]", Worth.SAVES)
    else:
        overrides = ("room.reflectors=[{}, {}, {}]",)
        yield Setting("room", "3 reflectors in the room", overrides, worth=Worth.PHYSICS)


def wall_settings(config: Config) -> Iterator[Setting]:
    """Yield other rays through the wall, and what reflects in it."""
    wall = config.wall
    if wall is None:
        return
    if wall.echoes == "exact":
        yield _wall_without_echoes(config, wall)
        return
    for rays in RAYS:
        if rays != wall.rays:
            worth = Worth.SAVES if rays == "straight" else Worth.PHYSICS
            yield keyed("wall", f"wall.rays={rays}", worth)
    for fresnel in ("perpendicular", "parallel"):
        if fresnel != wall.fresnel:
            yield keyed("wall", f"wall.fresnel={fresnel}", Worth.PHYSICS)
    is_impulse = isinstance(config.radar, ImpulseRadar)
    base: Overrides = () if is_impulse else ("engine.kind=cube", "wall.rays=plane")
    base_name = DEFAULT if is_impulse else "engine.kind: cube, plane rays"
    overrides = (*base, "wall.echoes=exact")
    yield Setting("wall", "wall.echoes: exact", overrides, base, base_name, worth=Worth.SLOW)


def _wall_without_echoes(config: Config, wall: WallConfig) -> Setting:
    """Setting of a wall that only delays and weakens, as thick, for a wall that reflects inside."""
    layers = wall.layers or ()
    thickness = sum(nominal(layer.thickness_m) for layer in layers) or nominal(wall.size_m[0])
    sides = ", ".join(f"{nominal(side):g}" for side in wall.size_m[1:])
    size = f"wall.size_m=[{thickness:g}, {sides}]"
    overrides = ("wall.echoes=none", "wall.layers=null", size)
    if config.engine.kind == "direct":
        return Setting("wall", "wall.echoes: none", overrides, worth=Worth.SAVES)
    name = "wall.echoes: none, engine.kind: direct"
    return Setting("wall", name, (*overrides, "engine.kind=direct"), worth=Worth.SAVES)


def receiver_settings(config: Config) -> Iterator[Setting]:
    """Yield coloured noise and interference, or none of them."""
    receiver = config.receiver
    is_other = isinstance(config.radar, ArrayRadar) or _has_real_samples(config)
    if not config.has_noise or is_other:  # whose receivers have white noise alone
        return
    prf = nominal(config.radar.prf_hz)
    if nominal(receiver.noise_corner_hz) > 0:
        off = Setting("receiver", "receiver.noise_corner_hz: 0", ("receiver.noise_corner_hz=0",))
    else:
        corner = f"receiver.noise_corner_hz={prf / 20:g}"
        off = Setting("receiver", "a noise corner at PRF/20", (corner,), is_noisy=True)
    yield off
    if receiver.tones:
        yield Setting("receiver", "receiver.tones: []", ("receiver.tones=[]",), is_noisy=True)
    else:
        tone = f"receiver.tones=[{{doppler_hz: {prf / 8:g}}}]"
        yield Setting("receiver", "an interference line at PRF/8", (tone,), is_noisy=True)
