"""The JSON schema of configs, by which editors complete keys and say what they mean."""

from collections.abc import Iterator
from typing import Any

from radhar_cli.config.documents import BASE
from radhar_cli.schema.section import Section


def json_schema(kind: type[Section]) -> dict[str, Any]:
    """Make the JSON schema (draft 2020-12) of a config file, each key with its description.

    It knows keys, types and choices; bounds and what sections ask of each other are checked by
    radhar alone.
    """
    schema = kind.model_json_schema()
    known = {section.__name__: section for section in _sections(Section)}
    for name, part in schema.get("$defs", {}).items():
        if name in known:
            _describe(part, known[name])
    _describe(schema, kind)
    description = "Another file, whose values hold where this one says nothing."
    schema["properties"][BASE] = {"type": "string", "description": description}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _describe(part: dict[str, Any], section: type[Section]) -> None:
    """Add the description of each key to the schema of a section, in place."""
    for key, text in section.descriptions().items():
        if key in part.get("properties", {}):
            part["properties"][key]["description"] = " ".join(text.split())


def _sections(kind: type[Section]) -> Iterator[type[Section]]:
    for form in kind.__subclasses__():
        yield form
        yield from _sections(form)
