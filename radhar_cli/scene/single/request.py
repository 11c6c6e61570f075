"""Request for one scene: which sample of which config, and what to make of it."""

import json
from dataclasses import dataclass
from typing import Literal

from radhar_cli.config.checks.signal import problems_of_maps
from radhar_cli.config.data_set import Config
from radhar_cli.config.engine import EngineConfig
from radhar_cli.config.maps import FRAME_MAPS, KNOWN_MAPS
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.config.radar import ArrayRadar, ImpulseRadar
from radhar_cli.config.reading import ABSENT
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.motion.activities.activity import Activity, activity_named
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.protocol import Motion, ScattererSubset
from radhar_cli.processing.map_kind import MAP_KINDS, TREATMENTS, UNTREATED
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.signal import signal_name
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene

ALL: Literal["all"] = "all"  # instead of names of maps
# {name in a request for maps of a board: the products behind it}
FRAMES = {
    **{name: (name,) for name in FRAME_MAPS},
    "points": ("cloud", "skeletons", "points_person"),
    "cube": ("cube",),
}


@dataclass(frozen=True)
class SceneRequest:
    """One scene to simulate, and what of it to compute.

    Attributes:
        config: config that the scene is drawn from; image and split are not used.
        activity: slug, label or Activity; None where the config has but one.
        seed: seed instead of the config's.
        index: number of the sample within its class.
        nominal: whether every number is at the middle of its range instead of drawn.
        joint: the only scatterer of the main person to keep, alone in the scene; None keeps all.
        maps: names of maps; None for those of the config, "all" for every map that its radar
            makes, and the cube of a board.
        raw: whether the raw beat matrix is computed too, static returns included. The maps are then
            made of its samples (`engine.kind: cube`), so that it gives the same ones.
    """

    config: Config
    activity: str | Activity | None = None
    seed: int | None = None
    index: int = 0
    nominal: bool = False
    joint: str | None = None
    maps: tuple[str, ...] | Literal["all"] | None = None
    raw: bool = False

    def draw_scene(self) -> Scene:
        """Draw the scene; the maps of its config are those of the request.

        Raises:
            ConfigError: there is no such activity, or a map that the radar does not make.
            SceneError: no scene inside the model is drawn.
        """
        activity, maps = activity_of(self.activity, self.config), self._chosen_maps()
        if mistakes := problems_of_maps(self.config, maps):
            lines = (
                f"{mistake.key} = {json.dumps(mistake.value, default=str)}: {mistake.right}"
                for mistake in mistakes
            )
            raise ConfigError("\n".join(dict.fromkeys(lines)))
        if self.joint is not None and activity.is_nobody:
            raise ConfigError(f"joint = {self.joint!r}: should be left out; nobody is there")
        seed = self.config.seed if self.seed is None else self.seed
        config = self.config.model_copy(update={"maps": maps, "seed": seed, "engine": self._engine})
        return scene_of(config, activity, self.index, self.nominal)

    @property
    def _engine(self) -> EngineConfig:
        """Engine of the scene, which draws noise as the recording has it if there is to be one.

        The direct engine draws noise after the sum over range, of the same law but not the same.
        """
        engine = self.config.engine
        has_one_noise = isinstance(self.config.radar, ArrayRadar | ImpulseRadar)
        if not self.raw or has_one_noise:
            return engine
        return engine.model_copy(update={"kind": "cube"})

    def _chosen_maps(self) -> tuple[str, ...]:
        if self.maps is None:
            return self.config.maps
        return maps_of_radar(self.config) if self.maps == ALL else self.maps

    def echoing_motions(self, motions: tuple[Motion, ...]) -> tuple[Motion, ...]:
        """Motions that the echo is made of, of everybody's, the main person's first.

        Raises:
            ConfigError: the main person has no joint of that name.
        """
        if self.joint is None:
            return motions
        return (ScattererSubset(motions[0], (_joint_index(self.joint, motions[0].names),)),)

    def product_names(self, maps: tuple[str, ...]) -> "ProductNames":
        """Names of the products that give these maps, and all else that is requested."""
        config, is_board = self.config, isinstance(self.config.radar, ArrayRadar)
        frames = [product for name in maps for product in FRAMES.get(name, ())]
        frames += ["points_kind"] if "points" in maps and config.room.faces else []
        frames += ["cube"] if is_board and self.raw and "cube" not in frames else []
        treatments = {UNTREATED}
        if not is_board:
            names = maps_of_radar(config)
            treatments |= {MAP_KINDS[name].treatment for name in names if name in MAP_KINDS}
        signals = {str(one): signal_name(one) for one in TREATMENTS if one in treatments}
        others = ["waveform", "antennas", "wall"] + ["board"] * is_board
        others += ["accuracy"] if self._engine.kind == "direct" else []
        others += ["raw_echo"] if self.raw and not is_board else []
        names_of_maps = tuple(name for name in maps if name not in FRAMES)
        ends = config.radar.other_subframes if isinstance(config.radar, ArrayRadar) else ()
        return ProductNames(names_of_maps, signals, tuple(frames), tuple(others), tuple(ends))


