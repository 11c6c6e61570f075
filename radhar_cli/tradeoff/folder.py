"""The output folder of a sweep: one run at a time, and one sweep."""

import json
import shutil
from pathlib import Path

from radhar_cli.config.schema import Config
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.folder import checked_identity
from radhar_cli.dataset.identity import differences, identity
from radhar_cli.dataset.layout import WORK
from radhar_cli.errors import FolderError
from radhar_cli.untrusted import read_json

NAME = "sweep.json"


def reserve(folder: Path, config: Config, overwrite: bool) -> None:
    """Make a folder, whose lock is held, this config's sweep, or refuse.

    Raises:
        FolderError: it holds something else, or the sweep of another config.
    """
    path = folder / WORK / NAME
    old = checked_identity(read_json(path), path) if path.exists() else None
    new = {"keys": identity(config)["keys"], "versions": identity(config)["versions"]}
    if old is None:
        foreign_files = sorted(p.name for p in folder.iterdir() if p.name != WORK)
        if foreign_files:
            raise FolderError(
                f"{folder}: holds {', '.join(foreign_files[:5])} but no sweep; choose an empty "
                "folder"
            )
    elif overwrite:
        for part in ("measured", "accuracy"):
            shutil.rmtree(folder / WORK / part, ignore_errors=True)
    elif differing := differences(old, new):
        raise FolderError(
            f"{folder}: holds the sweep of another config; it differs in\n  "
            + "\n  ".join(differing)
            + "\nchoose another folder, or --overwrite to start this one over"
        )
    write_whole(folder, path, json.dumps(new).encode())
