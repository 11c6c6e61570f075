"""Write the tables of config keys into docs/reference, out of the schema.

    python scripts/config_tables.py

A table stands between `<!-- keys: SECTIONS -->`, `<!-- limits -->` or `<!-- tasks -->` and
`<!-- end -->`; `-` is what lies in no section. What stands around them is written by hand.
"""

import inspect
import re
from collections.abc import Collection, Iterator
from functools import partial
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from page_parts import replace_part
from pydantic import BaseModel

from radhar_cli.config.checks.people import HUMAN_LIMITS
from radhar_cli.config.data_set import Config
from radhar_cli.config.starting_file import as_text
from radhar_cli.motion.movements.catalogue import users_of
from radhar_cli.motion.movements.exercises import EXERCISES
from radhar_cli.schema.annotations import (
    ByModel,
    Mark,
    Paper,
    People,
    annotations,
    section,
    sections,
)
from radhar_cli.schema.number import MAX_NUMBER, Bounds, Choice, Normal, Uniform, Vary
from radhar_cli.schema.section import PerActivity, Section

REFERENCE = Path(__file__).resolve().parents[1] / "docs/reference"
PAGES = ("config.md", "config_signal.md", "limits.md")
MARKER = re.compile(r"<!-- (keys: [^>]*|limits|tasks) -->")
# Tasks, the keys that they take, and the page that tells of them.
TASKS = {
    "choose the classes": ("activities classes samples_per_class", "guide/motion"),
    "describe my radar": (
        "radar.carrier_hz radar.bandwidth_hz radar.prf_hz radar.tx_m",
        "guide/frames",
    ),
    "simulate my TI board": ("radar.cfg radar.device cloud.chain", "guide/boards"),
    "have several radars": ("radars", "guide/several_radars"),
    "say who people are": ("subject.height_m body.scatterers", "guide/motion"),
    "place people": (
        "motion.place.range_m motion.place.cross_range_m motion.angle_deg",
        "guide/motion",
    ),
    "say how long, and when they begin": ("duration_s timing.onset timing.visible", "guide/motion"),
    "have minutes of one thing after the other": ("stream.count stream.bout_s", "guide/streams"),
    "use my motion capture": ("classes motion.folder", "guide/motion_files"),
    "add other people, a room, a wall": (
        "people room.faces wall.size_m wall.eps_r",
        "guide/scenes",
    ),
    "set the noise": ("snr_db receiver.noise_figure_db", "results/noise"),
    "choose maps and images": ("maps image.size_px image.dynamic_range_db", "results/gallery"),
    "choose the transform": ("processing.window_s processing.overlap_fraction", "physics/model"),
    "keep persons apart in the split": ("split.by split.subjects split.test", "guide/training"),
    "cut recordings of a real radar": ("recordings.window_s recordings.hop_s", "guide/measured"),
    "save time or files": ("engine.tolerance_db output.png", "results/tradeoff"),
}


def fill_tables(page: str) -> str:
    """Return a page with its tables as the schema has them."""
    for marker in MARKER.finditer(page):
        kind, _, names = marker[1].partition(": ")
        rows = {"limits": _limits, "tasks": _tasks}.get(kind) or partial(_keys, names.split())
        table = "\n".join(rows())
        page = replace_part(page, marker[1], table, marker[0], "<!-- end -->")
    return page


def _keys(names: list[str]) -> Iterator[str]:
    """Rows of some sections of Config; `-` is what lies in no section."""
    yield "| key | default | meaning |"
    yield "| --- | --- | --- |"
    for name in names:
        if name == "-":
            yield from _rows(Config, "")
            continue
        kinds = sections(Config.model_fields[name])
        for number, kind in enumerate(kinds):
            assert issubclass(kind, Section)
            if len(kinds) == 1:
                yield from _rows(kind, f"{name}.")
            else:
                yield from _rows_of_alternative(kind, kinds[:number], name)


def _rows_of_alternative(
    kind: type[Section], earlier: tuple[type[BaseModel], ...], name: str
) -> Iterator[str]:
    """Rows of one of several sections that a key may hold: a heading, and keys not yet there."""
    documented = {key for other in earlier for key in other.model_fields} - {"waveform"}
    inherited = [key for key in kind.model_fields if key in documented]
    text = " ".join((inspect.getdoc(kind) or "").partition("\n\n")[0].split())
    also = f" As above: {', '.join(f'`{key}`' for key in inherited)}." if inherited else ""
    yield f"| **{getattr(kind, 'named', name)}** |  | {text}{also} |"
    yield from _rows(kind, f"{name}.", documented)


def _rows(kind: type[Section], prefix: str, left_out: Collection[str] = ()) -> Iterator[str]:
    texts, about = kind.descriptions(), annotations(kind)
    for name, field in kind.model_fields.items():
        if name in left_out:
            continue
        inner, many = section(field), get_origin(field.annotation) is tuple
        if inner is None or many:
            words = " ".join(texts.get(name, "").split())
            parts = _choices(field.annotation), words, _users(prefix + name, about[name])
            meaning = " ".join(filter(None, parts))
            default = "" if field.is_required() else _default(field.default, about[name])
            yield f"| `{prefix}{name}` | {default} | {meaning} |"
        if inner is not None and prefix and inner.descriptions():
            yield from _rows(inner, f"{prefix}{name}.{'N.' if many else ''}")


