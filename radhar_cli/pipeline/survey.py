"""Check scenes before any echo is computed: what lies outside the model, and what to warn of."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.activity import Activity
from radhar_cli.arrays import Float, Index
from radhar_cli.body.pose import Body
from radhar_cli.body.skeleton import JOINTS
from radhar_cli.config.experiment import Config, timing_warnings
from radhar_cli.errors import SceneError
from radhar_cli.pipeline.models import antennas_of, body_of, wall_of, waveform_of
from radhar_cli.radar.propagation import Antennas, bistatic_delay, leg
from radhar_cli.radar.transmission import wall_delay
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform
from radhar_cli.scenario import Scene, draw_scene

CLOSEST_M = 0.05
GRID_HZ = 50.0
GRID_PER_CYCLE = 40
ANTENNA_KEYS = {"transmitter": "radar.tx_m", "receiver": "radar.rx_m"}
MOST_ATTEMPTS = 1000
CHUNK = 65536
GRID_CHUNK = 16384


class Approach(NamedTuple):
    """The nearest that a scatterer comes to an antenna."""

    distance: float
    joint: str
    antenna: str
    time: float


@dataclass(frozen=True)
class Findings:
    """What a look at one scene's kinematics found.

    Attributes:
        closest: nearest passage, exact wherever it is below 5 cm.
        leaves_half_band: a scatterer's delay lies beyond the kept range bins.
        aliases: a scatterer's Doppler lies beyond PRF/2.
        meets_wall: a scatterer is inside the wall.
    """

    closest: Approach
    leaves_half_band: bool
    aliases: bool
    meets_wall: bool

    @property
    def too_close(self) -> bool:
        return self.closest.distance < CLOSEST_M

    @property
    def kinds(self) -> dict[str, bool]:
        """What there is to warn of."""
        return {
            "wall": self.meets_wall,
            "half_band": self.leaves_half_band,
            "aliasing": self.aliases,
        }

    @property
    def invalid(self) -> str | None:
        """Why the scene lies outside the model, or None."""
        if self.too_close:
            c = self.closest
            return (
                f"{c.joint} comes to {c.distance * 100:.3g} cm from the {c.antenna} "
                f"({ANTENNA_KEYS[c.antenna]}) at t = {c.time:.3f} s; "
                f"the model holds from {CLOSEST_M * 100:g} cm on"
            )
        if self.meets_wall:
            return "the body passes through the wall"
        if self.leaves_half_band:
            return "a scatterer leaves the range half-band"
        return None


def survey(scene: Scene, config: Config) -> Findings:
    """Look at one scene on a grid of pulses dense enough for its motion."""
    body, antennas = body_of(scene), antennas_of(scene)
    wall, waveform = wall_of(scene, config), waveform_of(scene, config)
    rate = max(GRID_HZ, GRID_PER_CYCLE * body.highest_frequency)
    step = max(1, int(waveform.prf / rate))
    pulses = np.append(np.arange(0, waveform.n_pulses - 1, step), waveform.n_pulses - 1)
    looks = [  # consecutive ones share a pulse, so that no step between two is missed
        _look(body, antennas, wall, waveform, pulses[first : first + GRID_CHUNK + 1])
        for first in range(0, pulses.size - 1, GRID_CHUNK)
    ]
    return Findings(
        closest=min(look.closest for look in looks),
        leaves_half_band=any(look.leaves_half_band for look in looks),
        aliases=any(look.aliases for look in looks),
        meets_wall=any(look.meets_wall for look in looks),
    )


def _look(
    body: Body, antennas: Antennas, wall: Wall | None, waveform: Waveform, pulses: Index
) -> Findings:
    """`survey` of some pulses of the grid."""
    t = waveform.times(pulses.astype(float))
    p = body.positions(t)
    tau = bistatic_delay(leg(p, antennas.tx), leg(p, antennas.rx))
    if wall is not None:
        for antenna in (antennas.tx, antennas.rx):
            tau = tau + wall_delay(p, antenna, wall)
    doppler = np.abs(np.diff(tau, axis=1)) * waveform.f0 / np.maximum(np.diff(t), 1e-300)
    return Findings(
        closest=_closest(body, antennas, waveform, p, pulses),
        leaves_half_band=bool(tau.max() * SPEED_OF_LIGHT / 2 >= waveform.half_band_range),
        aliases=bool(doppler.max(initial=0.0) > waveform.prf / 2),
        meets_wall=wall is not None and bool(wall.contains(p).any()),
    )


def _closest(
    body: Body, antennas: Antennas, waveform: Waveform, p: Float, pulses: Index
) -> Approach:
    """Nearest passage on the grid, or at every pulse where the grid cannot rule out 5 cm."""
    near = _nearest(p, waveform.times(pulses.astype(float)), antennas)
    if np.diff(pulses).max() == 1:
        return near
    between = np.sqrt((np.diff(p, axis=2) ** 2).sum(axis=0)).max()
    if near.distance - between > CLOSEST_M:
        return near
    for start in range(pulses[0], pulses[-1] + 1, CHUNK):
        t = waveform.times(np.arange(start, min(start + CHUNK, pulses[-1] + 1), dtype=float))
        near = min(near, _nearest(body.positions(t), t, antennas))
    return near


def _nearest(p: Float, t: Float, antennas: Antennas) -> Approach:
    candidates = []
    for name, antenna in (("transmitter", antennas.tx), ("receiver", antennas.rx)):
        r = leg(p, antenna)
        joint, at = np.unravel_index(np.argmin(r), r.shape)
        candidates.append(Approach(float(r[joint, at]), JOINTS[joint], name, float(t[at])))
    return min(candidates)


class Drawn(NamedTuple):
    """Outcome for one row: the attempt that is kept, and what there is to warn of in it."""

    attempt: int
    kinds: dict[str, bool]


def settle(config: Config, activity: Activity, index: int) -> Drawn:
    """Survey one sample and apply `on_invalid`.

    Raises:
        SceneError: a scatterer too close to an antenna (unless redrawn), any scene outside the
            model under `on_invalid: error`, or no valid scene in 1000 redraws.
    """
    findings: Findings | None = None
    for attempt in range(MOST_ATTEMPTS if config.on_invalid == "redraw" else 1):
        scene = draw_scene(config, activity, index, attempt)
        findings = survey(scene, config)
        if findings.invalid is None or (config.on_invalid == "keep" and not findings.too_close):
            return Drawn(attempt, findings.kinds)
    assert findings is not None
    if config.on_invalid == "redraw":
        raise SceneError(
            f"sample {activity.slug}/{index}: no scene inside the model in {MOST_ATTEMPTS} draws "
            f"(on_invalid: redraw); the last: {findings.invalid}"
        )
    raise SceneError(
        f"sample {activity.slug}/{index}: {findings.invalid} (on_invalid: {config.on_invalid})"
    )


_WORDING = {
    "wall": "the body passes through the wall",
    "half_band": "a scatterer leaves the range half-band and its echo the kept bins",
    "aliasing": "a joint moves faster than the Doppler PRF/2 and aliases",
}
KINDS = tuple(_WORDING)


def check(scene: Scene, config: Config) -> list[str]:
    """Survey one scene and say what to warn of.

    Raises:
        SceneError: a scatterer comes within 5 cm of an antenna.
    """
    findings = survey(scene, config)
    if findings.too_close:
        raise SceneError(f"{scene.name}: {findings.invalid}")
    said = [_WORDING[kind] for kind, found in findings.kinds.items() if found]
    return said + timing_warnings(config, (scene.activity,))


def fallback_warnings(fallen: int, recordings: int) -> list[dict[str, Any]]:
    """What to say of the recordings that the cube made instead of the direct engine."""
    if not fallen:
        return []
    message = f"{fallen} of {recordings} recordings: computed by the cube (engine.fallback)"
    return [{"kind": "fallback", "recordings": fallen, "message": message}]


def warnings(config: Config, drawn: Sequence[Drawn]) -> list[dict[str, Any]]:
    """What to say once per run: [{kind, recordings, message}]."""
    counts = {kind: sum(outcome.kinds[kind] for outcome in drawn) for kind in _WORDING}
    said: list[dict[str, Any]] = [
        {
            "kind": kind,
            "recordings": n,
            "message": f"{n} of {len(drawn)} recordings: {_WORDING[kind]}",
        }
        for kind, n in counts.items()
        if n
    ]
    return said + [
        {"kind": "timing", "recordings": config.samples_per_class, "message": message}
        for message in timing_warnings(config)
    ]
