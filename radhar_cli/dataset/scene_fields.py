"""The drawn numbers of a scene as columns: SI for dataset.h5, config units for scenes.csv.

A column is named after the last part of its key, without the unit: `motion.walking.speed_mps` is
`speed`.
Where two keys of a config end alike, or a table has a column of that name already, the section
stands before it: `radar_dwell` and `motion_dwell`. Should these be alike too, the names are the
keys themselves, which are unique and hold a dot, which no other name does.
"""

from collections import Counter
from collections.abc import Sequence
from math import degrees, nan, pi
from typing import NamedTuple

import numpy as np

from radhar_cli.config.data_set import AnyConfig, Config, MeasuredConfig
from radhar_cli.config.motion import EARLIER_KEYS, FALL
from radhar_cli.config.paths import numbers
from radhar_cli.config.room import FacesConfig
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.motion import aspect_at_middle, moving
from radhar_cli.scene.scene import Scene, file_keys, keys_of_people, number_at

_UNITS = {name: name for name in ("m", "s", "kg")} | {"hz": "Hz", "mps": "m/s", "deg": "rad"}
_UNITS |= {"db": "dB", "dbi": "dBi", "dbsm": "dBsm"}


class Field(NamedTuple):
    """A column: config key (its name in scenes.csv), name in dataset.h5, SI unit, factor to it."""

    key: str
    name: str
    unit: str
    factor: float


# Columns of the tables of samples that are no numbers of a scene.
TAKEN = frozenset(("subject", "index", "label", "labels", "image"))
# Sections whose columns are named after them.
PREFIXES = {"wall": "wall", "image.cfar": "cfar", "radar.beam": "beam", "room.box_m": "room"}
PREFIXES |= {f"room.faces.{name}": name for name in FacesConfig.model_fields}
# And those of lists, with the number in the list.
LISTS = {"room.reflectors": "reflector", "receiver.tones": "tone", "wall.layers": "layer"}
# Lists of places, whose axes are (left, up).
PLACES = {"radar.array.tx": "array_tx", "radar.array.rx": "array_rx"}
# When that begins which the class is named by: follows from timing.onset and what the person does.
ONSET = Field("movement_onset_s", "movement_onset", "s", 1.0)
# Aspect of the sample's main person to one of several radars, in the middle of the recording.
ASPECT = Field("aspect_deg", "aspect", "rad", pi / 180)
# The one number of a scene that is measured, not drawn.
ERROR = Field("error_db", "error_db", "dB", 1.0)


# Of a window of a recording: which part of the manifest, from when on, how sure the track is.
RECORDED = (
    Field("recordings.part", "part", "1", 1.0),
    Field("recordings.start_s", "start", "s", 1.0),
    Field("recordings.confidence", "confidence", "1", 1.0),
)


def fields(config: AnyConfig) -> tuple[Field, ...]:
    """List every number that any scene of a config depends on, in the order of the schema.

    Then comes when the movement begins, and last the measured error of the direct engine, where
    there are such.
    """
    if isinstance(config, MeasuredConfig):
        return RECORDED
    every, chosen = [key for key, _ in numbers(config)], config.chosen_activities
    every += [FALL, *file_keys(config)]
    keys = [key for key in every if any(config.depends_on(activity, key) for activity in chosen)]
    if "subject.weight_kg" not in keys:
        keys.insert(keys.index("subject.height_m") + 1, "subject.weight_kg")
    keys += keys_of_people(config)
    onset = (ONSET,) if "timing.onset" in keys else ()
    measured = (ERROR,) if config.has_error else ()
    aspects = _aspects(config)
    return (*_make_names_unique([_field(key) for key in keys]), *aspects, *onset, *measured)


def _aspects(config: Config) -> tuple[Field, ...]:
    """Columns of the aspects of everybody to one of several radars; none with a radar alone."""
    if config.radar_name is None:
        return ()
    others = [
        ASPECT._replace(key=f"people.{n}.{ASPECT.key}", name=f"people_{n + 1}_{ASPECT.name}")
        for n in range(len(config.people))
    ]
    return (ASPECT, *others)


def values(scene: Scene, columns: tuple[Field, ...], error_db: float = nan) -> Float:
    """Numbers of a scene in the units of the config keys [field], NaN where one does not apply.

    Args:
        columns: the fields.
        error_db: measured error of the direct engine, for the field ERROR.
    """
    known = {ERROR.key: error_db}
    if scene.config.radar_name is not None and ASPECT in columns:
        known |= dict.fromkeys((field.key for field in _aspects(scene.config)), nan)
        for person in scene.present:
            key = f"{f'people.{person.number - 1}.' if person.number else ''}{ASPECT.key}"
            known[key] = degrees(aspect_at_middle(scene, person))
    if ONSET in columns:
        known[ONSET.key] = movement_onset(scene)
    return np.array([known[f.key] if f.key in known else number_at(scene, f.key) for f in columns])


def movement_onset(scene: Scene) -> float:
    """Return the time at which the movement begins that names a scene's class, s; or NaN.

    It is below 0 where the movement is under way as the recording begins.
    """
    onset = getattr(moving(scene.people[0]), "onset", None)
    return nan if onset is None else float(onset)


def _make_names_unique(columns: list[Field]) -> list[Field]:
    """Give longer names to columns whose names are taken or alike; return all columns."""
    for longer in (_name_with_section, lambda field: field.key):
        counts = Counter(
            [ERROR.name, ONSET.name, ASPECT.name, *TAKEN, *(field.name for field in columns)]
        )
        columns = [
            field._replace(name=longer(field)) if counts[field.name] > 1 else field
            for field in columns
        ]
    return columns


def _name_with_section(field: Field) -> str:
    """The name of a column with the section of its key before it."""
    prefix, key = "", field.key
    if key.startswith("people."):
        _, number, key = key.split(".", 2)
        prefix = f"people_{int(number) + 1}_"
    return f"{prefix}{key.partition('.')[0]}_{field.name.removeprefix(prefix)}"


def _field(key: str) -> Field:
    """Make the column of a config key."""
    if key.startswith("people."):
        field_of_person = _field(key.split(".", 2)[2])
        name = f"people_{int(key.split('.')[1]) + 1}_{field_of_person.name}"
        return field_of_person._replace(key=key, name=name)
    if key.startswith("classes."):
        _, slug, name, *place = key.split(".")
        if not place:  # of files
            return Field(key, f"{slug}_{name}", "1", 1.0)
        return Field(key, f"{slug}_{name.removesuffix('s_s')}_{place[0]}", "s", 1.0)
    path = EARLIER_KEYS.get(key, key)  # by which columns are named
    path, _, axis = path.rpartition(".") if path[-1].isdigit() else (path, "", "")
    section, _, name = path.rpartition(".")
    stem, _, suffix = name.rpartition("_")
    unit = _UNITS.get(suffix, "1")
    stem = stem if suffix in _UNITS else name
    listed, _, number = section.rpartition(".")
    ends: Sequence[str] = "xyz"
    if listed in LISTS:
        stem = f"{LISTS[listed]}_{number}_{stem}"
    if section in PLACES:
        stem, ends = f"{PLACES[section]}_{name}", ("left", "up")
    if section == "room.box_m":
        ends, unit = ("from", "to"), "m"
    parts = (PREFIXES.get(section), stem, ends[int(axis)] if axis else None)
    return Field(key, "_".join(filter(None, parts)), unit, pi / 180 if unit == "rad" else 1.0)
