"""A data set of measured data: windows of the recordings that a manifest lists."""

import csv
import io
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.capture.board_frames import OF_FRAMES, frames_of_recording
from radhar_cli.capture.chain import maps_of
from radhar_cli.capture.content import (
    TOLERANCE,
    Content,
    describe_difference,
    describe_other_chirps,
    radar_section,
)
from radhar_cli.capture.fitted_radar import radar_of_recording
from radhar_cli.capture.images import are_images, is_image, list_images, read_image
from radhar_cli.capture.point_recording import (
    NOBODY,
    PointRecording,
    PointRecordingInfo,
    is_point_recording,
)
from radhar_cli.capture.recording import Recording
from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.config.identity import resolved
from radhar_cli.config.maps import ANGLE_TIME_MAPS, FRAME_MAPS
from radhar_cli.config.radar import ArrayRadar, BoardRadar
from radhar_cli.config.reading import validated
from radhar_cli.config.recordings import RecordingsConfig
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.dataset.files import digest_of
from radhar_cli.dataset.recorded import windows
from radhar_cli.dataset.sample import SampleRow, StoredSample, storable_array
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.files.untrusted import refuse_outside, text_of
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.frame_sheets import cloud_sheet
from radhar_cli.processing.power_map import MapImage, PowerMap
from radhar_cli.scene.products.images import draw_measured_map, level_scale_of
from radhar_cli.scene.products.maps import image_name
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.schema.twelve import TWELVE

MAX_MANIFEST = 2**20  # bytes
MAX_CONFIG = 2**19  # characters of the resolved config: two of it lie beside the data set
COLUMNS = ("file", "label", "person", "start", "stop", "split")


def read_manifest(path: Path) -> list[dict[str, Any]]:
    """Read the rows of a manifest: CSV with a heading, or a YAML list of mappings.

    Columns are file (below the manifest's folder), label, and optionally person, start, stop (s)
    and split (train, validation or test).

    Raises:
        ConfigError: it is neither, lists nothing, or a row cannot be used.
    """
    text = text_of(path, MAX_MANIFEST, ConfigError)
    if path.suffix.lower() in (".yaml", ".yml"):
        rows = parse_yaml(text, str(path))[0]
        if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
            raise ConfigError(f"{path}: should be a list of {{file: ..., label: ...}}")
    else:
        try:
            rows = [*csv.DictReader(io.StringIO(text), strict=True)]
        except csv.Error as error:
            raise ConfigError(f"{path}: is not CSV ({error})") from None
    checked = [_check_row(row, f"{path}: row {number}") for number, row in enumerate(rows, 1)]
    if not checked:
        raise ConfigError(f"{path}: lists nothing; should have columns {', '.join(COLUMNS)}")
    return checked


def _check_row(row: dict[Any, Any], where: str) -> dict[str, Any]:
    """Check a row of a manifest; return it as plain values of a part of the config."""
    cells = {key: value for key, value in row.items() if value not in (None, "")}
    for key in cells:
        if key not in COLUMNS:
            hint = did_you_mean(str(key), COLUMNS, f"columns are {', '.join(COLUMNS)}")
            raise ConfigError(f"{where}: {key!r} is not a column; {hint}")
    for key in ("file", "label"):
        if key not in cells:
            raise ConfigError(f"{where}: {key} is missing")
    for key in ("start", "stop"):
        try:
            cells[key] = float(cells[key]) if key in cells else None
        except (TypeError, ValueError):
            raise ConfigError(f"{where}: {key} = {cells[key]!r}: should be seconds") from None
    person = cells.get("person")
    return {
        "file": str(cells["file"]),
        "label": _slug(str(cells["label"])),
        "person": None if person is None else str(person),
        "start_s": cells["start"],
        "stop_s": cells["stop"],
        **({"split": cells["split"]} if "split" in cells else {}),
    }


def _slug(label: str) -> str:
    """Slug of a label: S1 to S12 by number, others in lower case with underscores."""
    name = label.strip().lower().replace(" ", "_").replace("-", "_")
    return TWELVE.get(name, name)


