"""What has been measured already, kept in the output folder: the same command goes on from it."""

import hashlib
import json
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import WORK
from radhar_cli.untrusted import read_json


class Ledger:
    """JSON values by key, each in a file of its own that is whole or not there."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def get(self, key: str) -> Any | None:
        """The value, or None if it has not been measured."""
        path = self._path(key)
        return read_json(path) if path.exists() else None

    def put(self, key: str, value: Any) -> None:
        """Keep a value."""
        write_whole(self._folder, self._path(key), json.dumps(value).encode())

    def _path(self, key: str) -> Path:
        name = hashlib.sha256(key.encode()).hexdigest()[:32]
        return self._folder / WORK / "measured" / f"{name}.json"
