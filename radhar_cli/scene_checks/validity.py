"""Check scenes before any echo is computed: what lies outside the model, and what to warn of."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntFlag
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.activities.activity import Activity
from radhar_cli.assembly.physics import (
    antennas_of,
    body_of,
    box_of,
    moving,
    reflectors_of,
    wall_of,
    waveform_of,
    ways_of,
)
from radhar_cli.bodies.motion_paths import OfMotion, point_delay, through_wall_delay
from radhar_cli.config.checks.doubts import timing_warnings, tone_warnings
from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import BoardRadar, CwRadar, FmcwRadar, ImpulseRadar, SfcwRadar
from radhar_cli.echo.accuracy import first_aim, settings
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.interpolation import BEFORE
from radhar_cli.echo.knots import CHUNK_KNOTS, knots_of, widest_step
from radhar_cli.echo.paths import Paths
from radhar_cli.errors import SceneError
from radhar_cli.motion.files.motion import SEAM
from radhar_cli.motion.human.two_link import OutOfReachError
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.segments import Landmarks
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.radar.propagation import Antennas, bistatic_delay, leg
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform
from radhar_cli.scene import (
    MAX_PLACES,
    Person,
    Redrawn,
    Scene,
    draw_scene,
    nominal_scene,
    redrawn,
)
from radhar_cli.scene_checks.unused_keys import unused_keys
from radhar_cli.scene_checks.visibility import noise_alone

MIN_DISTANCE_M = 0.05
BODY_RADIUS_M = 0.2  # of the upper body about the torso, horizontally
BEHIND_M = 1.0  # this far behind the radar nobody is meant to be
HEAD_M = 0.2  # from the highest joint to the top of the head
LOOKS_AHEAD = 0.5  # least horizontal share of the boresight of a radar that has a behind
REACH_M = 1.0  # distance of a segment's surface from its joints, at most
GRID_HZ = 50.0
GRID_PER_CYCLE = 40
USUAL_DB = -80.0  # tolerance at whose knots a person alone is checked
ANTENNA_KEYS = {"transmitter": "radar.tx_m", "receiver": "radar.rx_m"}
MAX_ATTEMPTS = 1000
# Draws after which there are no more where none comes near, without and with lists to choose from.
FAR_DRAWS, FAR_CHOICES = 50, 200
TORSOS_APART_M = 0.5
CROWDED = "their motion.range_m and motion.cross_range_m should leave room"
CHUNK = 65536
GRID_CHUNK = 16384
FLOOR_MARGIN_M = 1e-3  # for rounding, and the paper's ankles in the floor


FLAG_TYPE = np.uint16


class Flags(IntFlag):
    """What there is to warn of in a scene; FLAG_TYPE in the files of a build."""

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


BLACK = (
    "a map is black: nothing is left of the echo (after canceller, wall and distance), or nothing "
    "above the CFAR's threshold, or a cloud has no point"
)
ANGLES_ALIAS = (
    "; transmitters take turns, so that its angles are wrong, too, by the phase of the wrong speed"
)
_WORDING = {
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
    Flags.RADAR: "a person walks through the radar: the torso comes within "
    f"{BODY_RADIUS_M:g} m of an antenna (motion.range_m, motion.angle_deg, duration_s)",
    Flags.BEHIND: f"a person walks past the radar, to more than {BEHIND_M:g} m behind it "
    "(motion.range_m, motion.angle_deg, duration_s)",
    Flags.SWEEP: "positions are frozen during a sweep, in which a joint is so fast that its echo "
    "belongs more than a range cell elsewhere",
}


class Approach(NamedTuple):
    """The nearest that a scatterer comes to an antenna."""

    distance: float
    joint: str
    antenna: str
    time: float


@dataclass(frozen=True)
class SceneCheck:
    """What the check of one scene's kinematics found."""

    closest: Approach  # nearest passage, exact wherever it is below 5 cm
    # WALL, a scatterer is inside the wall or outside the room; HALF_BAND, a delay lies beyond the
    # kept range bins; ALIASING, a Doppler lies beyond PRF/2; FLOOR, a height is below 0
    flags: Flags
    # how far the worst scatterer is inside the wall or outside the room (WALL), and beyond the
    # half-band (HALF_BAND), m; 0 where none is
    inside_wall: float = 0.0
    beyond_band: float = 0.0
    outside: tuple[float, str] = (0.0, "")  # how far somebody leaves room.box_m, m, and where

    @property
    def too_close(self) -> bool:
        """Whether a scatterer comes within MIN_DISTANCE_M of an antenna."""
        return self.closest.distance < MIN_DISTANCE_M

    @property
    def invalid(self) -> str | None:
        """Why the scene lies outside the model, or None."""
        if self.too_close:
            c = self.closest
            return (
                f"{c.joint} comes to {c.distance * 100:.3g} cm from the {c.antenna} "
                f"({ANTENNA_KEYS[c.antenna]}) at t = {c.time:.3f} s; "
                f"the model holds from {MIN_DISTANCE_M * 100:g} cm on"
            )
        if self.outside[1]:
            return f"the body leaves room.box_m, at {self.outside[1]}"
        if Flags.WALL in self.flags:
            return "the body passes through the wall"
        if Flags.RADAR in self.flags:
            return _WORDING[Flags.RADAR]
        if Flags.HALF_BAND in self.flags:
            return "a scatterer leaves the range half-band"
        return None

    @property
    def miss(self) -> tuple[str, float]:
        """What makes an invalid scene so, and by how many metres."""
        if self.too_close:
            return "too close", MIN_DISTANCE_M - self.closest.distance
        if Flags.WALL in self.flags:
            return "wall", self.inside_wall
        if Flags.RADAR in self.flags:  # by how much is not known
            return "radar", 0.0
        return "half-band", self.beyond_band