def with_recordings(config: Config, manifest: Path) -> MeasuredConfig:
    """Make the config of a data set of recordings, which are opened for their length and radar.

    Numbers that `config` draws take their middle.

    Args:
        config: config that says how recordings are processed.
        manifest: list of the recordings, or a tree or .npz of images.

    Raises:
        ConfigError: the manifest cannot be used, or recordings are of different radars.
    """
    if are_images(manifest):
        return _with_images(config, manifest)
    parts = read_manifest(manifest)
    document = _shared_document(config)
    section = document["recordings"]
    checked = [{**part, "start_s": part["start_s"] or 0.0, "stop_s": 0.0} for part in parts]
    # Names are checked before any file is opened.
    validated(RecordingsConfig, {**section, "parts": checked}, str(manifest), {})
    names = [*dict.fromkeys(part["file"] for part in parts)]
    for name in names:
        refuse_outside(manifest.parent / name, manifest.parent)
    of_points = is_point_recording(manifest.parent / names[0])
    if of_points:
        listed = _list_points(manifest, names)
    else:
        has_frames = isinstance(config.radar, ArrayRadar)
        needs_frames = not has_frames and not OF_FRAMES.keys().isdisjoint(config.maps)
        listed = _list_samples(manifest, names, has_frames, needs_frames)
    _set_times(parts, listed.lengths, manifest)
    checksums = {name: digest_of(manifest.parent / name) for name in names}
    document["recordings"] = {
        **section,
        "frame_s": listed.frame_s,
        "joints": listed.joints,
        "parts": parts,
        "sha256": checksums,
    }
    document["radar"] = listed.radar_section(document["radar"])
    return _with_split(config, document, manifest)


class Listed(NamedTuple):
    """Recordings of a manifest.

    Attributes:
        lengths: Duration of each, s, by name.
        radar_section: Makes the section `radar` of their data set, of that of a config.
        frame_s: Time from frame to frame of points, s; None of samples.
        joints: Whether recordings of points have joints.
    """

    lengths: dict[str, float]
    radar_section: Callable[[dict[str, Any]], dict[str, Any]]
    frame_s: float | None = None
    joints: bool = False


def _list_samples(
    manifest: Path, names: Sequence[str], has_frames: bool, needs_frames: bool
) -> Listed:
    """List recordings of samples, all of one radar.

    Args:
        manifest: list of the recordings.
        names: their files, from the manifest's folder on.
        has_frames: whether the config's radar has frames, whose maps have all ranges of the band.
        needs_frames: whether maps need frames that the radar of the recordings is to tell.

    Raises:
        ConfigError: they are of different radars.
    """
    lengths, radar = dict[str, float](), None
    noted: dict[str, Any] | None = None
    for name in names:
        with Recording(manifest.parent / name) as recording:
            lengths[name] = round(recording.segments.duration, 9)
            content = recording.info.content
            if needs_frames and noted is None:
                noted = radar_of_recording(recording)
        radar = radar or content
        if has_frames or noted is not None:
            difference = describe_other_chirps(content, radar)
        else:
            difference = describe_difference(content, radar)
        if difference is not None:
            raise ConfigError(f"{manifest}: {name}: {difference}, as in {names[0]}: one radar")
    assert radar is not None  # as a manifest lists something
    return Listed(lengths, partial(_section_of_samples, content=radar, noted=noted))


def _section_of_samples(
    radar: dict[str, Any], content: Content, noted: dict[str, Any] | None
) -> dict[str, Any]:
    """Section `radar` of a data set of samples: the config's with what the recordings determine.

    Args:
        radar: section of the config, plain values.
        noted: section by what the recordings say, which takes its place; None for the config's.
    """
    return radar_section(radar, content) if noted is None else noted


def _list_points(manifest: Path, names: Sequence[str]) -> Listed:
    """List recordings of points, all of one board.

    Raises:
        ConfigError: they are of different boards.
    """
    lengths, infos, cfg, joints = dict[str, float](), list[PointRecordingInfo](), "", False
    for name in names:
        with PointRecording(manifest.parent / name) as recording:
            lengths[name] = round(recording.duration, 9)
            infos.append(recording.info)
            joints = joints or recording.joints is not None
        first, info = infos[0], infos[-1]
        if abs(info.frame_s - first.frame_s) > TOLERANCE * first.frame_s:
            raise ConfigError(
                f"{manifest}: {name}: frame_s = {info.frame_s:g}: should be {first.frame_s:g}, as "
                f"in {names[0]}: one radar"
            )
        cfg = cfg or info.cfg
        if info.cfg not in ("", cfg):
            raise ConfigError(f"{manifest}: {name}: was imported with another .cfg: one radar")
    return Listed(lengths, partial(_section_of_points, cfg=cfg), infos[0].frame_s, joints)


