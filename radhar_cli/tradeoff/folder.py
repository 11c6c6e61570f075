"""The output folder of a sweep: one run at a time, and one sweep."""

import json
import shutil
from pathlib import Path

from radhar_cli.config.schema import Config
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.folder import checked_identity, refuse_differences, refuse_foreign_files
from radhar_cli.dataset.identity import differences, identity
from radhar_cli.dataset.layout import WORK
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
        refuse_foreign_files(folder, "sweep")
    elif overwrite:
        shutil.rmtree(folder / WORK / "measured", ignore_errors=True)
    else:
        refuse_differences(folder, "config's sweep", differences(old, new))
    write_whole(folder, path, json.dumps(new).encode())
