"""Check a finished data set: checksums, labels, counts, and samples synthesised anew."""

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from PIL import Image

from radhar_cli.config.identity import config_hash
from radhar_cli.config.reading import config_from_json
from radhar_cli.config.schema import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.identity import versions
from radhar_cli.dataset.layout import DATASET, PNG, Rows, png_path
from radhar_cli.dataset.png import colour_table, stored_levels
from radhar_cli.dataset.sample import synthesise
from radhar_cli.dataset.split import split_rows
from radhar_cli.errors import FolderError
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.process import prepare_process


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
    try:
        with h5py.File(path, "r") as file:
            config = config_from_json(str(file.attrs["config"]), str(path))
            report = Report(len(file["label"]))
            _versions(file, report)
            if _structure(file, config, report):
                _checksums(file, config, report)
                _resynthesise(file, config, samples, report)
                if (path.parent / PNG).is_dir():
                    _pngs(file, config, path.parent, report)
            return report
    except (OSError, KeyError, ValueError) as error:
        raise FolderError(f"{path}: is not a whole data set of ours ({error})") from None


def _versions(file: h5py.File, report: Report) -> None:
    for library, here in versions().items():
        there = str(file.attrs[f"{library}_version"])
        if there != here:
            report.other_versions.append(f"{library} {there} there, {here} here")


def _structure(file: h5py.File, config: Config, report: Report) -> bool:
    rows = Rows.of(config)
    expected: dict[str, Any] = {
        "label": np.repeat([a.index for a in rows.activities], rows.per_class),
        "split": split_rows(config),
    }
    expected["sample_key"] = np.stack(
        [expected["label"], np.tile(np.arange(rows.per_class), len(rows.activities))], axis=1
    )
    for name, right in expected.items():
        found = file[name][:]
        if found.shape != right.shape:
            report.problems.append(f"/{name}: {found.shape} instead of {right.shape}")
        elif (found != right).any():
            report.problems.append(f"/{name}: {np.count_nonzero(found != right)} wrong values")
    if config_hash(config) != file.attrs["config_hash"]:
        report.problems.append("the stored config does not have the stored hash")
    if config.seed != file.attrs["seed"]:
        report.problems.append("the stored seed is not the config's")
    for name in config.maps:
        shape = (len(rows), *config.image.size_px)
        if file[f"maps/{name}"].shape != shape or file[f"maps/{name}"].dtype != np.uint8:
            report.problems.append(f"/maps/{name}: should be uint8 {shape}")
    return not report.problems


def _checksums(file: h5py.File, config: Config, report: Report) -> None:
    for name in config.maps:
        stored = file[f"sha256/{name}"][:]
        for row, levels in enumerate(file[f"maps/{name}"]):
            if hashlib.sha256(levels.tobytes()).hexdigest().encode() != stored[row]:
                report.problems.append(f"/maps/{name}[{row}]: does not match its checksum")


def _resynthesise(file: h5py.File, config: Config, samples: int, report: Report) -> None:
    rows, plan = Rows.of(config), plan_images(config)
    columns = scene_fields.fields(config)
    allowed = 1 if report.other_versions else 0
    count = min(samples, len(rows))
    for sample in range(count):
        row = (2 * sample + 1) * len(rows) // (2 * count)
        activity, index = rows[row]
        scene, _ = draw_valid_scene(config, activity, index)
        for column, value in zip(columns, scene_fields.values([scene], columns)[0], strict=True):
            there = file[f"scene/{column.name}"][row]
            if not np.isclose(there, value * column.factor, rtol=1e-12, atol=0, equal_nan=True):
                report.problems.append(
                    f"/scene/{column.name}[{row}]: {there} instead of {value * column.factor}"
                )
        for name, image in synthesise(scene, plan).items():
            there = file[f"maps/{name}"][row].astype(int)
            worst = int(np.abs(there - image.levels).max())
            report.worst_level = max(report.worst_level, worst)
            if worst > allowed:
                report.problems.append(
                    f"/maps/{name}[{row}] ({scene.name}): differs by up to {worst} grey levels"
                )
            entropy = float(file[f"entropy/{name}"][row])
            if abs(entropy - image.entropy) > 1e-3 * max(1.0, image.entropy):
                report.problems.append(f"/entropy/{name}[{row}]: {entropy}, not {image.entropy}")
        report.resynthesised += 1


def _pngs(file: h5py.File, config: Config, folder: Path, report: Report) -> None:
    rows, split = Rows.of(config), split_rows(config)
    table = colour_table(config.image.colour_map)
    for name in config.maps:
        if not (folder / PNG / name).is_dir():
            continue
        for row, levels in enumerate(file[f"maps/{name}"]):
            path = png_path(name, split[row], *rows[row])
            try:
                with Image.open(folder / path) as picture:
                    there = stored_levels(picture)
                    shown = np.asarray(picture.convert("RGB"))
            except OSError as error:
                report.problems.append(f"{path}: cannot be read ({error})")
                continue
            report.pngs += 1
            if (
                there is None
                or not np.array_equal(there, levels)
                or not np.array_equal(shown, table[levels])
            ):
                report.problems.append(f"{path}: does not show /maps/{name}[{row}]")
