"""YAML files as documents: the keys of a file lie over the file that its `base` names."""

import json
import os
import re
from collections.abc import Iterator, Mapping
from copy import deepcopy
from functools import lru_cache
from itertools import accumulate
from pathlib import Path
from typing import Any, TypeAlias

from radhar_cli.config.motion import EARLIER_KEYS
from radhar_cli.config.yaml_reader import MAX_TEXT, parse_yaml
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.files.untrusted import read_text, text_of
from radhar_cli.radar.board import plain_name
from radhar_cli.schema.number import FORMS

Document: TypeAlias = dict[str, Any]
Places: TypeAlias = dict[str, str]  # {dotted key: file:line}
Source: TypeAlias = Path | Mapping[str, Any] | None  # a file, the plain values of one, or nothing

BASE = "base"
FILE_OF_CFG = "radar.cfg:"  # key, which none is, of the name that messages have for a .cfg
SUFFIXES = (".yaml", ".yml", ".json")
RADARS = {
    path.stem: path
    for path in sorted(
        Path(__file__).with_name("radars").glob("*.cfg"),
        key=lambda path: (path.stem.startswith("awr"), path.stem),
    )
}
SHIPPED = Path(__file__).with_name("presets")  # in a clone a link to configs/, in a wheel its files
PRESETS = {
    path.relative_to(SHIPPED).with_suffix("").as_posix(): path
    for path in sorted(SHIPPED.rglob("*.yaml"))
}
WRITTEN_RADARS = tuple(  # radars that are no TI board: their frames stand in a preset
    name.removeprefix("boards/")
    for name in PRESETS
    if name.startswith("boards/") and "iwr" not in name
)
# Keys as folders and options have them, and as earlier versions had them.
OTHER_NAMES = {
    "split.val": "split.validation",
    **{earlier: key for key, earlier in EARLIER_KEYS.items()},
}
MAX_CHAIN = 8  # files in a chain of bases
ONE_VALUE = {*FORMS, "sequence", "files"}  # mappings with such a key are replaced as a whole


def read_document(path: Path) -> tuple[Document, Places]:
    """Read a file of keys and values, without its base.

    Returns:
        The document, in which `radar.cfg` is the text of the .cfg, and {dotted key: file:line}.

    Raises:
        ConfigError: the file cannot be read, is not YAML, or holds no mapping.
    """
    document, lines = parse_yaml(text_of(path, MAX_TEXT, ConfigError), str(path))
    document = {} if document is None else document
    if not isinstance(document, dict):
        raise ConfigError(f"{path}: should be a mapping of keys such as 'seed: 1'")
    places = {key: f"{path}:{line}" for key, line in lines.items()}
    _fill_in(document, places, path.parent, str(path))
    return document, places


def _fill_in(document: Document, places: Places, folder: Path, where: str) -> None:
    """Give keys their present names, and each `radar.cfg` the text of its file.

    Args:
        document: keys and values, changed in place.
        places: {dotted key: file:line}, changed in place.
        folder: folder from which files are named.
        where: name of the document in messages.
    """
    _rename_keys(document, "", places)
    people = document.get("people")
    for number, person in enumerate(people if isinstance(people, list) else ()):
        _rename_keys(person, f"people.{number}.", places)
    radar, radars = document.get("radar"), document.get("radars")
    written = {f"radars.{k}": one for k, one in radars.items()} if isinstance(radars, dict) else {}
    for key, value in {"radar": radar, **written}.items():
        if isinstance(value, dict) and "cfg" in value:
            places[f"{key}.cfg:"] = name_of_cfg(value["cfg"])
            value["cfg"] = cfg_text(value["cfg"], folder, places.get(f"{key}.cfg", where))


def find_preset(path: str) -> str | None:
    """Find the preset that a path names: as documents do, by its name, or by its last part."""
    name = path.removeprefix("configs/").removesuffix(".yaml")
    if name in PRESETS:
        return name
    return next((preset for preset in PRESETS if preset.rpartition("/")[2] == path), None)


def find_config(path: Path) -> Path:
    """Path of a config: of the file itself, or of a config that radhar comes with.

    The latter has a name, as `human/room` or `room`, or stands in the documentation as
    `configs/human/room.yaml`. A name with a suffix alone, as `room.yaml`, is that of a file.

    Raises:
        ConfigError: there is no such file, but a config of radhar has a name like it.
    """
    name = path.as_posix()
    if path.exists() or (path.suffix and not name.startswith("configs/")):
        return path
    preset = find_preset(name)
    if preset is None and not path.suffix and (close := did_you_mean(name, PRESETS, "")):
        raise ConfigError(f"{path}: no such file, and no config of radhar; {close}")
    return path if preset is None else PRESETS[preset]


