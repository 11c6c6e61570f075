"""Metadata within dataset.h5: labels, splits and keys, and the attributes of all datasets."""

import json
from typing import Any

import h5py
import numpy as np

from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.identity import config_hash, resolved
from radhar_cli.config.image import AbsoluteReference, ImageConfig
from radhar_cli.config.maps import FRAME_MAPS
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.dataset import layout, scene_fields
from radhar_cli.dataset.array_description import describe_arrays, label_axes
from radhar_cli.dataset.column_labels import label_names
from radhar_cli.dataset.identity import identity, versions
from radhar_cli.dataset.layout import SPLITS, TIME, Rows
from radhar_cli.dataset.split import persons, split_rows
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.processing.scale import NOISE_PLACE
from radhar_cli.scene.products.segments import label_names as stream_label_names
from radhar_cli.scene.room import names_of_ways
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.schema.annotations import value_text

BLOCK = 4096  # rows of a column read at once
CFAR_TEXT = (
    "255 where a pixel exceeds its threshold over the mean of the training cells around it, else 0 "
    "(image.cfar in the config)"
)
LEVELS_TEXT = (
    "level = floor(255 (dB / dynamic_range_db + 1) + 1/2), dB = 10 log10(power / white), "
    "clipped to [-dynamic_range_db, 0]; level 0 everywhere for an all-zero map; "
)
SHEET_TEXT = "frames side by side, row by row, evenly spread over the sample; edges are a frame's"
SLOW_TIME_TEXT = (
    "x[m] after receiver and canceller, for unit transmit power; NaN after the last pulse of "
    "a recording that is shorter than others"
)


def create_sample_columns(file: h5py.File, config: AnyConfig) -> None:
    """Write the datasets of labels, splits and keys, and the empty ones of /scene."""
    rows = Rows.of(config)
    count = len(rows)
    file["label"] = rows.label.astype(np.uint8)
    file["label"].attrs["names"] = rows.names
    file["label"].attrs["meaning"] = "place in names: the order of `activities` in the config"
    file["split"] = split_rows(config)
    file["split"].attrs["meaning"] = ", ".join(f"{i} {name}" for i, name in enumerate(SPLITS))
    keys = file.create_dataset("sample_key", (count, 2), np.int64)
    keys.attrs["columns"] = ["label", "index"]
    if (person := persons(config)) is not None:
        subject = file.create_dataset("scene/subject", (count,), np.int64, data=person)
        subject.attrs["unit"] = "1"
    keys[:, 0] = rows.label
    keys[:, 1] = np.concatenate([np.arange(number) for number in rows.counts])
    for field in scene_fields.fields(config):
        dataset = file.create_dataset(f"scene/{field.name}", (count,), np.float64)
        dataset.attrs["unit"] = field.unit
        dataset.attrs["config_key"] = field.key


def describe_columns(file: h5py.File, config: AnyConfig) -> None:
    """Write the attributes of the filled datasets: of maps, products, labels and slow time."""
    for name in config.maps:
        _describe_map(file, config, name)
        _describe_columns_of_map(file, config, name)
    describe_arrays(file, config)
    if isinstance(config, Config):
        _describe_products(file, config)
        if config.stream is not None:
            _describe_stream(file, config)


def _describe_map(file: h5py.File, config: AnyConfig, name: str) -> None:
    """Write the attributes of a map, and of its edges and entropy."""
    extent = _common_extent(file[f"extent/{name}"])
    left, right, bottom, top = extent or (np.nan,) * 4
    row_quantity, row_unit = layout.row_axis(name)
    column_quantity, column_unit = layout.column_axis(name)
    image, is_decibel = config.image, config.image.kind == "decibel"
    column_name = "time" if column_quantity == TIME[0] else column_quantity
    attributes = {
        "axes": ["sample", f"{row_quantity} (row 0 is the highest)", column_name],
        "row_quantity": row_quantity,
        "row_unit": row_unit,
        "row_top": top,
        "row_bottom": bottom,
        "column_quantity": column_quantity,
        "column_unit": column_unit,
        "column_left": left,
        "column_right": right,
        "kind": image.kind,
        **({"dynamic_range_db": image.dynamic_range_db} if is_decibel else {}),
        **({"reference": value_text(image.reference)} if is_decibel else {}),
        "levels": LEVELS_TEXT + describe_levels(image) if is_decibel else CFAR_TEXT,
        **({"sheet": SHEET_TEXT} if name in FRAME_MAPS else {}),
        **({"edges": "differ from sample to sample: see /extent"} if extent is None else {}),
    }
    file[f"maps/{name}"].attrs.update(attributes)
    label_axes(file[f"maps/{name}"], ["sample", row_quantity, column_name])
    edges = [f"{column_name} left ({column_unit})", f"{column_name} right ({column_unit})"]
    edges += [f"{row_quantity} bottom ({row_unit})", f"{row_quantity} top ({row_unit})"]
    file[f"extent/{name}"].attrs["columns"] = edges
    file[f"entropy/{name}"].attrs["unit"] = "bit"