def check_scene(scene: Scene) -> SceneCheck:
    """Check one scene on a grid of pulses dense enough for its motion."""
    return _check_people(scene, scene.people)


def _check_people(scene: Scene, people: tuple[Person, ...]) -> SceneCheck:
    checks = [_checked(scene, person) for person in people]
    flags, closest = checks[0].flags, min(check.closest for check in checks)
    for check in checks[1:]:
        flags |= check.flags & ~Flags.GATE  # which follows the sample's own person
    room = reflectors_of(scene)
    if room is not None:  # reflectors move by millimetres: one instant will do
        p, start, antennas = room.positions(np.zeros(1)), np.zeros(1), antennas_of(scene)
        legs = leg(p, antennas.tx), leg(p, antennas.rx)
        closest = min(closest, _nearest(room.names, start, *legs))
    outside = max(check.outside for check in checks)
    return replace(checks[0], closest=closest, flags=flags, outside=outside)


def _checked(scene: Scene, person: Person) -> SceneCheck:
    try:
        return _check(scene, person, moving(person))
    except OutOfReachError as error:
        keys = f"{person.prefix}motion.*, {person.prefix}timing.*"
        raise SceneError(f"{scene.name}: {error} ({keys})") from None


def _check(scene: Scene, person: Person, motion: Motion) -> SceneCheck:
    antennas, wall, box = antennas_of(scene), wall_of(scene), box_of(scene)
    w, processing = waveform_of(scene), scene.config.processing
    body = body_of(person, motion) if scene.config.body.scatterers == "segments" else None
    gate = processing.gate_m if processing.range_sum == "gated" else None
    flags = Flags.RUNS_OUT if getattr(motion, "stops", False) else Flags(0)
    flags |= Flags.SEAM if getattr(motion, "slides", False) else Flags(0)
    near, c = list[Approach](), scene.config
    inside_wall, beyond_band, outside = 0.0, 0.0, (0.0, "")
    shared = not c.people and c.room.faces is None and not isinstance(c.radar, BoardRadar)
    frozen = (
        isinstance(c.radar, FmcwRadar | SfcwRadar | BoardRadar) and not c.engine.motion_in_chirp
    )
    ahead = list[Float]()
    for asked, places, pulses in _grid(motion, w, shared):
        if body is not None and isinstance(body.motion, Landmarks):  # which its echo asks for too
            body.motion.landmark_positions(asked)
        t, p = asked[places], motion.positions(asked)[..., places]
        r_tx, r_rx = leg(p, antennas.tx), leg(p, antennas.rx)
        tau = bistatic_delay(r_tx, r_rx)
        if p[2].min() < -FLOOR_MARGIN_M:
            flags |= Flags.FLOOR
        torso = motion.torso(asked)[:, 0, places]
        if _meets(torso, p[2].max(axis=0), antennas):
            flags |= Flags.RADAR
        ahead.append(_ahead(torso, antennas))
        if wall is not None:
            tau += through_wall_delay(p, antennas, wall)
            deepest = float(wall.depth(p).max())
            if deepest >= 0:
                flags, inside_wall = flags | Flags.WALL, max(inside_wall, deepest)
        if box is not None:
            outside = max(outside, box.farthest_outside(p))
        if (beyond := tau.max() * SPEED_OF_LIGHT / 2 - w.half_band_range) >= 0:
            flags, beyond_band = flags | Flags.HALF_BAND, max(beyond_band, float(beyond))
        rate = np.abs(np.diff(tau)).max(axis=0, initial=0.0) / np.maximum(np.diff(t), 1e-300)
        if rate.max(initial=0.0) * w.f0 > w.prf / 2:
            flags |= Flags.ALIASING
        speed = SPEED_OF_LIGHT / 2 * rate.max(initial=0.0)
        if frozen and speed * sweep_shift(w) > SPEED_OF_LIGHT / (2 * w.bandwidth):
            flags |= Flags.SWEEP
        if isinstance(gate, tuple):
            torso = point_delay(motion.torso(asked)[..., places], antennas, wall)
            distance = torso * (SPEED_OF_LIGHT / 2)
            if distance.min() < gate[0] or distance.max() > gate[1]:
                flags |= Flags.GATE
        one = _nearest(motion.names, t, r_tx, r_rx)
        near.append(_closest(motion, antennas, w, p, pulses, one))
        if body is not None and body.segments and near[-1].distance < REACH_M * body.thickness:
            clear = (body.clearance(antenna, t) for antenna in (antennas.tx, antennas.rx))
            one = _nearest(tuple(segment.name for segment in body.segments), t, *clear)
            near.append(one._replace(distance=max(one.distance, 0.0)))
    flags |= Flags.WALL if outside[1] else Flags(0)
    if min(part.min() for part in ahead) < -BEHIND_M and ahead[0][0] > 0:
        flags |= Flags.BEHIND
    return SceneCheck(min(near), flags, max(inside_wall, outside[0]), beyond_band, outside)


