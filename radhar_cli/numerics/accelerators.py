"""Libraries that are used where they are installed: `pip install numba pyfftw`."""

import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from threading import Lock
from typing import Any, TypeAlias

import numpy as np

from radhar_cli.errors import MachineError

Routine: TypeAlias = Callable[..., Any]
_LOADING = Lock()


@cache
def installed(library: str) -> str | None:
    """Version of a library, or None where it is not installed."""
    try:
        return version(library)
    except PackageNotFoundError:
        return None


def load(library: str) -> Any:
    """Import a library that is installed.

    Raises:
        MachineError: it does not work here.
    """
    with _LOADING:
        # pyfftw imports both where it finds them: 0.2 s for what is not used here. Meanwhile no
        # other thread can.
        hidden = {"dask", "scipy.fftpack"} - sys.modules.keys()
        sys.modules.update(dict.fromkeys(hidden))  # type: ignore[arg-type]
        try:
            return import_module(library)
        except ImportError as error:
            raise MachineError(
                f"{library} {installed(library)} does not work here ({error}); should be a version "
                f"for NumPy {np.__version__}, or be removed"
            ) from None
        finally:
            for name in hidden:
                sys.modules.pop(name, None)


@cache
def machine_code(function: Routine, *called: tuple[Routine, Routine]) -> Routine:
    """Compile a function, or take it from the cache beside its file or in the user's folder.

    Args:
        function: function that numba compiles.
        called: (function that it calls, function whose code is compiled in its place). All are
            in one file, whose age tells whether the cache is up to date.
    """
    njit = load("numba").njit
    # Sums in any order, but not as if there were no NaN.
    options: dict[str, Any] = {"fastmath": {"contract", "nsz", "reassoc"}, "error_model": "numpy"}
    inlined: Any = options | {"forceinline": True}  # else loops with calls are not vectorised
    for original, replacement in called:
        overload = load("numba.extending").overload
        register = overload(original, strict=False, jit_options=inlined)
        register(lambda *_, replacement=replacement: replacement)
    try:
        compiled: Routine = njit(function, cache=True, **options)
    except RuntimeError:  # no folder for the cache can be written
        compiled = njit(function, **options)
    return compiled
