"""Untrusted data sets: one line that names file and field, or a right result; in bounds."""

import json
import os
import re
import shutil
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers import slow
from security.bounded import Answer, answers, refused

from radhar_cli.dataset.build_version import build_version
from radhar_cli.errors import FolderError
from radhar_cli.readers import hdf5_check
from radhar_cli.readers.untrusted_hdf5 import UntrustedFile

Change = Callable[[h5py.File, Path], None]
COMMANDS = ("inspect", "preview", "view", "verify", "eval")
HOSTILE: dict[str, tuple[Change, str, tuple[str, ...]]] = {}
RAW = 32 * 32
_packer = zlib.compressobj()
BOMB = b"".join(_packer.compress(bytes(2**20)) for _ in range(2**7)) + _packer.flush()


def hostile(expected: str, *commands: str) -> Callable[[Change], Change]:
    """Register a change to a data set, the expected message, and the commands that give it."""

    def register(change: Change) -> Change:
        HOSTILE[change.__name__.strip("_")] = (change, expected, commands or COMMANDS)
        return change

    return register


def replaced(name: str, expected: str, *commands: str, **arguments: Any) -> None:
    """A dataset that is replaced by one created with these arguments."""

    def change(file: h5py.File, _: Path) -> None:
        del file[name]
        file.create_dataset(name, **arguments)

    change.__name__ = f"{name} by {arguments}"[:80]
    hostile(expected, *commands)(change)


def attribute(name: str, value: Any, expected: str, *commands: str) -> None:
    def change(file: h5py.File, _: Path) -> None:
        del file.attrs[name]
        if value is not None:
            file.attrs[name] = value

    change.__name__ = f"attribute {name} = {value!r}"[:60]
    hostile(expected, *commands)(change)


def secret(place: Path) -> Path:
    """A file outside the data set, as pixels and as bytes."""
    with h5py.File(place / "secret.h5", "w") as file:
        file["maps/stft"] = np.full((6, 32, 32), 77, np.uint8)
        file["label"] = np.zeros(6, np.uint8)
    (place / "secret.txt").write_bytes(b"password" * 1000)
    return place


@hostile(r"/maps/stft: is a link")
def external_link_to_pixels(file: h5py.File, place: Path) -> None:
    del file["maps/stft"]
    file["maps/stft"] = h5py.ExternalLink(str(secret(place) / "secret.h5"), "/maps/stft")


@hostile(r"/maps/stft: is a link")
def external_link_to_a_group(file: h5py.File, place: Path) -> None:
    del file["maps"]
    file["maps"] = h5py.ExternalLink(str(secret(place) / "secret.h5"), "/maps")


@hostile(r"/label: is a link")
def external_link_to_labels(file: h5py.File, place: Path) -> None:
    del file["label"]
    file["label"] = h5py.ExternalLink(str(secret(place) / "secret.h5"), "/label")


@hostile(r"/label: is a link")
def external_link_to_a_pipe(file: h5py.File, place: Path) -> None:
    os.mkfifo(place / "pipe")
    del file["label"]
    file["label"] = h5py.ExternalLink(str(place / "pipe"), "/label")


@hostile(r"/label: is a link")
def soft_link_that_ends_in_itself(file: h5py.File, _: Path) -> None:
    del file["label"]
    file["label"] = h5py.SoftLink("/label")


@hostile(r"/maps/stft: should be a dataset")
def hard_link_in_a_ring(file: h5py.File, _: Path) -> None:
    del file["maps/stft"]
    file["maps/stft"] = file["/"]


@hostile(r"/maps/stft: lies in another file")
def external_storage_of_pixels(file: h5py.File, place: Path) -> None:
    del file["maps/stft"]
    bytes_there = [(str(secret(place) / "secret.txt"), 0, 6 * RAW)]
    file.create_dataset("maps/stft", (6, 32, 32), np.uint8, external=bytes_there)


@hostile(r"/split: lies in another file")
def external_storage_of_splits(file: h5py.File, place: Path) -> None:
    del file["split"]
    file.create_dataset("split", (6,), "u1", external=[(str(secret(place) / "secret.txt"), 0, 6)])


@hostile(r"/maps/stft: lies in another file")
def virtual_pixels(file: h5py.File, place: Path) -> None:
    layout = h5py.VirtualLayout((6, 32, 32), np.uint8)
    layout[:] = h5py.VirtualSource(secret(place) / "secret.h5", "maps/stft", (6, 32, 32))
    del file["maps/stft"]
    file.create_virtual_dataset("maps/stft", layout)


