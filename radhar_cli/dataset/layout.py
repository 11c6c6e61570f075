"""Which sample stands in which row, and what its files are called."""

from dataclasses import dataclass
from pathlib import Path

from radhar_cli.activity import Activity
from radhar_cli.config.schema import Config

DATASET = "dataset.h5"
CONFIG = "config.yaml"
SCENES = "scenes.csv"
PNG = "png"
WORK = ".radhar"
IDENTITY = "identity.json"
MANIFEST = "manifest.json"
CHECKS = "checks"
SPLITS = ("train", "validation", "test")
# Beside the maps, for each of them: type and shape of a sample's part.
COLUMNS: dict[str, tuple[str, tuple[int, ...]]] = {
    "entropy": ("f4", ()),
    "sha256": ("S64", ()),
    "extent": ("f8", (4,)),
}
SPLIT_FOLDERS = ("train", "val", "test")


def is_incomplete(folder: Path) -> bool:
    """Whether a build in this folder was begun and not finished."""
    return any((folder / WORK / name).exists() for name in (IDENTITY, "shards", CHECKS))


@dataclass(frozen=True)
class Rows:
    """The fixed, class-major order of a data set's samples."""

    activities: tuple[Activity, ...]
    per_class: int

    @classmethod
    def of(cls, config: Config) -> "Rows":
        return cls(config.chosen_activities, config.samples_per_class)

    def __len__(self) -> int:
        return len(self.activities) * self.per_class

    def __getitem__(self, row: int) -> tuple[Activity, int]:
        """(activity, index within its class) of a row."""
        which, index = divmod(row, self.per_class)
        return self.activities[which], index


def png_path(map_name: str, split: int, activity: Activity, index: int) -> Path:
    """Path of a PNG inside the output folder, the layout that torchvision's ImageFolder reads."""
    return Path(PNG, map_name, SPLIT_FOLDERS[split], activity.slug, f"{index:05d}.png")
