"""Simulate one scene: every map, every signal, the truth behind them."""

import json
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from radhar_cli.activities.activity import Activity, activity_named
from radhar_cli.assembly.bodies import Link, make_path_sources
from radhar_cli.assembly.physics import motion_of, reflectors_of
from radhar_cli.config.checks.signal import problems_of_maps
from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import FRAME_MAPS, MAP_NAMES
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.config.radar import BoardRadar, CwRadar, ImpulseRadar
from radhar_cli.config.reading import ABSENT, as_config
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.direct import Accuracy
from radhar_cli.echo.exact import beat_blocks
from radhar_cli.echo.impulse import steady_profile
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.static_returns import StaticReturn, leakage, near_face_distance, wall_echo
from radhar_cli.errors import ConfigError, SceneError, did_you_mean
from radhar_cli.motion.protocol import Motion, ScattererSubset
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.look import Look, ProfileSamples
from radhar_cli.processing.map_kind import MAP_KINDS, TREATMENTS, UNTREATED
from radhar_cli.processing.points import Cloud
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.processing.signal import Signal, shown_pulses
from radhar_cli.products.fallback import EchoAccuracy, Fallback
from radhar_cli.products.plan import Product
from radhar_cli.products.run import Results, record
from radhar_cli.products.signal import receive_echo, signal_name
from radhar_cli.radar.board import Board
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.layers import Layers
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.scene import Person, Scene, draw_scene, nominal_scene
from radhar_cli.scene_checks.drawing import draw_valid_scene
from radhar_cli.scene_checks.flags import BLACK
from radhar_cli.scene_checks.validity import MIN_DISTANCE_M
from radhar_cli.scene_checks.warnings import scene_warnings
from radhar_cli.single_scene.truth import PathTruth, Truth, path_truth, truth

ALL: Literal["all"] = "all"  # instead of names of maps
# {what may be asked for of a board: the products behind it}
FRAMES = {
    **{name: (name,) for name in FRAME_MAPS},
    "points": ("cloud", "skeletons", "points_person"),
    "cube": ("cube",),
}


class Other(NamedTuple):
    """Somebody else in a scene."""

    person: Person
    motion: Motion
    truth: Truth


@dataclass(frozen=True)
class Simulation:
    """One simulated scene.

    Attributes:
        scene: what was simulated; in `scene.config` every number is fixed.
        waveform, antennas, wall: of the radar and the wall, with derived quantities.
        motion: all that moves, whatever was left out of the echo.
        joint: name of the only scatterer that was kept, or None.
        maps: {map name: PowerMap}.
        signals: {raw | compensated | denoised | compensated_denoised: Signal}.
        truth: kinematics at every pulse.
        warnings: what lies outside the limits of the model, in words.
        seconds: {product: time it took}.
        accuracy: settings and error of the direct engine; None for the cube.
        beat: raw echo [N_ADC, M] with static leakage and wall return, with `raw`; of an impulse
            radar its real profiles [samples, M].
        board: the board, or None.
        frames: of a board: {map name: FrameMaps}, and `cube`, `cloud`, `skeletons`,
            `points_person` if asked for.
        others: other people in the scene.
        paths: every path, if there are several people or a room with faces; else None.
    """

    scene: Scene
    waveform: Waveform
    antennas: Antennas
    wall: Wall | None
    motion: Motion
    joint: str | None
    maps: dict[str, PowerMap]
    signals: dict[str, Signal]
    truth: Truth
    warnings: list[str]
    seconds: dict[str, float]
    accuracy: Accuracy | None = None
    beat: Complex | Float | None = None
    board: Board | None = None
    frames: dict[str, Any] = field(default_factory=dict)
    others: list[Other] = field(default_factory=list)
    paths: PathTruth | None = None

    def __repr__(self) -> str:
        made = {name: one.power.shape for name, one in self.maps.items()}
        parts = [" ".join(f"{name} {list(shape)}" for name, shape in made.items()) or "no maps"]
        parts += [f"frames: {', '.join(self.frames)}"] if self.frames else []
        parts += [f"signals: {', '.join(self.signals)}"] + ["beat"] * (self.beat is not None)
        parts += [f"{1 + len(self.others)} people"] * bool(self.others)
        parts += [f"warnings: {len(self.warnings)}"] * bool(self.warnings)
        seconds, seed = self.config.duration_s, self.config.seed
        return f"<Simulation {self.scene.name}, seed {seed}, {seconds:g} s: {'; '.join(parts)}>"

    @property
    def config(self) -> Config:
        """Config of the scene, in which every number is fixed."""
        return self.scene.config

    @property
    def activity(self) -> Activity:
        """Activity of the sample's main person."""
        return self.scene.activity