@hostile(r"/label: lies in another file")
def virtual_labels(file: h5py.File, place: Path) -> None:
    layout = h5py.VirtualLayout((6,), np.uint8)
    layout[:] = h5py.VirtualSource(secret(place) / "secret.h5", "label", (6,))
    del file["label"]
    file.create_virtual_dataset("label", layout)


def claim(file: h5py.File, per_class: int) -> None:
    """Say in the config that there are so many samples."""
    config = json.loads(file.attrs["config"])
    config["samples_per_class"] = per_class
    file.attrs["config"] = json.dumps(config)


def spread(file: h5py.File, per_class: int, **how: Any) -> None:
    """Give everything so many rows, none of which is stored."""
    claim(file, per_class)
    names: list[str] = []
    file.visititems(lambda name, found: names.append(name) if hasattr(found, "shape") else None)
    for name in names:
        old = file[name]
        shape, dtype = (2 * per_class, *old.shape[1:]), old.dtype
        chunks = (1, *shape[1:]) if name.startswith("maps") else how.get("chunks")
        del file[name]
        file.create_dataset(name, shape, dtype, chunks=chunks)


@hostile(r"/maps/stft: holds 0 samples; should hold 2000000000|samples_per_class = 1000000000")
def a_billion_rows(file: h5py.File, _: Path) -> None:
    spread(file, 10**9, chunks=True)


@hostile(r"/maps/stft: holds 0 samples; should hold 20000000")
def many_rows_that_are_not_there(file: h5py.File, _: Path) -> None:
    spread(file, 10**7, chunks=None)


@hostile(r"samples_per_class = -3")
def negative_rows(file: h5py.File, _: Path) -> None:
    claim(file, -3)


@hostile(r"/maps/stft: has the shape \(6, 32, 32\); should have \(8, 32, 32\)")
def another_count_than_the_config(file: h5py.File, _: Path) -> None:
    claim(file, 4)


@hostile(r"image.size_px.*8192")
def images_too_large(file: h5py.File, _: Path) -> None:
    config = json.loads(file.attrs["config"])
    config["image"]["size_px"] = [2**20, 2**20]
    file.attrs["config"] = json.dumps(config)


def chunk(content: bytes, mask: int = 0) -> Change:
    def change(file: h5py.File, _: Path) -> None:
        for row in range(6):
            file["maps/stft"].id.write_direct_chunk((row, 0, 0), content, mask)

    return change


PIXELS_READ = ("preview", "verify", "eval")
for name, content, expected in (
    ("gzip_bomb", BOMB, "buffer is only 1089 bytes, 1[0-9]{5} bytes required"),
    ("gzip_that_becomes_too_much", zlib.compress(b"\0" * 2**20), "too long or truncated"),
    ("gzip_that_becomes_too_little", zlib.compress(b"\0" * 10), "is 10 bytes; should be 1024"),
    ("gzip_that_is_cut", zlib.compress(bytes(range(256)) * 4)[:-5], "too long or truncated"),
    ("gzip_that_is_none", b"\xff" * 100, "incorrect header check"),
):
    _change = chunk(content)
    _change.__name__ = name
    hostile(rf"/maps/stft\[\d\]: .*{expected}", *PIXELS_READ)(_change)

