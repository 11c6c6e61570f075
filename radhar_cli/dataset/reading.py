"""Open a finished data set: arrays that are read when indexed, and their description."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.data_set import AnyConfig, Config, MeasuredConfig
from radhar_cli.config.reading import validated
from radhar_cli.config.stream import frame_classes
from radhar_cli.dataset import layout, scene_fields
from radhar_cli.dataset.folder import holds_samples, stored_identity
from radhar_cli.dataset.identity import versions
from radhar_cli.dataset.radar_folders import (
    describe_missing,
    folder_of_all_radars,
    refuse_several_radars,
)
from radhar_cli.errors import ConfigError, FolderError, describe_schema, did_you_mean
from radhar_cli.extensions import any_name
from radhar_cli.files.untrusted import Closing
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.readers.untrusted_hdf5 import Column, NumberColumn, UntrustedFile

NO_DATA_SET = "no such file; `radhar prepare` makes data sets of images and points"
MAX_ENTROPY_BITS = 64.0
BLOCK = 4096  # rows of a column read at once


class Dataset(Closing):
    """A data set opened for reading; its file is not trusted.

    Names, shapes and types of everything in it follow from its config and are checked here.

    Args:
        path: path of dataset.h5, or of the file that is going to be renamed to it.

    Attributes:
        path: path of the file.
        config: config of the data set.
        maps: {map name: uint8 [N, H, W]}.
        label: uint8 [N], place in `classes`, as in every other form of the data set.
        split: uint8 [N]; 0 train, 1 validation, 2 test.
        classes: name of every label [C]: the slugs, in the order of the config's `activities`.
        labels: uint8 [N, len(class_slugs)], 1 for activities of anybody in the scene; None without
            `people`.
        person_label: int16 [N, 1 + people], the class of each person, place in `class_slugs`, -1
            absent; None without `people`.
        sample_key: int64 [N, 2], (label, index within the class).
        scene: {field: [N]}, SI units.
        fields: descriptions of the columns of `scene`, but for `subject`.
        large: {name: [N, ...]} of all datasets with a sample a chunk, the maps among them.
        sha256: checksums {name of a large dataset: [N]}.
        products: {name: an array of each sample}, of `output.products`.
        column_label: {map name: uint8 [N, W]}, numbers in `column_labels.label_names`; empty where
            they were not asked for.
        frame_label: {map name: int16 [N, person, W]} of streams, places in `frame_classes`, -1
            nobody.
        frame_classes: names of the labels in time of streams; empty of other data sets.
        class_slugs: `classes`, then activities of `people` alone.

    Raises:
        FolderError: it is not a data set of radhar, or is damaged; names file and field.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.file = UntrustedFile(path)
        try:
            if self.file.has_attribute("scene"):
                raise FolderError(f"{path}: is a scene of `radhar simulate`, not a data set")
            self._refuse_other_formats()
            self.config = stored_config(self.file.json("config"), str(path))
            self._check()
        except BaseException:
            self.file.close()
            raise

    def _refuse_other_formats(self) -> None:
        """Refuse a file whose layout is of another version: its labels mean something else."""
        if not self.file.has_attribute("schema_version"):
            return  # what else it lacks is said of it
        version = self.file.whole_number("schema_version")
        if version != layout.SCHEMA_VERSION:
            cure = (
                ", in which labels are 0 to C - 1; `radhar generate` of its config.yaml makes it "
                "anew"
            )
            raise FolderError(
                f"{self.path}: {describe_schema(version, layout.SCHEMA_VERSION, cure)}"
            )

    def _check(self) -> None:
        """Open everything that the config names, and check its shapes and types."""
        config, file, count = self.config, self.file, len(layout.Rows.of(self.config))
        self.fields = scene_fields.fields(config)
        self.classes = tuple(activity.slug for activity in config.chosen_activities)
        self.class_slugs = [activity.slug for activity in config.every_class]
        self.frame_classes: tuple[str, ...] = ()
        if config.stream is not None:
            self.frame_classes = frame_classes(config.stream_activities)
        names: tuple[str, ...] = config.maps
        self.large = {
            name: file.chunks(name, dtype, (count, *shape))
            for name, (dtype, shape) in layout.large_datasets(config).items()
        }
        self.maps = {name: self.large[f"maps/{name}"] for name in names}
        self.sample_key = file.column("sample_key", np.int64, (count, 2))
        self.scene = {
            field.name: file.column(f"scene/{field.name}", np.float64, (count,))
            for field in self.fields
        }
        if config.split.subjects is not None:
            self.scene["subject"] = file.column("scene/subject", np.int64, (count,))
        small = {
            name: file.column(name, dtype, (count, *shape))
            for name, (dtype, shape) in layout.small_datasets(config).items()
        }
        self.sha256 = {name: small[layout.checksum_of(name)] for name in self.large}
        named = (f"scene/{field.name}" for field in self.fields)
        self.small = small | dict(zip(named, self.scene.values(), strict=False))
        self.products = {
            name: ProductArrays(
                file.samples(f"products/{name}", may_be_empty=True),
                small[layout.count_of(name)][:],
            )
            for name in config.stored
        }
        labelled = names if config.output.column_labels else ()
        self.column_label = {name: small[f"{layout.COLUMN_LABEL}/{name}"] for name in labelled}
        self.frame_label = {
            name: small[key] for name in names if (key := f"{layout.FRAME_LABEL}/{name}") in small
        }
        self.labels, self.person_label = (
            small[name][:] if config.people else None
            for name in (layout.LABELS, layout.PERSON_LABEL)
        )
        self.label = _small_numbers(file.column("label", np.uint8, (count,)), len(self.classes))
        self.split = _small_numbers(file.column("split", np.uint8, (count,)), len(layout.SPLITS))

    def __len__(self) -> int:
        return len(self.label)

    def __repr__(self) -> str:
        numbers = np.bincount(self.split, minlength=len(layout.SPLITS))
        splits = ", ".join(f"{numbers[n]} {name}" for n, name in self.present_splits.items())
        products = f"; products {', '.join(self.products)}" if self.products else ""
        size = " x ".join(map(str, self.config.image.size_px))
        maps = f"maps {', '.join(self.maps)} of {size} px{products}"
        classes = ", ".join(self.class_slugs[n] for n in np.unique(self.label))
        return f"<Dataset {self.path}: {len(self)} samples ({splits}) of {classes}; {maps}>"

    @property
    def present_splits(self) -> dict[int, str]:
        """Splits that have samples: {number: name}."""
        return {n: name for n, name in enumerate(layout.SPLITS) if (self.split == n).any()}

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """Warnings of the build: {kind, recordings, message} of each.

        Raises:
            FolderError: they are damaged.
        """
        messages: list[dict[str, Any]] = self.file.json("warnings")
        if not isinstance(messages, list) or not all(
            isinstance(warning, dict) and isinstance(warning.get("message"), str)
            for warning in messages
        ):
            raise FolderError(f"{self.path}: attribute warnings: should be a list of messages")
        return messages

    @property
    def versions(self) -> dict[str, str]:
        """Versions of the libraries that decided the bytes, by name; `unknown` if not stored."""
        named = {library: f"{library}_version" for library in versions()}
        return {
            library: self.file.text(key) if self.file.has_attribute(key) else "unknown"
            for library, key in named.items()
        }

    def entropy(self, name: str) -> Float:
        """Entropy of the power of map `name` in each sample [N], bits."""
        column = self.small[f"entropy/{name}"]
        bits: Float = column[:].astype(float)
        if not ((bits >= 0) & (bits <= MAX_ENTROPY_BITS)).all():
            raise FolderError(f"{column.where}: should be 0 to {MAX_ENTROPY_BITS:g} bits")
        return bits

    def extent(self, name: str) -> tuple[float, float, float, float] | None:
        """Edges of map `name`: left and right in s, bottom and top in Hz or m.

        They are None where they differ from sample to sample (see `extents`).
        """
        first = self.small[f"extent/{name}"].rows(0, 1)
        same = [bool((edges == first).all()) for edges in self._edges(name)]
        left, right, bottom, top = map(float, first[0])
        return (left, right, bottom, top) if all(same) else None

    def extents(self, name: str) -> Float:
        """Edges (left, right, bottom, top) of map `name` in each sample [N, 4]."""
        return np.concatenate([*self._edges(name)])

    def _edges(self, name: str) -> Iterator[Float]:
        """Yield the edges of a map, BLOCK rows at a time, checked."""
        column = self.small[f"extent/{name}"]
        for start in range(0, len(column), BLOCK):
            edges: Float = column.rows(start, start + BLOCK)
            left, right, bottom, top = edges.T
            if not (np.isfinite(edges).all() and (left < right).all() and (bottom < top).all()):
                raise FolderError(f"{column.where}: should be left < right, bottom < top")
            yield edges

    def map_name(self, name: str | None) -> str:
        """Check the name of a map and return it; None names the first map.

        Raises:
            FolderError: there is no such map.
        """
        if name is None:
            return self.config.maps[0]
        if name not in self.maps:
            hint = did_you_mean(name, self.maps, f"it has {', '.join(self.maps)}")
            raise FolderError(f"{self.path}: has no map {name!r}; {hint}")
        return name

    def close(self) -> None:
        """Close the file."""
        self.file.close()


