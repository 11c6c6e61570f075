"""The folder of several radars of the same scenes: one folder each, and a file that lists them."""

import json
from collections.abc import Iterable
from pathlib import Path

from radhar_cli.dataset.folder import refuse_file, refuse_foreign_files
from radhar_cli.errors import FolderError
from radhar_cli.files.replacing import refuse_links, write_text
from radhar_cli.files.untrusted import read_json

RADARS = "radars.json"


def reserve_radars(folder: Path, names: Iterable[str]) -> dict[str, Path]:
    """Take a folder for the data sets of several radars, and write the file that lists them.

    Args:
        folder: the folder, which need not exist; folders of its radars are not looked into.
        names: names of the radars.

    Returns:
        {name: folder of the radar}, none of them made.

    Raises:
        FolderError: it is a file, or holds other files, or those of other radars.
    """
    listed = sorted(names)
    refuse_file(folder)
    stored_radars = radars_of(folder)
    if stored_radars and stored_radars != listed:
        raise FolderError(
            f"{folder}: holds the radars {', '.join(stored_radars)}, not {', '.join(listed)}; "
            "choose an empty folder"
        )
    if not stored_radars:
        refuse_foreign_files(folder, f"{RADARS} of several radars", allowed=())
    else:
        refuse_foreign_files(folder, "radar of these names", allowed=(RADARS, *listed))
    folders = {name: folder / name for name in listed}
    for path in (*folders.values(), folder / RADARS):
        refuse_links(folder, path)
    if not stored_radars:
        folder.mkdir(parents=True, exist_ok=True)
        write_text(folder / RADARS, json.dumps({"radars": listed}) + "\n")
    return folders


def radars_of(folder: Path) -> list[str]:
    """Names of the radars whose folders a folder holds; none of any other folder.

    Raises:
        FolderError: its list of radars is damaged.
    """
    path = folder / RADARS
    if not path.is_file():
        return []
    document = read_json(path)
    names = document.get("radars") if isinstance(document, dict) else None
    if not isinstance(names, list) or not names or not all(map(_is_name, names)):
        raise FolderError(f"{path}: is damaged: should be the names of radars")
    return sorted(names)


def _is_name(name: object) -> bool:
    """Whether a name is that of a folder inside of another one."""
    return isinstance(name, str) and name.replace("-", "").replace("_", "").isalnum()


def folders_of_radars(folder: Path) -> dict[str, Path]:
    """Folders {name: path} of the radars of a folder; {"": the folder itself} of any other.

    Raises:
        FolderError: its list of radars is damaged.
    """
    return {name: folder / name for name in radars_of(folder)} or {"": folder}


def folder_of_all_radars(folder: Path) -> Path:
    """Folder that `generate` and `merge` build for the data set of one: that of all its radars."""
    parent = folder.parent if folder.name else folder.absolute().parent
    try:
        return parent if folder.absolute().name in radars_of(parent) else folder
    except FolderError:
        return folder


def describe_missing(path: Path, otherwise: str = "no such file or folder") -> str:
    """Describe the missing data set of one of several radars, with the command that makes it.

    Args:
        path: path of nothing.
        otherwise: description of any other path.
    """
    if (target := folder_of_all_radars(path)) == path:
        return otherwise
    return f"not made yet; `radhar generate CONFIG -o {target}` goes on with all radars"


def folders_of_merged_radars(folder: Path, parts: Iterable[Path]) -> dict[str, Path]:
    """Folders {name: path} of the radars of a folder, or of parts that are merged into a new one.

    Args:
        folder: folder to merge into, which need not exist; it is taken for the radars of the parts.
        parts: folders of parts; those of one radar name none.

    Raises:
        FolderError: parts are of other radars than others, or as `reserve_radars`.
    """
    names = radars_of(folder)
    for part in parts:
        listed = radars_of(part)
        if names and listed and names != listed:
            raise FolderError(
                f"{part}: holds parts of the radars {', '.join(listed)}, not {', '.join(names)}"
            )
        names = names or listed
    return reserve_radars(folder, names) if names else {"": folder}


def refuse_several_radars(folder: Path) -> None:
    """Refuse a folder of several radars where the data set of one of them is needed.

    Raises:
        FolderError: it is such a folder; the message names those of its radars.
    """
    if names := radars_of(folder):
        one_each = ", ".join(str(folder / name) for name in names)
        raise FolderError(f"{folder}: holds a data set of each of several radars; give {one_each}")