PIXELS = {"shape": (6, 32, 32), "dtype": np.uint8}
ONE = {**PIXELS, "data": np.zeros((6, 32, 32), np.uint8), "chunks": (1, 32, 32)}
replaced("maps/stft", "holds 0 samples", **PIXELS, chunks=(1, 32, 32))
replaced("maps/stft", r"has chunks of \(6, 32, 32\)", **{**ONE, "chunks": (6, 32, 32)})
replaced("maps/stft", r"has chunks of None", **PIXELS, data=np.zeros((6, 32, 32), np.uint8))
replaced("maps/stft", r"through filters \[32000\]", **ONE, compression="lzf")
replaced("maps/stft", r"through filters \[2, 1\]", **ONE, compression="gzip", shuffle=True)
replaced("maps/stft", r"through filters \[6\]", **ONE, scaleoffset=0)
replaced("maps/stft", r"through filters \[3\]", **ONE, fletcher32=True)
replaced("maps/stft", "of the type float32", **{**ONE, "data": None, "dtype": "f4"})
replaced("maps/stft", "of the type int8", **{**ONE, "data": None, "dtype": "i1"})
replaced("maps/stft", r"has the shape \(6, 32\)", shape=(6, 32), dtype="u1")
replaced("maps/stft", "of the type object", shape=(6, 32, 32), dtype=h5py.vlen_dtype(np.uint8))
replaced("maps/stft", "of the type", shape=(6, 32, 32), dtype=[("a", "u1"), ("b", "f8")])
replaced("label", "holds 200; should be 0 to 1", data=np.full(6, 200, np.uint8))
replaced("label", "of the type object", data=["a"] * 6)
replaced("label", "of the type object", shape=(6,), dtype=h5py.ref_dtype)
replaced("label", "of the type int64", data=np.zeros(6, np.int64))
replaced("label", "of the type float64", data=np.full(6, np.nan))
replaced("label", r"has the shape \(\)", data=np.uint8(3))
replaced("label", r"has the shape \(5,\)", data=np.zeros(5, np.uint8))
replaced("label", r"has the shape \(20000000000,\)", shape=(2 * 10**10,), dtype="u1")
replaced("label", r"has the shape None", data=h5py.Empty("u1"))
replaced("label", "one piece of 6 bytes", data=np.zeros(6, np.uint8), chunks=(3,))
replaced("label", "one piece of 6 bytes", shape=(6,), dtype="u1", chunks=(2**30,), maxshape=(None,))
replaced("label", "one piece of 6 bytes", shape=(6,), dtype="u1")
replaced("split", "holds 9; should be 0 to 2", data=np.full(6, 9, np.uint8))
replaced("sample_key", r"has the shape \(6,\)", data=np.zeros(6, np.int64))
replaced("scene/height", "of the type complex128", data=np.zeros(6, complex))
replaced("scene/height", "of the type int64", data=np.zeros(6, np.int64))
replaced("scene/height", "at most 1e\\+30", "inspect", data=np.array([1e308, -1e308, 0, 0, 0, 0]))
replaced("scene/height", "at most 1e\\+30", "inspect", data=np.array([np.inf, 0, 0, 0, 0, 0]))
replaced("entropy/stft", "should be 0 to 64 bits", "inspect", data=np.full(6, np.nan, "f4"))
replaced("entropy/stft", "should be 0 to 64 bits", "inspect", data=np.full(6, 3e38, "f4"))
replaced("extent/stft", "left < right", "preview", data=np.full((6, 4), np.nan))
replaced("extent/stft", "left < right", "preview", data=np.tile([1.0, 0, 0, 1], (6, 1)))
replaced("sha256/stft", r"of the type \|S10", data=np.zeros(6, "S10"))
for name in ("maps", "maps/stft", "label", "scene", "scene/height", "entropy/stft", "extent"):

    def gone(file: h5py.File, _: Path, name: str = name) -> None:
        del file[name]

    gone.__name__ = f"no {name}"
    hostile(r": is missing")(gone)


@hostile("/label: should be a dataset")
def a_group_for_labels(file: h5py.File, _: Path) -> None:
    del file["label"]
    file.create_group("label")


@hostile("/label: should be a dataset")
def a_type_for_labels(file: h5py.File, _: Path) -> None:
    del file["label"]
    file["label"] = np.dtype("u1")


@hostile("/maps/stft: is missing")
def a_dataset_for_a_group(file: h5py.File, _: Path) -> None:
    del file["maps"]
    file["maps"] = np.zeros(3)


attribute("config", None, "attribute config: is missing")
attribute("config", "{", "attribute config: is not JSON")
attribute("config", "[" * 100_000, "attribute config: is not JSON .*nested")
attribute("config", "9" * 5000, "attribute config: is not JSON")
attribute("config", '{"seed": NaN}', "the stored config: seed")
attribute("config", '{"colour": 3}', "the stored config: colour")
attribute("config", "[]", "the stored config: .*mapping")
attribute("config", 3, "attribute config: should be text")
attribute("config", ["{}", "{}"], "attribute config: should be a single value")
attribute("config", h5py.Empty("S1"), "attribute config: should be a single value")
attribute("config", np.bytes_(b"\xff\xfe"), "attribute config: cannot be read")
attribute("config", np.array([1, 2.0]), "attribute config: should be a single value")
attribute("warnings", None, "attribute warnings: is missing", "inspect")
attribute("warnings", "[3]", "attribute warnings: should be a list of messages", "inspect")
attribute("warnings", '[{"message": []}]', "should be a list of messages", "inspect")
attribute("numpy_version", 3.0, "attribute numpy_version: should be text", "inspect", "verify")


