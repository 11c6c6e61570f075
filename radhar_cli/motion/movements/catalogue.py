"""All movements and their sections of keys: what the modules beside this one have."""

from collections.abc import Iterable
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from radhar_cli.motion import movements
from radhar_cli.motion.movements.kind import MovementKind
from radhar_cli.schema.annotations import People
from radhar_cli.schema.section import Section

# Keys of configs and columns of data sets keep this order; further modules follow by name.
ORDER = (
    *("walking", "running", "limping", "aids", "carrying", "paper", "rotating", "striking"),
    *("exercises", "gestures", "repeating", "grabbing", "sitting", "transitions", "falling"),
    "falling_off_seat",
    *("lying", "crawling", "kneeling", "idle"),
)

TIMING_ORDER = (
    *("seat_start_s", "seat_duration_s", "grab_start_s", "grab_duration_s", "rise_start_s"),
    *("rise_duration_s", "walk_begin_s", "walk_start_s", "walk_stop_s", "sit_duration_s"),
    *("fall_duration_s", "blend_s", "overlap_s"),
)


def _sort_as(names: Iterable[str], order: tuple[str, ...]) -> list[str]:
    """Sort names as in an order; those that it lacks follow by name."""
    return sorted(
        sorted(names), key=lambda name: order.index(name) if name in order else len(order)
    )


def _modules() -> list[ModuleType]:
    """Modules of the package in ORDER."""
    names = _sort_as((info.name for info in iter_modules(movements.__path__)), ORDER)
    return [import_module(f"{movements.__name__}.{name}") for name in names if name != "catalogue"]


def name_of(section: type[Section]) -> str:
    """Name of a section of `motion`: that of its module."""
    return section.__module__.rpartition(".")[2]


_MODULES = _modules()
# {name of a section of `motion`: its class}
SECTIONS: dict[str, type[Section]] = {
    name_of(module.SECTION): module.SECTION for module in _MODULES if hasattr(module, "SECTION")
}
# Sections whose keys are keys of `timing`, these as a section has them, and their defaults.
TIMINGS: list[type[Section]] = [one.TIMING for one in _MODULES if hasattr(one, "TIMING")]
_KEYS = {name: one for one in TIMINGS for name in one.model_fields}
TIMING_KEYS = {name: _KEYS[name].__annotations__[name] for name in _sort_as(_KEYS, TIMING_ORDER)}
TIMING_DEFAULTS = {name: _KEYS[name].model_fields[name].default for name in TIMING_KEYS}
MOVEMENTS: dict[str, MovementKind] = {
    kind.name: kind for module in _MODULES for kind in getattr(module, "MOVEMENTS", ())
}


def users_of(key: str, people: People) -> tuple[str, ...]:
    """Movements and S labels that use a dotted key; none where everybody does.

    Args:
        key: Dotted key, such as `motion.repeating.size_jitter`.
        people: Annotation of the key.
    """
    if people.names == "":
        return ()
    sharing = (name for name, kind in MOVEMENTS.items() if key in kind.keys)
    return (*(people.names or "").split(), *sharing)