def simulate(
    config: Config | str | Path,
    activity: str | Activity | None = None,
    seed: int | None = None,
    *,
    index: int = 0,
    nominal: bool = False,
    joint: str | None = None,
    maps: tuple[str, ...] | Literal["all"] | None = None,
    raw: bool = False,
    progress: Progress = NO_PROGRESS,
) -> Simulation:
    """Simulate one sample of one activity.

    Args:
        config: ranges are drawn from it; image and split are not used. Or its path.
        activity: slug, label or Activity; None where the config has but one.
        seed: instead of the config's.
        index: number of the sample within its class.
        nominal: use the middle of every range instead of random draws.
        joint: keep only this scatterer of the sample's main person.
        maps: which to compute; None for those of the config, "all" for every map that its radar
            makes, and the cube of a board.
        raw: compute the raw beat matrix too, static returns included.
        progress: is told of every product that is made.

    Raises:
        ConfigError: unknown activity or joint, a map that there cannot be, or as `load_config`.
        SceneError: a scatterer comes within 5 cm of an antenna (`on_invalid: redraw` draws such a
            scene again), or with `raw` the near face of the wall within 5 cm of the antennas'
            midpoint.
    """
    config = as_config(config)
    activity = activity_of(activity, config)
    fitting = _fitting_maps(config)
    maps = config.maps if maps is None else fitting if maps == ALL else maps
    if mistakes := problems_of_maps(config, maps):
        lines = (
            f"{one.key} = {json.dumps(one.value, default=str)}: {one.right}" for one in mistakes
        )
        raise ConfigError("\n".join(dict.fromkeys(lines)))
    config = config.model_copy(update={"maps": maps, **({} if seed is None else {"seed": seed})})
    scene = scene_of(config, activity, index, nominal)
    warnings = scene_warnings(scene)
    motion, *others = map(motion_of, scene.people)
    echoing_motion = (
        motion if joint is None else ScattererSubset(motion, (_joint_index(joint, motion.names),))
    )
    board = isinstance(config.radar, BoardRadar)
    frames = [product for name in maps for product in FRAMES.get(name, ())]
    frames += ["points_kind"] if "points" in maps and config.room.faces else []
    maps = tuple(name for name in maps if name not in FRAMES)
    kinds = [] if board else [MAP_KINDS[name] for name in fitting if name in MAP_KINDS]
    of_maps = {UNTREATED, *(kind.treatment for kind in kinds)}
    signals = {str(one): signal_name(one) for one in TREATMENTS if one in of_maps}
    frames += ["cube"] if board and raw and "cube" not in frames else []
    product_names = [*signals.values(), *maps, *frames, "waveform", "antennas", "wall"]
    product_names += ["board"] if board else []
    product_names += ["accuracy"] if config.engine.kind == "direct" else []
    product_names += ["raw_echo"] if raw and not board else []
    raw_rows = [RAW_PROFILES if isinstance(config.radar, ImpulseRadar) else RAW_ECHO]
    motions = (echoing_motion, *(others if joint is None else ()))
    recorded = record(scene, product_names, raw_rows, progress, motions=motions)
    radar = {name: recorded[name] for name in ("antennas", "wall", "waveform")}
    accuracy: EchoAccuracy | None = recorded.products.get("accuracy")
    if isinstance(accuracy, Fallback):
        warnings.append(f"computed by the cube (engine.fallback): {accuracy.reason}")
    black_maps = [name for name in maps if not recorded[name].power.any()]
    black_maps += [
        {"cloud": "points"}.get(name, name) for name in frames if _is_empty(recorded[name])
    ]
    warnings += [f"{', '.join(black_maps)}: {BLACK}"] if black_maps else []
    return Simulation(
        scene=scene,
        **radar,
        motion=motion,
        joint=None if joint is None else echoing_motion.names[0],
        maps={name: recorded[name] for name in maps},
        signals={treatment: recorded[name] for treatment, name in signals.items()},
        truth=truth(motion, **radar),
        others=[
            Other(person, one, truth(one, **radar))
            for person, one in zip(scene.people[1:], others, strict=True)
        ],
        warnings=warnings,
        seconds=recorded.seconds,
        accuracy=accuracy if isinstance(accuracy, Accuracy) else None,
        beat=recorded["raw_echo"] if raw and not board else None,
        board=recorded["board"] if board else None,
        frames={name: recorded[name] for name in frames},
        paths=_paths(scene, (motion, *others), recorded) if others or config.room.faces else None,
    )