def _section_of_points(radar: dict[str, Any], cfg: str) -> dict[str, Any]:
    """Section `radar` of a data set of points: the board's, whose .cfg they were imported with.

    Other keys of a board stay as the config has them; without a .cfg all of `radar` does.
    """
    if not cfg:
        return radar
    board_keys = {key: value for key, value in radar.items() if key in BoardRadar.model_fields}
    return (board_keys if "cfg" in radar else {}) | {"cfg": cfg}


def _set_times(parts: Sequence[dict[str, Any]], lengths: dict[str, float], manifest: Path) -> None:
    """Fill in where the parts of recordings begin and end.

    Raises:
        ConfigError: a part does not lie within its recording.
    """
    for part in parts:
        name, start, stop = part["file"], part["start_s"] or 0.0, part["stop_s"]
        stop = lengths[name] if stop is None else stop
        if not 0 <= start < stop <= lengths[name] + 1e-6:
            raise ConfigError(
                f"{manifest}: {name}: from {start:g} to {stop:g} s: should lie within its "
                f"{lengths[name]:.6g} s"
            )
        part["start_s"], part["stop_s"] = start, stop


def _shared_document(config: Config) -> dict[str, Any]:
    """Plain values of the keys of a config that measured data have, too."""
    nominal = resolved(nominal_scene(config, config.every_class[0]).config)
    document = {key: nominal[key] for key in MeasuredConfig.model_fields}
    return document | {"recordings": nominal["recordings"] or {}}


def _with_images(config: Config, path: Path) -> MeasuredConfig:
    """Make the config of a data set of existing images; each lasts recordings.window_s."""
    section = config.recordings or RecordingsConfig()
    if len(config.maps) != 1 or section.rows is None or not section.rows[0] < section.rows[1]:
        raise ConfigError(
            f"{path}: of images, maps should name the one map that they show, and "
            "recordings.rows=[low, high] the edges of its rows (Hz, or m)"
        )
    if config.output.power is not None:
        raise ConfigError("output.power: should be null; images have no power behind them")
    images, document = list_images(path, section.packed), _shared_document(config)
    window = {"start_s": 0.0, "stop_s": section.window_s}
    parts = [{**part, "label": _slug(part["label"]), **window} for part in images.parts]
    document["recordings"] |= {"parts": parts, "sha256": images.sha256}
    document["image"] |= {"size_px": list(images.size)}
    return _with_split(config, document, path)


def _with_split(config: Config, document: dict[str, Any], manifest: Path) -> MeasuredConfig:
    """Add the split to a document, and validate it as the config of a measured data set."""
    parts = document["recordings"]["parts"]
    document["split"] = _split(config, document["recordings"], manifest)
    if len(json.dumps(document)) > MAX_CONFIG:
        raise ConfigError(f"{manifest}: has {len(parts)} rows, too many for one data set")
    return validated(MeasuredConfig, document, str(manifest), *config._places)


def _split(config: Config, section: dict[str, Any], manifest: Path) -> dict[str, Any]:
    """Make the section `split`: the manifest's; by subject, with its number of persons."""
    split: dict[str, Any] = config.split.model_dump()
    parts = section["parts"]
    if parts[0].get("split") is not None:
        return split | {"by": "sample", "subjects": None} | _stated_shares(section, manifest)
    if config.split.by == "subject":
        nobody = [number for number, part in enumerate(parts, 1) if part["person"] is None]
        if nobody:
            raise ConfigError(
                f"{manifest}: row {nobody[0]}: person is missing, which split.by: subject needs"
            )
        split["subjects"] = len({part["person"] for part in parts})
    return split


def _stated_shares(section: dict[str, Any], manifest: Path) -> dict[str, float]:
    """Shares of the windows that a manifest puts into each part of the split."""
    recorded = validated(RecordingsConfig, section, str(manifest), {})
    windows_of = Counter[str]()
    for part in recorded.parts:
        windows_of[str(part.split)] += recorded.count(part)
    total = max(windows_of.total(), 1)
    held_back = {name: round(windows_of[name] / total, 3) for name in ("validation", "test")}
    return {"train": round(1 - sum(held_back.values()), 3), **held_back}


