"""Samples of a data set synthesised one by one, without building the data set.

Fields have the names, types and values that they have in dataset.h5 (docs/reference/files.md), one
row of each: `maps/stft`, `power/stft`, `entropy/stft`, `slow_time`, `scene/height`, `label`, ...
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from operator import index as whole_number
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.activity import Activity, know_activities, own_activities
from radhar_cli.config.reading import as_config
from radhar_cli.config.schema import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import (
    COLUMN_LABEL,
    LABELS,
    PERSON_LABEL,
    checksum_of,
    chunked,
    columns,
)
from radhar_cli.dataset.sample import Sample, synthesise
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.pipeline.plan import Plan
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.scene import ByIdentity, Scene
from radhar_cli.simulation.simulate import activity_of
from radhar_cli.worker_process import one_thread

ALWAYS = ("label", "sample_key")
_MADE_BY = {
    "power": "output.power: float16",
    "largest_db": "output.power: float16",
    "slow_time": "output.slow_time: true",
    COLUMN_LABEL: "output.column_labels: true",
}


def sample(
    config: Config | str | Path,
    activity: str | Activity | None,
    index: int = 0,
    fields: Iterable[str] | None = None,
    seed: int | None = None,
) -> dict[str, Any]:
    """Synthesise one sample of a data set: the same as in a dataset.h5 of this config, bit for bit.

    Args:
        config: of the data set, or its path.
        activity: slug, label or Activity; None where the config has but one.
        index: number of the sample within its class; may lie beyond `samples_per_class`.
        fields: names in dataset.h5 of what is asked for; nothing else is computed. None is all of
            its large ones: every map, `power/...` and `slow_time` where the config stores them.
        seed: instead of the config's.

    Returns:
        {name: array or number}, `label` and `sample_key` always among them.

    Raises:
        ConfigError: an unknown activity or field, an index or seed that is not a whole number from
            0 to 2^63 - 1, no config, a config of measured data, or as `load_config`.
        SceneError: a scene outside the model (`on_invalid`), or one that the direct engine does not
            reach its tolerance in.
    """
    seed = None if seed is None else whole("seed", seed)
    make = _recipe(ByIdentity(as_config(config)), _named(fields), seed)
    return make(activity_of(activity, make.config), index)


@dataclass(frozen=True)
class Recipe:
    """Makes samples of a data set; can be pickled."""

    config: Config
    fields: tuple[str, ...]  # names in dataset.h5 of what is made

    @classmethod
    def of(
        cls,
        config: Config | str | Path,
        fields: Iterable[str] | None = None,
        seed: int | None = None,
    ) -> "Recipe":
        """The recipe for arguments as those of `sample`.

        Raises:
            ConfigError: as `sample`.
        """
        config = as_config(config)
        if config.recorded is not None:
            raise ConfigError("recordings: are measured; should be a config of scenes to simulate")
        if seed is not None:
            config = config.model_copy(update={"seed": whole("seed", seed)})
        named = _named(fields)
        asked = tuple(chunked(config)) if named is None else tuple(dict.fromkeys(named))
        known = field_names(config)
        for name in asked:
            if name not in known:
                kind = _MADE_BY.get(name.partition("/")[0])
                hint = f"{kind} makes it" if kind else did_you_mean(name, known, ", ".join(known))
                raise ConfigError(f"fields: {name!r} is not in this data set; {hint}")
        return cls(config, asked)

    def __call__(self, activity: Activity, index: int) -> dict[str, Any]:
        """The fields of one sample.

        Raises:
            ConfigError: an index that is not a whole number from 0 to 2^63 - 1.
            SceneError: as `sample`.
        """
        index = whole("index", index)
        with one_thread():
            scene, _ = draw_valid_scene(self._narrowed, activity, index)
            made = synthesise(scene, self._plan)
            return {name: self._field(name, scene, made) for name in (*ALWAYS, *self.fields)}

    @property
    def class_slugs(self) -> list[str]:
        """Slug of every label."""
        return [activity.slug for activity in self.config.every_class]

    @cached_property
    def _narrowed(self) -> Config:
        """The config of what is asked for alone; what is drawn and made stays the same.

        `output.power` stays as it is, since it decides in which precision maps are made.
        """
        of_maps = [name.partition("/")[::2] for name in self.fields]
        shown = {name for kind, name in of_maps if kind != "scene"}
        kinds = {kind for kind, _ in of_maps}
        stored = {"slow_time": "slow_time" in kinds, "column_labels": COLUMN_LABEL in kinds}
        return self.config.model_copy(
            update={
                "maps": tuple(name for name in self.config.maps if name in shown),
                "output": self.config.output.model_copy(update=stored),
            }
        )

    @cached_property
    def _plan(self) -> Plan:
        entropy = any(name.startswith("entropy/") for name in self.fields)
        return plan_images(self._narrowed, entropy)

    @cached_property
    def _large(self) -> dict[str, tuple[int, ...]]:
        return {name: shape for name, (_, shape) in chunked(self.config).items()}

    @cached_property
    def _scene_fields(self) -> dict[str, scene_fields.Field]:
        return {field.name: field for field in scene_fields.fields(self.config)}

    def _field(self, name: str, scene: Scene, made: Sample) -> Any:
        kind, _, rest = name.partition("/")
        if name in self._large:
            return np.ascontiguousarray(made.chunk(name, self._large[name]))
        if kind == "label":
            return scene.activity.index
        if kind == "sample_key":
            return np.array([scene.activity.index, scene.index])
        if name == "scene/subject":
            return scene.subject
        if name in (LABELS, PERSON_LABEL):
            return made.labels[name]
        if kind == "scene":
            field = self._scene_fields[rest]
            return float(scene_fields.values(scene, (field,))[0]) * field.factor
        if kind == COLUMN_LABEL:
            return made.column_labels[rest]
        image = made.images[rest]
        return {
            "entropy": np.float32(image.entropy),
            "extent": np.array(image.extent),
            "largest_db": image.largest_db,
        }[kind]

    def __getstate__(self) -> dict[str, Any]:
        # Plans are of functions that cannot be pickled; other processes make their own.
        return {"config": self.config, "fields": self.fields, "own": own_activities()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        know_activities(state.pop("own"))
        self.__dict__.update(state)


def whole(name: str, value: int) -> int:
    """An argument that should be a whole number from 0 to 2^63 - 1, of numpy's too.

    Raises:
        ConfigError: it is none.
    """
    try:
        number = whole_number(value)
    except TypeError:
        number = -1
    if not 0 <= number < 2**63:
        raise ConfigError(f"{name} = {value!r}: should be a whole number from 0 to 2^63 - 1")
    return number


def _named(fields: Iterable[str] | None) -> tuple[str, ...] | None:
    """Names of fields as they were given, None for those that a data set has.

    Raises:
        ConfigError: these are no names.
    """
    if fields is None:
        return None
    listed = isinstance(fields, Iterable) and not isinstance(fields, str)
    names: tuple[Any, ...] = tuple(fields) if listed else (None,)
    if not all(isinstance(name, str) for name in names):
        raise ConfigError(f"fields = {fields!r}: should be a list of names, such as ['maps/stft']")
    return names


@lru_cache(maxsize=16)
def _recipe(same: ByIdentity, fields: tuple[str, ...] | None, seed: int | None) -> Recipe:
    return Recipe.of(same.config, fields, seed)


def field_names(config: Config) -> tuple[str, ...]:
    """Every field of a sample that there can be: datasets of its dataset.h5.

    Without checksums, the split, and the error of the engine, which is no number of the scene.
    """
    checksums = {checksum_of(name) for name in chunked(config)}
    scene = [f.name for f in scene_fields.fields(config) if f is not scene_fields.ERROR]
    if config.split.subjects is not None:
        scene.append("subject")
    return (
        *chunked(config),
        *(name for name in columns(config) if name not in checksums),
        *(f"scene/{name}" for name in scene),
        *ALWAYS,
    )