def _is_empty(product: object) -> bool:
    """Whether the maps of a board's frames have no power, or its cloud has no point."""
    if isinstance(product, FrameMaps):
        return not product.power.any()
    return isinstance(product, Cloud) and not len(product.points)


def _paths(scene: Scene, motions: tuple[Motion, ...], recorded: Results) -> PathTruth:
    """Evaluate all paths at the pulses that a range-time map shows."""
    w: Waveform = recorded["waveform"]
    shown = shown_pulses(w.n_pulses, scene.config.image.size_px[1])
    link = Link(recorded["antennas"], recorded["wall"], w)
    sources = make_path_sources(scene, motions, link, reflectors_of(scene))
    return path_truth(sources, w.times(shown.astype(float)))


def scene_of(config: Config, activity: Activity, index: int, nominal: bool) -> Scene:
    """Draw sample `index` as a data set has it, again where `on_invalid` says so.

    With `nominal` every number is at its middle instead.

    Raises:
        SceneError: no scene inside the model is drawn.
    """
    if nominal:
        return nominal_scene(config, activity)
    if config.on_invalid == "redraw" or config.people:
        return draw_valid_scene(config, activity, index)[0]
    return draw_scene(config, activity, index)


def _fitting_maps(config: Config) -> tuple[str, ...]:
    """Find the maps that the radar of a config makes with its processing."""
    return tuple(one for one in possible_maps(config) if not problems_of_maps(config, (one,)))


def map_names(chosen: list[str], config: Config) -> tuple[str, ...]:
    """Check names of maps, and put them in the order of the schema.

    Args:
        chosen: names; `all` alone is every map that the radar makes.
        config: config of the radar.

    Raises:
        ConfigError: there is no map of that name.
    """
    if [name.strip() for name in chosen] == [ALL]:
        return _fitting_maps(config)
    names = [name.strip() for name in chosen]
    known = dict.fromkeys((*MAP_NAMES, *FRAMES, *config.maps))  # products of one's own, too
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known, "there are " + ", ".join(known))
            raise ConfigError(f"{name!r} {ABSENT.get(name, f'is not a map; {hint}')}")
    return tuple(name for name in known if name in names)


def raw_echo(
    scene: Scene,
    paths: PathSource,
    waveform: Waveform,
    antennas: Antennas,
    wall: Wall | None,
    receiver: tuple[Impairment, ...],
) -> Complex | Float:
    """Compute the beat matrix as an ADC would record it: body, noise, leakage and wall echo.

    Args:
        scene: the scene; its wall must keep 5 cm from the antennas' midpoint.
        paths: paths of the body.
        waveform: chirps and pulses.
        antennas: antennas, which leak.
        wall: wall, which echoes by itself, or None.
        receiver: impairments, noise among them.

    Returns:
        s_noisy[n, m] [N_ADC, M]; its in-phase channel for a receiver of real samples
        (`radar.output`).

    Raises:
        SceneError: the wall's near face is within 5 cm of the antennas' midpoint.
    """
    blocks = beat_blocks(paths, waveform, receiver, scene.config.engine.motion_in_chirp)
    beat = np.concatenate(list(blocks), axis=1)
    beat += _steady_beat(leakage(antennas), waveform)
    if wall is not None:
        _refuse_near_face(scene, antennas, wall)
        echo = _steady_beat(wall_echo(antennas, wall, waveform), waveform)
        if wall.layers is not None:
            echo *= _reflection(wall.layers, waveform.frequencies())[:, None]
        beat += echo
    is_real = isinstance(scene.radar, CwRadar) and scene.radar.output == "real"
    return beat.real if is_real else beat


