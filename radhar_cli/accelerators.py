"""Libraries that are used where they are installed: `pip install 'radhar[fast]'`."""

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
    """The version of a library that is installed, if it is."""
    try:
        return version(library)
    except PackageNotFoundError:
        return None


def load(library: str) -> Any:
    """Import one that is installed; a MachineError says that it does not work here."""
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

    Of pairs of functions that it calls, the first is compiled into it as the second is written.
    All are in its file: the age of that tells whether the cache is up to date.
    """
    njit = load("numba").njit
    # Sums in any order, but not as if there were no NaN.
    options: dict[str, Any] = {"fastmath": {"contract", "nsz", "reassoc"}, "error_model": "numpy"}
    inlined: Any = options | {"forceinline": True}  # else loops with calls are not vectorised
    for one, instead in called:
        within = load("numba.extending").overload(one, strict=False, jit_options=inlined)
        within(lambda *_, instead=instead: instead)
    try:
        compiled: Routine = njit(function, cache=True, **options)
    except RuntimeError:  # no folder for the cache can be written
        compiled = njit(function, **options)
    return compiled