@hostile("attribute config: should be text of at most 1048576 characters")
def a_config_of_two_megabytes(file: h5py.File, _: Path) -> None:
    file.attrs["config"] = "[" + "1," * 10**6 + "1]"


@hostile("/scene/.*: is larger than the file")
def columns_that_share_their_bytes(file: h5py.File, _: Path) -> None:
    rows = 2 * 2000
    claim(file, rows // 2)
    del file["maps/stft"]
    images = file.create_dataset("maps/stft", (rows, 32, 32), "u1", chunks=(1, 32, 32))
    for row in range(rows):
        images.id.write_direct_chunk((row, 0, 0), b"\0")
    del file["sample_key"]
    file["sample_key"] = np.zeros((rows, 2), np.int64)
    names = list(file["scene"])
    del file["scene"]
    shared = file.create_dataset("shared", data=np.zeros(rows))
    for name in names:
        file[f"scene/{name}"] = shared


# What does not matter, and what is odd but right.
HARMLESS: dict[str, Change] = {}


def harmless(change: Change) -> Change:
    HARMLESS[change.__name__] = change
    return change


@harmless
def nothing(file: h5py.File, _: Path) -> None:
    pass


@harmless
def many_attributes(file: h5py.File, _: Path) -> None:
    for number in range(3000):
        file.attrs[f"x{number}"] = "y" * 100


@harmless
def deep_groups_and_rings(file: h5py.File, _: Path) -> None:
    place = file.create_group("deep")
    for _level in range(1000):
        place = place.create_group("g")
    place["ring"] = file["/"]
    file["scene/ring"] = file["scene"]
    file["maps/elsewhere"] = h5py.ExternalLink("/dev/zero", "/")


@harmless
def numbers_of_another_byte_order(file: h5py.File, _: Path) -> None:
    for name in ("sample_key", "scene/height", "entropy/stft", "extent/stft"):
        values = file[name][:]
        del file[name]
        file[name] = values.astype(values.dtype.newbyteorder(">"))


@harmless
def no_attributes_of_maps(file: h5py.File, _: Path) -> None:
    for name in list(file["maps/stft"].attrs):
        del file["maps/stft"].attrs[name]


@harmless
def plain_chunks_in_a_gzip_dataset(file: h5py.File, _: Path) -> None:
    for row in range(6):
        levels = file["maps/stft"][row].tobytes()
        file["maps/stft"].id.write_direct_chunk((row, 0, 0), levels, 1)


def circle(data: bytes) -> bytes:
    """A file with a free object of no size for a text: HDF5 itself reads it without end."""
    text = build_version().encode()
    place = data.index(len(text).to_bytes(8, "little") + text)  # half way in an object's header
    return data[: place - 8] + bytes(16) + data[place + 8 :]


def crash(data: bytes) -> bytes:
    """A file with a text of a kind that there is not: HDF5 itself crashes on it."""
    place = data.index(b"\x19\x01\x01\x00", data.index(b"h5py_version"))
    return data[: place + 1] + b"\xff\xfe" + data[place + 3 :]


def no_file(place: Path, kind: str, whole: bytes) -> Path:
    path = place / "dataset.h5"
    if kind == "a text without length":
        path.write_bytes(circle(whole))
    elif kind == "a text without kind":
        path.write_bytes(crash(whole))
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "folder":
        path.mkdir()
    elif kind != "nothing":
        path.write_bytes(
            {"empty": b"", "text": b"hello" * 999, "magic": b"\x89HDF\r\n\x1a\n"}[kind]
        )
    return path


NO_FILES = {
    "pipe": "should be a regular file",
    "device": "should be a regular file",
    "folder": "should be a regular file",
    "empty": "is not an HDF5 file",
    "text": "is not an HDF5 file",
    "magic": "is not an HDF5 file",
    "a text without kind": "attribute h5py_version: should be text",
    "a text without length": "takes HDF5 more than 2 s|heap object size does not match",
}


def command(name: str, folder: Path, run: Path) -> list[object]:
    return {
        "inspect": ["inspect", folder],
        "preview": ["preview", folder],
        "view": ["view", folder],
        "verify": ["verify", folder, "--samples", 0],
        "eval": ["eval", run, folder, "--split", "all", "-o", folder.parent / "report"],
    }[name]


def commands_of(case: str) -> tuple[str, ...]:
    """Commands that are given a hostile file: all in the whole suite, else one after another.

    All of them open a data set by the same checks, and each still has a fifth of the files.
    """
    commands = HOSTILE[case][2]
    number = list(HOSTILE).index(case) % len(commands)
    return commands if slow.whole_suite else commands[number : number + 1]


@pytest.fixture(scope="module")
def told(
    good_set: Path, good_run: Path, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Answer]:
    """What every command says of every file, keyed `command case`."""
    place = tmp_path_factory.mktemp("hostile")
    asked: dict[str, list[object]] = {}

    def ask(case: str, commands: tuple[str, ...], folder: Path) -> None:
        asked.update({f"{name} {case}": command(name, folder, good_run) for name in commands})

    changes = {name: (change, commands_of(name)) for name, (change, _, _) in HOSTILE.items()}
    changes |= {name: (change, COMMANDS) for name, change in HARMLESS.items()}
    for number, (case, (change, commands)) in enumerate(changes.items()):
        folder = place / str(number) / "set"
        folder.mkdir(parents=True)
        shutil.copy(good_set / "dataset.h5", folder)
        with h5py.File(folder / "dataset.h5", "r+") as file:
            change(file, folder.parent)
        ask(case, commands, folder)
    for kind in NO_FILES:
        (place / kind / "set").mkdir(parents=True)
        no_file(place / kind / "set", kind, (good_set / "dataset.h5").read_bytes())
        ask(kind, ("inspect",) if " " in kind else COMMANDS, place / kind / "set")
    shutil.copytree(good_set, place / "good/set")
    return answers(place, asked, [command(name, place / "good/set", good_run) for name in COMMANDS])


@pytest.mark.every(4)
@pytest.mark.parametrize("case", [*HOSTILE, *NO_FILES])
def test_hostile_files_are_refused_by_file_and_field(told: dict[str, Answer], case: str) -> None:
    if case in HOSTILE:
        expected, commands = HOSTILE[case][1], commands_of(case)
    else:
        expected, commands = NO_FILES[case], ("inspect",)
    for name in commands:
        answer = told[f"{name} {case}"]
        said_last = answer.err.removeprefix("run: smallnet, 2 classes\n")
        message = refused(answer._replace(err=said_last))
        assert len(message.splitlines()) == 1
        assert "dataset.h5: " in message
        assert re.search(expected, message), (name, message)


SEEN_BY_VERIFY = (
    *("many_attributes", "deep_groups_and_rings", "numbers_of_another_byte_order"),
    "no_attributes_of_maps",
)


@pytest.mark.every(3)
@pytest.mark.parametrize("case", HARMLESS)
@pytest.mark.parametrize("name", COMMANDS)
def test_harmless_changes_have_no_effect(told: dict[str, Answer], case: str, name: str) -> None:
    answer, right = told[f"{name} {case}"], told[f"{name} nothing"]
    found = name == "verify" and case in SEEN_BY_VERIFY
    assert (answer.status, right.status) == (int(found), 0), answer.err
    if found:
        assert "Traceback" not in answer.err
        assert all(line.startswith(("WRONG", "...")) for line in answer.out.splitlines())
    if name == "eval":
        accuracy = [line for line in answer.err.splitlines() if "%" in line]
        assert accuracy == [line for line in right.err.splitlines() if "%" in line]


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("import os; print(0, flush=True); os.abort()", "HDF5 crashes on it, SIGABRT"),
        ("import sys; print(0); sys.exit('unable to allocate')", "unable to allocate"),
    ],
)
def test_a_crash_of_hdf5_is_one_line(
    program: str, expected: str, good_set: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "crashing.py").write_text(program)
    monkeypatch.setattr(hdf5_check, "__file__", str(tmp_path / "crashing.py"))
    file = Path(shutil.copy(good_set / "dataset.h5", tmp_path))
    with pytest.raises(FolderError, match=expected) as error:
        UntrustedFile(file)
    assert str(error.value).startswith(f"{file}: cannot be read")
