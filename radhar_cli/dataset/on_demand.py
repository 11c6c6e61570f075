"""Samples of a data set synthesised one by one, without building the data set.

Fields have the names, types and values that they have in dataset.h5 (docs/reference/files.md), one
row of each: `maps/stft`, `power/stft`, `entropy/stft`, `slow_time`, `scene/height`, `label`, ...
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from operator import index as whole_number
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import as_config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import large_datasets
from radhar_cli.dataset.sample import synthesise
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import Activity, know_activities, own_activities
from radhar_cli.processes.worker_process import one_thread
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.plan import Plan
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import ByIdentity
from radhar_cli.scene.single.request import activity_of


def sample(
    config: Config | str | Path,
    activity: str | Activity | None,
    index: int = 0,
    seed: int | None = None,
) -> "Sample":
    """Synthesise one sample of a data set: the same as in a dataset.h5 of this config, bit for bit.

    Args:
        config: config of the data set, or its path; its `maps` and `output` name the products.
        activity: slug, S1 to S12 or Activity, one of the config's; None where it has but one.
        index: number of the sample within its class; may lie beyond `samples_per_class`.
        seed: seed instead of the config's.

    Returns:
        {name in dataset.h5: array or number}.

    Raises:
        ConfigError: an unknown activity, an index or seed that is not a whole number from 0 to
            2^63 - 1, no config, a config of measured data, or as `load_config`.
        SceneError: a scene outside the model (`on_invalid`), or one in which the direct engine
            does not reach its tolerance.
    """
    make = _recipe(
        ByIdentity(as_config(config)), None if seed is None else require_index("seed", seed)
    )
    return make(activity_of(activity, make.config), index)


class Sample(dict[str, Any]):
    """One sample: {name in dataset.h5: array or number}."""

    def __repr__(self) -> str:
        scene = sum(name.startswith("scene/") for name in self)
        shapes = {name: list(getattr(value, "shape", ())) for name, value in self.items()}
        arrays = [f"{name} {shape}" for name, shape in shapes.items() if len(shape) > 1]
        others = len(self) - scene - len(arrays)
        return f"<Sample: {', '.join(arrays)}; {scene} scene fields, {others} others>"


@dataclass(frozen=True)
class Recipe:
    """Callable that makes samples of a data set; can be pickled."""

    config: Config

    @classmethod
    def of(cls, config: Config | str | Path, seed: int | None = None) -> "Recipe":
        """Make a recipe of a config or its path, with another seed if one is given.

        Raises:
            ConfigError: the config or the seed cannot be used.
        """
        config = as_config(config)
        if seed is not None:
            config = config.model_copy(update={"seed": require_index("seed", seed)})
        return cls(config)

    def __call__(self, activity: Activity, index: int) -> Sample:
        """Synthesise one sample: that of an index within the class of an activity.

        Raises:
            ConfigError: the activity is no class of the config, or the index no whole number.
            SceneError: the scene lies outside the model, or misses the tolerance.
        """
        index, label = require_index("index", index), self._label(activity)
        with one_thread():
            scene, _ = draw_valid_scene(self.config, activity, index)
            synthesised = synthesise(scene, self._plan, self.config)
        sample = Sample(label=label, sample_key=np.array([label, index]))
        sample.update(synthesised.columns)
        for name, (_, shape) in large_datasets(self.config).items():
            sample[name] = np.ascontiguousarray(synthesised.chunk(name, shape))
        all_fields = scene_fields.fields(self.config)
        fields = tuple(field for field in all_fields if field is not scene_fields.ERROR)
        for field, value in zip(fields, scene_fields.values(scene, fields), strict=True):
            sample[f"scene/{field.name}"] = float(value) * field.factor
        if self.config.split.subjects is not None:
            sample["scene/subject"] = scene.subject
        return sample

    def _label(self, activity: Activity) -> int:
        """Label of a class: its place among those of the config."""
        names = self._classes
        if activity.slug not in names:
            raise ConfigError(
                f"activity = {activity.slug}: is no class of this config, so it has no label; "
                f"activities has {', '.join(names)}"
            )
        return names.index(activity.slug)

    @cached_property
    def _classes(self) -> tuple[str, ...]:
        return tuple(activity.slug for activity in self.config.chosen_activities)

    @cached_property
    def _plan(self) -> Plan:
        return plan_images(self.config)

    def __getstate__(self) -> dict[str, Any]:
        # Plans are of functions that cannot be pickled; other processes make their own.
        return {"config": self.config, "own": own_activities()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        know_activities(state.pop("own"))
        self.__dict__.update(state)


def require_index(name: str, value: int) -> int:
    """Check that an argument is a whole number from 0 to 2^63 - 1, of Python or NumPy.

    Raises:
        ConfigError: it is not; the message has the `name` of the argument.
    """
    try:
        number = whole_number(value)
    except TypeError:
        number = -1
    if not 0 <= number < 2**63:
        raise ConfigError(f"{name} = {value!r}: should be a whole number from 0 to 2^63 - 1")
    return number


@lru_cache(maxsize=16)
def _recipe(config_key: ByIdentity, seed: int | None) -> Recipe:
    return Recipe.of(config_key.config, seed)
