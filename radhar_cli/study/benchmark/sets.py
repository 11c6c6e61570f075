"""The two data sets of a protocol: found, prepared, simulated, opened under the same classes."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.capture.preparing import ORIGIN, Preparation, prepare_dataset, read_preparation
from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.documents import PRESETS
from radhar_cli.dataset.build import build
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import DATASET, RECORDINGS
from radhar_cli.dataset.split import TEST, TRAIN
from radhar_cli.errors import FolderError
from radhar_cli.files.untrusted import read_json
from radhar_cli.learning.images.classes import keep_known_classes
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.learning.images.opening import open_inputs
from radhar_cli.learning.images.sequences import CLOUDS, COLUMNS
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import Progress
from radhar_cli.study.benchmark.protocols import PERSONS, Protocol

SNR_COLUMN = COLUMNS.index("snr")
LOOKED_AT = 32  # samples that tell whether points have an SNR
NO_SNR = "points of one side have no SNR, so that it is left out on both"
DEEPEST = 4  # folders below the one that is given, in which data sets and parts are looked for
MAX_FOLDERS = 10_000


@dataclass(frozen=True)
class MeasuredSource:
    """Measured data set of a protocol that is there: prepared already, or a download."""

    dataset: Path | None  # that was prepared
    preparation: Preparation | None  # of a download
    recordings: int | None = None  # in the download


def find_measured_set(protocol: Protocol, folder: Path, out: Path) -> MeasuredSource | None:
    """Find the measured data set of a protocol below a folder; None where it is not there.

    Args:
        protocol: the protocol.
        folder: folder of downloads and prepared data sets.
        out: folder of the benchmark, which is passed over.

    Raises:
        RadharError: the download cannot be read as it is.
    """
    folders = [*_folders(folder, out)]
    for inner in folders:
        if _is_prepared(inner, protocol):
            return MeasuredSource(inner, None)
    for inner in folders if protocol.part else [folder]:
        if protocol.part and inner.name.lower() != protocol.part.lower():
            continue
        preparation = read_preparation(protocol.recipe, inner, protocol.preparing)
        list_takes = preparation.recipe.list_takes
        assert list_takes is not None
        if count := sum(1 for _ in list_takes(inner, preparation.settings)):
            return MeasuredSource(None, preparation, count)
    return None


def _folders(folder: Path, without: Path) -> Iterator[Path]:
    """Yield a folder and those below it but one, the upper ones first; no link is followed."""
    waiting, count = [(folder, 0)], 0
    while waiting and count < MAX_FOLDERS:
        inner, depth = waiting.pop(0)
        count += 1
        yield inner
        if depth < DEEPEST and not (inner / RECORDINGS / ORIGIN).exists():
            try:
                children = sorted(inner.iterdir())
            except PermissionError:
                continue
            inner_folders = [p for p in children if p.is_dir() and not p.is_symlink()]
            waiting += [(p, depth + 1) for p in inner_folders if p.absolute() != without.absolute()]


def _is_prepared(folder: Path, protocol: Protocol) -> bool:
    """Whether a folder holds the data set that `radhar prepare` makes for a protocol."""
    origin = folder / RECORDINGS / ORIGIN
    if not (folder / DATASET).exists() or not origin.is_file():
        return False
    try:
        about = read_json(origin)
    except FolderError:
        return False
    if not isinstance(about, dict) or about.get("recipe") != protocol.recipe:
        return False
    return not protocol.part or Path(str(about.get("folder"))).name.lower() == protocol.part.lower()


def prepare_measured_set(source: MeasuredSource, out: Path, jobs: int, progress: Progress) -> Path:
    """Data set of a source, prepared in `out` where it is a download.

    Raises:
        RadharError: nothing of it can be read, or the folder holds something else.
    """
    if source.preparation is None:
        assert source.dataset is not None
        return source.dataset
    prepare_dataset(source.preparation, out, jobs, progress)
    return out


def simulation_config(protocol: Protocol, per_class: int | None) -> Config:
    """Config of the simulated data set of a protocol.

    Args:
        per_class: number of samples of a class; None is the preset's.
    """
    count = [] if per_class is None else [f"samples_per_class={per_class}"]
    overrides = [*protocol.simulating, *count, "split={train: 0.8, validation: 0.2}"]
    return load_config(PRESETS[protocol.simulation], overrides, Config)


def simulate(config: Config, out: Path, jobs: int, progress: Progress) -> Path:
    """Simulated data set in a folder that its identity names, made unless it is there."""
    folder = out / identity_hash(identity(config))[:16]
    if not (folder / DATASET).exists():
        build(config, folder, jobs, progress)
    return folder


class Fold(NamedTuple):
    """Part of the measured data set that is tested together, and what may be learned from.

    Attributes:
        learned: rows [L] that may be learned from; empty where there are none.
        tested: rows [T] that are tested.
        why_not: why nothing is learned from; "" where something is.
    """

    learned: Index
    tested: Index
    why_not: str = ""


@dataclass(frozen=True)
class BothSets:
    """Measured and simulated samples under one list of classes."""

    measured: ImageSet
    simulated: ImageSet  # with a split
    folds: tuple[Fold, ...]
    left_out: tuple[str, ...]  # measured classes that the simulation lacks


def open_both(protocol: Protocol, config: TrainConfig, measured: Path, simulated: Path) -> BothSets:
    """Open the two data sets of a protocol; classes that either lacks are left out.

    Raises:
        RadharError: they have no two classes together, or lack what the protocol needs.
    """
    of_measured, of_simulated = (
        open_inputs(path, _map_of(path, protocol), config, protocol.size_px).renamed(protocol.names)
        for path in (measured, simulated)
    )
    of_simulated = of_simulated.cut(config.validation_share, 1)
    names = of_measured.classes
    if protocol.find_joints:
        _require_joints(of_measured, of_simulated)
        together = tuple(dict.fromkeys((*names, *of_simulated.classes)))
    else:
        of_simulated = _keep_classes(of_simulated, names)
        together = tuple(name for name in names if name in of_simulated.classes)
        if len(together) < 2:
            raise FolderError(
                f"{simulated}: has the class {together[0]!r} alone of {', '.join(names)}; should "
                "have two or more"
            )
        of_measured = of_measured.renamed({name: None for name in names if name not in together})
    left_out = tuple(name for name in names if name not in together)
    of_measured, of_simulated = (
        replace(
            images,
            classes=together,
            samples=replace(images.samples, label=labels_for(images, together)),
        )
        for images in (of_measured, of_simulated)
    )
    of_measured, of_simulated = _with_equal_snr(of_measured, of_simulated, protocol)
    return BothSets(of_measured, of_simulated, _cut_folds(of_measured, protocol), left_out)


@dataclass(frozen=True)
class WithoutSnr:
    """Clouds whose points have no SNR, and the joints behind them."""

    pixels: Any

    def read(self, row: int) -> Levels:
        """Clouds [T, points, 6] of a row; the column of the SNR is 0."""
        clouds: Levels = self.pixels.read(row).copy()
        clouds[..., SNR_COLUMN] = 0
        return clouds

    def joints(self, row: int) -> Float:
        """Joints [T, joint, 3] of a row, m."""
        joints: Float = self.pixels.joints(row)
        return joints


def _with_equal_snr(
    measured: ImageSet, simulated: ImageSet, protocol: Protocol
) -> tuple[ImageSet, ImageSet]:
    """Clouds of which both or neither have an SNR, which would else tell one from the other."""
    both = measured, simulated
    if protocol.map != CLOUDS or all(map(_has_snr, both)):
        return both
    measured, simulated = (
        replace(images, pixels=WithoutSnr(images.pixels), notes=(*images.notes, NO_SNR))
        for images in both
    )
    return measured, simulated


def _has_snr(images: ImageSet) -> bool:
    """Whether points of some sequences have an SNR."""
    rows = range(0, len(images), max(1, len(images) // LOOKED_AT))
    return any(images.pixels.read(row)[..., SNR_COLUMN].any() for row in rows)


def _keep_classes(simulated: ImageSet, names: tuple[str, ...]) -> ImageSet:
    """Simulated samples of the classes that are measured.

    Raises:
        FolderError: there are none.
    """
    try:
        return keep_known_classes(simulated, names)
    except FolderError:
        raise FolderError(
            f"{simulated.where}: has the classes {', '.join(simulated.classes)}; should have some "
            f"of {', '.join(names)}"
        ) from None


def _map_of(path: Path, protocol: Protocol) -> str | None:
    """Map that is opened of a data set; of a tree of images the one that it has."""
    is_dataset = path.is_file() or (path / DATASET).exists()
    return protocol.map if is_dataset or (path / protocol.map).is_dir() else None


def _require_joints(*sets: ImageSet) -> None:
    """Refuse data sets without joints, or with others than the first one.

    Raises:
        FolderError: names the data set.
    """
    for images in sets:
        if images.joints != sets[0].joints or not images.joints:
            have = f"the joints {', '.join(images.joints)}" if images.joints else "no joints"
            raise FolderError(f"{images.where}: has {have}; should have those of {sets[0].where}")


def _cut_folds(measured: ImageSet, protocol: Protocol) -> tuple[Fold, ...]:
    """Parts of the measured data set: the authors' test part, or persons dealt into folds."""
    every, split = np.arange(len(measured)), measured.samples.split
    nothing = every[:0]
    if protocol.split != PERSONS:
        is_test = np.zeros(len(measured), bool) if split is None else split == TEST
        if not is_test.any():
            return (Fold(nothing, every, "there is no test part of the authors"),)
        if is_test.all():
            return (Fold(nothing, every, "there is no training part of the authors"),)
        return (Fold(every[~is_test], every[is_test]),)
    groups = measured.samples.groups(every)
    persons = np.unique(groups.number)
    if groups.kind != "person" or persons.size < 2:
        why = "there is a single person" if groups.kind == "person" else "nobody is named"
        return (Fold(nothing, every, why),)
    order = stream(1, TRAINING, name="benchmark persons").permutation(persons)
    parts = np.array_split(order, min(protocol.folds, order.size))
    masks = (np.isin(groups.number, part) for part in parts)
    return tuple(Fold(every[~is_tested], every[is_tested]) for is_tested in masks)


def learning_set(both: BothSets, fold: Fold, config: TrainConfig) -> ImageSet:
    """Measured samples that may be learned from, with parts that train and validate.

    The authors' validation part is kept; else a share of each class is cut off.

    Raises:
        FolderError: a class has too few.
    """
    images = both.measured.take(fold.learned)
    split = images.samples.split
    has_parts = split is not None and {*np.unique(split).tolist()} == {0, 1}
    if not has_parts or len(both.folds) > 1:
        images = replace(images, samples=replace(images.samples, split=None))
    return images.cut(config.validation_share, config.seed)


def training_part(images: ImageSet) -> ImageSet:
    """Samples of the training part alone."""
    images = images.take(images.rows("train"))
    split = np.full(len(images), TRAIN, np.uint8)
    return replace(images, samples=replace(images.samples, split=split))
