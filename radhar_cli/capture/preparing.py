"""A download of a published set becomes recordings and their manifest, by a recipe.

Recordings appear whole and stay, so that a killed run goes on; one that is older than its files
is made again. All else is the way of any data set of recordings (`windows.py`).
"""

import csv
import io
import json
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from radhar_cli.capture.point_recording import PointRecording, is_point_recording
from radhar_cli.capture.recipes.recipe import SetRecipe, Take
from radhar_cli.capture.recipes.registry import find_recipe
from radhar_cli.capture.recording import Label, Recording
from radhar_cli.capture.windows import (
    COLUMNS,
    MAX_MANIFEST,
    WindowFactory,
    warnings_of,
    with_recordings,
)
from radhar_cli.config.data_set import AnyConfig, Config, ConfigOfRecordings
from radhar_cli.config.reading import validated, with_overrides
from radhar_cli.dataset.build import BuildOutcome, build
from radhar_cli.dataset.folder import folder_lock, refuse_foreign_files, stored_identity
from radhar_cli.dataset.layout import RECORDINGS, WORK
from radhar_cli.dataset.workers import run_tasks
from radhar_cli.errors import CaptureError, ConfigError, FolderError
from radhar_cli.files.replacing import refuse_links, write_text
from radhar_cli.files.untrusted import read_json
from radhar_cli.processes.progress import Progress
from radhar_cli.readers.untrusted_hdf5 import remember, try_files
from radhar_cli.schema.section import Section

MANIFEST, ORIGIN = "manifest.csv", "origin.json"
SHOWN = 5  # of what is left out
VALIDATION_OF = 5  # every so many recordings of training validate, where the authors name none


@dataclass(frozen=True)
class Preparation:
    """A data set to prepare: its recipe, download and settings.

    Attributes:
        name: Name of the recipe.
        recipe: The recipe.
        folder: Folder of the download, absolute.
        settings: Settings that the recipe asks for.
        config: Config of the data set.
        has_own_split: Whether the user gives the split.
    """

    name: str
    recipe: SetRecipe
    folder: Path
    settings: Section
    config: Config
    has_own_split: bool


class Prepared(NamedTuple):
    """Recordings of a download.

    Attributes:
        manifest: Manifest for `radhar generate --recordings`.
        takes: Number of takes in the download.
        new: Number of recordings that this run made.
        left_out: Reason for each take that is left out.
        notes: Other remarks for the user.
    """

    manifest: Path
    takes: int
    new: int
    left_out: tuple[str, ...]
    notes: tuple[str, ...]


def read_preparation(name: str, folder: Path, overrides: Sequence[str]) -> Preparation:
    """Find a recipe, and read its settings and the config of its data set.

    Args:
        name: Name of the recipe.
        folder: Folder of the download.
        overrides: KEY=VALUE of each; keys that the recipe asks for are its own, others the
            config's.

    Raises:
        RadharError: there is no such recipe or folder, or an override cannot be used.
    """
    recipe = find_recipe(name)
    if not folder.exists():
        raise FolderError(f"{folder}: no such folder; should be the download of {name}")
    answers, others = list[str](), list[str]()
    for override in overrides:
        key = override.partition("=")[0].partition(".")[0].strip()
        (answers if key in recipe.settings.model_fields else others).append(override)
    settings = validated(recipe.settings, with_overrides({}, answers), "--set", {})
    document = json.loads(json.dumps(dict(recipe.config)))  # a copy that may be changed
    document.setdefault("output", {}).setdefault("license", recipe.licence or None)
    document.setdefault("recordings", {})["source"] = recipe.source
    has_own_split = any(text.startswith("split") for text in others)
    config = validated(ConfigOfRecordings, with_overrides(document, others), "--set", {})
    return Preparation(name, recipe, folder.absolute(), settings, config, has_own_split)