@dataclass(frozen=True)
class ProductNames:
    """Names of the products of one scene, by what becomes of them.

    Attributes:
        maps: products that are maps of one channel.
        signals: slow-time signals {treatment: product}.
        frames: products of a board's frames.
        others: radar, wall, board, accuracy, raw echo.
        ends: ends of the names of the same products of a board's other subframes.
    """

    maps: tuple[str, ...]
    signals: dict[str, str]
    frames: tuple[str, ...]
    others: tuple[str, ...]
    ends: tuple[str, ...] = ()

    @property
    def together(self) -> list[str]:
        """Every name, signals first."""
        of_subframes = [name + end for end in self.ends for name in (*self.frames, "board")]
        return [*self.signals.values(), *self.maps, *self.frames, *self.others, *of_subframes]


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


def maps_of_radar(config: Config) -> tuple[str, ...]:
    """Names of the maps that the radar of a config makes with its processing."""
    return tuple(name for name in possible_maps(config) if not problems_of_maps(config, (name,)))


def map_names(chosen: list[str], config: Config) -> tuple[str, ...]:
    """Check names of maps, and put them in the order of the schema.

    Args:
        chosen: names; `all` alone is every map that the radar makes.

    Raises:
        ConfigError: there is no map of that name.
    """
    if [name.strip() for name in chosen] == [ALL]:
        return maps_of_radar(config)
    names = [name.strip() for name in chosen]
    known = dict.fromkeys((*KNOWN_MAPS, *FRAMES, *config.maps))  # products of one's own, too
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known, "there are " + ", ".join(known))
            raise ConfigError(f"{name!r} {ABSENT.get(name, f'is not a map; {hint}')}")
    return tuple(name for name in known if name in names)


def activity_of(activity: str | Activity | None, config: Config) -> Activity:
    """Find an activity, with its number in a config where it is a user-defined class.

    Args:
        activity: slug, label or Activity; None where the config has but one.
        config: config whose classes are known, too.

    Raises:
        ConfigError: there is no such activity, none is named and the config has several, or
            `activity` is neither name nor Activity.
    """
    chosen = config.chosen_activities
    if activity is None and len(chosen) > 1:
        raise ConfigError(f"an activity is needed: the config has {len(chosen)} activities")
    if activity is None:
        return chosen[0]
    if not isinstance(activity, (str, Activity)):
        raise ConfigError(f"activity = {activity!r}: should be a slug, a label or an Activity")
    classes = {known.slug: known for known in config.every_class}
    try:
        named = activity_named(activity, classes) if isinstance(activity, str) else activity
    except ValueError as error:
        raise ConfigError(str(error)) from None
    is_movement = named.slug in MOVEMENTS and named.slug not in classes
    if is_movement and config.motion.model != "human":
        right = "is a movement of people, which motion.model: human makes"
        raise ConfigError(f"activity = {named.slug}: {right}")
    return classes.get(named.slug, named)


def _joint_index(name: str, joints: tuple[str, ...]) -> int:
    key = name.strip().lower().replace("-", "_").replace(" ", "_")
    if key in joints:
        return joints.index(key)
    hint = did_you_mean(key, joints, "the joints are " + ", ".join(joints))
    raise ConfigError(f"{name!r} is not a joint; {hint}")
