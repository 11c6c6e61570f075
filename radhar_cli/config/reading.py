"""Read a YAML config, apply ``--set`` overrides, and say clearly what is wrong with it."""

import difflib
import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from radhar_cli.config.checks import Problem
from radhar_cli.config.schema import Config, Section
from radhar_cli.errors import ConfigError

S = TypeVar("S", bound=Section)

_UNION_TAGS = {"number", "uniform", "normal", "choice", "vary", "same", "per_activity"}
_INT = re.compile(r"^[-+]?(?:0|[1-9][0-9_]*)$")
_FLOAT = re.compile(
    r"^[-+]?(?:[0-9][0-9_]*\.[0-9_]*(?:[eE][-+]?[0-9]+)?|\.[0-9][0-9_]*(?:[eE][-+]?[0-9]+)?|[0-9][0-9_]*[eE][-+]?[0-9]+"
    r"|\.(?:inf|Inf|INF))$|^\.(?:nan|NaN|NAN)$"
)
_BOOL = re.compile(r"^(?:true|True|TRUE|false|False|FALSE)$")
_NULL = re.compile(r"^(?:~|null|Null|NULL|)$")


class _Loader(yaml.SafeLoader):
    """YAML 1.2 scalars: ``77e9`` is a number, ``1:30`` and ``yes`` are not; keys may not repeat."""


_Loader.yaml_implicit_resolvers = {}

for _tag, _pattern, _first in (
    ("bool", _BOOL, "tTfF"),
    ("int", _INT, "-+0123456789"),
    ("float", _FLOAT, "-+0123456789."),
    ("null", _NULL, ["~", "n", "N", ""]),
    ("merge", re.compile(r"^<<$"), "<"),
):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", _pattern, list(_first))


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    own: set[str] = set()
    for key_node, _ in node.value:
        merges = key_node.tag == "tag:yaml.org,2002:merge"
        key = "<<" if merges else loader.construct_object(key_node, deep=True)
        if isinstance(key, str) and key not in own:
            own.add(key)
            continue
        wrong = "appears twice" if isinstance(key, str) else "should be text"
        raise yaml.MarkedYAMLError(
            problem=f"the key {key!r} {wrong}", problem_mark=key_node.start_mark
        )
    loader.flatten_mapping(node)  # merged keys (<<) come first and give way
    return {
        loader.construct_object(key, deep=True): loader.construct_object(value, deep=True)
        for key, value in node.value
    }


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)


def load_config(path: str | Path, overrides: Iterable[str] = ()) -> Config:
    """Read a data set's config file and apply overrides such as ``radar.prf_hz=128``.

    Raises:
        ConfigError: unreadable file, bad YAML, or a value out of place; the message names the
            file, the line, the key, the value and what would be right.
    """
    return load_section(Config, Path(path), overrides)


def load_section(kind: type[S], path: Path | None, overrides: Iterable[str] = ()) -> S:
    """Read a file that holds one `kind` of config, or its defaults, and apply overrides.

    Raises:
        ConfigError: as `load_config`.
    """
    document, lines = _document(path) if path else ({}, {})
    for override in overrides:
        _override(document, override)
        lines = {k: v for k, v in lines.items() if not _within(k, override.split("=")[0].strip())}
    return validated(kind, document, str(path) if path else "--set", lines)


def _document(path: Path) -> tuple[dict[str, Any], dict[str, int]]:
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read as text ({error})") from None
    document = _parse(text, str(path))
    lines = _key_lines(text)
    if document is None:
        document = {}
    if not isinstance(document, dict):
        raise ConfigError(f"{path}: should be a mapping of keys such as 'seed: 1'")
    return document, lines


def config_from_json(text: str, where: str) -> Config:
    """Rebuild a resolved config from the JSON stored with a data set."""
    try:
        document = json.loads(text)
    except ValueError as error:
        raise ConfigError(f"{where}: the stored config is not JSON ({error})") from None
    return validated(Config, document, where, {})


def validated(kind: type[S], document: Any, where: str, lines: dict[str, int]) -> S:
    """Turn a parsed document into a config, or raise a ConfigError with one line per mistake."""
    try:
        return kind.model_validate(document)
    except ValidationError as error:
        messages = [
            _place(where, problem.key, lines) + _what(problem)
            for problem in _found(kind, error, document)
        ]
        raise ConfigError("\n".join(dict.fromkeys(messages))) from None


