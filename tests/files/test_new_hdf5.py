"""HDF5 files on a disk that is full, and signals while one is written."""

import signal
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.command_line import process

from radhar_cli.files.new_hdf5 import new_hdf5

FULL_AT_ANY_BYTE = """
import resource, sys
from pathlib import Path
import h5py, numpy as np
from radhar_cli.files.new_hdf5 import new_hdf5

def write(path):
    with new_hdf5(path, Path("walk.h5")) as (file, check):
        chunked = file.create_dataset("beat", (2, 64), "f4", chunks=(1, 16))
        for start in range(0, 64, 8):
            chunked[:, start : start + 8] = start
        for number in range(8):
            file[f"axes/{number}"] = np.arange(50.0)
            file[f"axes/{number}"].attrs["unit"] = "s"
        file.create_dataset("map", data=np.arange(999.0), compression="gzip")

path = Path(sys.argv[1])
write(path)
size, said = path.stat().st_size, set()
for limit in range(0, size, 97):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        write(path)
    except OSError as error:
        said.add(f"{error.filename}: {error.strerror}")
    else:
        sys.exit(f"{limit} of {size} bytes: no error")
sys.stdout.write(", ".join(said))
"""


def test_a_disk_that_is_full_at_any_byte_is_an_error_that_names_the_file(tmp_path: Path) -> None:
    """HDF5 alone raises what it likes, or ends the interpreter as it exits."""
    done = process("-c", FULL_AT_ANY_BYTE, tmp_path / "walk.unfinished")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "walk.h5: File too large"


def test_the_check_tells_at_once() -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("no /dev/full")
    passed = []

    def write() -> None:
        with new_hdf5(full, Path("walk.h5")) as (file, check):
            file.create_dataset("beat", (4, 2**18), "f4", chunks=(1, 2**18))[...] = 1
            passed.append("a write")
            file.flush()
            check()
            passed.append("the check")

    with pytest.raises(OSError, match="No space left") as error:
        write()
    assert error.value.filename == "walk.h5"
    assert passed == ["a write"]


def test_an_interrupt_waits_for_the_check(tmp_path: Path) -> None:
    """Raised at once it would come up inside HDF5, in the first Python that runs: a write."""
    path, handler, passed = tmp_path / "walk.h5", signal.getsignal(signal.SIGINT), []

    def write() -> None:
        with new_hdf5(path, path) as (file, check):
            signal.raise_signal(signal.SIGINT)
            file["time"] = np.arange(9)
            passed.append("a write")
            check()
            passed.append("the check")

    with pytest.raises(KeyboardInterrupt):
        write()
    assert passed == ["a write"]
    assert signal.getsignal(signal.SIGINT) is handler
    with new_hdf5(path, path) as (file, _):
        file["again"] = np.arange(9)
    with h5py.File(path) as written:
        assert list(written) == ["again"]
