"""Open a finished data set: lazy arrays and what is known of them."""

import json
from pathlib import Path
from types import TracebackType
from typing import Any

import h5py

from radhar_cli.activity import ACTIVITIES
from radhar_cli.dataset.layout import DATASET, SPLITS, begun
from radhar_cli.errors import FolderError, did_you_mean


class Dataset:
    """A data set opened for reading; arrays are read from disk when they are indexed.

    Attributes:
        path: of dataset.h5.
        maps: {map name: uint8 [N, H, W]}.
        label, split, sample_key: [N], [N], [N, 2].
        scene: {field: [N]}, SI units.
        entropy: {map name: [N]}, bits.
        config: the resolved config as plain values.
        warnings: what was said when it was built.
        class_slugs: slug of every label, 0 to 11.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.file = h5py.File(path, "r")
        except OSError as error:
            raise FolderError(f"{path}: is no HDF5 file, or a truncated one ({error})") from None
        try:
            self.maps: dict[str, h5py.Dataset] = dict(self.file["maps"].items())
            self.label, self.split = self.file["label"], self.file["split"]
            self.sample_key = self.file["sample_key"]
            self.scene: dict[str, h5py.Dataset] = dict(self.file["scene"].items())
            self.entropy: dict[str, h5py.Dataset] = dict(self.file["entropy"].items())
            self.config: dict[str, Any] = json.loads(self.file.attrs["config"])
            self.warnings: list[dict[str, Any]] = json.loads(self.file.attrs["warnings"])
        except (KeyError, ValueError, AttributeError, OSError):
            self.file.close()
            raise FolderError(f"{path}: is an HDF5 file, but no data set of radhar's") from None
        self.class_slugs = [activity.slug for activity in ACTIVITIES]
        self.splits = SPLITS

    def __len__(self) -> int:
        return len(self.label)

    def map_name(self, name: str | None) -> str:
        """The map of that name, or the first.

        Raises:
            FolderError: the data set does not have it.
        """
        if name is None:
            stored: str = self.config["maps"][0]
            return stored
        if name not in self.maps:
            hint = did_you_mean(name, self.maps, f"it has {', '.join(self.maps)}")
            raise FolderError(f"{self.path}: has no map {name!r}; {hint}")
        return name

    def close(self) -> None:
        """Close the file."""
        self.file.close()

    def __enter__(self) -> "Dataset":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()


def open_dataset(path: str | Path) -> Dataset:
    """Open the data set in a folder, or a dataset.h5.

    Raises:
        FolderError: there is none, it is not ours, or it is damaged.
    """
    path = Path(path)
    file = path / DATASET if path.is_dir() else path
    if not file.exists():
        unfinished = path.is_dir() and begun(path)
        hint = (
            "its build is unfinished; run `radhar generate` again" if unfinished else "no such file"
        )
        raise FolderError(f"{file}: {hint}")
    return Dataset(file)
