"""Images of a dataset.h5: levels, or their colours in the PNGs."""

import hashlib
import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from radhar_cli.arrays import Levels
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.dataset.recorded import windows
from radhar_cli.learning.images.image_set import ImageSet, class_order, repeated

_WHO_AND_HOW = ("subject.", "motion.", "timing.", "recordings.part", "recordings.start_s")


@dataclass
class H5Pixels:
    """Rows of one map through a table [256, 3]; every process opens the file for itself."""

    path: Path
    map: str
    table: Levels
    _open: dict[int, Dataset] = field(default_factory=dict, repr=False)

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row.

        Raises:
            FolderError: the file is damaged there.
        """
        mine = self._open.get(os.getpid())
        if mine is None:
            self._open.clear()
            mine = self._open[os.getpid()] = open_dataset(self.path)
        rgb: Levels = self.table[mine.maps[self.map][row]]
        return rgb

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_open": {}}


def h5_images(path: Path, map_name: str | None, kind: str) -> ImageSet:
    """Open one map of a dataset.h5, or of the folder it lies in, as images."""
    with open_dataset(path) as data:
        name, rows = data.map_name(map_name), Rows.of(data.config)
        slug, snr_db = np.array(data.class_slugs)[data.label], data.config.snr_db
        classes = class_order(set(slug.tolist()))
        colours = colour_table(data.config.image.colour_map)
        table = colours if kind == "rgb" else repeated(np.arange(256, dtype=np.uint8))
        return ImageSet(
            where=path,
            map=name,
            classes=classes,
            label=np.array([classes.index(s) for s in slug], dtype=np.intp),
            split=data.split,
            names=tuple(f"{s}/{rows.name(row)}" for row, s in enumerate(slug)),
            scenes=_scenes(data, slug.tolist()),
            size=data.config.image.size_px,
            pixels=H5Pixels(data.path, name, table),
            snr_db=float(snr_db) if isinstance(snr_db, (int, float)) else None,
            persons=_persons(data),
        )


def _persons(data: Dataset) -> tuple[str, ...] | None:
    """Who is in each row; of a recording that does not say, which recording it was cut from."""
    if data.config.recorded is not None:
        parts = (window.part for window in windows(data.config))
        return tuple(f"file {p.file}" if p.person is None else p.person for p in parts)
    if data.config.split.subjects is None:
        return None
    return tuple(map(str, data.scene["subject"][:].tolist()))


def _scenes(data: Dataset, slugs: list[str]) -> tuple[str, ...]:
    """A fingerprint of who moved and how, in SI units; radar, wall and noise do not enter."""
    fields = [field for field in data.fields if field.key.startswith(_WHO_AND_HOW)]
    fields.sort(key=lambda field: field.name)
    columns = [data.scene[field.name][:] for field in fields]
    table = np.stack(columns, axis=1) if columns else np.zeros((len(slugs), 0))
    return tuple(
        hashlib.blake2b(slug.encode() + row.tobytes(), digest_size=8).hexdigest()
        for slug, row in zip(slugs, table, strict=True)
    )