def prepare_recordings(
    preparation: Preparation, out: Path, jobs: int, progress: Progress, overwrite: bool
) -> Prepared:
    """Make the recordings of a download that are missing, and their manifest.

    Args:
        out: Folder of the data set.
        jobs: Number of processes.
        progress: Is told of every recording.
        overwrite: Start over where the folder holds recordings of another download.

    Raises:
        CaptureError: the folder is not that data set, or nothing of it can be read.
        FolderError: the output folder holds something else, or another run writes there.
    """
    recipe = preparation.recipe
    if recipe.find_manifest is not None:
        return Prepared(recipe.find_manifest(preparation.folder), 0, 0, (), ())
    assert recipe.list_takes is not None
    takes = _require_takes(recipe.list_takes(preparation.folder, preparation.settings), preparation)
    recordings = out.absolute() / RECORDINGS
    with folder_lock(out.absolute()):
        _reserve(preparation, out.absolute(), overwrite)
        paths = {take: recordings / f"{take.name}.h5" for take in takes}
        missing = [take for take in takes if not _is_current(paths[take], take)]
        progress.stage("recordings", len(takes), len(takes) - len(missing), "recording")
        failures = dict[str, str]()
        tasks = ((take, paths[take]) for take in missing)
        for name, failure in run_tasks(_write_take, tasks, max(1, min(jobs, len(missing)))):
            if failure is not None:
                failures[name] = failure
            progress.advance(1)
        readable = [take for take in takes if take.name not in failures]
        left_out = tuple(failures[name] for name in sorted(failures))
        if not readable:
            raise CaptureError(f"{preparation.folder}: nothing of it can be read: {left_out[0]}")
        splits, notes = _splits(readable, preparation.has_own_split)
        rows = _manifest_rows(recordings, readable, splits)
        write_text(recordings / MANIFEST, rows)
    if recipe.count is not None and len(takes) != recipe.count:
        notes.append(
            f"{len(takes)} of the {recipe.count} recordings of {preparation.name} are there"
        )
    return Prepared(recordings / MANIFEST, len(takes), len(missing), left_out, tuple(notes))


class PreparedDataset(NamedTuple):
    """Data set of a download: its recordings, its config, and the result of its build."""

    recordings: Prepared
    config: AnyConfig
    outcome: BuildOutcome


def prepare_dataset(
    preparation: Preparation, out: Path, jobs: int, progress: Progress, overwrite: bool = False
) -> PreparedDataset:
    """Make the data set of a download, or resume it.

    Args:
        out: Folder of the data set.
        jobs: Number of processes.
        progress: Is told of recordings, samples, and what is left out.
        overwrite: Start over where the folder holds another download.

    Raises:
        CaptureError: the folder is not that data set, or nothing of it can be read.
        FolderError: the output folder holds something else, or another run writes there.
    """
    prepared = prepare_recordings(preparation, out, jobs, progress, overwrite)
    for why in prepared.left_out[:SHOWN]:
        progress.say(f"warning: left out: {why}")
    if (more := len(prepared.left_out) - SHOWN) > 0:
        progress.say(f"warning: {more} more are left out")
    for note in prepared.notes:
        progress.say(note)
    config = with_recordings(preparation.config, prepared.manifest)
    for warning in warnings_of(config):
        progress.say(f"warning: {warning}")
    manifest = prepared.manifest
    factory = WindowFactory(manifest if manifest.is_dir() else manifest.parent)
    outcome = build(config, out, jobs, progress, overwrite, None, factory)
    return PreparedDataset(prepared, config, outcome)


def _require_takes(listed: Iterable[Take], preparation: Preparation) -> list[Take]:
    """Check that there are takes, each with a name of its own."""
    by_name = dict[str, Take]()
    for take in listed:
        other = by_name.setdefault(take.name.lower(), take)
        if other is not take:
            raise CaptureError(
                f"{take.sources[0]}: is {take.name}, as {other.sources[0]} is: name the folder of "
                "one"
            )
    if not by_name:
        raise CaptureError(
            f"{preparation.folder}: is not {preparation.name} as it is published: should hold "
            f"{preparation.recipe.layout}"
        )
    return [*by_name.values()]


