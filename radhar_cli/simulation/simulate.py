"""Simulate one scene: every map, every signal, the truth behind them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from radhar_cli.activity import Activity, activity_named
from radhar_cli.arrays import Complex, Float
from radhar_cli.body.skeleton import JOINTS
from radhar_cli.config.experiment import MAP_NAMES, Config, MapName
from radhar_cli.echo import cube
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.direct import Accuracy
from radhar_cli.echo.static_returns import leakage, near_face_distance, wall_echo
from radhar_cli.errors import ConfigError, SceneError, did_you_mean
from radhar_cli.pipeline.axes import Axes, axes_of
from radhar_cli.pipeline.body_paths import BodyPaths
from radhar_cli.pipeline.plan import SIGNALS, plan
from radhar_cli.pipeline.run import Recording, run
from radhar_cli.pipeline.survey import CLOSEST_M, check
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scenario import Scene, draw_scene, nominal_scene
from radhar_cli.simulation.truth import Truth, truth

SIGNAL_NAMES: Mapping[str, str] = {
    "raw": "plain",
    "compensated": "compensated",
    "denoised": "denoised",
    "compensated_denoised": "compensated_denoised",
}
assert set(SIGNAL_NAMES.values()) == set(SIGNALS)


@dataclass(frozen=True)
class PowerMap:
    """One map in physical units.

    Attributes:
        name: one of the nine.
        power: [frequency or range, time], lowest first.
        vertical: Doppler frequency (Hz) or range (m) of the rows.
        time: centres of the columns, s.
        entropy: bits.
    """

    name: str
    power: Float
    vertical: Float
    time: Float
    entropy: float

    @property
    def is_range(self) -> bool:
        return self.name == "rtm"

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges (time start, time stop, vertical low, vertical high)."""
        return Axes(self.vertical, self.time).extent


@dataclass(frozen=True)
class Simulation:
    """One simulated scene.

    Attributes:
        config: that it was drawn from.
        scene: the drawn numbers.
        waveform: the radar's, with everything that follows from it.
        joint: the single scatterer that was kept, or None.
        maps: {map name: PowerMap}.
        slow_time: {raw | compensated | denoised | compensated_denoised: x [M - 1]}.
        truth: kinematics at every pulse.
        warnings: what lies outside the model, in words.
        seconds: {stage: time it took}.
        accuracy: settings and measured error of the direct engine; None of the cube.
        beat: raw echo [N_ADC, M] with static leakage and wall return, where asked for.
    """

    config: Config
    scene: Scene
    waveform: Waveform
    joint: str | None
    maps: dict[str, PowerMap]
    slow_time: dict[str, Complex]
    truth: Truth
    paths: BodyPaths = field(repr=False)
    warnings: list[str]
    seconds: dict[str, float]
    accuracy: Accuracy | None = None
    beat: Complex | None = None

    @property
    def activity(self) -> Activity:
        return self.scene.activity


def simulate(
    config: Config,
    activity: str | Activity,
    seed: int | None = None,
    *,
    nominal: bool = False,
    joint: str | None = None,
    maps: tuple[MapName, ...] = MAP_NAMES,
    raw: bool = False,
) -> Simulation:
    """Simulate sample 0 of one activity.

    Args:
        config: ranges are drawn from it; `maps`, image and split are not used.
        activity: slug, label or Activity.
        seed: instead of the config's.
        nominal: take the middle of every range instead of drawing.
        joint: keep this scatterer alone.
        maps: which of the nine to compute.
        raw: compute the raw beat matrix too, static returns included.

    Raises:
        ConfigError: unknown activity or joint.
        SceneError: a scatterer comes within 5 cm of an antenna, or with `raw` the near face of the
            wall within 5 cm of the antennas' midpoint.
    """
    if isinstance(activity, str):
        activity = _activity(activity)
    if seed is not None:
        config = config.model_copy(update={"seed": seed})
    scene = nominal_scene(config, activity) if nominal else draw_scene(config, activity, 0)
    warnings = check(scene, config)
    chosen = None if joint is None else (_joint(joint),)
    entropies = [f"entropy:{name}" for name in maps]
    signals = [f"signal:{which}" for which in SIGNALS]
    recording = run(plan(config, [*signals, *maps, *entropies]), scene, config, chosen)
    products = recording.products
    why = recording.fallback
    fallback = [f"computed by the cube (engine.fallback): {why}"] if why else []
    return Simulation(
        config=config,
        scene=scene,
        waveform=recording.waveform,
        joint=None if chosen is None else JOINTS[chosen[0]],
        maps={name: _power_map(name, recording) for name in maps},
        slow_time={name: products[f"signal:{which}"] for name, which in SIGNAL_NAMES.items()},
        truth=truth(products["paths"], recording.waveform),
        paths=products["paths"],
        warnings=[*warnings, *fallback],
        seconds=recording.seconds,
        accuracy=recording.accuracy,
        beat=raw_echo(recording) if raw else None,
    )


def map_names(chosen: list[str] | None) -> tuple[MapName, ...]:
    """The maps of these names, in our order; all nine for None.

    Raises:
        ConfigError: one is unknown.
    """
    names = [name.strip() for name in chosen] if chosen is not None else list(MAP_NAMES)
    for name in names:
        if name not in MAP_NAMES:
            hint = did_you_mean(name, MAP_NAMES, "there are " + ", ".join(MAP_NAMES))
            raise ConfigError(f"{name!r} is no map; {hint}")
    return tuple(name for name in MAP_NAMES if name in names)


def raw_echo(recording: Recording) -> Complex:
    """s_noisy[n, m] [N_ADC, M] as an ADC would record it: body, noise, leakage and wall echo.

    Raises:
        SceneError: the wall's near face is within 5 cm of the antennas' midpoint.
    """
    waveform, paths = recording.waveform, recording.products["paths"]
    rng = recording.noise("beat") if "signal_power" in recording.plan else None
    moving = recording.config.engine.motion_in_chirp
    blocks = [
        block[:, (1 if first else 0) :]
        for first, block in cube.beat_blocks(paths, waveform, recording.sigma, rng, moving)
    ]
    beat = np.concatenate(blocks, axis=1)
    static = [leakage(paths.antennas)]
    if paths.wall is not None:
        distance = near_face_distance(paths.antennas, paths.wall)
        if distance < CLOSEST_M:
            raise SceneError(
                f"{recording.scene.name}: the near face of the wall (wall.center_m, wall.size_m) "
                f"is {distance * 100:.3g} cm from the middle of radar.tx_m and radar.rx_m; its "
                f"echo in a raw recording holds from {CLOSEST_M * 100:g} cm on"
            )
        static.append(wall_echo(paths.antennas, paths.wall, waveform))
    delay = np.array([[one.delay] for one in static])
    amplitude = np.array([[one.amplitude] for one in static])
    beat += beat_matrix(delay, amplitude, waveform)
    return beat


def _power_map(name: str, recording: Recording) -> PowerMap:
    axes = axes_of(name, recording)
    products: dict[str, Any] = recording.products
    return PowerMap(name, products[name], axes.vertical, axes.time, products[f"entropy:{name}"])


def _activity(name: str) -> Activity:
    try:
        return activity_named(name)
    except ValueError as error:
        raise ConfigError(str(error)) from None


def _joint(name: str) -> int:
    key = name.strip().lower().replace("-", "_").replace(" ", "_")
    if key in JOINTS:
        return JOINTS.index(key)
    hint = did_you_mean(key, JOINTS, "the joints are " + ", ".join(JOINTS))
    raise ConfigError(f"{name!r} is no joint; {hint}")
