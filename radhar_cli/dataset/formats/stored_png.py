"""The PNG file of a stored map, whose levels are compared with their checksum."""

import hashlib

from radhar_cli.dataset.png import encode_png
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import FolderError
from radhar_cli.numerics.arrays import Levels


def checked_png(data: Dataset, table: Levels, map_name: str, row: int) -> bytes:
    """Encode the PNG file of a sample as `generate` writes it, with a colour table [256, 3].

    Raises:
        FolderError: the stored levels do not match their checksum.
    """
    name = f"maps/{map_name}"
    levels, stored = data.large[name][row], data.sha256[name].rows(row, row + 1)[0]
    if hashlib.sha256(levels.tobytes()).hexdigest().encode() != stored:
        raise FolderError(f"{data.path}: /{name}[{row}]: does not match its checksum")
    return encode_png(levels, table, data.config.output.png_level)
