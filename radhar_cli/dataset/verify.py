"""Check a finished data set: checksums, labels, counts, and samples synthesised anew."""

import hashlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from radhar_cli.config.identity import config_hash
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.identity import versions
from radhar_cli.dataset.image_file import read_gray, read_rgb
from radhar_cli.dataset.layout import DATASET, PNG, Rows, png_path
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.sample import synthesise
from radhar_cli.dataset.split import split_rows
from radhar_cli.errors import FolderError
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.worker_process import prepare_process


@dataclass
class Report:
    """What verification found.

    Attributes:
        samples: in the data set.
        resynthesised: of them, made anew.
        other_versions: library versions that differ from those that built it.
        worst_level: largest difference of a grey level among the samples made anew.
        pngs: PNG files compared.
        problems: everything that is wrong.
    """

    samples: int
    resynthesised: int = 0
    other_versions: list[str] = field(default_factory=list)
    worst_level: int = 0
    pngs: int = 0
    problems: list[str] = field(default_factory=list)


def verify(folder: Path, samples: int) -> Report:
    """Verify the data set in `folder` (or the dataset.h5 itself).

    Args:
        folder: output of `generate`.
        samples: how many to synthesise anew, spread evenly over the rows.

    Raises:
        FolderError: there is no readable data set of ours.
    """
    prepare_process()
    path = folder / DATASET if folder.is_dir() else folder
    if not path.exists():
        raise FolderError(f"{path}: no such file; `radhar generate` writes it when it is complete")
    with Dataset(path) as data:
        report = Report(len(data))
        _versions(data, report)
        if _structure(data, report):
            _checksums(data, report)
            _resynthesise(data, samples, report)
            if (path.parent / PNG).is_dir():
                _pngs(data, path.parent, report)
        return report


def _versions(data: Dataset, report: Report) -> None:
    for library, here in versions().items():
        there = data.file.text(f"{library}_version")
        if there != here:
            report.other_versions.append(f"{library} {there} there, {here} here")


def _structure(data: Dataset, report: Report) -> bool:
    config = data.config
    rows = Rows.of(config)
    label = np.repeat([a.index for a in rows.activities], rows.per_class)
    index = np.tile(np.arange(rows.per_class), len(rows.activities))
    for name, found, right in (
        ("label", data.label, label),
        ("split", data.split, split_rows(config)),
        ("sample_key", data.sample_key[:], np.stack([label, index], axis=1)),
    ):
        if (found != right).any():
            report.problems.append(f"/{name}: {np.count_nonzero(found != right)} wrong values")
    if config_hash(config) != data.file.text("config_hash"):
        report.problems.append("the stored config does not have the stored hash")
    if config.seed != data.file.whole_number("seed"):
        report.problems.append("the stored seed is not the config's")
    return not report.problems


def _checksums(data: Dataset, report: Report) -> None:
    for name, images in data.maps.items():
        stored = data.sha256[name][:]
        for row in range(len(data)):
            levels = images[row]
            if hashlib.sha256(levels.tobytes()).hexdigest().encode() != stored[row]:
                report.problems.append(f"/maps/{name}[{row}]: does not match its checksum")


def _resynthesise(data: Dataset, samples: int, report: Report) -> None:
    config = data.config
    rows, plan = Rows.of(config), plan_images(config)
    columns = data.fields
    scene_values = {field.name: data.scene[field.name][:] for field in columns}
    entropies = {name: data.entropy(name) for name in data.maps}
    allowed = 1 if report.other_versions else 0
    count = min(samples, len(rows))
    for sample in range(count):
        row = (2 * sample + 1) * len(rows) // (2 * count)
        activity, index = rows[row]
        scene, _ = draw_valid_scene(config, activity, index)
        drawn = zip(columns, scene_fields.values(scene, columns), strict=True)
        for column, value in drawn:
            if column is scene_fields.ERROR:
                continue
            there = scene_values[column.name][row]
            if not np.isclose(there, value * column.factor, rtol=1e-12, atol=0, equal_nan=True):
                report.problems.append(
                    f"/scene/{column.name}[{row}]: {there} instead of {value * column.factor}"
                )
        for name, image in synthesise(scene, plan).images.items():
            there = data.maps[name][row].astype(int)
            worst = int(np.abs(there - image.levels).max())
            report.worst_level = max(report.worst_level, worst)
            if worst > allowed:
                report.problems.append(
                    f"/maps/{name}[{row}] ({scene.name}): differs by up to {worst} grey levels"
                )
            entropy = float(entropies[name][row])
            if abs(entropy - image.entropy) > 1e-3 * max(1.0, image.entropy):
                report.problems.append(f"/entropy/{name}[{row}]: {entropy}, not {image.entropy}")
        report.resynthesised += 1


def _pngs(data: Dataset, folder: Path, report: Report) -> None:
    config = data.config
    rows, split = Rows.of(config), split_rows(config)
    table = colour_table(config.image.colour_map)
    for name in config.maps:
        if not (folder / PNG / name).is_dir():
            continue
        for row in range(len(data)):
            levels = data.maps[name][row]
            path = png_path(name, split[row], *rows[row])
            try:
                same = np.array_equal(read_gray(folder / path), levels) and np.array_equal(
                    read_rgb(folder / path), table[levels]
                )
            except FolderError as error:
                report.problems.append(f"{path}: cannot be read ({error})")
                continue
            report.pngs += 1
            if not same:
                report.problems.append(f"{path}: does not show /maps/{name}[{row}]")
