"""All movements and their sections of keys: what the modules beside this one have."""

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
    *("lying", "crawling", "kneeling", "idle"),
)


def _modules() -> list[ModuleType]:
    """Modules of the package in ORDER."""
    names = sorted(info.name for info in iter_modules(movements.__path__))
    rank = {name: place for place, name in enumerate(ORDER)}
    names.sort(key=lambda name: rank.get(name, len(rank)))
    return [import_module(f"{movements.__name__}.{name}") for name in names if name != "catalogue"]


def name_of(section: type[Section]) -> str:
    """Name of a section of `motion`: that of its module."""
    return section.__module__.rpartition(".")[2]


_MODULES = _modules()
# {name of a section of `motion`: its class}
SECTIONS: dict[str, type[Section]] = {
    name_of(module.SECTION): module.SECTION for module in _MODULES if hasattr(module, "SECTION")
}
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
