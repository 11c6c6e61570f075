"""Libraries that are used where they are installed."""

import sys

import numpy as np
import pytest

from radhar_cli.dataset import identity
from radhar_cli.errors import MachineError
from radhar_cli.numerics import accelerators
from radhar_cli.numerics.accelerators import installed, load, machine_code

LIBRARIES = ("numba", "pyfftw")


@pytest.mark.parametrize("library", LIBRARIES)
def test_its_version_is_part_of_the_identity(monkeypatch, library):
    """Shards of machines with and without it are not mixed."""
    found = []
    for version in (None, "0.61.0", "0.62.0"):
        given = {library: version}
        monkeypatch.setattr(identity, "installed", given.get)
        named = identity.versions()
        assert named[library] == (version or "none")
        found.append(identity.identity_hash({"keys": {}, "versions": named}))
    assert len(set(found)) == 3


@pytest.mark.parametrize("library", LIBRARIES)
def test_one_that_does_not_work_is_named(monkeypatch, library):
    monkeypatch.setattr(accelerators, "installed", lambda library: "0.1")
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MachineError, match=rf"{library} 0\.1 does not work here .*; should be"):
        load(library)


def test_one_that_is_missing():
    assert installed("no-such-library") is None


@pytest.mark.skipif(installed("numba") is None, reason="needs radhar[fast]")
def test_without_a_folder_for_the_cache_it_is_compiled_all_the_same(monkeypatch):
    import numba

    def njit(function, cache=False, **options):
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return numba.jit(function, nopython=True, **options)

    monkeypatch.setattr(numba, "njit", njit)
    total = np.zeros(1)

    def fill(total):
        total[:] = 3.0

    machine_code.__wrapped__(fill)(total)
    assert total == [3.0]