def raw_profiles(
    scene: Scene,
    profiles: Float,
    waveform: Impulse,
    antennas: Antennas,
    wall: Wall | None,
    receiver: tuple[Impairment, ...],
) -> Float:
    """Compute range profiles as an impulse radar would record them.

    Args:
        scene: the scene; its wall must keep 5 cm from the antennas' midpoint.
        profiles: profiles of the body alone [samples, M].
        waveform: pulses.
        antennas: antennas, which leak.
        wall: wall, which echoes by itself, or None.
        receiver: impairments, noise among them.

    Returns:
        Profiles [samples, M] of body, noise, leakage and wall echo.

    Raises:
        SceneError: the wall's near face is within 5 cm of the antennas' midpoint.
    """
    look = Look.of_all("profiles", ProfileSamples(waveform))
    r: Float = receive_echo(profiles.astype(complex), look, receiver).x[0].real
    r = r + steady_profile(*leakage(antennas), waveform)
    if wall is not None:
        _refuse_near_face(scene, antennas, wall)
        layers = wall.layers
        reflected = None if layers is None else partial(_reflection, layers)
        r += steady_profile(*wall_echo(antennas, wall, waveform), waveform, reflected)
    return r


def _reflection(layers: Layers, f: Float) -> Complex:
    """R of a wall at frequencies f (Hz), at right angles."""
    reflected: Complex = layers.scattering_coefficients(f, np.ones(())).reflected
    return reflected


def _refuse_near_face(scene: Scene, antennas: Antennas, wall: Wall) -> None:
    """Raise SceneError of a wall whose near face is within 5 cm of the antennas' midpoint."""
    distance = near_face_distance(antennas, wall)
    if distance < MIN_DISTANCE_M:
        raise SceneError(
            f"{scene.name}: the near face of the wall (wall.center_m, wall.size_m) "
            f"is {distance * 100:.3g} cm from the middle of radar.tx_m and radar.rx_m; its "
            f"echo in a raw recording holds from {MIN_DISTANCE_M * 100:g} cm on"
        )


def _steady_beat(static_return: StaticReturn, waveform: Waveform) -> Complex:
    return beat_matrix(
        np.array([[static_return.delay]]), np.array([[static_return.amplitude]]), waveform
    )


RAW_ECHO = Product(
    "raw_echo",
    ("scene", "paths", "waveform", "antennas", "wall", "receiver"),
    raw_echo,
    "beat matrix as recorded, static returns included",
)
RAW_PROFILES = Product(
    "raw_echo",
    ("scene", "profiles", "waveform", "antennas", "wall", "receiver"),
    raw_profiles,
    "range profiles as recorded, static returns included",
)


def activity_of(asked: str | Activity | None, config: Config) -> Activity:
    """Find an activity, with its number in a config where it is a user-defined class.

    Args:
        asked: slug, label or Activity; None where the config has but one.
        config: config whose classes are known, too.

    Raises:
        ConfigError: there is no such activity, none is named and the config has several, or
            `asked` is neither name nor Activity.
    """
    chosen = config.chosen_activities
    if asked is None and len(chosen) > 1:
        raise ConfigError(f"an activity is needed: the config has {len(chosen)} activities")
    if asked is None:
        return chosen[0]
    if not isinstance(asked, (str, Activity)):
        raise ConfigError(f"activity = {asked!r}: should be a slug, a label or an Activity")
    own = {one.slug: one for one in config.every_class}
    try:
        activity = activity_named(asked, own) if isinstance(asked, str) else asked
    except ValueError as error:
        raise ConfigError(str(error)) from None
    return own.get(activity.slug, activity)


def _joint_index(name: str, joints: tuple[str, ...]) -> int:
    key = name.strip().lower().replace("-", "_").replace(" ", "_")
    if key in joints:
        return joints.index(key)
    hint = did_you_mean(key, joints, "the joints are " + ", ".join(joints))
    raise ConfigError(f"{name!r} is not a joint; {hint}")
