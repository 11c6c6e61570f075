"""YAML files as documents: what a file says lies over the file that its `base` names."""

import json
import os
from collections.abc import Iterator, Mapping
from itertools import accumulate
from pathlib import Path
from typing import Any, TypeAlias

from radhar_cli.config.number import FORMS
from radhar_cli.config.yaml_reader import MAX_TEXT, parse_yaml
from radhar_cli.errors import ConfigError
from radhar_cli.untrusted import read_text, text_of

Document: TypeAlias = dict[str, Any]
Places: TypeAlias = dict[str, str]  # {dotted key: file:line}

BASE = "base"
SUFFIXES = (".yaml", ".yml", ".json")
RADARS = {path.stem: path for path in sorted(Path(__file__).with_name("radars").glob("*.cfg"))}
MAX_CHAIN = 8  # files in a chain of bases
_ONE_VALUE = {*FORMS, "sequence", "files"}  # mappings with such a key are replaced as a whole


def read_document(path: Path) -> tuple[Document, Places]:
    """A file of keys and values, and where each key stands."""
    document, lines = parse_yaml(text_of(path, MAX_TEXT, ConfigError), str(path))
    document = {} if document is None else document
    if not isinstance(document, dict):
        raise ConfigError(f"{path}: should be a mapping of keys such as 'seed: 1'")
    places = {key: f"{path}:{line}" for key, line in lines.items()}
    radar = document.get("radar")
    if isinstance(radar, dict) and "cfg" in radar:
        radar["cfg"] = cfg_text(radar["cfg"], path.parent, places.get("radar.cfg", str(path)))
    return document, places


def cfg_text(given: Any, folder: Path, where: str) -> Any:
    """The text of a .cfg: of a known radar, or of a path; a text is left as it is."""
    if not isinstance(given, str) or "\n" in given.strip():
        return given
    try:
        return read_text(RADARS.get(given.lower(), folder / given), MAX_TEXT)
    except (OSError, ValueError) as error:
        told = getattr(error, "strerror", None) or error
        raise ConfigError(
            f"{where}: radar.cfg = {json.dumps(given)}: should be the path of a TI .cfg ({told}), "
            f"or one of {', '.join(RADARS)}"
        ) from None


def read_on_bases(path: Path | None, given: Mapping[str, Any]) -> tuple[Document, Places]:
    """A file's document over its base's, and that one's, until one has no base.

    Args:
        path: of the file; None for an empty one.
        given: may have a `base` instead of the file's own, as seen from the current folder.
    """
    document, places = read_document(path) if path else ({}, {})
    files = [path] if path else []
    folder, who = path.parent if path else Path(), places.get(BASE, "")
    base = document.pop(BASE, None)
    if BASE in given:
        base, folder, who = given[BASE], Path(), f"--set {BASE}"
    while base is not None:
        who = f"{who}: {BASE} = {json.dumps(base)[:120]}"
        if not isinstance(base, str) or not base.endswith(SUFFIXES):
            raise ConfigError(f"{who}: should be the path of a {', '.join(SUFFIXES)} file")
        below = _plain(folder / base)
        try:
            lower, lower_places = read_document(below)
        except ConfigError as error:
            raise ConfigError(f"{who}: {error}") from None
        chain = " -> ".join(map(str, (*files, below)))
        if any(below.samefile(file) for file in files):
            raise ConfigError(f"{who}: should not lead back to a file on the way: {chain}")
        files.append(below)
        if len(files) > MAX_CHAIN:
            raise ConfigError(f"{who}: should end after {MAX_CHAIN} files: {chain}")
        folder, who = below.parent, lower_places.get(BASE, "")
        base = lower.pop(BASE, None)
        replaced: set[str] = set()
        document = _over(_with_folder(lower, folder), document, "", replaced)
        places = {k: v for k, v in lower_places.items() if replaced.isdisjoint(_ways(k))} | places
    return document, places


def _plain(path: Path) -> Path:
    """A path without "..", where links do not make that another file."""
    plain = Path(os.path.normpath(path))
    try:
        return plain if plain.samefile(path) else path
    except (OSError, ValueError):
        return path  # reported where it is read


def _over(lower: Any, own: Any, key: str, replaced: set[str]) -> Any:
    """Mappings key by key; else what is own. Notes the keys whose lower value is gone."""
    both = isinstance(lower, dict) and isinstance(own, dict)
    if not both or own.keys() & _ONE_VALUE or ("per_activity" in own) != ("per_activity" in lower):
        replaced.add(key)
        return own
    merged = dict(lower)
    for name, value in own.items():
        inner = f"{key}.{name}" if key else name
        merged[name] = _over(lower[name], value, inner, replaced) if name in lower else value
    return merged


def _ways(key: str) -> Iterator[str]:
    """A dotted key and all that it lies in."""
    return accumulate(key.split("."), lambda parent, name: f"{parent}.{name}")


def _with_folder(document: Document, folder: Path) -> Document:
    """A base whose motion files, if it names some, are relative to its own folder."""
    motion, classes = document.get("motion") or {}, document.get("classes")
    if not isinstance(motion, dict) or not isinstance(motion.get("folder", ""), str):
        return document  # a mistake, reported later
    has_files = isinstance(classes, dict) and any(
        isinstance(one, list) or (isinstance(one, dict) and "files" in one)
        for one in classes.values()
    )
    if not has_files and "folder" not in motion:
        return document
    whole = str((folder / motion.get("folder", "")).absolute())
    return {**document, "motion": {**motion, "folder": whole}}
