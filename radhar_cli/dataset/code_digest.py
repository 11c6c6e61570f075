"""Identity of code that a user added: the files it is written in, and the numbers it holds.

Two versions of a function should have two digests, also where the change lies in a function that it
calls, in another file of the user's, or in the arguments of a partial function. Installed packages
are not read, but for those that are named, nor are files of data that the code opens.
"""

import hashlib
import inspect
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import partial
from pathlib import Path
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

OURS = "radhar_cli"  # whose version is known
_LIBRARY = Path(sysconfig.get_path("stdlib"))
_INSTALLED = {"site-packages", "dist-packages"}  # folders of packages


def code_digest(values: Iterable[Any], modules: Iterable[str] = ()) -> str:
    """Digest of values, of which some can be called, and of the sources behind them.

    Args:
        values: functions, partial ones, objects of the user's classes, plain values, or mappings
            and sequences of those.
        modules: names of further modules whose sources count, and those of their packages that
            they import, installed or not.

    Returns:
        Twelve hexadecimal digits, the same in every process that imports the same sources.
    """
    reader = _Reader()
    described = [reader.describe(value) for value in values]
    sources = sorted(map(_digest_of_file, _sources(reader.modules, tuple(modules))))
    return hashlib.sha256(repr((described, sources)).encode()).hexdigest()[:12]


class _Reader:
    """Describes values in words that are the same in every process, and notes their modules."""

    def __init__(self) -> None:
        self.modules = set[str]()
        self._open = set[int]()  # values that hold, at some depth, the one that is being described

    def describe(self, value: Any) -> Any:
        """A value in nested tuples of text, equal for equal values and code."""
        if value is None or isinstance(value, (bool, int, float, complex, str, bytes)):
            return type(value).__name__, repr(value)
        if id(value) in self._open:
            return ("again",)
        self._open.add(id(value))
        try:
            return self._describe(value)
        finally:
            self._open.discard(id(value))

    def _describe(self, value: Any) -> Any:
        if isinstance(value, Mapping):
            pairs = [(self.describe(key), self.describe(held)) for key, held in value.items()]
            return "mapping", sorted(pairs, key=repr)
        if isinstance(value, (set, frozenset)):
            return "set", sorted(map(self.describe, value), key=repr)
        if isinstance(value, (list, tuple)):
            return "sequence", [*map(self.describe, value)]
        if isinstance(value, partial):
            return "partial", *map(self.describe, (value.func, value.args, value.keywords))
        if isinstance(value, MethodType):
            return "method", self.describe(value.__func__), self.describe(value.__self__)
        if isinstance(value, FunctionType):
            return self._function(value)
        if isinstance(value, ModuleType):
            self.modules.add(value.__name__)
            return "module", value.__name__.rpartition(".")[2]
        if isinstance(value, type) or (not hasattr(value, "__dict__") and not is_dataclass(value)):
            return self._describe_named(value)
        return "object", self._describe_named(type(value)), self.describe(_state(value))

    def _describe_named(self, value: Any) -> Any:
        """Describe a class, or an object that holds nothing that Python shows."""
        if hasattr(value, "tobytes") and hasattr(value, "dtype"):  # an array
            numbers = hashlib.sha256(value.tobytes()).hexdigest()
            return "array", str(value.dtype), str(getattr(value, "shape", "")), numbers
        kind = value if isinstance(value, type) or hasattr(value, "__qualname__") else type(value)
        self.modules.add(str(getattr(kind, "__module__", None)))
        return "named", kind.__qualname__

    def _function(self, function: FunctionType) -> Any:
        self.modules.add(function.__module__)
        cells = []
        for cell in function.__closure__ or ():
            try:
                cells.append(self.describe(cell.cell_contents))
            except ValueError:  # not filled yet
                cells.append("empty")
        held = self.describe((function.__defaults__, function.__kwdefaults__))
        return "function", function.__qualname__, _text_of(function), held, cells


def _state(value: Any) -> Any:
    """Return the state of an object; of a data class the fields alone, without caches."""
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name, None) for field in fields(value)}
    return vars(value)


def _text_of(function: FunctionType) -> str:
    """Source of a function, or its byte code where no file holds it."""
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):
        return repr(_code_of(function.__code__))


def _code_of(code: CodeType) -> Any:
    constants = [_code_of(one) if isinstance(one, CodeType) else one for one in code.co_consts]
    return code.co_code, repr(constants), code.co_names


def _sources(modules: Iterable[str], extensions: tuple[str, ...]) -> Iterator[Path]:
    """Sources of the user's modules of these names, and of those that they have imported."""
    packages = {name.partition(".")[0] for name in extensions}
    waiting = [*modules, *extensions]
    visited: set[str] = set()
    while waiting:
        name = waiting.pop()
        package, module = name.partition(".")[0], sys.modules.get(name)
        if name in visited or module is None or package == OURS:
            continue
        visited.add(name)
        path = _file_of(module)
        if path is None or (package not in packages and _is_installed(path)):
            continue
        yield path
        for value in [*vars(module).values()]:
            module_name = value.__name__ if isinstance(value, ModuleType) else None
            module_name = module_name or getattr(value, "__module__", None)
            if isinstance(module_name, str):
                waiting.append(module_name)


def _file_of(module: ModuleType) -> Path | None:
    """Source of a module, if it is written in Python."""
    name = getattr(module, "__file__", None)
    return Path(name).resolve() if isinstance(name, str) and name.endswith(".py") else None


def _is_installed(path: Path) -> bool:
    return path.is_relative_to(_LIBRARY) or not _INSTALLED.isdisjoint(path.parts)


def _digest_of_file(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return "gone"
