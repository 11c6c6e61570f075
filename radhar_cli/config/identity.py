"""Which keys decide the bytes of a data set, and their fingerprint."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.several_radars import NAME_KEY, OTHERS_KEY, OWN_SECTIONS, RADARS_KEY
from radhar_cli.schema.section import Section

NOT_IDENTITY = ("output.png", "output.license")


def resolved(config: Section) -> dict[str, Any]:
    """Return the config with every default, as plain JSON values.

    Keys of several radars are left out where there is one.
    """
    document = config.model_dump(mode="json", exclude_none=False)
    if document.get(NAME_KEY) is None:
        for key in (NAME_KEY, OTHERS_KEY):
            document.pop(key, None)
    return document


def resolved_together(configs: Mapping[str, Section]) -> dict[str, Any]:
    """Return the configs of several radars of the same scenes as one document, which reads back.

    Args:
        configs: {name of the radar: config}, as `load_radars` returns them; {"": config} is that
            config alone.
    """
    documents = {name: resolved(config) for name, config in configs.items()}
    if [*documents] == [""]:
        return documents[""]
    together, *others = documents.values()
    differing = [key for key in OWN_SECTIONS if any(one[key] != together[key] for one in others)]
    radars = {
        name: document["radar"] | {key: document[key] for key in differing}
        for name, document in documents.items()
    }
    of_one = {NAME_KEY, OTHERS_KEY, *differing}
    return {
        RADARS_KEY if key == "radar" else key: radars if key == "radar" else value
        for key, value in together.items()
        if key not in of_one
    }


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