def _choices(kind: Any) -> str:
    literals = [k for k in (kind, *get_args(kind)) if get_origin(k) is Literal]
    found = [f"`{one}`" for k in literals for one in get_args(k)]
    return ", ".join(found) + "." if len(found) > 1 and get_origin(kind) is not tuple else ""


def _users(key: str, about: tuple[Any, ...]) -> str:
    """Whether it is a number that may be drawn, who uses it, and how it is drawn, in brackets."""
    number = ["number"] if any(isinstance(one, Bounds) for one in about) else []
    used = [
        f"{type(one).__name__.lower()}: {', '.join(_names(key, one)) or 'all'}"
        for one in about
        if isinstance(one, People | Paper)
    ]
    marks = [one.value for one in about if isinstance(one, Mark)]
    words = "; ".join((*number, *used, *marks))
    return words and f"({words})"


def _names(key: str, users: People | Paper) -> Iterator[str]:
    """Movements and labels that use a key; exercises together."""
    names = users_of(key, users) if isinstance(users, People) else users.names.split()
    exercises = {"exercises"} if {*EXERCISES} <= {*names} else set[str]()
    yield from (name for name in names if not exercises or name not in EXERCISES)
    yield from exercises


def _default(value: Any, about: tuple[Any, ...]) -> str:
    values = next((one.values for one in about if isinstance(one, ByModel)), None)
    if values is None:
        return _shown(value)
    return _grouped(values)


def _grouped(values: dict[str, Any]) -> str:
    names = dict[str, list[str]]()
    for name, value in values.items():
        names.setdefault(_shown(value), []).append(name)
    return "; ".join(f"{', '.join(some)}: {value}" for value, some in names.items())


def _shown(value: Any) -> str:
    match value:
        case PerActivity():
            return f"({_grouped(value.per_activity)})"
        case Uniform():
            return "uniform {} to {}".format(*map(as_text, value.uniform))
        case Normal():
            mean, sd, low, high = map(as_text, (*value.normal, *value.support))
            return f"normal {mean} +- {sd}, {low} to {high}"
        case Vary():
            return f"{as_text(value.vary[0])} +-{100 * value.vary[1]:g} %"
        case Choice():
            if value.weights is None:
                return " or ".join(map(_shown, value.choice))
            total = sum(value.weights)
            shares = zip(map(_shown, value.choice), value.weights, strict=True)
            return " or ".join(f"{one} ({weight / total:.0%})" for one, weight in shares)
        case tuple() | list():
            return f"[{', '.join(map(_shown, value))}]"
        case BaseModel():
            return as_text(value.model_dump())
    return as_text(value)


def _tasks() -> Iterator[str]:
    """Rows of tasks; a key that the schema does not have is a mistake of TASKS."""
    yield "| to | set | read |"
    yield "| --- | --- | --- |"
    known = {*annotations(Config), *Config.model_fields}
    for task, (keys, page) in TASKS.items():
        missing = {*keys.split()} - known
        if missing:
            raise ValueError(f"keys of {task!r} that the schema does not have: {missing}")
        written = ", ".join(f"`{key}`" for key in keys.split())
        yield f"| {task} | {written} | [{Path(page).name.replace('_', ' ')}](../{page}.md) |"


def _limits() -> Iterator[str]:
    yield "| key | from .. to | people: from .. to |"
    yield "| --- | --- | --- |"
    for key, about in annotations(Config).items():
        limits, human = _range(about), HUMAN_LIMITS.get(key)
        if limits or human:
            yield f"| `{key}` | {limits} | {'{:g} to {:g}'.format(*human) if human else ''} |"


def _range(about: tuple[Any, ...]) -> str:
    """The tightest bounds of a key, in its unit."""
    bounds = [one for one in about if isinstance(one, Bounds)]
    if bounds:
        low, high = max(one.low for one in bounds), min(one.high for one in bounds)
        unit = next((f" {one.unit}" for one in reversed(bounds) if one.unit), "")
        return f"{low:g} to {high:g}{unit}" if high < MAX_NUMBER else f"{low:g} or more"
    words = dict[str, None]()
    for one in about:
        match one:
            case Gt():
                words[f"above {one.gt:g}"] = None
            case Ge():
                words[f"{one.ge:g}"] = None
            case Lt():
                words[f"to below {one.lt:g}"] = None
            case Le():
                words[f"to {one.le:g}"] = None
    return " ".join(words) + (" or more" if len(words) == 1 else "")


def main() -> None:
    """Write the pages."""
    for page in map(REFERENCE.joinpath, PAGES):
        page.write_text(fill_tables(page.read_text()))


if __name__ == "__main__":
    main()