def sweep_shift(waveform: Waveform) -> float:
    """How far motion within a sweep moves the echo of 1 m/s, m (that is, s): (fc + B)/K.

    The beat of tau + 2 v t/c at the middle of the sweep, t = T/2, is that of the range where the
    sweep begins and v (fc + K T)/K: the Doppler of the mid frequency, v (fc + B/2)/K, and v T/2
    that is walked by then. Positions that are frozen where a sweep begins have neither.
    """
    return (waveform.fc + waveform.bandwidth) / waveform.slope


def _meets(torso: Float, top: Float, antennas: Antennas) -> bool:
    """Whether a body is where an antenna is: its torso [3, M] and its highest joint [M], m."""
    for x, y, z in antennas.places:
        near = np.hypot(torso[0] - x, torso[1] - y) < BODY_RADIUS_M
        if (near & (top + HEAD_M > z)).any():
            return True
    return False


def _ahead(torso: Float, antennas: Antennas) -> Float:
    """How far a torso [3, M] is before the hindmost antenna [M], m; 1 where a radar looks down.

    Antennas without a pattern look along x.
    """
    forward = np.array(antennas.aim.axes[0] if antennas.aim else (1.0, 0.0, 0.0))[:2]
    if np.hypot(*forward) < LOOKS_AHEAD:
        return np.ones(torso.shape[1])
    nearest = min(forward @ np.array(place)[:2] for place in antennas.places)
    ahead: Float = forward @ torso[:2] - nearest
    return ahead


