"""Check a finished data set: checksums, labels, counts, and samples synthesised again."""

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.data_set import Config
from radhar_cli.config.identity import as_yaml
from radhar_cli.config.motion_files import set_motion_folder
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.assembly import CONFIG_HEADING, SCENES_DIGEST
from radhar_cli.dataset.column_labels import label_names
from radhar_cli.dataset.files import digest_of, read_bytes
from radhar_cli.dataset.identity import versions
from radhar_cli.dataset.image_file import SUFFIXES, read_gray, read_rgb
from radhar_cli.dataset.image_tables import image_tables
from radhar_cli.dataset.layout import COLUMN_LABEL, CONFIG, PNG, SCENES, WORK, Rows, checksum_of
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.dataset.sample import StoredSample, synthesise
from radhar_cli.dataset.split import persons, split_rows
from radhar_cli.errors import FolderError
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.processing.power_map import MapImage
from radhar_cli.readers.untrusted_hdf5 import DIGESTS
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import Scene

# Of a mask's pixels that may differ under other versions of the libraries.
MASK_SHARE = 1e-3
# How far stored power and signals may be off then, dB and relative.
POWER_DB, SIGNAL_ERROR = 0.25, 1e-5
ROWS = 4096  # of a column, read at once


@dataclass
class Verification:
    """Result of a verification."""

    samples: int  # in the data set
    resynthesised: int = 0  # of them, made anew
    # library versions that differ from those that built it
    other_versions: list[str] = field(default_factory=list)
    unmade: int = 0  # of them, not made anew as their motion files are not known
    worst_level: int = 0  # largest difference of a grey level among the samples made anew
    pngs: int = 0  # PNG files compared
    problems: list[str] = field(default_factory=list)  # everything that is wrong


def verify(
    folder: Path, samples: int, motion: Path | None = None, progress: Progress = NO_PROGRESS
) -> Verification:
    """Verify a data set against its config and seed.

    Args:
        folder: output folder of `generate`, or its dataset.h5.
        samples: number of samples to synthesise anew, spread evenly over the rows.
        motion: folder of the motion files of its classes; None re-synthesises no sample of them: a
            stored config is not trusted to name files.
        progress: is told of each checksum, sample and PNG file.

    Raises:
        FolderError: there is no data set, or it cannot be read.
    """
    if motion is not None and not motion.is_dir():
        raise FolderError(f"{motion}: no such folder; should hold the motion files of the data set")
    prepare_process()
    beside = folder if folder.is_dir() else folder.parent
    with open_dataset(folder) as data:
        report, stored = Verification(len(data)), data.versions
        report.other_versions += [
            f"{library} {stored[library]} there, {here} here"
            for library, here in versions().items()
            if stored[library] != here
        ]
        if _verify_structure(data, report):
            _verify_checksums(data, report, progress)
            _verify_attributes(data, report)
            if isinstance(data.config, Config):  # recordings may lie anywhere
                _resynthesise(data, data.config, samples, report, motion, progress)
            if (beside / PNG).is_dir():
                _verify_pngs(data, beside, report, progress)
            elif (beside / WORK).is_dir() and data.config.output.png:
                report.problems.append(f"{PNG}: is missing; `radhar generate` makes it again")
            if (beside / WORK).is_dir():
                _verify_config_and_table(data, beside, report)
        return report


def _verify_structure(data: Dataset, report: Verification) -> bool:
    """Compare labels, splits, keys and persons with the config; return whether all agree."""
    config = data.config
    rows = Rows.of(config)
    label = rows.label
    index = np.concatenate([np.arange(count) for count in rows.counts])
    columns = [
        ("label", data.label, label),
        ("split", data.split, split_rows(config)),
        ("sample_key", data.sample_key[:], np.stack([label, index], axis=1)),
    ]
    if (person := persons(config)) is not None:
        columns.append(("scene/subject", data.scene["subject"][:], person))
    for name, stored, expected in columns:
        if (stored != expected).any():
            report.problems.append(f"/{name}: {np.count_nonzero(stored != expected)} wrong values")
    return not report.problems


def _verify_checksums(data: Dataset, report: Verification, progress: Progress) -> None:
    """Compare every large and small dataset with its checksum."""
    progress.stage("checksums", len(data) * len(data.large), 0, "checksum")
    for name, chunks in data.large.items():
        stored = data.sha256[name][:]
        for row in range(len(data)):
            if hashlib.sha256(chunks[row].tobytes()).hexdigest().encode() != stored[row]:
                report.problems.append(f"/{name}[{row}]: does not match its checksum")
            progress.advance(1)
    stored_digests = _read_mapping(data, "columns_sha256", report)
    for name, column in data.small.items():
        if name.startswith(checksum_of("")):
            continue
        digest = hashlib.sha256()
        for start in range(0, len(data), ROWS):
            digest.update(column.rows(start, start + ROWS).tobytes())
        if stored_digests.get(name) != digest.hexdigest():
            report.problems.append(f"/{name}: does not match its checksum")


