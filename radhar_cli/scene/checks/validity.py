"""Check the kinematics of a scene before any echo is computed: what lies outside the model."""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from radhar_cli.config.radar import ArrayRadar
from radhar_cli.echo.bodies.motion_paths import point_delay, through_wall_delay
from radhar_cli.echo.bodies.segment_paths import Body
from radhar_cli.errors import SceneError
from radhar_cli.motion.human.two_link import OutOfReachError
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.segments import Landmarks
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.propagation import Antennas, bistatic_delay, leg
from radhar_cli.radar.room import Box
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.checks.check_grid import CheckGrid, check_grids
from radhar_cli.scene.checks.flags import BEHIND_M, BODY_RADIUS_M, WORDING, Flags
from radhar_cli.scene.checks.sweep import sweep_shift
from radhar_cli.scene.motion import body_of, moving
from radhar_cli.scene.place import distance_ahead
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.room import reflectors_of, wall_of
from radhar_cli.scene.scene import Person, Scene

HALF_BAND = "half-band"  # a miss that is of the radar alone
MIN_DISTANCE_M = 0.05
HEAD_M = 0.2  # from the highest joint to the top of the head
REACH_M = 1.0  # distance of a segment's surface from its joints, at most
ANTENNA_KEYS = {"transmitter": "radar.tx_m", "receiver": "radar.rx_m"}
CHUNK = 65536
FLOOR_MARGIN_M = 1e-3  # for rounding, and the paper's ankles in the floor


class Approach(NamedTuple):
    """Nearest passage of a scatterer and an antenna.

    Attributes:
        distance: distance, m.
        joint: name of the scatterer.
        antenna: transmitter or receiver.
        time: time of it, s.
    """

    distance: float
    joint: str
    antenna: str
    time: float


@dataclass(frozen=True)
class SceneCheck:
    """Result of the check of a scene's kinematics."""

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
        """Reason why the scene lies outside the model, or None."""
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
            return WORDING[Flags.RADAR]
        if Flags.HALF_BAND in self.flags:
            return "a scatterer leaves the range half-band"
        return None

    @property
    def miss(self) -> tuple[str, float]:
        """Cause that makes a scene invalid, and its size in metres."""
        if self.too_close:
            return "too close", MIN_DISTANCE_M - self.closest.distance
        if Flags.WALL in self.flags:
            return "wall", self.inside_wall
        if Flags.RADAR in self.flags:  # by how much is not known
            return "radar", 0.0
        return HALF_BAND, self.beyond_band


def check_scene(scene: Scene) -> SceneCheck:
    """Check one scene on a grid of pulses dense enough for its motion."""
    return check_people(scene, scene.people)


def check_people(scene: Scene, people: tuple[Person, ...]) -> SceneCheck:
    """Check some of the people of a scene, the sample's own person first, and its reflectors."""
    checks = [check_person(scene, person) for person in people]
    flags, closest = checks[0].flags, min(check.closest for check in checks)
    for check in checks[1:]:
        flags |= check.flags & ~Flags.GATE  # which follows the sample's own person
    room = reflectors_of(scene)
    if room is not None:  # reflectors move by millimetres: one instant will do
        start, antennas = np.zeros(1), antennas_of(scene)
        p = room.positions(start)
        legs = leg(p, antennas.tx), leg(p, antennas.rx)
        closest = min(closest, _find_nearest(room.names, start, *legs))
    outside = max(check.outside for check in checks)
    return replace(checks[0], closest=closest, flags=flags, outside=outside)


def check_person(scene: Scene, person: Person) -> SceneCheck:
    """Check one person of a scene.

    Raises:
        SceneError: no body can do what is drawn.
    """
    try:
        return _check_motion(Surroundings.of(scene, person), moving(person))
    except OutOfReachError as error:
        sections = ("motion.*", "timing.*", "subject.height_m")
        keys = ", ".join(f"{person.prefix}{section}" for section in sections)
        raise SceneError(f"{scene.name}: {error} ({keys})") from None


class RadarChecks(NamedTuple):
    """Checks of some people of a scene by each of its radars.

    Attributes:
        by_radar: check by the scene's own radar.
        decisive: the one by which the scene is kept or not: where somebody comes too close to an
            antenna, else the first that is invalid, else that of the own radar.
        scene: the scene as the radar of the decisive check has it.
    """

    by_radar: SceneCheck
    decisive: SceneCheck
    scene: Scene

    @property
    def invalid(self) -> str | None:
        """Reason why the scene lies outside the model, or None; names one of several radars."""
        reason, config = self.decisive.invalid, self.scene.config
        if reason is None or not config.other_radars:
            return reason
        return f"radar {config.radar_name}: {reason}"


