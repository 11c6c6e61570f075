"""Several radars of the same scenes: a document with `radars` becomes a document of each.

What stands in `radar`, and in the sections that a radar may have of its own, lies under every entry
of `radars`, as a base lies under a file. The document of a radar has one `radar`, the name of it,
and the other radars, which scenes have to fit as well.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import cos, isfinite, radians, sin
from typing import Any

from radhar_cli.config.documents import FILE_OF_CFG, ONE_VALUE, Document, Places, lay_over
from radhar_cli.config.first_level import Request
from radhar_cli.config.radar import RADARS, ArrayRadar, FmcwRadar, class_of_radar
from radhar_cli.errors import did_you_mean
from radhar_cli.schema.section import Problem

RADARS_KEY, NAME_KEY, OTHERS_KEY = "radars", "radar_name", "other_radars"
ASPECT = "aspect"
MAX_RADARS = 8
MAX_ASPECT = 1e6  # of its places, m
# What an entry of `radars` may have besides the keys of a radar.
OWN_SECTIONS = (
    *("maps", "processing", "image", "cloud", "receiver"),
    *("snr_db", "snr_reference", "engine"),
)
# What is one for all radars, of whose keys none has its name.
_OF_ALL = Request.model_fields.keys() - {RADARS_KEY, NAME_KEY, OTHERS_KEY, "radar", *OWN_SECTIONS}
_OF_ALL -= {key for radar in RADARS for key in radar.model_fields}
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,39}")
_PLACES = ("position_m", "yaw_deg", "tx_m", "rx_m")  # keys that `aspect` says
_ASPECT_KEYS = ("angle_deg", "distance_m", "about_m", "height_m")


@dataclass(frozen=True)
class RadarDocument:
    """Document of one of several radars.

    Attributes:
        name: name of the radar in `radars`.
        values: plain values of its config.
        written: content of the file: {name: entry of `radars`}, `radar` and the rest.
    """

    name: str
    values: Document
    written: Document

    def key_in_file(self, key: str) -> str:
        """Dotted key that the file has for one of this document, such as `radars.side.yaw_deg`."""
        name, first, rest = self.name, *_split(key)
        if first == OTHERS_KEY:
            name, rest = _split(rest)
            first = "radar" if rest else OTHERS_KEY
        if first not in ("radar", *OWN_SECTIONS):
            return key
        entry, inner = self._entry(name), rest if first == "radar" else key
        common = self.written.get("radar") if first == "radar" else self.written
        aspect = _aspect_of(entry, _mapping(common))
        if first == "radar" and aspect and _split(inner)[0] in _PLACES:
            inner = ASPECT
        if _holds(entry, inner) or (first == "radar" and not _holds(common, inner)):
            return ".".join(filter(None, (RADARS_KEY, name, inner)))
        return f"radar.{inner}" if first == "radar" else inner

    def known_beside(self, key: str) -> tuple[str, ...]:
        """Names, none of them a radar's key, that may stand where the file has a dotted key."""
        parent, _, _ = self.key_in_file(key).rpartition(".")
        if parent == f"{RADARS_KEY}.{self.name}":
            return (ASPECT, *OWN_SECTIONS)
        return (ASPECT,) if parent == "radar" else ()

    def places(self, places: Places) -> Places:
        """Places {dotted key: file:line} in which a .cfg is that of this radar."""
        cfg = places.get(file_of_cfg(self.name))
        return places if cfg is None else {**places, FILE_OF_CFG: cfg}

    def _entry(self, name: str) -> Mapping[str, Any]:
        return _mapping(self.written[RADARS_KEY].get(name))


def file_of_cfg(name: str) -> str:
    """Key, which none is, of the name that messages have for the .cfg of one of `radars`."""
    return f"{RADARS_KEY}.{name}.cfg:"


def key_among_radars(key: str, name: str | None) -> str:
    """Dotted key that a file of several radars has for one of the config of one of them.

    Args:
        key: dotted key of the config, such as `other_radars.side.prf_hz`.
        name: name of its radar; None of a config of one radar, which keeps its keys.
    """
    first, rest = _split(key)
    if name is None or not rest or first not in ("radar", OTHERS_KEY):
        return key
    return f"{RADARS_KEY}.{name}.{rest}" if first == "radar" else f"{RADARS_KEY}.{rest}"