def _read_mapping(data: Dataset, name: str, report: Verification) -> dict[str, Any]:
    """Read an attribute of the file that should be a mapping; report any other."""
    value = data.file.json(name)
    if isinstance(value, dict):
        return value
    report.problems.append(f"attribute {name}: should be a mapping")
    return {}


def _verify_attributes(data: Dataset, report: Verification) -> None:
    """Compare the names and attributes in the file with those of its build."""
    stored_digests = data.file.attribute_digests()
    built_digests = _read_mapping(data, DIGESTS, report)
    for name in sorted(stored_digests.keys() | built_digests.keys()):
        if stored_digests.get(name) != built_digests.get(name):
            problem = "attributes differ from those that were built"
            problem = "was not built" if name not in built_digests else problem
            problem = "is missing" if name not in stored_digests else problem
            report.problems.append(f"{name}: {problem}")


def _verify_config_and_table(data: Dataset, folder: Path, report: Verification) -> None:
    """Compare config.yaml and scenes.csv with dataset.h5."""
    for name in (CONFIG, SCENES):
        if not (folder / name).exists():
            report.problems.append(f"{name}: is missing")
    if (folder / CONFIG).exists() and not report.other_versions:
        expected = (CONFIG_HEADING + as_yaml(data.config)).encode()
        if read_bytes(folder / CONFIG) != expected:
            report.problems.append(f"{CONFIG}: is not the config in dataset.h5")
    if (folder / SCENES).exists() and digest_of(folder / SCENES) != data.file.text(SCENES_DIGEST):
        report.problems.append(f"{SCENES}: is not that of dataset.h5")


def _resynthesise(
    data: Dataset,
    config: Config,
    samples: int,
    report: Verification,
    motion: Path | None,
    progress: Progress,
) -> None:
    """Synthesise some samples again, and compare all that is stored of them."""
    config = config if motion is None else set_motion_folder(config, motion)
    rows, plan = Rows.of(config), plan_images(config)
    comparison = _SampleComparison(data, config, report)
    chosen_rows = rows.spread(samples)
    progress.stage("samples again", len(chosen_rows), 0)
    for number, row in enumerate(chosen_rows):
        progress.advance(int(number > 0))
        activity, index = rows[row]
        if motion is None and config.files_of(activity) is not None:
            report.unmade += 1
            continue
        scene, _ = draw_valid_scene(config, activity, index)
        comparison.compare(row, scene, synthesise(scene, plan, config))
        report.resynthesised += 1