class ProductArrays:
    """Arrays of the samples, which one array holds one after the other along axis 0.

    Attributes:
        counts: number of rows of each sample [N].
    """

    def __init__(self, samples: NumberColumn, counts: Index) -> None:
        if (counts < 0).any() or counts.sum() != samples.shape[0]:
            raise FolderError(f"{samples.where}: has not as many rows as its counts say")
        self._samples, self.counts, self._stops = samples, counts, np.cumsum(counts)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array that holds the rows of all samples."""
        return self._samples.shape

    def __len__(self) -> int:
        return self._stops.size

    def __getitem__(self, row: int) -> NDArray[Any]:
        stop = int(self._stops[row])
        return self._samples.rows(int(self._stops[row - 1]) if row else 0, stop)


def _small_numbers(column: Column, below: int) -> Levels:
    """Read a column of whole numbers [N] from 0 to `below` - 1.

    Raises:
        FolderError: one is larger.
    """
    values: Levels = column[:]
    if values.max(initial=0) >= below:
        raise FolderError(f"{column.where}: holds {values.max()}; should be 0 to {below - 1}")
    return values


def stored_config(document: Any, where: str) -> AnyConfig:
    """Read the config that is stored with a data set.

    Args:
        document: its plain values.
        where: file or folder, for messages.

    Raises:
        FolderError: it is not a valid config.
    """
    measured = isinstance(document, dict) and document.get("recordings") is not None
    kind: type[AnyConfig] = MeasuredConfig if measured else Config
    try:
        with any_name():
            return validated(kind, document, f"{where}: the stored config", {})
    except ConfigError as error:
        raise FolderError(str(error).splitlines()[0]) from None


def open_dataset(path: str | Path) -> Dataset:
    """Open the data set in a folder, or a dataset.h5.

    Raises:
        FolderError: there is no such data set, it is not of radhar, or it is damaged.
    """
    path = Path(path)
    file = path / layout.DATASET if path.is_dir() else path
    if not file.exists():
        refuse_several_radars(path)
        raise FolderError(f"{file}: {why_missing(path)}")
    return Dataset(file)


def why_missing(path: Path) -> str:
    """Describe why a path leads to no dataset.h5, with the command that makes one."""
    path = path.parent if path.name == layout.DATASET else path
    target = folder_of_all_radars(path)
    if (parts := path / layout.PARTS).is_dir():
        return f"not made yet; `radhar merge {target}` puts the parts in {parts} together"
    if not layout.is_incomplete(path):
        return describe_missing(path, NO_DATA_SET if path.is_dir() else "no such file")
    part = (stored_identity(path) or {}).get("part")
    if part is not None and (path / layout.WORK / layout.BUILT).exists():
        return f"{path} is part {part} alone; `radhar merge OUT` makes OUT of all parts"
    if part is not None:
        return f"its build is unfinished; run `radhar generate` again, with --shard {part}"
    if not holds_samples(path):
        return f"no sample is made yet; `radhar generate CONFIG -o {target}` can build there"
    return f"its build is unfinished; `radhar generate CONFIG -o {target}` goes on"
