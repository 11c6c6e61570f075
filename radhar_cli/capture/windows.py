"""A data set of measured data: windows of the recordings that a manifest lists."""

import csv
import hashlib
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.activities.activity import TWELVE
from radhar_cli.capture.chain import maps_of
from radhar_cli.capture.content import Content, describe_difference, radar_section
from radhar_cli.capture.images import are_images, is_image, list_images, read_image
from radhar_cli.capture.recording import Recording
from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.config.identity import resolved
from radhar_cli.config.reading import validated
from radhar_cli.config.recordings import RecordingsConfig
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.dataset.recorded import windows
from radhar_cli.dataset.sample import SampleRow, StoredSample
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.files.untrusted import refuse_outside, text_of
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.power_map import MapImage
from radhar_cli.products.images import draw_measured_map
from radhar_cli.scene import nominal_scene

MAX_MANIFEST = 2**20  # bytes
MAX_CONFIG = 2**19  # characters of the resolved config: two of it lie beside the data set
COLUMNS = ("file", "label", "person", "start", "stop")


def read_manifest(path: Path) -> list[dict[str, Any]]:
    """Read the rows of a manifest: CSV with a heading, or a YAML list of mappings.

    Columns are file (below the manifest's folder), label, and optionally person, start, stop (s).

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
    parts, checksums = read_manifest(manifest), dict[str, str]()
    lengths = dict[str, float]()
    radar: Content | None = None
    document = _shared_document(config)
    section = document["recordings"]
    checked = [{**part, "start_s": part["start_s"] or 0.0, "stop_s": 0.0} for part in parts]
    # Names are checked before any file is opened.
    validated(RecordingsConfig, {**section, "parts": checked}, str(manifest), {})
    for part in parts:
        name = part["file"]
        if name not in lengths:
            path = manifest.parent / name
            refuse_outside(path, manifest.parent)
            with Recording(path) as recording:
                lengths[name] = round(recording.segments.duration, 9)
                content = recording.info.content
            radar = radar or content
            if (difference := describe_difference(content, radar)) is not None:
                raise ConfigError(
                    f"{manifest}: {name}: {difference}, as in {parts[0]['file']}: one radar"
                )
            with path.open("rb") as file:
                checksums[name] = hashlib.file_digest(file, "sha256").hexdigest()
        start, stop = part["start_s"] or 0.0, part["stop_s"]
        stop = lengths[name] if stop is None else stop
        if not 0 <= start < stop <= lengths[name] + 1e-6:
            raise ConfigError(
                f"{manifest}: {name}: from {start:g} to {stop:g} s: should lie within its "
                f"{lengths[name]:.6g} s"
            )
        part["start_s"], part["stop_s"] = start, stop
    document["recordings"] = {**section, "parts": parts, "sha256": checksums}
    assert radar is not None  # as a manifest lists something
    document["radar"] = radar_section(document["radar"], radar)
    return _with_split(config, document, manifest)


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
    document["split"] = _split(config, parts, manifest)
    if len(json.dumps(document)) > MAX_CONFIG:
        raise ConfigError(f"{manifest}: has {len(parts)} rows, too many for one data set")
    return validated(MeasuredConfig, document, str(manifest), *config._places)


def _split(config: Config, parts: Sequence[dict[str, Any]], manifest: Path) -> dict[str, Any]:
    """Make the section `split`; by subject, it has the number of persons in the manifest."""
    split: dict[str, Any] = config.split.model_dump()
    if config.split.by == "subject":
        nobody = [number for number, part in enumerate(parts, 1) if part["person"] is None]
        if nobody:
            raise ConfigError(
                f"{manifest}: row {nobody[0]}: person is missing, which split.by: subject needs"
            )
        split["subjects"] = len({part["person"] for part in parts})
    return split


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
    if config.split.by == "sample" and recorded.hop_s < recorded.window_s:
        warnings.append(
            "windows of one recording may lie in several parts of the split; split.by: subject "
            "keeps persons apart"
        )
    return warnings


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
        with Recording(self.folder / part.file) as recording:
            results = maps_of(
                recording, config, config.maps, start, start + recorded.window_s, recorded.receiver
            )
        images: dict[str, MapImage] = {}
        for name in config.maps:
            power_map = results.maps[name]
            columns = replace(power_map.columns, values=power_map.columns.values - start)
            images[name] = draw_measured_map(config, replace(power_map, columns=columns))
        confidence = nan if results.track is None else float(results.track.confidence.mean())
        return SampleRow(StoredSample(images), np.array([number, start, confidence]))

    def _image(self, config: MeasuredConfig, file: str) -> StoredSample:
        """Read the sample of an existing image."""
        recorded = config.recordings
        assert recorded.rows is not None
        levels = read_image(self.folder, file, config.image.size_px, recorded.packed)
        extent = (0.0, recorded.window_s, *recorded.rows)
        image = MapImage(levels, entropy_bits(levels.astype(float)), extent)
        return StoredSample({config.maps[0]: image})
