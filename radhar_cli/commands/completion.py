"""What a shell offers after an option; nothing is imported before it asks."""

import inspect
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from pydantic import BaseModel

MODELS = (
    *("fftnet", "smallnet", "mobilenetv2_100", "resnet50", "vgg19", "vit_base_patch16_224"),
    "convnext_tiny",
)


def activities(incomplete: str) -> list[str]:
    """Slugs of the twelve."""
    from radhar_cli.activity import ACTIVITIES

    return [one.slug for one in ACTIVITIES if one.slug.startswith(incomplete)]


def models(incomplete: str) -> list[str]:
    """Our networks and some of timm's, whose whole list needs PyTorch."""
    return [name for name in MODELS if name.startswith(incomplete)]


def maps(incomplete: str) -> list[str]:
    """Names of maps; the last of several with commas between them."""
    from radhar_cli.config import MAP_NAMES

    before, comma, last = incomplete.rpartition(",")
    return [before + comma + name for name in MAP_NAMES if name.startswith(last)]


def keys(context: typer.Context, incomplete: str) -> list[str]:
    """``key=`` of the file that `--set` changes."""
    if context.info_name == "import":  # keys of a radar's header, none of a config's
        return []
    if context.info_name == "train":
        from radhar_cli.learning.settings import TrainConfig as Kind
    else:
        from radhar_cli.config import Config as Kind  # type: ignore[assignment]
    return [f"{key}=" for key in _keys(Kind) if key.startswith(incomplete)]


def _keys(kind: "type[BaseModel]", prefix: str = "") -> Iterator[str]:
    from typing import get_args

    from radhar_cli.config.schema import Section

    for name, field in kind.model_fields.items():
        kinds = [field.annotation, *get_args(field.annotation)]
        inner = next((k for k in kinds if isinstance(k, type) and issubclass(k, Section)), None)
        if inner is not None:
            yield from _keys(inner, f"{prefix}{name}.")
        if inner is not field.annotation and not field.exclude:
            yield prefix + name


OFFERED: dict[str, Callable[..., list[str]]] = {
    "activity": activities,
    "map_": maps,
    "maps": maps,
    "model": models,
    "set_": keys,
}


def complete_options(command: Callable[..., Any]) -> None:
    """Let the options of a command that are named above complete their values."""
    for name, parameter in inspect.signature(command).parameters.items():
        for option in getattr(parameter.annotation, "__metadata__", ()):
            option.autocompletion = OFFERED.get(name)