def _rename_keys(section: Any, prefix: str, places: Places) -> None:
    """Give the keys of OTHER_NAMES their own names, unless those have values, too.

    Args:
        section: A document, or one of its people; changed in place.
        prefix: Beginning of its keys in `places`.
        places: {dotted key: file:line}, changed in place.
    """
    for other, key in OTHER_NAMES.items():
        *parents, name = key.split(".")
        short, holder = other.rpartition(".")[2], parents[0]
        place = section.get(holder) if isinstance(section, dict) else None
        if not isinstance(place, dict) or short not in place:
            continue
        inner = place.setdefault(parents[1], {}) if parents[1:] else place
        if not isinstance(inner, dict) or name in inner:
            continue  # which the reader refuses
        inner[name] = place.pop(short)
        for known in [known for known in places if _is_below(known, prefix + other)]:
            places[prefix + key + known.removeprefix(prefix + other)] = places.pop(known)


def _is_below(key: str, parent: str) -> bool:
    """Whether a dotted key is another one, or lies in it."""
    return key == parent or key.startswith(f"{parent}.")


def cfg_text(value: Any, folder: Path, where: str) -> Any:
    """Read the text of a .cfg.

    Args:
        value: name of a radar in RADARS, path of a .cfg, or its text, which is returned as it is.
        folder: folder from which a path is seen.
        where: file and line, or option, that a message names.

    Raises:
        ConfigError: there is no such file, or it cannot be read as text.
    """
    if not isinstance(value, str) or "\n" in value.strip():
        return value
    try:
        return read_text(RADARS.get(name_of_radar(value) or "", folder / value), MAX_TEXT)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        if where == "--radar":
            raise ConfigError(
                f"--radar {json.dumps(value)}: should be the path of a TI .cfg ({reason}), or one "
                f"of {', '.join((*RADARS, *WRITTEN_RADARS))}; any other radar is a short config by "
                "its data sheet (docs/guide/frames.md, docs/guide/impulse.md)"
            ) from None
        named = advice_on_radars(value)
        advice = f"; {named}" if named else f", or one of {', '.join(RADARS)}"
        raise ConfigError(
            f"{where}: radar.cfg = {json.dumps(value)}: should be the path of a TI .cfg "
            f"({reason}){advice}"
        ) from None


def name_of_cfg(value: Any) -> str:
    """Name the .cfg that a value of `radar.cfg` stands for: a path as it is written, or the key."""
    is_path = isinstance(value, str) and "\n" not in value.strip()
    return value if is_path and name_of_radar(value) is None else "radar.cfg"


def name_of_radar(value: str) -> str | None:
    """Name of the built-in radar that a text stands for; None for none.

    Capitals, hyphens, BOOST, EVM and AWR for IWR do not matter. A device's name alone, and its name
    with _clouds, stand for the same profile unless it has one of each name.
    """
    return _names_of_radars().get(plain_name(value))


def name_of_written(value: str) -> str | None:
    """Name of the radar of WRITTEN_RADARS that a text stands for; None for none.

    Capitals, spaces, hyphens, underscores and makers do not matter, nor the end of a name that one
    radar alone begins with: K-LC6, EV-TINYRAD24G, Infineon BGT60, X4.
    """
    plain = re.sub(r"[-_ ]", "", value.lower()).removeprefix("ev")
    for maker in ("xethru", "novelda", "infineon", "acconeer", "rfbeam"):
        plain = plain.removeprefix(maker)
    names = {name.replace("_", ""): name for name in WRITTEN_RADARS}
    alike = [name for other, name in names.items() if plain[1:] and other.startswith(plain)]
    return names.get(plain) or (alike[0] if len(alike) == 1 else None)


def advice_on_radars(value: object) -> str:
    """Advise on names of built-in radars that stand where their keys should.

    Args:
        value: that of a key of a radar: a name, a list of names, or mappings that hold names.

    Returns:
        The command that writes the config of each, whose `radar:` is to be copied; "" where the
        value names none. A name has a digit, since words of waveforms begin names, too.
    """
    if isinstance(value, (list, dict)):
        values = [*value.values()] if isinstance(value, dict) else value
        return "; ".join(dict.fromkeys(filter(None, map(advice_on_radars, values))))
    if not isinstance(value, str) or not re.search(r"[a-z][-_ ]?\d", value, re.IGNORECASE):
        return ""
    if (name := name_of_written(value) or name_of_radar(value)) is None:
        return ""
    return f"`radhar config init FILE --radar {name}` writes the `radar:` of {name} to copy"


@lru_cache(maxsize=1)
def _names_of_radars() -> dict[str, str]:
    """Names of the built-in radars by their plain names (`plain_name`)."""
    names = {plain_name(name): name for name in RADARS}
    for name in RADARS:
        device, _, kind = name.partition("_")
        if kind in ("", "clouds"):
            names.setdefault(plain_name(device), name)
            names.setdefault(plain_name(f"{device}_clouds"), name)
    return names


