"""Which keys decide the bytes of a data set, and their fingerprint."""

import hashlib
import json
from typing import Any

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.section import Section

NOT_IDENTITY = ("output.png", "output.license")


def resolved(config: Section) -> dict[str, Any]:
    """Return the config with every default, as plain JSON values."""
    return config.model_dump(mode="json", exclude_none=False)


def as_yaml(config: Section) -> str:
    """Return the resolved config as YAML, which reads back as the same config."""
    return yaml_text(resolved(config))


def yaml_text(document: dict[str, Any]) -> str:
    """Return plain values as YAML, the innermost lists and mappings in a line.

    A text of several lines, such as that of a .cfg, is a block.
    """
    import yaml

    class Dumper(yaml.SafeDumper):
        """Dumper with a representation of texts of its own."""

    def represent_text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
        style = "|" if "\n" in text else None
        if not {"\x85", "\u2028", "\u2029"}.isdisjoint(text):
            style = '"'  # other styles would fold these line breaks
        return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)

    Dumper.add_representer(str, represent_text)
    return yaml.dump(
        document,
        Dumper=Dumper,
        sort_keys=False,
        default_flow_style=None,
        width=100,
        allow_unicode=True,
    )


def flat_document(document: dict[str, Any]) -> dict[str, Any]:
    """Flatten a resolved config to {dotted key: value}, of the keys that decide bytes.

    Whether PNGs are written at all is not among them, so that they can be added later; nor is the
    licence.
    """

    def walk(value: Any, key: str) -> list[tuple[str, Any]]:
        if isinstance(value, dict):
            return [pair for k, v in value.items() for pair in walk(v, f"{key}.{k}" if key else k)]
        return [(key, value)]

    return {k: v for k, v in walk(document, "") if k not in NOT_IDENTITY}


def config_hash(config: AnyConfig | dict[str, Any]) -> str:
    """SHA-256, in hex, of the keys that decide bytes.

    Args:
        config: a config, or one as it is stored (`resolved`).
    """
    document = config if isinstance(config, dict) else resolved(config)
    text = json.dumps(flat_document(document), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