def _reserve(preparation: Preparation, out: Path, overwrite: bool) -> None:
    """Take a locked folder for the recordings of a download.

    Raises:
        FolderError: it holds something else, or recordings of another download.
    """
    recordings = out / RECORDINGS
    origin = {
        "recipe": preparation.name,
        "folder": str(preparation.folder),
        "settings": preparation.settings.model_dump(mode="json"),
    }
    refuse_links(out, recordings)
    if (recordings / ORIGIN).exists():
        stored = read_json(recordings / ORIGIN)
        if stored == origin:
            return
        if not overwrite:
            raise FolderError(
                f"{recordings}: holds recordings of {_describe_origin(stored)}; choose another "
                "folder, or --overwrite to start over"
            )
        shutil.rmtree(recordings)
    elif recordings.exists() or stored_identity(out) is None:
        refuse_foreign_files(out, "data set of radhar prepare", (WORK,))
    elif not overwrite:
        raise FolderError(f"{out}: holds a data set of something else; choose another folder")
    recordings.mkdir(parents=True, exist_ok=True)
    write_text(recordings / ORIGIN, json.dumps(origin))


def _describe_origin(stored: Any) -> str:
    """Describe the download that recordings were made of: its recipe, folder and settings."""
    if not isinstance(stored, dict):
        return "another download"
    return f"{stored.get('recipe')}, {stored.get('folder')}, {stored.get('settings')}"


def _is_current(path: Path, take: Take) -> bool:
    """Whether the recording of a take is there, and no older than its files."""
    if not path.is_file() or path.is_symlink():
        return False
    age = path.stat().st_mtime_ns
    return all(source.exists() and source.stat().st_mtime_ns <= age for source in take.sources)


def _write_take(take: Take, path: Path) -> tuple[str, str | None]:
    """Write the recording of a take; return its name, and why it cannot be made, if so."""
    try:
        take.write(path)
    except (CaptureError, ConfigError, FolderError) as error:
        path.unlink(missing_ok=True)  # of files that were other ones before
        return take.name, str(error)
    return take.name, None


def _splits(takes: Sequence[Take], has_own_split: bool) -> tuple[list[str | None], list[str]]:
    """Part of the split of each take, if the authors state it, and remarks on it."""
    splits, notes = [take.split for take in takes], list[str]()
    if has_own_split or None in splits:
        return [None] * len(takes), notes
    if "train" in splits and "validation" not in splits:
        training = [number for number, split in enumerate(splits) if split == "train"]
        for number in training[VALIDATION_OF - 1 :: VALIDATION_OF]:
            splits[number] = "validation"
        notes.append(
            f"validation: every {VALIDATION_OF}th recording of the authors' training part, as they "
            "name none"
        )
    return splits, notes


def _manifest_rows(recordings: Path, takes: Sequence[Take], splits: Sequence[str | None]) -> str:
    """Text of the manifest of recordings, by the labels that they have."""
    names = [f"{take.name}.h5" for take in takes]
    try_files([recordings / name for name in names])
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for name, split in zip(names, splits, strict=True):
        remember(recordings / name)
        for label in _labels_of(recordings / name):
            cells = (label.label, label.person, label.start_s, label.stop_s, split)
            writer.writerow([name, *("" if cell is None else cell for cell in cells)])
    if len(text.getvalue()) > MAX_MANIFEST:
        raise CaptureError(f"{recordings}: has too many parts for one data set; name fewer files")
    return text.getvalue()


def _labels_of(path: Path) -> Sequence[Label]:
    """Labels of a recording of samples or of points."""
    if is_point_recording(path):
        with PointRecording(path) as points:
            return points.info.labels
    with Recording(path) as recording:
        return recording.info.labels
