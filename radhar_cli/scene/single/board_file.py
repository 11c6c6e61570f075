"""Frames of a board in an HDF5 file: cube, maps, points, skeletons, and what they mean."""

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import h5py
import numpy as np

from radhar_cli.config.radar import BoardRadar, Radar
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.points import COLUMN_UNITS, COLUMNS, Cloud
from radhar_cli.radar.board import Board
from radhar_cli.scene.products.board_people import Skeletons
from radhar_cli.scene.single.single_precision import in_single

AXES = "of the radar: x ahead, y left, z up, m"
DOPPLER_SIGN = "positive approaching"


def write_frames(
    file: h5py.File,
    subframes: Mapping[str, tuple[Board, Mapping[str, Any]]],
    radar: Radar,
    ways: Sequence[str] = (),
) -> None:
    """Write /cube, /range_doppler and so on, /points, /points_start, /points_person, /skeleton.

    Args:
        file: HDF5 file, open for writing.
        subframes: {end of names: board, products} of each subframe that there is, the products
            {name: product} of FrameMaps, `cube`, `cloud`, `skeletons`, `points_person`,
            `points_kind`, as far as they were made.
        radar: radar of the scene, or of a recording.
        ways: names of the ways by which people are seen, where `points_kind` was made.
    """
    for end, (board, frames) in subframes.items():
        _write_subframe(file, frames, board, ways, end)
    if isinstance(radar, BoardRadar):
        file.attrs["cfg"] = radar.cfg
        file.attrs["cfg_sha256"] = hashlib.sha256(radar.cfg.encode()).hexdigest()
        file.attrs["device"] = str(radar.device or "array")
    board = next(board for board, _ in subframes.values())
    file.attrs.update(
        {
            "axes": AXES,
            "doppler_sign": DOPPLER_SIGN,
            "position_m": np.array(board.position),
            "yaw_deg": np.degrees(board.yaw),
            "tilt_deg": np.degrees(board.tilt),
            "roll_deg": np.degrees(board.roll),
        }
    )


def _write_subframe(
    file: h5py.File, frames: Mapping[str, Any], board: Board, ways: Sequence[str], end: str
) -> None:
    """Write the products of a board's frames, or of a subframe, with an end to each name."""
    for key, product in frames.items():
        name = key + end
        if isinstance(product, FrameMaps):
            _write_maps(file, name, product)
        elif isinstance(product, Cloud):
            _write_cloud(file, product, end)
        elif isinstance(product, Skeletons):
            _write_skeletons(file, product, end)
        elif key == "cube":
            file[name] = in_single(product)
            file[name].attrs["axes"] = ["frame", "loop", "virtual", "sample"]
            file[name].attrs["meaning"] = "raw samples for unit transmit power"
            if board.bpm is not None:
                file[name].attrs["bpm"] = board.bpm
        elif key == "points_kind":
            file[name] = product
            file[name].attrs["kinds"] = [*ways]
        else:
            file[name] = product
            file[name].attrs["meaning"] = "number of the person, -1 of none"
    file.attrs[f"frame_times{end}"] = board.middles
    file.attrs[f"virtual_elements{end}"] = board.places


def _write_maps(file: h5py.File, name: str, maps: FrameMaps) -> None:
    """Write the maps of all frames to /<name>, and their axes to /axes/<name>."""
    dataset = file.create_dataset(name, data=in_single(maps.power), compression="gzip")
    dataset.attrs["axes"] = ["frame", maps.rows.name, maps.columns.name]
    dataset.attrs["meaning"] = "power for unit transmit power: a steady echo of amplitude a is a^2"
    for axis in (maps.rows, maps.columns):
        scale = file.create_dataset(f"axes/{name}/{axis.name}", data=axis.values)
        scale.attrs["unit"] = axis.unit
    file.create_dataset(f"axes/{name}/time", data=maps.times).attrs["unit"] = "s"


def _write_cloud(file: h5py.File, cloud: Cloud, end: str) -> None:
    """Write the points of all frames to /points, and where each frame begins to /points_start."""
    points, start = f"points{end}", f"points_start{end}"
    file[points], file[start] = cloud.points, cloud.start
    file[points].attrs["columns"] = COLUMNS
    file[points].attrs["units"] = COLUMN_UNITS
    file[points].attrs["axes"] = AXES
    file[points].attrs["doppler_sign"] = DOPPLER_SIGN
    file[start].attrs["meaning"] = "frame f has the points start[f] to start[f + 1] - 1"


def _write_skeletons(file: h5py.File, skeletons: Skeletons, end: str) -> None:
    """Write joints to /skeleton, their velocities to /skeleton_velocity, their names."""
    position, velocity = f"skeleton{end}", f"skeleton_velocity{end}"
    file[position], file[velocity] = skeletons.positions, skeletons.velocities
    for name, unit in ((position, "m"), (velocity, "m/s")):
        file[name].attrs["unit"] = unit
        file[name].attrs["axes"] = ["frame", "person", "joint", "ahead left up"]
        file[name].attrs["meaning"] = "in the middle of the chirps of a frame; NaN if absent"
    if "joint_names" not in file:
        file["joint_names"] = [*skeletons.names]