def warnings_of(config: MeasuredConfig) -> list[str]:
    """Warnings for a data set of recordings: short parts, shared persons, packed images."""
    recorded, warnings = config.recordings, list[str]()
    if is_image(recorded.parts[0].file):
        height, width = config.image.size_px
        if height == 8 * width and not recorded.packed:
            warnings.append(
                f"images are {height} x {width} pixels; where each byte holds 8 columns as bits, "
                f"recordings.packed=true makes {height} x {height} of them"
            )
        return warnings
    short = sum(not recorded.count(part) for part in recorded.parts)
    if short:
        warnings.append(f"{short} parts are shorter than the window of {recorded.window_s:g} s")
    is_cut_by_window = config.split.by == "sample" and not recorded.has_split
    if is_cut_by_window and recorded.hop_s < recorded.window_s:
        warnings.append(
            "windows of one recording may lie in several parts of the split; split.by: subject "
            "keeps persons apart"
        )
    return warnings


def _from_start(power_map: PowerMap, start: float) -> PowerMap:
    """Count the times of a map from the start of its window, s."""
    columns = power_map.columns
    if columns.name != "time":
        return power_map
    return replace(power_map, columns=replace(columns, values=columns.values - start))


@dataclass(frozen=True)
class WindowFactory:
    """Callable that makes the rows of a data set of recordings."""

    folder: Path  # of the manifest, absolute

    def __call__(self, config: MeasuredConfig, row: int) -> SampleRow:
        """Make the sample of a row, and its scene numbers."""
        recorded = config.recordings
        number, part, start = windows(config)[row]
        if is_image(part.file):
            return SampleRow(self._image(config, part.file), np.array([number, start, nan]))
        if recorded.frame_s is not None:
            return SampleRow(self._points(config, part.file, start), np.array([number, start, nan]))
        sample, confidence = self._maps(config, part.file, start)
        return SampleRow(sample, np.array([number, start, confidence]))

    def _maps(self, config: MeasuredConfig, file: str, start: float) -> tuple[StoredSample, float]:
        """Make the sample of a window of samples, and the mean confidence of the torso's track."""
        recorded, confidence = config.recordings, nan
        stop = start + recorded.window_s
        of_frames = [name for name in config.maps if name in OF_FRAMES]
        maps: dict[str, PowerMap] = {}
        images: dict[str, MapImage] = {}
        products: dict[str, NDArray[Any]] = {}
        with Recording(self.folder / file) as recording:
            signals = [name for name in config.maps if name not in of_frames]
            if signals:
                results = maps_of(recording, config, signals, start, stop, recorded.receiver)
                maps |= results.maps
                if results.track is not None:
                    confidence = float(results.track.confidence.mean())
            if of_frames:
                sheets = [image_name(name) for name in of_frames if name in FRAME_MAPS]
                names = [*of_frames, *sheets]
                outputs, _ = frames_of_recording(recording, config, names, start, stop)
                maps |= {name: outputs[name] for name in of_frames if name in ANGLE_TIME_MAPS}
                images = {
                    name: outputs[image_name(name)] for name in of_frames if name in FRAME_MAPS
                }
                scale = level_scale_of(config)
                products = {name: storable_array(outputs[name], name, scale) for name in images}
        for name, power_map in maps.items():
            images[name] = draw_measured_map(config, _from_start(power_map, start))
        ordered = {name: images[name] for name in config.maps}
        return StoredSample(ordered, products=products), confidence

    def _points(self, config: MeasuredConfig, file: str, start: float) -> StoredSample:
        """Read the sample of a window of a recording of points: its points and their sheet."""
        with PointRecording(self.folder / file) as recording:
            cloud = recording.window(start, config.recordings.window_s)
            joints = recording.joints_within(start, config.recordings.window_s)
        products = {
            "points": cloud.points,
            "points_start": cloud.start,
            "points_person": np.full(len(cloud.points), NOBODY, np.int16),
        } | ({"skeleton": joints} if config.recordings.joints else {})
        images = {"points": cloud_sheet(cloud, config.image.size_px)}
        return StoredSample(images, products=products)

    def _image(self, config: MeasuredConfig, file: str) -> StoredSample:
        """Read the sample of an existing image."""
        recorded = config.recordings
        assert recorded.rows is not None
        levels = read_image(self.folder, file, config.image.size_px, recorded.packed)
        extent = (0.0, recorded.window_s, *recorded.rows)
        image = MapImage(levels, entropy_bits(levels.astype(float)), extent)
        return StoredSample({config.maps[0]: image})
