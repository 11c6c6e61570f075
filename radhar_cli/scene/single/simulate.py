"""Simulate one scene: every map, every signal, the truth behind them."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, NamedTuple

from radhar_cli.config.checks.doubts import word_warnings
from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar, ImpulseRadar
from radhar_cli.config.reading import as_config
from radhar_cli.echo.direct import Accuracy
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.points import Cloud
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.processing.signal import Signal, shown_pulses
from radhar_cli.radar.board import Board
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.checks.flags import BLACK
from radhar_cli.scene.checks.warnings import scene_warnings
from radhar_cli.scene.motion import aspect_of, motion_of
from radhar_cli.scene.paths import Link, make_path_sources
from radhar_cli.scene.products.fallback import EchoAccuracy, Fallback
from radhar_cli.scene.products.run import Results, record
from radhar_cli.scene.room import reflectors_of
from radhar_cli.scene.scene import Person, Scene
from radhar_cli.scene.single.raw_echo import RAW_ECHO, RAW_PROFILES
from radhar_cli.scene.single.request import ProductNames, SceneRequest
from radhar_cli.scene.single.truth import (
    PathTruth,
    Truth,
    evaluate_path_truth,
    evaluate_truth,
    truth_of_nobody,
)


class OtherPerson(NamedTuple):
    """Somebody else in a scene."""

    person: Person
    motion: Motion
    truth: Truth


class SubframeProducts(NamedTuple):
    """Products of the frames of a subframe.

    Attributes:
        board: the board with the chirps of the subframe.
        frames: the same products as of the chosen one.
    """

    board: Board
    frames: dict[str, Any]


@dataclass(frozen=True)
class Simulation:
    """One simulated scene.

    Attributes:
        scene: the scene; in `scene.config` every number is fixed.
        waveform, antennas, wall: of the radar and the wall, with derived quantities.
        motion: all that moves, whatever was left out of the echo.
        joint: name of the only scatterer that was kept, or None.
        maps: {map name: PowerMap}.
        signals: {raw | compensated | denoised | compensated_denoised: Signal}.
        truth: kinematics at every pulse.
        warnings: violations of the limits of the model, in words.
        seconds: {product: time it took}.
        accuracy: settings and error of the direct engine; None for the cube.
        beat: raw echo [N_ADC, M] with static leakage and wall return, with `raw`; of an impulse
            radar its real profiles [samples, M].
        board: the board, or None.
        frames: of a board: {map name: FrameMaps}, and `cube`, `cloud`, `skeletons`,
            `points_person` if asked for.
        subframes: {end of names: products} of the other subframes of a board.
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
    subframes: dict[str, SubframeProducts] = field(default_factory=dict)
    others: list[OtherPerson] = field(default_factory=list)
    paths: PathTruth | None = None

    def __repr__(self) -> str:
        shapes = {name: power_map.power.shape for name, power_map in self.maps.items()}
        parts = [" ".join(f"{name} {list(shape)}" for name, shape in shapes.items()) or "no maps"]
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
    def all_subframes(self) -> dict[str, SubframeProducts]:
        """Products of every subframe of a board, by the ends of their names in files."""
        radar = self.config.radar
        if self.board is None or not isinstance(radar, ArrayRadar):
            return {}
        by_end = {"": SubframeProducts(self.board, self.frames), **self.subframes}
        return {in_files: by_end[end] for end, in_files in radar.ends_in_files.items()}

    @property
    def activity(self) -> Activity:
        """Activity of the sample's main person."""
        return self.scene.activity