class _SampleComparison:
    """Compares samples synthesised again with those that are stored; problems go to the report."""

    def __init__(self, data: Dataset, config: Config, report: Verification) -> None:
        self._data, self._report = data, report
        self._is_bitwise = not report.other_versions
        self._is_mask = config.image.kind == "cfar"
        self._labels = label_names(config)
        self._scene_values = {field.name: data.scene[field.name][:] for field in data.fields}
        self._entropies = {name: data.entropy(name) for name in data.maps}

    def compare(self, row: int, scene: Scene, sample: StoredSample) -> None:
        """Compare all that is stored of a row."""
        self._compare_numbers(row, scene)
        self._compare_arrays(row, scene.name, sample)
        self._compare_labels(row, scene.name, sample)
        for name, image in sample.images.items():
            self._compare_image(row, scene.name, name, image)

    def _say(self, problem: str) -> None:
        self._report.problems.append(problem)

    def _compare_numbers(self, row: int, scene: Scene) -> None:
        """Compare the numbers of a scene with those of /scene, but for the measured error."""
        columns = self._data.fields
        drawn_numbers = scene_fields.values(scene, columns)
        for column, value in zip(columns, drawn_numbers, strict=True):
            if column is scene_fields.ERROR:
                continue
            stored, drawn = self._scene_values[column.name][row], value * column.factor
            if not np.isclose(stored, drawn, rtol=1e-12, atol=0, equal_nan=True):
                self._say(f"/scene/{column.name}[{row}]: {stored} instead of {drawn}")

    def _compare_arrays(self, row: int, scene_name: str, sample: StoredSample) -> None:
        """Compare power, slow time and products."""
        for name, stored in self._data.large.items():
            if not name.startswith("maps/"):
                expected = sample.chunk(name, stored.shape[1:])
                if not _matches(stored[row], expected, self._is_bitwise):
                    self._say(f"/{name}[{row}] ({scene_name}): differs")
        for name, expected in sample.products.items():
            if not _matches(self._data.products[name][row], expected, self._is_bitwise):
                self._say(f"/products/{name}[{row}] ({scene_name}): differs")

    def _compare_labels(self, row: int, scene_name: str, sample: StoredSample) -> None:
        """Compare the labels of people, and of the columns of images."""
        for name, labels in sample.labels.items():
            if (self._data.small[name].rows(row, row + 1)[0] != labels).any():
                self._say(f"/{name}[{row}] ({scene_name}): is not {labels.tolist()}")
        # Under other versions a phase may begin a column later: rounding.
        tolerated = 0 if self._is_bitwise else len(self._labels)
        for name, labels in sample.column_labels.items():
            stored = self._data.column_label[name].rows(row, row + 1)[0]
            wrong_columns = int(np.count_nonzero(stored != labels))
            if wrong_columns > tolerated:
                self._say(f"/{COLUMN_LABEL}/{name}[{row}]: {wrong_columns} wrong columns")

    def _compare_image(self, row: int, scene_name: str, name: str, image: MapImage) -> None:
        """Compare the levels of an image, and the entropy of its map."""
        difference = np.abs(self._data.maps[name][row].astype(int) - image.levels)
        largest, share = int(difference.max()), float(np.mean(difference > 0))
        self._report.worst_level = max(self._report.worst_level, largest)
        if self._is_mask:  # a cell at its threshold is set or not: whole levels, but few of them
            is_off, amount = share > self._tolerance(MASK_SHARE), f"in {share:.2%} of its pixels"
        else:
            is_off, amount = largest > self._tolerance(1), f"by up to {largest} grey levels"
        if is_off:
            self._say(f"/maps/{name}[{row}] ({scene_name}): differs {amount}")
        entropy = float(self._entropies[name][row])
        if abs(entropy - image.entropy) > 1e-3 * max(1.0, image.entropy):
            self._say(f"/entropy/{name}[{row}]: {entropy}, not {image.entropy}")

    def _tolerance(self, rounding: float) -> float:
        """Return the tolerance of a difference: that of rounding under other versions, else 0."""
        return 0.0 if self._is_bitwise else rounding


def _matches(stored: NDArray[Any], expected: NDArray[Any], bitwise: bool) -> bool:
    """Whether a stored array matches the one synthesised again.

    Args:
        stored: the stored array.
        expected: the array synthesised again.
        bitwise: whether every bit should agree; else as other versions of libraries may round it.
    """
    if bitwise or stored.shape != expected.shape:
        return stored.shape == expected.shape and stored.tobytes() == expected.tobytes()
    if stored.dtype.kind == "f":  # decibels; cells far below the others are rounding
        is_off = np.abs(stored.astype(float) - expected) > POWER_DB
        return bool(np.mean(is_off) <= MASK_SHARE)
    is_nan = np.isnan(expected)
    error = np.linalg.norm((stored - expected)[~is_nan])
    near: bool = error <= SIGNAL_ERROR * np.linalg.norm(expected[~is_nan])
    return near and np.array_equal(np.isnan(stored), is_nan)


def _verify_pngs(data: Dataset, folder: Path, report: Verification, progress: Progress) -> None:
    """Compare the PNG files, and the tables beside them, with the maps."""
    config = data.config
    rows, split = Rows.of(config), split_rows(config)
    table = colour_table(config.image.colour_map)
    for foreign_name in sorted({path.name for path in (folder / PNG).iterdir()} - {*config.maps}):
        report.problems.append(f"{PNG}/{foreign_name}: is no map of this data set")
    for path, text in image_tables(config, split):
        try:
            if read_bytes(folder / path, len(text)) != text:
                report.problems.append(f"{path}: is not that of dataset.h5")
        except FileNotFoundError:
            report.problems.append(f"{path}: is missing; `radhar generate` makes it again")
        except FolderError as error:
            report.problems.append(str(error))
    progress.stage("PNG files", len(data) * len(config.maps), 0, "file")
    for name in config.maps:
        if not (folder / PNG / name).is_dir():
            report.problems.append(f"{PNG}/{name}: is missing")
            continue
        for row in range(len(data)):
            progress.advance(1)
            levels = data.maps[name][row]
            path = rows.png_path(name, split[row], row)
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
        expected_paths = {rows.png_path(name, split[row], row) for row in range(len(data))}
        expected_paths |= {parent for path in expected_paths for parent in path.parents}
        for path in sorted((folder / PNG / name).rglob("*")):
            name_in_folder = path.relative_to(folder)
            if name_in_folder not in expected_paths and (
                path.is_dir() or path.suffix.lower() in SUFFIXES
            ):
                kind = "class" if path.is_dir() else "image"
                report.problems.append(f"{name_in_folder}: is no {kind} of this data set")