def check_by_each_radar(scene: Scene, people: tuple[Person, ...]) -> RadarChecks:
    """Check some of the people of a scene, the sample's own person first, by each of its radars.

    Raises:
        SceneError: no body can do what is drawn.
    """
    scenes = scene.of_each_radar
    checks = [check_people(one, people) for one in scenes]
    by_radar = checks[[one is scene for one in scenes].index(True)]
    order = sorted(
        zip(checks, scenes, strict=True),
        key=lambda pair: (not pair[0].too_close, pair[0].invalid is None),
    )
    if order[0][0].invalid is None:
        return RadarChecks(by_radar, by_radar, scene)
    return RadarChecks(by_radar, *order[0])


@dataclass(frozen=True)
class Surroundings:
    """Radar, wall and room that the motion of a person is checked against.

    Attributes:
        antennas: antennas of the radar.
        wall: wall, or None.
        box: faces of the room, or None.
        waveform: waveform of the radar.
        body: body of segments about the joints; None for points and surfaces.
        gate_m: nearest and farthest range of a fixed gate, m, or None.
        freezes_sweeps: whether positions are frozen during a sweep.
        shares_grid: whether the motion is checked where the direct engine evaluates it.
        one_of_several: whether the radar is one of several, which look at the person.
    """

    antennas: Antennas
    wall: Wall | None
    box: Box | None
    waveform: Waveform
    body: Body | None
    gate_m: tuple[float, float] | None
    freezes_sweeps: bool
    shares_grid: bool
    one_of_several: bool = False

    @classmethod
    def of(cls, scene: Scene, person: Person) -> "Surroundings":
        """Collect the surroundings that a person of a scene is checked against."""
        config, gate_m = scene.config, scene.config.processing.gate_m
        is_gated = config.processing.range_sum == "gated"
        has_segments = config.body.scatterers == "segments"
        is_alone = not config.people and config.room.faces is None
        return cls(
            antennas=antennas_of(scene),
            wall=wall_of(scene),
            box=scene.room.make_box(),
            waveform=waveform_of(scene),
            body=body_of(person, moving(person)) if has_segments else None,
            gate_m=gate_m if is_gated and isinstance(gate_m, tuple) else None,
            freezes_sweeps=config.radar.sweeps and not config.engine.motion_in_chirp,
            shares_grid=is_alone and not isinstance(config.radar, ArrayRadar),
            one_of_several=bool(config.other_radars),
        )


@dataclass
class _Findings:
    """Findings of the check of one person, grid after grid."""

    flags: Flags
    approaches: list[Approach] = field(default_factory=list)
    torso_ahead: list[Float] = field(default_factory=list)  # of the hindmost antenna, m
    looks_at: tuple[float, float] | None = None  # by antennas without a pattern, m
    inside_wall: float = 0.0
    beyond_band: float = 0.0
    outside: tuple[float, str] = (0.0, "")

    def check_places(self, around: Surroundings, p: Float, torso: Float) -> None:
        """Check joints [3, I, M] and the torso [3, M], m: floor, radar, room and wall."""
        if p[2].min() < -FLOOR_MARGIN_M:
            self.flags |= Flags.FLOOR
        if _meets_antenna(torso, p[2].max(axis=0), around.antennas):
            self.flags |= Flags.RADAR
        if around.one_of_several and not self.torso_ahead:
            self.looks_at = float(torso[0, 0]), float(torso[1, 0])
        self.torso_ahead.append(distance_ahead(torso, around.antennas, self.looks_at))
        if around.box is not None:
            self.outside = max(self.outside, around.box.farthest_outside(p))
        if around.wall is not None:
            depth = float(around.wall.depth(p).max())
            if depth >= 0:
                self.flags |= Flags.WALL
                self.inside_wall = max(self.inside_wall, depth)

    def check_delays(self, around: Surroundings, t: Float, delay: Float) -> None:
        """Check delays [I, M] (s) at times t [M] (s): half-band, Doppler, motion in a sweep."""
        w = around.waveform
        beyond = delay.max() * SPEED_OF_LIGHT / 2 - w.half_band_range
        if beyond >= 0:
            self.flags |= Flags.HALF_BAND
            self.beyond_band = max(self.beyond_band, float(beyond))
        rates = np.abs(np.diff(delay)).max(axis=0, initial=0.0) / np.maximum(np.diff(t), 1e-300)
        rate = rates.max(initial=0.0)
        if rate * w.f0 > w.prf / 2:
            self.flags |= Flags.ALIASING
        speed = SPEED_OF_LIGHT / 2 * rate
        if around.freezes_sweeps and speed * sweep_shift(w) > SPEED_OF_LIGHT / (2 * w.bandwidth):
            self.flags |= Flags.SWEEP

    def check_gate(self, gate_m: tuple[float, float], torso_delay: Float) -> None:
        """Check delays of the torso (s) against a gate of fixed ranges (m)."""
        distance = torso_delay * (SPEED_OF_LIGHT / 2)
        if distance.min() < gate_m[0] or distance.max() > gate_m[1]:
            self.flags |= Flags.GATE

    def conclude(self) -> SceneCheck:
        """Make the result of all grids."""
        flags = self.flags | (Flags.WALL if self.outside[1] else Flags(0))
        hindmost = min(part.min() for part in self.torso_ahead)
        if hindmost < -BEHIND_M and self.torso_ahead[0][0] > 0:
            flags |= Flags.BEHIND
        inside = max(self.inside_wall, self.outside[0])
        return SceneCheck(min(self.approaches), flags, inside, self.beyond_band, self.outside)


