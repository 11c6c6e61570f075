"""What has been measured already, kept in the output folder: the same command goes on from it."""

import hashlib
import json
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import WORK
from radhar_cli.errors import FolderError
from radhar_cli.untrusted import read_json

T = TypeVar("T")


class ResultCache:
    """JSON values by key, each in a file of its own that is whole or not there."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def get(self, key: str, kind: type[T] | Any = Any) -> T | None:
        """The value, or None if it has not been measured.

        Raises:
            FolderError: what is kept is of another kind.
        """
        path = self._path(key)
        if not path.exists():
            return None
        try:
            value: T = TypeAdapter(kind).validate_python(read_json(path))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]["msg"]
            raise FolderError(f"{path}: is damaged ({first}); delete it") from None
        return value

    def put(self, key: str, value: Any) -> None:
        """Keep a value."""
        write_whole(self._folder, self._path(key), json.dumps(value).encode())

    def _path(self, key: str) -> Path:
        name = hashlib.sha256(key.encode()).hexdigest()[:32]
        return self._folder / WORK / "measured" / f"{name}.json"