def radar_names(document: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the radars of a document in the order of the alphabet; none without `radars`."""
    radars = document.get(RADARS_KEY)
    return tuple(sorted(radars)) if isinstance(radars, dict) else ()


def problems_of_radars(document: Mapping[str, Any]) -> Iterator[Problem]:
    """Find the problems of the entries of `radars` as such, and of `radar_name`."""
    radars = document.get(RADARS_KEY)
    if radars is None:
        return
    if not isinstance(radars, dict) or not radars:
        right = "should be a mapping of names: {front: {...}, side: {...}}, each with keys of radar"
        yield Problem(RADARS_KEY, radars, right)
        return
    if len(radars) > MAX_RADARS:
        yield Problem(RADARS_KEY, [*radars], f"should be {MAX_RADARS} radars at most")
    shared = document.get("radar")
    if shared is not None and not isinstance(shared, dict):
        yield Problem("radar", shared, "should be a mapping of keys")
    lowered = dict[str, str]()
    for name, entry in radars.items():
        key = f"{RADARS_KEY}.{name}"
        if not isinstance(name, str) or not _NAME.fullmatch(name) or name in ONE_VALUE:
            right = "should have a name of letters, digits, - and _, which is that of a folder, too"
            yield Problem(RADARS_KEY, name, right)
        elif (other := lowered.setdefault(name.lower(), name)) != name:
            right = f"should differ from {other} by more than capitals, as folders do"
            yield Problem(RADARS_KEY, name, right)
        if entry is not None and not isinstance(entry, dict):
            yield Problem(key, entry, "should be a mapping of keys of radar, or {}")
        else:
            yield from _misplaced_problems(key, _mapping(entry))
            yield from _aspect_problems(key, _mapping(entry), _mapping(shared))
    if OTHERS_KEY in document:
        right = "should be left out with radars, of which the others are"
        yield Problem(OTHERS_KEY, document[OTHERS_KEY], right)
    chosen = document.get(NAME_KEY)
    if chosen is not None and chosen not in radars:
        yield Problem(NAME_KEY, chosen, f"should be one of radars: {', '.join(map(str, radars))}")


def _misplaced_problems(key: str, entry: Mapping[str, Any]) -> Iterator[Problem]:
    """Find keys of an entry of `radars` that are one for all radars, or that hold a radar."""
    for name, value in entry.items():
        if name in _OF_ALL:
            right = f"is one for all radars; should stand beside {RADARS_KEY}, not in it"
            yield Problem(f"{key}.{name}", value, right)
        elif name in ("radar", RADARS_KEY):
            right = f"should be left out: keys of a radar stand in {key} itself"
            yield Problem(f"{key}.{name}", value, right)


def _aspect_problems(
    key: str, entry: Mapping[str, Any], shared: Mapping[str, Any]
) -> Iterator[Problem]:
    """Find the problems of the place where `aspect` puts a radar."""
    written, common = entry.get(ASPECT), shared.get(ASPECT)
    for value, where in ((written, f"{key}.{ASPECT}"), (common, f"radar.{ASPECT}")):
        if value is not None and not isinstance(value, dict):
            right = "should be {angle_deg: 90, distance_m: 3, about_m: [3, 0]}"
            yield Problem(where, value, right)
            return
    aspect = _aspect_of(entry, shared)
    if aspect is None:
        return
    for name, value in aspect.items():
        where = f"{key}.{ASPECT}.{name}" if name in _mapping(written) else f"radar.{ASPECT}.{name}"
        if name not in _ASPECT_KEYS:
            near = did_you_mean(str(name), _ASPECT_KEYS, f"known here: {', '.join(_ASPECT_KEYS)}")
            yield Problem(where, value, f"is an unknown key; {near}")
        elif name == "about_m":
            pair = isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))
            if not pair or max(map(abs, value)) > MAX_ASPECT:
                yield Problem(where, value, "should be [range, cross-range] of a place, m")
        elif name == "angle_deg" and _is_number(value) and abs(value) > 360:
            yield Problem(where, value, "should be from -360 to 360 degrees")
        elif _is_number(value) and abs(value) > MAX_ASPECT:
            yield Problem(where, value, f"should be at most {MAX_ASPECT:.0e} in size")
        elif not _is_number(value) or (name == "distance_m" and value <= 0):
            above = " above 0" * (name == "distance_m")
            yield Problem(where, value, f"should be a number{above}, one for all scenes")
    missing = [name for name in _ASPECT_KEYS[:3] if name not in aspect]
    if missing and aspect.keys() <= {*_ASPECT_KEYS}:  # or one of them is written otherwise
        yield Problem(f"{key}.{ASPECT}", aspect, f"should have {', '.join(missing)}, too")
    for name in _PLACES:
        if name in entry:
            right = f"should be left out with {ASPECT}, which says where the radar is"
            yield Problem(f"{key}.{name}", entry[name], right)
    beam = lay_over(_mapping(shared.get("beam")), _mapping(entry.get("beam")))
    if not _is_number(pan := beam.get("pan_deg", 0.0)):
        yield Problem(f"{key}.beam.pan_deg", pan, f"should be a number with {ASPECT}")


def _aspect_of(entry: Mapping[str, Any], shared: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Return an entry's aspect over that of all radars; None without one, or where it is null."""
    if entry.get(ASPECT, shared.get(ASPECT)) is None:
        return None
    return {**_mapping(shared.get(ASPECT)), **_mapping(entry.get(ASPECT))}


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def documents_of_radars(document: Document) -> dict[str, RadarDocument]:
    """Make the document of each radar of one that has `radars` without problems.

    Args:
        document: plain values of a file over its bases, with all overrides.

    Returns:
        {name: document}, in the order of the alphabet.
    """
    names, radars = radar_names(document), document[RADARS_KEY]
    alone = {k: v for k, v in document.items() if k not in (RADARS_KEY, NAME_KEY, "radar")}
    sections = {name: _mapping(radars[name]) for name in names}
    full = {name: _radar_of(document.get("radar"), sections[name]) for name in names}
    documents = dict[str, RadarDocument]()
    for name in names:
        entry = {key: sections[name][key] for key in OWN_SECTIONS if key in sections[name]}
        values: Document = lay_over(alone, entry)
        others = {other: full[other] for other in names if other != name}
        values |= {"radar": full[name], NAME_KEY: name, OTHERS_KEY: others}
        documents[name] = RadarDocument(name, values, document)
    return documents


def _radar_of(shared: Any, entry: Mapping[str, Any]) -> Document:
    """Keys of a radar: those of an entry over those that all radars have, with its place."""
    keys = {key: value for key, value in entry.items() if key not in OWN_SECTIONS}
    radar: Document = lay_over(_mapping(shared), keys)
    aspect = radar.pop(ASPECT, None)
    return radar | _pose_of(aspect, radar) if aspect else radar


def _pose_of(aspect: Mapping[str, Any], radar: Mapping[str, Any]) -> Document:
    """Keys by which a radar looks at a place from a distance, along a direction.

    Antennas that have places of their own keep their heights and their distance, and turn about
    their middle.

    Args:
        aspect: `angle_deg`, the direction in which it looks, from the x axis to the left;
            `distance_m`; `about_m`, range and cross-range of the place; maybe `height_m`.
        radar: the other keys of the radar.
    """
    angle, distance = radians(aspect["angle_deg"]), aspect["distance_m"]
    x = aspect["about_m"][0] - distance * cos(angle)
    y = aspect["about_m"][1] - distance * sin(angle)
    kind = class_of_radar(radar) or FmcwRadar
    is_array = issubclass(kind, ArrayRadar) and radar.get("tx_m") is None
    height = aspect.get("height_m")
    if is_array:
        z = height if height is not None else _coordinate(radar, "position_m", 2, 1.0)
        return {"position_m": [x, y, z], "yaw_deg": aspect["angle_deg"]}
    tx, rx = (
        [_coordinate(radar, key, axis, usual[axis]) for axis in range(3)]
        for key, usual in (("tx_m", (0.4, -0.1, 1.5)), ("rx_m", (0.4, 0.1, 1.5)))
    )
    half = [(b - a) / 2 for a, b in zip(tx, rx, strict=True)]
    along = half[0] * cos(angle) - half[1] * sin(angle)
    across = half[0] * sin(angle) + half[1] * cos(angle)
    lift = 0.0 if height is None else height - (tx[2] + rx[2]) / 2
    pose: Document = {
        "tx_m": [x - along, y - across, tx[2] + lift],
        "rx_m": [x + along, y + across, rx[2] + lift],
    }
    if isinstance(beam := radar.get("beam"), dict):
        pose["beam"] = {**beam, "pan_deg": beam.get("pan_deg", 0.0) + aspect["angle_deg"]}
    if issubclass(kind, ArrayRadar):
        pose["yaw_deg"] = aspect["angle_deg"]
    return pose


def _coordinate(radar: Mapping[str, Any], key: str, axis: int, usual: float) -> Any:
    """A coordinate that a radar has under a key; the usual one where it is no plain number."""
    place = radar.get(key)
    value = place[axis] if isinstance(place, list) and len(place) == 3 else usual
    return value if _is_number(value) else usual


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _split(key: str) -> tuple[str, str]:
    """First name of a dotted key, and the names after it."""
    first, _, rest = key.partition(".")
    return first, rest


def _holds(value: Any, key: str) -> bool:
    """Whether plain values have a dotted key."""
    for name in key.split("."):
        if not isinstance(value, dict) or name not in value:
            return isinstance(value, list) and name.isdigit()
        value = value[name]
    return True
