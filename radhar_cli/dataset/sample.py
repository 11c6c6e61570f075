"""One sample of a data set: the image of every map, and how exact they are."""

from collections.abc import Callable, Mapping
from math import isfinite, nan
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.dataset.column_labels import label_columns, label_names
from radhar_cli.dataset.layout import (
    COLUMN_LABEL,
    FRAME_LABEL,
    LABELS,
    PERSON_LABEL,
    SEGMENTS,
    TIME,
    column_axis,
)
from radhar_cli.echo.accuracy import error_as_stored
from radhar_cli.echo.direct import Accuracy
from radhar_cli.errors import SceneError
from radhar_cli.numerics.arrays import Complex, Float, Levels
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.power_map import MapImage
from radhar_cli.processing.scale import DecibelScale
from radhar_cli.scene.products.fallback import EchoAccuracy, Fallback
from radhar_cli.scene.products.images import level_scale_of
from radhar_cli.scene.products.plan import Plan
from radhar_cli.scene.products.run import Results, run
from radhar_cli.scene.products.segments import column_times, label_frames
from radhar_cli.scene.scene import Scene


class StoredSample(NamedTuple):
    """One sample: the images of a scene, and all that a data set stores with them."""

    images: dict[str, MapImage]  # {map name: image}, in the order of the config
    # measured error of the direct engine; NaN where it made nothing that could err
    error_db: float = nan
    # the cube made the signal, as the direct engine could not (`engine.fallback`)
    fell_back: bool = False
    # {map name: [width]}, where asked for (`output.column_labels`)
    column_labels: Mapping[str, Levels] = MappingProxyType({})
    # x[m] after the canceller, where it is stored (`output.slow_time`)
    slow_time: Complex | None = None
    # {name: array}, where they are stored (`output.products`)
    products: Mapping[str, NDArray[Any]] = MappingProxyType({})
    # {name: values}: LABELS and PERSON_LABEL of scenes with `people`, FRAME_LABEL of streams
    labels: Mapping[str, NDArray[Any]] = MappingProxyType({})

    @property
    def columns(self) -> dict[str, Any]:
        """Values of this sample in the small datasets: {name in dataset.h5: value}."""
        values = dict[str, Any](self.labels)
        for name, image in self.images.items():
            values[f"entropy/{name}"] = np.float32(image.entropy)
            values[f"extent/{name}"] = np.array(image.extent)
            if image.decibels is not None:
                values[f"largest_db/{name}"] = image.largest_db
        labels = {f"{COLUMN_LABEL}/{name}": label for name, label in self.column_labels.items()}
        return values | labels

    def chunk(self, name: str, shape: tuple[int, ...]) -> NDArray[Any]:
        """Array of this sample in a large dataset (`layout.large_datasets`), in the shape given."""
        kind, _, map_name = name.partition("/")
        if kind == "maps":
            return self.images[map_name].levels
        if kind == "power":
            decibels = self.images[map_name].decibels
            assert decibels is not None
            return decibels
        assert self.slow_time is not None
        padded = np.full(shape, complex(nan, nan), np.complex64)
        padded[: self.slow_time.size] = self.slow_time
        return padded


class SampleRow(NamedTuple):
    """One row of a data set: a sample, the numbers of its scene, and its warnings."""

    sample: StoredSample
    values: Float  # numbers of `scene_fields.fields` [field]
    flags: int = 0  # `Flags`


# Makes a row of a data set that is not simulated; what it holds can be pickled.
RowFactory: TypeAlias = Callable[[MeasuredConfig, int], SampleRow]


def synthesise(scene: Scene, plan: Plan, config: Config) -> StoredSample:
    """Run the plan of a data set on one scene.

    Args:
        plan: plan of the images (`plan_images`).
        config: config of the data set, whose classes the labels number; that of the scene has but
            the class that is performed.

    Raises:
        SceneError: an engine misses its tolerance, or a product cannot be stored.
    """
    return store(run(plan, {"scene": scene}), scene, config)


