"""Whatever `train` and `eval` read, or a table, as what an audit looks at."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from radhar_cli.config.class_laws import laws_by_class
from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.config.image import ImageConfig
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.folder import FilePixels, map_of_folder, open_tree
from radhar_cli.learning.images.image_set import SPLIT_NAMES, ImageSet
from radhar_cli.learning.images.opening import is_tree, open_images
from radhar_cli.learning.run_files import is_run
from radhar_cli.numerics.arrays import Index, Levels
from radhar_cli.study.audit.clouds import has_clouds
from radhar_cli.study.audit.evidence import Evidence
from radhar_cli.study.audit.recordings import (
    LABELS,
    RECORDING,
    SPLIT,
    WHO,
    RecordingTable,
    match_table,
    name_evidence,
    read_table,
    recording_of_window,
    table_evidence,
    window_evidence,
)
from radhar_cli.study.audit.scene_numbers import scene_evidence, sentences_on_cue


@dataclass(frozen=True)
class AuditedSet:
    """A data set with everything from which its classes may be guessed, but for its images.

    Attributes:
        where: file or folder.
        classes: name of each label.
        label: [N].
        names: [N] names of the samples.
        evidence: evidence of all N samples.
        images: images; None of a table alone.
        split: [N] 0 train, 1 validation, 2 test; None where it is not split.
        person: [N] person of the sample; None where it is not known.
        recording: [N] recording that the sample was cut from; None where it is not known.
        scene: [N] fingerprint of person and motion; None where it is not known.
        on_cue: sentences on onsets that do not vary.
        too_few_on_cue: sentences on those of which too few samples are there to tell.
        laws: sentences on numbers whose laws differ by class.
        has_clouds: whether the dataset.h5 holds point clouds.
        is_simulated: whether a config can be changed.
        image: section `image` of a simulated dataset.h5; None of anything else.
    """

    where: Path
    classes: tuple[str, ...]
    label: Index
    names: Sequence[str]
    evidence: tuple[Evidence, ...]
    images: ImageSet | None = None
    split: Levels | None = None
    person: Sequence[object] | None = None
    recording: Sequence[object] | None = None
    scene: Sequence[object] | None = None
    on_cue: tuple[str, ...] = ()
    too_few_on_cue: tuple[str, ...] = ()
    laws: tuple[str, ...] = ()
    has_clouds: bool = False
    is_simulated: bool = False
    image: ImageConfig | None = None

    def __len__(self) -> int:
        return len(self.label)

    def file_of(self, row: int) -> Path | None:
        """Image file of a row; None where images lie in one file."""
        pixels = None if self.images is None else self.images.pixels
        return pixels.files[row] if isinstance(pixels, FilePixels) else None


def open_for_audit(path: Path, map_name: str | None, table: Path | None) -> AuditedSet:
    """Open a data set, a tree of images, or a table, for an audit.

    Args:
        path: dataset.h5 or its folder, a tree of images, or a CSV file with a column `class`.
        map_name: map whose images are looked at; None takes the first.
        table: CSV file of further columns of the samples; None for nothing.

    Raises:
        FolderError: a file cannot be used.
    """
    if path.suffix.lower() == ".csv" and path.is_file():
        if table is not None:
            raise FolderError(f"--table {table}: {path} is a table itself")
        return _open_table(path)
    if path.exists() and not is_run(path) and is_tree(path):
        audited = _open_tree(path, map_name)
    else:
        audited = _open_h5(path, map_name)
    if table is None:
        return audited
    return _with_columns(audited, match_table(read_table(table), audited.names))


def _open_table(path: Path) -> AuditedSet:
    """Open a table alone, of which a column names the classes."""
    table = read_table(path)
    labels = table.first_of(LABELS)
    if labels is None:
        raise FolderError(
            f"{path}: has the columns {', '.join(table.columns)}; one should be "
            f"{' or '.join(LABELS)}"
        )
    classes = tuple(sorted(set(labels)))
    audited = AuditedSet(
        where=path,
        classes=classes,
        label=np.searchsorted(classes, labels),
        names=[f"row {row}" for row in range(2, len(labels) + 2)],
        evidence=(),
    )
    keys = {key: cells for key, cells in table.columns.items() if key not in ("file", "sample")}
    return _with_columns(audited, replace(table, columns=keys))


def _open_tree(path: Path, map_name: str | None) -> AuditedSet:
    """Open class folders of images, of whatever sizes."""
    images = open_tree(path, map_name, "gray", any_size=True)
    assert isinstance(images.pixels, FilePixels)
    samples = images.samples
    return AuditedSet(
        where=path,
        classes=images.classes,
        label=samples.label,
        names=[str(file.relative_to(path)) for file in images.pixels.files],
        evidence=tuple(name_evidence(images.pixels.files)),
        images=images,
        split=samples.split,
        is_simulated=map_of_folder(path) is not None,
    )


def _open_h5(path: Path, map_name: str | None) -> AuditedSet:
    """Open a dataset.h5, of scenes or of recordings."""
    images = open_images(path, map_name, "gray")
    samples = images.samples
    person, scene = (
        None if column is None else column.tolist() for column in (samples.person, samples.scene)
    )
    recording: list[str] | None = None
    with open_dataset(path) as data:
        config = data.config
        if isinstance(config, MeasuredConfig):
            recording, scene = recording_of_window(config), None
            if all(part.person is None for part in config.recordings.parts):
                person = None
        cues = sentences_on_cue(data, samples.label)
        return AuditedSet(
            where=path,
            classes=images.classes,
            label=samples.label,
            names=samples.name.tolist(),
            evidence=tuple(_numbers_of(data)),
            images=images,
            split=samples.split,
            person=person,
            recording=recording,
            scene=scene,
            on_cue=tuple(cues.on_cue),
            too_few_on_cue=tuple(cues.too_few),
            laws=tuple(laws_by_class(config)) if isinstance(config, Config) else (),
            has_clouds=has_clouds(data),
            is_simulated=isinstance(config, Config),
            image=config.image if isinstance(config, Config) else None,
        )


def _numbers_of(data: Dataset) -> list[Evidence]:
    """Evidence of the numbers that come with recordings, or of those drawn for scenes."""
    if isinstance(data.config, MeasuredConfig):
        return window_evidence(data.config)
    return scene_evidence(data)


def _with_columns(audited: AuditedSet, table: RecordingTable) -> AuditedSet:
    """Data set with the columns of a table that has a row for each sample.

    Raises:
        FolderError: the column `split` names a split that does not exist.
    """
    split = audited.split
    if split is None and SPLIT in table.columns:
        cells = [cell.lower() for cell in table.columns[SPLIT]]
        for cell in cells:
            if cell not in SPLIT_NAMES:
                raise FolderError(
                    f"{table.path}: {SPLIT} = {cell!r}: should be {', '.join(SPLIT_NAMES)}"
                )
        split = np.array([SPLIT_NAMES[cell] for cell in cells], np.uint8)
    return replace(
        audited,
        evidence=(*audited.evidence, *table_evidence(table)),
        person=table.first_of(WHO) or audited.person,
        recording=table.first_of(RECORDING) or audited.recording,
        split=split,
    )