def _check_motion(around: Surroundings, motion: Motion) -> SceneCheck:
    """Check the motion of a person on all grids."""
    flags = Flags.RUNS_OUT if getattr(motion, "stops", False) else Flags(0)
    flags |= Flags.SEAM if getattr(motion, "slides", False) else Flags(0)
    clip = getattr(motion, "clip", None)
    if clip is not None:
        flags |= Flags.BRIDGED if clip.bridged else Flags(0)
        flags |= Flags.MARCHES if clip.marches else Flags(0)
    findings = _Findings(flags)
    for grid in check_grids(motion, around.waveform, around.shares_grid):
        _check_on_grid(findings, around, motion, grid)
    return findings.conclude()


def _check_on_grid(
    findings: _Findings, around: Surroundings, motion: Motion, grid: CheckGrid
) -> None:
    """Check the motion of a person on one grid."""
    antennas, wall, body = around.antennas, around.wall, around.body
    if body is not None and isinstance(body.motion, Landmarks):  # which its echo asks for too
        body.motion.landmark_positions(grid.times)
    t, p = grid.of_checked(grid.times), grid.of_checked(motion.positions(grid.times))
    torso = grid.of_checked(motion.torso(grid.times))
    findings.check_places(around, p, torso[:, 0])
    legs = leg(p, antennas.tx), leg(p, antennas.rx)
    delay = bistatic_delay(*legs)
    if wall is not None:
        delay += through_wall_delay(p, antennas, wall)
    findings.check_delays(around, t, delay)
    if around.gate_m is not None:
        findings.check_gate(around.gate_m, point_delay(torso, antennas, wall))
    nearest_joint = _refine_nearest(
        motion, around, p, grid.pulses, _find_nearest(motion.names, t, *legs)
    )
    findings.approaches.append(nearest_joint)
    if body is not None and body.segments and nearest_joint.distance < REACH_M * body.thickness:
        clearances = (body.clearance(antenna, t) for antenna in (antennas.tx, antennas.rx))
        names = tuple(segment.name for segment in body.segments)
        nearest_surface = _find_nearest(names, t, *clearances)
        distance = max(nearest_surface.distance, 0.0)
        findings.approaches.append(nearest_surface._replace(distance=distance))


def _meets_antenna(torso: Float, top: Float, antennas: Antennas) -> bool:
    """Whether a body is where an antenna is: its torso [3, M] and its highest joint [M], m."""
    for x, y, z in antennas.places:
        is_near = np.hypot(torso[0] - x, torso[1] - y) < BODY_RADIUS_M
        if (is_near & (top + HEAD_M > z)).any():
            return True
    return False


def _refine_nearest(
    motion: Motion, around: Surroundings, p: Float, pulses: Index, nearest: Approach
) -> Approach:
    """Find the nearest passage at every pulse where the grid cannot rule out 5 cm.

    Args:
        around: antennas and waveform.
        p: positions on the grid [3, I, M], m.
        pulses: pulses of the grid [M].
        nearest: nearest passage on the grid.
    """
    if np.diff(pulses).max() == 1:
        return nearest
    between = np.sqrt((np.diff(p, axis=2) ** 2).sum(axis=0).max())
    if nearest.distance - between > MIN_DISTANCE_M:
        return nearest
    waveform, antennas = around.waveform, around.antennas
    end = min(pulses[-1] + 1, waveform.n_pulses)
    for start in range(pulses[0], end, CHUNK):
        t = waveform.times(np.arange(start, min(start + CHUNK, end), dtype=float))
        p = motion.positions(t)
        legs = leg(p, antennas.tx), leg(p, antennas.rx)
        nearest = min(nearest, _find_nearest(motion.names, t, *legs))
    return nearest


def _find_nearest(names: tuple[str, ...], t: Float, r_tx: Float, r_rx: Float) -> Approach:
    """Find the nearest passage of scatterers [I] at distances [I, M] (m) from both antennas."""
    candidates = []
    for antenna, r in (("transmitter", r_tx), ("receiver", r_rx)):
        joint, time = divmod(int(np.argmin(r)), t.size)
        candidates.append(Approach(float(r[joint, time]), names[joint], antenna, float(t[time])))
    return min(candidates)