class _Asked(OfMotion):
    """A source without paths that records the times at which it is evaluated."""

    wall = None
    t: Float

    def __init__(self, motion: Motion) -> None:
        self.motion = motion

    def __call__(self, t: Float) -> Paths:
        self.t = t
        return Paths(*np.empty((2, 0, t.size)))


def _grid(
    motion: Motion, w: Waveform, shared: bool
) -> Iterator[tuple[Float, Index | slice, Index]]:
    """(times at which to evaluate a motion, which of them to check, their pulses).

    `shared` are the times at which the direct engine evaluates it too, whatever the engine, so that
    the same scenes are drawn; the last to be checked may come after the last pulse.
    """
    step = max(1, int(w.prf / max(GRID_HZ, GRID_PER_CYCLE * motion.highest_frequency)))
    usual = settings(first_aim(USUAL_DB), w, motion.highest_frequency)
    knots = widest_step(w, usual.spacing.per_second)
    if shared and GatedEcho.min_step <= knots <= step and w.n_pulses <= CHUNK_KNOTS * knots:
        asked = _Asked(motion)
        count = knots_of(asked, w, knots, (0, w.n_pulses)).shift.size
        each = np.append(np.arange(0, count, step // knots), count)
        yield asked.t, BEFORE + each, knots * each
        return
    pulses = np.append(np.arange(0, w.n_pulses - 1, step), w.n_pulses - 1)
    for first in range(0, pulses.size - 1, GRID_CHUNK):
        # Consecutive ones share a pulse, so that no step between two is missed.
        some = pulses[first : first + GRID_CHUNK + 1]
        yield w.times(some.astype(float)), slice(None), some


def _closest(
    motion: Motion, antennas: Antennas, waveform: Waveform, p: Float, pulses: Index, near: Approach
) -> Approach:
    """Nearest passage on the grid, or at every pulse where the grid cannot rule out 5 cm."""
    if np.diff(pulses).max() == 1:
        return near
    between = np.sqrt((np.diff(p, axis=2) ** 2).sum(axis=0).max())
    if near.distance - between > MIN_DISTANCE_M:
        return near
    end = min(pulses[-1] + 1, waveform.n_pulses)
    for start in range(pulses[0], end, CHUNK):
        t = waveform.times(np.arange(start, min(start + CHUNK, end), dtype=float))
        p = motion.positions(t)
        near = min(near, _nearest(motion.names, t, leg(p, antennas.tx), leg(p, antennas.rx)))
    return near


def _nearest(names: tuple[str, ...], t: Float, r_tx: Float, r_rx: Float) -> Approach:
    candidates = []
    for name, r in (("transmitter", r_tx), ("receiver", r_rx)):
        joint, at = divmod(int(np.argmin(r)), t.size)
        candidates.append(Approach(float(r[joint, at]), names[joint], name, float(t[at])))
    return min(candidates)


def draw_valid_scene(config: Config, activity: Activity, index: int) -> tuple[Scene, Flags]:
    """Draw one sample, check it and apply `on_invalid`; return it and what to warn of.

    Raises:
        SceneError: a scatterer too close to an antenna (unless redrawn), any scene outside the
            model under `on_invalid: error`, no valid scene in 1000 redraws, or as many as
            `hopeless` takes, or no place for one of `people`.
    """
    misses = list[tuple[str, float]]()
    draws = DRAWS_OF[redrawn(config, activity)]
    while True:
        scene = draw_scene(config, activity, index, len(misses))
        check = _check_people(scene, scene.people[:1])
        if check.invalid is None or (config.on_invalid == "keep" and not check.too_close):
            return _with_others(config, scene, check.flags)
        misses.append(check.miss)
        if len(misses) == MAX_ATTEMPTS or config.on_invalid != "redraw" or hopeless(misses, draws):
            break
    why, cure = f"{check.invalid}{_drawn(scene.people[0])}", _cure(scene.people[0], check)
    if config.on_invalid == "redraw":
        counted = "1 draw, and nothing is drawn again" if draws == 1 else f"{len(misses)} draws"
        raise SceneError(
            f"sample {activity.slug}/{index}: no scene inside the model in {counted} "
            f"(on_invalid: redraw); the last: {why}; {cure}"
        )
    raise SceneError(
        f"sample {activity.slug}/{index}: {why} (on_invalid: {config.on_invalid}); {cure}"
    )


def hopeless(misses: Sequence[tuple[str, float]], draws: int) -> bool:
    """Whether further draws of a scene are no use, as none so far came near the model.

    So it is after some draws that are invalid by the same check, the best of which misses by more
    than all of them differ; and at once where nothing is drawn again.

    Args:
        misses: of all draws, as `SceneCheck.miss` has them.
        draws: so many, and multiples of it, are looked at.
    """
    if len(misses) % draws:
        return False
    sizes = [size for _, size in misses]
    alike = len({kind for kind, _ in misses}) == 1
    return draws == 1 or (alike and min(sizes) > max(sizes) - min(sizes))


# Draws after which `hopeless` looks at them, by what is redrawn.
DRAWS_OF = {Redrawn.NOTHING: 1, Redrawn.NUMBERS: FAR_DRAWS, Redrawn.CHOICES: FAR_CHOICES}


def _with_others(config: Config, scene: Scene, flags: Flags) -> tuple[Scene, Flags]:
    """The scene of an own person who stays; others are drawn until they fit, one by one."""
    again = [0] * len(config.people)
    for number in range(1, len(config.people) + 1):
        why, cure = None, CROWDED
        for again[number - 1] in range(MAX_PLACES):
            scene = draw_scene(config, scene.activity, scene.index, scene.attempt, tuple(again))
            person = next((one for one in scene.people if one.number == number), None)
            if person is None:
                break
            check = _checked(scene, person)
            kept = config.on_invalid != "redraw" and not check.too_close
            why = None if kept and config.on_invalid == "keep" else check.invalid
            cure = _leave_room(person, check) if why else CROWDED
            why = why and why + _drawn(person)
            if why is None and too_near(scene, number) is None:
                flags |= check.flags & ~Flags.GATE  # which follows the sample's own person
                break
            if why is not None and config.on_invalid != "redraw":
                raise SceneError(f"{scene.name}: people.{number - 1}: {why}; {cure}")
        else:
            why = f"people.{number - 1}: {why}" if why else _crowded(number)
            raise SceneError(f"{scene.name}: {why} in {MAX_PLACES} draws; {cure}")
    return scene, flags


def too_near(scene: Scene, last: int | None = None) -> int | None:
    """The first of `people` whose torso comes within TORSOS_APART_M of another's, horizontally.

    Compared 50 times a second, of people to number `last`, or all. None where nobody does, or where
    no body can do what is drawn.
    """
    if len(scene.people) == 1:
        return None
    seconds = scene.people[0].seconds
    t, torsos = np.linspace(0, seconds, int(GRID_HZ * seconds) + 2), list[Float]()
    for person in scene.people:
        if last is not None and person.number > last:
            break
        try:
            torso = moving(person).torso(t)[:2, 0]
        except OutOfReachError:
            return None
        if any(np.hypot(*(torso - other)).min() < TORSOS_APART_M for other in torsos):
            return person.number
        torsos.append(torso)
    return None


def _key_prefix(person: Person) -> str:
    """What the keys of one of the people begin with in the config."""
    return f"people.{person.number - 1}." if person.number else ""


def _drawn(person: Person) -> str:
    whose = _key_prefix(person)
    drawn = {one: getattr(person.motion, one) for one in ("range_m", "cross_range_m")}
    shown = (f"{whose}motion.{key} = {one:.4g}" for key, one in drawn.items() if one is not None)
    return f", with {', '.join(shown)}"


def _crowded(number: int) -> str:
    return f"people.{number - 1} comes within {TORSOS_APART_M} m of another person"


def _leave_room(person: Person, check: SceneCheck) -> str:
    """What would give one of the people room to move."""
    whose = _key_prefix(person)
    keys = f"{whose}motion.range_m and {whose}motion.cross_range_m"
    if not check.outside[1]:
        return f"{keys} should leave room"
    human = person.number or person.config.motion.model == "human"
    turns = human and "walking" in person.activity.movements and not person.motion.lane_m
    turn = f"{whose}motion.lane_m lets people turn round; " if turns else ""
    return f"{turn}{keys}, room.box_m and duration_s should leave room"


def _cure(person: Person, check: SceneCheck) -> str:
    """What would make another scene of this one."""
    config = person.config
    if check.outside[1] and not check.too_close:
        return _leave_room(person, check)
    if check.too_close and check.closest.joint.startswith("reflector "):
        return "room.reflectors should be elsewhere"
    is_board = isinstance(config.radar, BoardRadar)
    if check.flags & Flags.HALF_BAND and is_board and not check.too_close:
        return "a smaller motion.range_m stays in the range that the board's .cfg sees"
    if config.on_invalid == "redraw" and check.flags & Flags.HALF_BAND and not check.too_close:
        impulse = isinstance(config.radar, ImpulseRadar)
        longer = "radar.profile_m that ends later" if impulse else "smaller radar.bandwidth_hz"
        return f"a {longer} reaches farther, a smaller motion.range_m leaves room"
    if config.on_invalid == "redraw":
        return "motion.range_m and motion.angle_deg should leave people room"
    return "on_invalid: redraw draws such scenes again"


def config_warnings(config: Config) -> list[str]:
    """Say which keys and lines have no effect or alias, and whether maps are noise alone."""
    lines = list[str]()
    if isinstance(config.radar, BoardRadar):
        header = config.radar.header
        lines = [f"radar.cfg: {one} is not known and has no effect" for one in header.unknown]
        off = "switches on what is not simulated: it has no effect"
        frame_s = header.loops * len(header.order) * header.slot_s
        window_s = config.processing.window_s if _says_window(config) else None
        if window_s is not None and window_s > frame_s:
            lines.append(
                f"processing.window_s has no effect beyond the {frame_s:.3g} s of a frame's chirps "
                f"(radar.cfg): it is {window_s:g} s"
            )
        lines += [f"radar.cfg: {one} {off}" for one in header.not_simulated]
    return (
        unused_keys(config) + tone_warnings(config) + lines + noise_alone(config) + _folded(config)
    )


def _says_window(config: Config) -> bool:
    """Whether a config gives the window of maps that it asks for."""
    of_doppler = any(name.startswith(("stft", "fsst")) for name in config.maps)
    return of_doppler and "window_s" in config.processing.model_fields_set


def _folded(config: Config) -> list[str]:
    """Say that some echoes by way of faces come from beyond the ranges that the radar has."""
    if config.room.faces is None or isinstance(config.radar, CwRadar | ImpulseRadar):
        return []
    farthest, reach = 0.0, 0.0
    for activity in config.chosen_activities:
        scene = nominal_scene(config, activity)
        antennas, motion = antennas_of(scene), scene.people[0].motion
        p = np.array([motion.range_m or 0.0, motion.cross_range_m or 0.0, 1.0])[:, None, None]
        for tx, rx in ways_of(scene):
            way = leg(tx.image(p), antennas.tx) + leg(rx.image(p), antennas.rx)
            farthest = max(farthest, float(way[0, 0]) / 2)
        reach = waveform_of(scene).half_band_range
    if farthest < reach:
        return []
    return [
        f"echoes by way of room.faces come from up to {farthest:.3g} m, beyond the range half-band "
        f"of {reach:.3g} m: they are missing from maps, or alias (radar.adc_rate_hz, room.order)"
    ]


def scene_warnings(scene: Scene) -> list[str]:
    """Check one scene, which keeps 5 cm from antennas, and return what to warn of, in words."""
    number = too_near(scene)
    if number is not None:
        raise SceneError(f"{scene.name}: {_crowded(number)}; {CROWDED}")
    check = check_scene(scene)
    if check.too_close:
        raise SceneError(f"{scene.name}: {check.invalid}; {_cure(scene.people[0], check)}")
    outside = [_words(flag, scene.config) for flag in Flags if flag in check.flags]
    if check.outside[1] and check.invalid is not None:
        outside[0] = check.invalid
    return (
        outside + config_warnings(scene.config) + timing_warnings(scene.config, (scene.activity,))
    )


def _words(flag: Flags, config: Config | None) -> str:
    """What a flag says, of scenes of a config where there is one."""
    radar = None if config is None else config.radar
    if flag is Flags.ALIASING and isinstance(radar, BoardRadar):
        turns = len(radar.header.order) > 1
        return _WORDING[flag] + ANGLES_ALIAS * turns
    if flag is Flags.SWEEP and config is not None:
        return f"{_WORDING[flag]}: {_slow_sweep(config)}"
    return _WORDING[flag]


def _slow_sweep(config: Config) -> str:
    """How far frozen positions leave echoes from where they belong, and the remedies."""
    radar = config.radar
    w = waveform_of(nominal_scene(config, config.chosen_activities[0]))
    shorter = "radar.dwell_s or radar.steps" if isinstance(radar, SfcwRadar) else "radar.chirp_s"
    within = "engine.motion_in_chirp: true with engine.kind: cube has it, "
    if isinstance(radar, BoardRadar):
        shorter, within = "a ramp of radar.cfg", ""
    return (
        f"by {sweep_shift(w):.2g} m at 1 m/s, with {w.chirp:.2g} s a sweep and cells of "
        f"{SPEED_OF_LIGHT / (2 * w.bandwidth):.2g} m ({within}a smaller {shorter} leaves less)"
    )


def flagged(
    counts: Mapping[Flags, int], recordings: int, config: Config | None = None
) -> list[dict[str, Any]]:
    """What to say of flags: [{kind, recordings, message}]; counts are of so many recordings."""
    return [
        {
            "kind": str(flag.name).lower(),
            "recordings": n,
            "message": f"{n} of {recordings} recordings: {_words(flag, config)}",
        }
        for flag, n in counts.items()
        if n
    ]


def warnings(
    config: Config, counts: Mapping[Flags, int], recordings: int | None = None
) -> list[dict[str, Any]]:
    """What to say once per run: that, and of the config; `recordings` are its own if not given."""
    recordings = recordings or sum(map(config.samples_of, config.chosen_activities))
    messages = [
        {"kind": "config", "recordings": recordings, "message": message}
        for message in config_warnings(config)
    ]
    return [*flagged(counts, recordings, config), *messages] + [
        {"kind": "timing", "recordings": config.samples_of(activity), "message": message}
        for activity in config.chosen_activities
        for message in timing_warnings(config, (activity,))
    ]