def describe_levels(image: ImageConfig, white: str = "level 255", black: str = "level 0") -> str:
    """Describe the powers at the brightest and the darkest level of decibels.

    Args:
        image: section `image` of the config.
        white: name of the brightest level.
        black: name of the darkest level.
    """
    span = f"{image.dynamic_range_db:g} dB"
    if isinstance(image.reference, AbsoluteReference):
        return f"{white} is {image.reference.dbm:g} dBm in a cell or more, {black} {span} below"
    if image.reference == "peak":
        return f"{white} is the largest power of the image, {black} {span} below it or less"
    below, above = (share * image.dynamic_range_db for share in (NOISE_PLACE, 1 - NOISE_PLACE))
    return (
        f"{black} is {below:g} dB below the noise floor of the image, {white} {above:g} dB above "
        f"it; where the largest power is more, {white} is the largest power, {black} {span} below"
    )


def _common_extent(extents: h5py.Dataset) -> tuple[float, float, float, float] | None:
    """Edges (left, right, bottom, top) of a map, of [N, 4]; None where samples differ in them."""
    first = extents[0]
    for start in range(0, len(extents), BLOCK):
        if (extents[start : start + BLOCK] != first).any():
            return None
    left, right, bottom, top = first.tolist()
    return left, right, bottom, top


def _describe_columns_of_map(file: h5py.File, config: AnyConfig, name: str) -> None:
    """Write the attributes of a map's arrays besides its levels: power, column labels."""
    if config.output.power is not None:
        file[f"power/{name}"].attrs["unit"] = f"dB below /largest_db/{name}"
        label_axes(file[f"power/{name}"], [one.label for one in file[f"maps/{name}"].dims])
        file[f"power/{name}"].attrs["meaning"] = "resized power, not clipped; rows as in /maps"
        file[f"largest_db/{name}"].attrs["unit"] = "dB for unit transmit power"
    if config.output.column_labels:
        labels = file[f"{layout.COLUMN_LABEL}/{name}"].attrs
        labels["names"] = label_names(config)
        labels["meaning"] = "number in names of what is under way at the middle of each column"


def _describe_stream(file: h5py.File, config: Config) -> None:
    """Write the attributes of the labels in time of streams."""
    names = stream_label_names(config)
    segments = file[f"products/{layout.SEGMENTS}"].attrs
    segments["names"] = names
    segments["meaning"] = "label is a place in names; person 0 is the sample's main person"
    for name in config.maps:
        if (key := f"{layout.FRAME_LABEL}/{name}") in file:
            file[key].attrs["names"] = names
            axes = ["sample", "person", "column of the map"]
            file[key].attrs["axes"] = axes
            label_axes(file[key], axes)
            meaning = "place in names of what is under way at the middle of each column; -1 nobody"
            file[key].attrs["meaning"] = meaning


def _describe_products(file: h5py.File, config: Config) -> None:
    """Write the attributes of products, labels of people and slow time."""
    radar = config.radar
    ends = radar.ends_in_files.values() if isinstance(radar, ArrayRadar) else ("",)
    recorded = any(config.files_of(activity) is not None for activity in config.chosen_activities)
    for end in ends:
        if f"products/points_kind{end}" in file:
            scene = nominal_scene(config, config.chosen_activities[0])
            file[f"products/points_kind{end}"].attrs["kinds"] = names_of_ways(scene)
        if f"products/skeleton{end}" in file and not recorded:
            file[f"products/skeleton{end}"].attrs["joint_names"] = [*JOINTS]
    if config.people:
        file[layout.LABELS].attrs["class_slugs"] = [
            activity.slug for activity in config.every_class
        ]
        meaning = "place in class_slugs of /labels, the sample's main person first; -1 absent"
        file[layout.PERSON_LABEL].attrs["meaning"] = meaning
    if config.output.slow_time:
        file["slow_time"].attrs.update({"axes": ["sample", "pulse"], "meaning": SLOW_TIME_TEXT})
        label_axes(file["slow_time"], ["sample", "pulse"])


def describe_file(file: h5py.File, config: AnyConfig, messages: list[dict[str, Any]]) -> None:
    """Write the attributes of the file itself; `messages` are its warnings."""
    named = identity(config)
    named = {part: named[part] for part in ("keys", "versions", "hash")}
    described = {
        "schema_version": layout.SCHEMA_VERSION,
        "config": json.dumps(resolved(config)),
        "config_hash": config_hash(config),
        "identity": json.dumps(named, sort_keys=True),
        "seed": config.seed,
        "class_names": [activity.label for activity in config.chosen_activities],
        "class_slugs": [activity.slug for activity in config.chosen_activities],
        "warnings": json.dumps(messages),
        **{f"{library}_version": version for library, version in versions().items()},
    }
    file.attrs.update(described)
