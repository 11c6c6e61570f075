"""Files that `radhar process` writes of a recording: maps.h5 and maps.png."""

import json
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from radhar_cli import __version__
from radhar_cli.capture.chain import Maps
from radhar_cli.capture.recording import RecordingInfo
from radhar_cli.config.data_set import Config
from radhar_cli.config.identity import resolved
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.errors import UnfinishedError
from radhar_cli.figures.frames_panel import BoardFrames, draw_frames
from radhar_cli.figures.maps_panel import MapsPage, draw_maps
from radhar_cli.files.new_hdf5 import new_hdf5
from radhar_cli.files.replacing import replacing
from radhar_cli.scene.single.board_file import write_frames
from radhar_cli.scene.single.scene_file import write_map

FILES = MAPS_FILE, FIGURE, FRAMES = "maps.h5", "maps.png", "frames.png"
TRACK_UNITS = {
    "time": "s",
    "range": "m",
    "velocity": "m/s, radial, receding",
    "confidence": "1; 0 in frames that were bridged",
}


def write_maps(maps: Maps, config: Config, info: RecordingInfo, folder: Path) -> list[Path]:
    """Write maps.h5 into a folder; return its path, in a list.

    Args:
        config: config by which they were made.
        info: description of the recording.
        folder: output folder.

    Raises:
        UnfinishedError: it cannot be written.
    """
    path = folder / MAPS_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(path) as unfinished, new_hdf5(unfinished, path) as (file, _):
            for name, power_map in maps.maps.items():
                write_map(file, name, power_map)
            if maps.board is not None:
                assert isinstance(config.radar, ArrayRadar)
                end = config.radar.ends_in_files[""]
                write_frames(file, {end: (maps.board, maps.frames)}, config.radar)
            if maps.track is not None:
                for name, unit in TRACK_UNITS.items():
                    file[f"track/{name}"] = getattr(maps.track, name)
                    file[f"track/{name}"].attrs["unit"] = unit
            file.attrs["recording"] = json.dumps(info.document())
            file.attrs["config"] = json.dumps(resolved(config))
            file.attrs["notes"] = json.dumps(maps.notes)
            file.attrs["radhar_version"] = __version__
    except OSError as error:
        raise UnfinishedError(f"{error.filename or folder}: {error.strerror or error}") from None
    return [path]


def draw(maps: Maps, config: Config, title: str, folder: Path) -> list[Path]:
    """Write maps.png, with the torso's track over the range-time map, and a board's frames.png.

    Returns:
        The paths that were written.
    """
    drawn = []
    if maps.maps:
        _draw_maps(maps, config, title, folder / FIGURE)
        drawn.append(folder / FIGURE)
    if maps.board is not None and maps.frames.keys() - {"cube"}:
        draw_frames(BoardFrames(maps.frames, maps.board, config.image, title), folder / FRAMES)
        drawn.append(folder / FRAMES)
    return drawn


def _draw_maps(maps: Maps, config: Config, title: str, path: Path) -> None:
    """Write maps.png."""
    track = maps.track
    last = max((one.rows.values[-1] for name, one in maps.maps.items() if name == "rtm"), default=1)
    far = last if track is None else 1.3 * float(track.range.max()) + 0.5

    def over(axes: Axes, name: str, unit: float) -> None:
        if track is not None and name == "rtm":
            sure = np.where(track.is_sure, track.range, np.nan)
            axes.plot(track.time, track.range, "w:", linewidth=0.8, scalex=False, scaley=False)
            axes.plot(track.time, sure, "w-", linewidth=1.0, scalex=False, scaley=False)

    draw_maps(MapsPage(maps.maps, config.image, maps.f0, float(far), title, over), path)
