"""Descriptions of the arrays of /products in dataset.h5: their axes, units and edges."""

from collections.abc import Sequence

import h5py
import numpy as np

from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.dataset import layout
from radhar_cli.dataset.card_contents import ROWS
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS
from radhar_cli.processing.points import COLUMN_UNITS, COLUMNS
from radhar_cli.processing.power_map import Axis
from radhar_cli.scene.products.board import make_board, scene_of_subframe
from radhar_cli.scene.products.segments import SEGMENT_COLUMNS, SEGMENT_UNITS
from radhar_cli.scene.scene import nominal_scene

JOINT = "frame", "person", "joint", "ahead left up"
# {array of /products: its axes and its unit}; units of columns stand in COLUMNS_OF.
ARRAYS = {
    "points": (("point", "column"), "of each column"),
    "points_start": (("frame",), "1"),
    "points_person": (("point",), "1"),
    "points_kind": (("point",), "1"),
    "skeleton": (JOINT, "m"),
    "skeleton_velocity": (JOINT, "m/s"),
    "cube": (("frame", "loop", "virtual", "sample"), "1"),
    layout.SEGMENTS: (("segment", "column"), "of each column"),
}
COLUMNS_OF = {
    "points": (COLUMNS, COLUMN_UNITS),
    layout.SEGMENTS: (SEGMENT_COLUMNS, SEGMENT_UNITS),
}
TIMES = "adc_rate_hz", "bandwidth_hz", "carrier_hz", "chirp_s", "prf_hz"  # which decide edges
DIFFER = "differ from sample to sample, as the radar does"


def label_axes(dataset: h5py.Dataset, names: Sequence[str]) -> None:
    """Give a dataset the labels of HDF5 for its dimensions."""
    for dimension, name in zip(dataset.dims, names, strict=True):
        dimension.label = name


def describe_arrays(file: h5py.File, config: AnyConfig) -> None:
    """Write axes, unit and meaning of each array of /products, and the edges of frame maps."""
    for name in config.stored:
        kind, _, subframe = name.partition("_sf")
        dataset = file[f"products/{name}"]
        counts = file[layout.count_of(name)]
        counts.attrs["meaning"] = f"rows of /products/{name} that each sample has"
        label_axes(counts, ["sample"])
        if kind in FRAME_MAP_KINDS and dataset.ndim == 3:
            _describe_frame_maps(file, config, name, int(subframe) if subframe else None)
            continue
        axes, unit = ARRAYS.get(kind, ((), ""))
        if len(axes) != dataset.ndim:  # a user's own
            axes = ("row", *(f"axis {number}" for number in range(1, dataset.ndim)))
            unit = "of the product"
        dataset.attrs["axes"], dataset.attrs["unit"] = axes, unit
        if "meaning" not in dataset.attrs:
            dataset.attrs["meaning"] = ROWS.get(kind, "a row of the product")
        if kind in COLUMNS_OF:
            dataset.attrs["columns"], dataset.attrs["units"] = COLUMNS_OF[kind]
        label_axes(dataset, axes)


def _describe_frame_maps(
    file: h5py.File, config: AnyConfig, name: str, subframe: int | None
) -> None:
    """Write the attributes of frames whose levels are stored, as those of maps have them.

    Args:
        file: dataset.h5, whose columns are filled.
        config: config of the data set.
        name: name of the array.
        subframe: number of the subframe in its name; None of a board without several.
    """
    kind = FRAME_MAP_KINDS[name.partition("_sf")[0]]
    dataset = file[f"products/{name}"]
    axes = ["frame", kind.rows.quantity, kind.columns.quantity]
    dataset.attrs["axes"] = axes
    dataset.attrs["unit"] = "level"
    dataset.attrs["meaning"] = "levels of a frame, as in /maps; row 0 is the lowest"
    names = ("bottom", "top", "row"), ("left", "right", "column")
    common = _axes_of(file, config, kind.name, subframe)
    for (first, last, side), quantity, axis in zip(
        names, (kind.rows, kind.columns), common or (None, None), strict=True
    ):
        low, high = (np.nan, np.nan) if axis is None else axis.edges
        described = {f"{side}_quantity": quantity.quantity, f"{side}_unit": quantity.unit}
        dataset.attrs.update({**described, f"{side}_{first}": low, f"{side}_{last}": high})
    if common is None:
        dataset.attrs["edges"] = DIFFER
    label_axes(dataset, axes)


def _axes_of(
    file: h5py.File, config: AnyConfig, name: str, subframe: int | None
) -> tuple[Axis, Axis] | None:
    """Axes of the rows and columns of frames that are stored; None where samples differ in them."""
    if not isinstance(config, Config) or _differs(file):
        return None
    scene = nominal_scene(config, config.chosen_activities[0])
    board = make_board(scene if subframe is None else scene_of_subframe(scene, subframe))
    kind, limits = FRAME_MAP_KINDS[name], config.image.range_limits_m
    rows = kind.rows.of(board)
    if limits is not None and rows.name == "range":
        rows = rows.only(rows.cells_within(limits))
    return rows, kind.columns.of(board)


def _differs(file: h5py.File) -> bool:
    """Whether the radar of some samples has other times or frequencies than that of others."""
    keys = {f"radar.{name}" for name in TIMES}
    drawn = [one[:] for one in file["scene"].values() if one.attrs.get("config_key") in keys]
    return any((values != values[0]).any() for values in drawn)