def read_on_bases(source: Source, overrides: Mapping[str, Any]) -> tuple[Document, Places]:
    """Read a file and lay it over its base, and that one over its own, until one has no base.

    Args:
        source: YAML file, or the name of a config that radhar comes with, or the plain values of
            one, whose files are named from the current folder; None for an empty one.
        overrides: document that may have a `base` instead of the file's own, as seen from the
            current folder.

    Returns:
        The document, without `base`, and {dotted key: file:line}.

    Raises:
        ConfigError: a file cannot be read, or bases lead back to one of them; names the chain.
    """
    files, folder = list[Path](), Path()
    if isinstance(source, Path):
        path = find_config(source)
        document, places = read_document(path)
        files, folder = [path], path.parent
    else:
        document, places = deepcopy(dict(source or {})), {}
        _fill_in(document, places, folder, "config")
    referred_from = places.get(BASE, "")
    base = document.pop(BASE, None)
    if BASE in overrides:
        base, folder, referred_from = overrides[BASE], Path(), f"--set {BASE}"
    while base is not None:
        referred_from = f"{referred_from}: {BASE} = {json.dumps(base)[:120]}"
        if not isinstance(base, str) or not (base.endswith(SUFFIXES) or base in PRESETS):
            close = did_you_mean(str(base), PRESETS, "") if isinstance(base, str) else ""
            advice = f"; {named}" if (named := advice_on_radars(base) or close) else ""
            raise ConfigError(
                f"{referred_from}: should be the path of a {', '.join(SUFFIXES)} file, or a name "
                f"that `radhar config list` has{advice}"
            )
        base_path = PRESETS[base] if base in PRESETS else _plain(folder / base)
        try:
            base_document, lower_places = read_document(base_path)
        except ConfigError as error:
            raise ConfigError(f"{referred_from}: {error}") from None
        chain = " -> ".join(map(str, (*files, base_path)))
        if any(base_path.samefile(file) for file in files):
            raise ConfigError(
                f"{referred_from}: should not lead back to a file on the way: {chain}"
            )
        files.append(base_path)
        if len(files) > MAX_CHAIN:
            raise ConfigError(f"{referred_from}: should end after {MAX_CHAIN} files: {chain}")
        folder, referred_from = base_path.parent, lower_places.get(BASE, "")
        base = base_document.pop(BASE, None)
        replaced: set[str] = set()
        document = _over(_with_folder(base_document, folder), document, "", replaced)
        places = {k: v for k, v in lower_places.items() if replaced.isdisjoint(_ways(k))} | places
    return document, places


def _plain(path: Path) -> Path:
    """A path without "..", where links do not make that another file."""
    plain = Path(os.path.normpath(path))
    try:
        return plain if plain.samefile(path) else path
    except (OSError, ValueError):
        return path  # reported where it is read


def _over(lower: Any, upper: Any, key: str, replaced: set[str]) -> Any:
    """Lay a value over that of a base: mappings key by key, anything else as a whole.

    Args:
        lower: value in the base.
        upper: value in the file over it.
        key: dotted key of both.
        replaced: keys whose lower value is gone are added to it.
    """
    both = isinstance(lower, dict) and isinstance(upper, dict)
    if (
        not both
        or upper.keys() & ONE_VALUE
        or ("per_activity" in upper) != ("per_activity" in lower)
    ):
        replaced.add(key)
        return upper
    merged = dict(lower)
    for name, value in upper.items():
        inner = f"{key}.{name}" if key else name
        merged[name] = _over(lower[name], value, inner, replaced) if name in lower else value
    return merged


def lay_over(lower: Mapping[str, Any], upper: Mapping[str, Any]) -> Document:
    """Lay a document over another, as a file lies over its base."""
    merged: Document = _over(dict(lower), dict(upper), "", set())
    return merged


def _ways(key: str) -> Iterator[str]:
    """Dotted keys of the sections around a key, the outermost first, and the key itself."""
    return accumulate(key.split("."), lambda parent, name: f"{parent}.{name}")


def _with_folder(document: Document, folder: Path) -> Document:
    """Make the motion files of a base, if it names some, relative to the base's own folder."""
    motion, classes = document.get("motion") or {}, document.get("classes")
    if not isinstance(motion, dict) or not isinstance(motion.get("folder", ""), str):
        return document  # a mistake, reported later
    has_files = isinstance(classes, dict) and any(
        isinstance(one, list) or (isinstance(one, dict) and "files" in one)
        for one in classes.values()
    )
    if not has_files and "folder" not in motion:
        return document
    absolute = str((folder / motion.get("folder", "")).absolute())
    return {**document, "motion": {**motion, "folder": absolute}}
