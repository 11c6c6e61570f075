"""Which keys decide the bytes of a data set, and their fingerprint."""

import hashlib
import json
from collections.abc import Iterator
from typing import Any

from radhar_cli.config.number import FORMS
from radhar_cli.config.schema import Config, Section

NOT_IDENTITY = ("output.png", "output.license")


def resolved(config: Section) -> dict[str, Any]:
    """Return the config with every default, as plain JSON values."""
    return config.model_dump(mode="json", exclude_none=False)


def as_yaml(config: Section) -> str:
    """The resolved config as YAML, which reads back as the same config."""
    return yaml_text(resolved(config))


def yaml_text(document: dict[str, Any]) -> str:
    """Plain values as YAML, the innermost in a line."""
    import yaml

    return yaml.safe_dump(
        document, sort_keys=False, default_flow_style=None, width=100, allow_unicode=True
    )


def differences(one: Section, other: Section) -> dict[str, tuple[Any, Any]]:
    """{dotted key: (value of one, value of the other)} where they are not the same.

    A number's distribution is one value; what only one of them has is null in the other.
    """

    def walk(here: Any, there: Any, key: str) -> Iterator[tuple[str, tuple[Any, Any]]]:
        sections = isinstance(here, dict) and isinstance(there, dict)
        if not sections or {*here, *there} & {*FORMS}:
            if here != there:
                yield key, (here, there)
            return
        for name in {**here, **there}:
            inner = f"{key}.{name}" if key else name
            yield from walk(here.get(name), there.get(name), inner)

    return dict(walk(resolved(one), resolved(other), ""))


def flat_document(document: dict[str, Any]) -> dict[str, Any]:
    """{dotted key: value} of a resolved config, of every key that decides bytes.

    Whether PNGs are written at all is not among them, so that they can be added later; nor is the
    licence.
    """

    def walk(value: Any, key: str) -> list[tuple[str, Any]]:
        if isinstance(value, dict):
            return [pair for k, v in value.items() for pair in walk(v, f"{key}.{k}" if key else k)]
        return [(key, value)]

    return {k: v for k, v in walk(document, "") if k not in NOT_IDENTITY}


def config_hash(config: Config) -> str:
    """Return the SHA-256 of the keys that decide bytes, in hex."""
    return document_hash(resolved(config))


def document_hash(document: dict[str, Any]) -> str:
    """`config_hash` of a resolved config as it is stored, maybe from before newer keys."""
    text = json.dumps(flat_document(document), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