def _parse(text: str, where: str) -> Any:
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        line = f":{mark.line + 1}" if mark else ""
        raise ConfigError(f"{where}{line}: not valid YAML: {error.problem}") from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise ConfigError(f"{where}: not valid YAML: {error}") from None


def _override(document: dict[str, Any], override: str) -> None:
    key, equals, text = override.partition("=")
    names = key.strip().split(".")
    if not equals or not all(names):
        raise ConfigError(
            f"--set {override}: should be key=value with a dotted key, such as radar.prf_hz=128"
        )
    place = document
    for name in names[:-1]:
        inner = place.get(name)
        # A copy: a YAML anchor may share this mapping with another key.
        inner = dict(inner) if isinstance(inner, dict) else {}
        place[name] = inner
        place = inner
    place[names[-1]] = _parse(text, f"--set {key.strip()}")


def _key_lines(text: str) -> dict[str, int]:
    def walk(node: yaml.Node | None, key: str) -> Iterator[tuple[str, int]]:
        if isinstance(node, yaml.MappingNode):
            for key_node, value in node.value:
                inner = f"{key}.{key_node.value}" if key else str(key_node.value)
                yield inner, key_node.start_mark.line + 1
                yield from walk(value, inner)

    return dict(walk(yaml.compose(text, Loader=_Loader), ""))


def _within(key: str, parent: str) -> bool:
    return key == parent or key.startswith(parent + ".")


# What pydantic says in terms of Python, said in terms of YAML.
_WORDING = {
    "model_type": "should be a mapping of keys",
    "dict_type": "should be a mapping of keys",
    "tuple_type": "should be a list, such as [a, b]",
    "missing": "is required",
}


def _found(kind: type[BaseModel], error: ValidationError, document: Any) -> Iterator[Problem]:
    for item in error.errors(include_url=False):
        if item["type"] == "across":
            yield from item["ctx"]["problems"]
            continue
        names = _document_path(item["loc"], document)
        key = ".".join(str(name) for name in names)
        if item["type"] == "extra_forbidden":
            yield Problem(key, item["input"], _unknown(kind, names))
        else:
            message = _WORDING.get(item["type"], item["msg"])
            if not message.startswith(("should", "'")):
                message = message[0].lower() + message[1:]
                message = message.removeprefix("input ")
            yield Problem(key, item["input"], message)


def _document_path(location: tuple[int | str, ...], document: Any) -> list[int | str]:
    """Drop from a pydantic location the tags of unions, which are no keys of the document.

    A tag comes once more as the key of the same name where the error lies inside of it.
    """
    names: list[int | str] = []
    place, tag = document, None
    for name in location:
        if name in _UNION_TAGS and name != tag:
            tag = name
            continue
        if isinstance(place, dict) and name in place:
            place, tag = place[name], None
        elif isinstance(place, (list, tuple)) and isinstance(name, int):
            place = place[name] if name < len(place) else None
        elif re.match(r"literal|tuple|function|.*\[", str(name)):
            continue
        else:
            place = None
        names.append(name)
    return names


def _unknown(kind: type[BaseModel], names: list[int | str]) -> str:
    section: type[BaseModel] | None = kind
    for name in names[:-1]:
        field = section.model_fields.get(str(name)) if section else None
        section = next(
            (
                kind
                for kind in (
                    [field.annotation, *getattr(field.annotation, "__args__", ())] if field else []
                )
                if isinstance(kind, type) and issubclass(kind, BaseModel)
            ),
            None,
        )
    known = list(section.model_fields) if section else []
    near = difflib.get_close_matches(str(names[-1]), known, n=1)
    if near:
        return f"is an unknown key; did you mean {near[0]!r}?"
    return "is an unknown key" + (f"; known here: {', '.join(known)}" if known else "")


def _place(where: str, key: str, lines: dict[str, int]) -> str:
    line = lines.get(key)
    parent = key
    while line is None and "." in parent:
        parent = parent.rpartition(".")[0]
        line = lines.get(parent)
    return f"{where}:{line}: {key}" if line else f"{where}: {key}"


def _what(problem: Problem) -> str:
    value = problem.value
    shown = json.dumps(value, default=_plain)
    shown = shown if len(shown) <= 120 else shown[:117] + "..."
    return f" = {shown}: {problem.right}"


def _plain(value: object) -> object:
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json", exclude_none=True)
    return str(value)