def simulate(  # noqa: PLR0913 - the documented interface, whose options are those of a request
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
        maps: names of the maps; None for those of the config, "all" for every map that its radar
            makes, and the cube of a board.
        raw: compute the raw beat matrix too, static returns included, and the maps of its samples.
        progress: is told of every product that is made.

    Raises:
        ConfigError: unknown activity or joint, a map that there cannot be, or as `load_config`.
        SceneError: a scatterer comes within 5 cm of an antenna (`on_invalid: redraw` draws such a
            scene again), or with `raw` the near face of the wall within 5 cm of the antennas'
            midpoint.
    """
    request = SceneRequest(as_config(config), activity, seed, index, nominal, joint, maps, raw)
    return simulate_scene(request, progress)


def simulate_scene(request: SceneRequest, progress: Progress = NO_PROGRESS) -> Simulation:
    """Simulate the scene of a request.

    Args:
        progress: is told of every product that is made.

    Raises:
        ConfigError, SceneError: as `simulate`.
    """
    scene = request.draw_scene()
    scene_notes = [*scene_warnings(scene), *word_warnings(request.config)]
    motions = tuple(map(motion_of, scene.people))
    echoing = request.echoing_motions(motions)
    names = request.product_names(scene.config.maps)
    raw_rows = [RAW_PROFILES if isinstance(scene.radar, ImpulseRadar) else RAW_ECHO]
    results = record(scene, names.together, raw_rows, progress, motions=echoing)
    joint = None if request.joint is None else echoing[0].names[0]
    return _simulation_of(scene, motions, joint, names, results, scene_notes)


def _simulation_of(
    scene: Scene,
    motions: tuple[Motion, ...],
    joint: str | None,
    names: ProductNames,
    results: Results,
    scene_notes: list[str],
) -> Simulation:
    """Put the products of a scene together with its truth."""
    radar = {name: results[name] for name in ("antennas", "wall", "waveform")}
    truths = [evaluate_truth(motion, **radar) for motion in motions]
    if scene.config.radar_name is not None:
        truths = [
            replace(truth, aspect=aspect_of(motion, radar["antennas"], truth.time))
            for motion, truth in zip(motions, truths, strict=True)
        ]
    truth = truths[0]
    accuracy: EchoAccuracy | None = results.products.get("accuracy")
    others = [
        OtherPerson(*other) for other in zip(scene.people[1:], motions[1:], truths[1:], strict=True)
    ]
    has_paths = len(motions) > 1 or bool(scene.config.room.faces)
    return Simulation(
        scene=scene,
        **radar,
        motion=motions[0],
        joint=joint,
        maps={name: results[name] for name in names.maps},
        signals={treatment: results[name] for treatment, name in names.signals.items()},
        truth=truth_of_nobody(truth, scene.activity.slug) if scene.is_empty else truth,
        others=others,
        warnings=[*scene_notes, *_result_warnings(names, results, scene.is_empty)],
        seconds=results.seconds,
        accuracy=accuracy if isinstance(accuracy, Accuracy) else None,
        beat=results["raw_echo"] if "raw_echo" in names.others else None,
        board=results["board"] if "board" in names.others else None,
        frames={name: results[name] for name in names.frames},
        subframes={
            end: SubframeProducts(
                results[f"board{end}"], {name: results[name + end] for name in names.frames}
            )
            for end in names.ends
        },
        paths=_evaluate_paths(scene, motions, results) if has_paths else None,
    )


def _result_warnings(names: ProductNames, results: Results, is_empty: bool) -> list[str]:
    """Warn of an engine that the direct one fell back to, and of maps without any power."""
    warnings = []
    accuracy = results.products.get("accuracy")
    if isinstance(accuracy, Fallback):
        warnings.append(f"computed by the cube (engine.fallback): {accuracy.reason}")
    black_maps = [name for name in names.maps if not results[name].power.any()]
    black_maps += [
        {"cloud": "points"}.get(name, name) for name in names.frames if _is_empty(results[name])
    ]
    if not black_maps or is_empty:
        return warnings
    return [*warnings, f"{', '.join(black_maps)}: {BLACK}"]


def _is_empty(product: object) -> bool:
    """Whether the maps of a board's frames have no power, or its cloud has no point."""
    if isinstance(product, FrameMaps):
        return not product.power.any()
    return isinstance(product, Cloud) and not len(product.points)


def _evaluate_paths(scene: Scene, motions: tuple[Motion, ...], results: Results) -> PathTruth:
    """Evaluate all paths at the pulses that a range-time map shows."""
    waveform: Waveform = results["waveform"]
    pulses = shown_pulses(waveform.n_pulses, scene.config.image.size_px[1])
    link = Link(results["antennas"], results["wall"], waveform)
    sources = make_path_sources(scene, motions, link, reflectors_of(scene))
    return evaluate_path_truth(sources, waveform.times(pulses.astype(float)))