def store(recording: Results, scene: Scene, config: Config) -> StoredSample:
    """Collect the products of a scene that a data set stores.

    Args:
        recording: products of the plan of a data set.
        config: config of the data set, as of `synthesise`.

    Raises:
        SceneError: a product cannot be stored.
    """
    images: dict[str, MapImage] = {name: recording[f"image:{name}"] for name in scene.config.maps}
    labels: dict[str, Levels] = {}
    if scene.config.output.column_labels:
        motion = recording["motions"][0]
        names = label_names(config)
        labels = {n: label_columns(scene, motion, image, names) for n, image in images.items()}
    accuracy: EchoAccuracy | None = recording.products.get("accuracy")
    fell_back, error_db = isinstance(accuracy, Fallback), nan
    if isinstance(accuracy, Accuracy) and isfinite(accuracy.error_db):
        error_db = accuracy.error_db
    slow_time = None
    if scene.config.output.slow_time:
        slow_time = _storable(recording["signal"].x[0, 0], scene.name)
        error_db = error_as_stored(error_db)
    scale = level_scale_of(scene.config)
    products = {
        name: storable_array(recording[product], name, scale)
        for name, product in scene.config.stored.items()
    }
    return StoredSample(
        images,
        error_db,
        fell_back,
        labels,
        slow_time,
        products,
        labels_of(scene, config) | frame_labels_of(images, products, config),
    )


def _storable(x: Complex, name: str) -> Complex:
    """Check that complex64 can hold the slow time [M] of a sample, and return it."""
    largest, single = float(np.abs(x).max(initial=0.0)), np.finfo(np.float32)
    if largest > 0 and not float(single.tiny) <= largest <= float(single.max):
        raise SceneError(
            f"sample {name}: output.slow_time: its largest value, {largest:.3g}, should be from "
            f"{single.tiny:.3g} to {single.max:.3g}, which complex64 holds (wall.loss_tangent, "
            "motion.range_m)"
        )
    return x


def labels_of(scene: Scene, config: Config) -> dict[str, NDArray[Any]]:
    """Labels of everybody in a scene: LABELS [class] and PERSON_LABEL [person] by name.

    Args:
        config: config of the data set; labels are places in its `every_class`.

    Returns:
        The labels; none where the config has no `people`.
    """
    if not scene.config.people:
        return {}
    classes = [activity.slug for activity in config.every_class]
    person = np.full(1 + len(scene.config.people), -1, np.int16)
    for someone in scene.present:
        person[someone.number] = classes.index(someone.activity.slug)
    present = np.zeros(len(classes), np.uint8)
    present[person[person >= 0]] = 1
    present[classes.index(scene.activity.slug)] = 1  # `nobody` is a label, too
    return {LABELS: present, PERSON_LABEL: person}


def frame_labels_of(
    images: Mapping[str, MapImage], products: Mapping[str, NDArray[Any]], config: Config
) -> dict[str, NDArray[Any]]:
    """Labels [person, width] of the columns of each map over time, by their names in dataset.h5.

    Args:
        images: {map name: image}.
        products: stored products, the segments among them.
        config: config of the data set.

    Returns:
        The labels; none where the config has no `stream`.
    """
    if config.stream is None:
        return {}
    people = 1 + len(config.people)
    return {
        f"{FRAME_LABEL}/{name}": label_frames(
            products[SEGMENTS], people, column_times(image.extent, image.levels.shape[1])
        ).astype(np.int16)
        for name, image in images.items()
        if column_axis(name) == TIME
    }


def storable_array(value: Any, name: str, scale: DecibelScale) -> NDArray[Any]:
    """Array of a product as it is stored: the power of a map, the samples of a signal, or an array.

    Frame maps are stored as images are: grey levels, on the scale of all frames of the sample, of
    the ranges that images show.
    """
    if isinstance(value, FrameMaps):
        return scale.levels(value.shown.power)
    value = getattr(value, "power", getattr(value, "x", value))
    array = np.asarray(None if isinstance(value, (tuple, list, dict)) else value)
    if array.ndim == 0 or array.dtype.kind not in "iufc":
        raise SceneError(f"output.products: {name} is {type(value).__name__}; should be an array")
    return array
