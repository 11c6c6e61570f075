"""Untrusted training runs and sweeps: one line that names file and field."""

import json
import os
import shutil
import struct
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import torch
from learning.patterns import trained
from safetensors import safe_open
from safetensors.torch import load_file, save_file
from security.bounded import limited

from radhar_cli.cli import program
from radhar_cli.errors import RadharError
from radhar_cli.learning.run_folder import load_best, read_history, read_metadata, read_trained_on

Change = Callable[[dict[str, Any]], object]


@pytest.fixture(autouse=True)
def in_bounds() -> Iterator[None]:
    with limited():
        yield


@pytest.fixture
def run(good_run: Path, tmp_path: Path) -> Path:
    """A copy of a run, to be damaged."""
    return Path(shutil.copytree(good_run, tmp_path / "run"))


def one_line(action: Callable[[], object], *words: str) -> None:
    with pytest.raises(RadharError) as caught:
        action()
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert len(message) < 2000
    for word in words:
        assert word in message, message


ABOUTS: dict[str, tuple[Change, str]] = {
    "sd of zero": (lambda a: a.update(sd=[0, 0, 0]), "sd.0"),
    "negative sd": (lambda a: a.update(sd=[1, -1, 1]), "sd.1"),
    "sd is no number": (lambda a: a.update(sd=[1, 1, float("nan")]), "sd.2"),
    "mean without end": (lambda a: a.update(mean=[float("inf"), 0, 0]), "mean.0"),
    "size of nothing": (lambda a: a.update(size=[0, 0]), "size.0"),
    "negative size": (lambda a: a.update(size=[-32, 32]), "size.0"),
    "huge size": (lambda a: a.update(size=[2**40, 32]), "size.0"),
    "size is text": (lambda a: a.update(size="big"), "size"),
    "a class twice": (lambda a: a.update(classes=["a", "a"]), "classes"),
    "no class": (lambda a: a.update(classes=[]), "classes"),
    "a million classes": (lambda a: a.update(classes=[str(i) for i in range(10**5)]), "classes"),
    "a class with a long name": (lambda a: a.update(classes=["a" * 300, "b"]), "classes.0"),
    "classes are numbers": (lambda a: a.update(classes=[1, 2]), "classes.0"),
    "a model with a long name": (lambda a: a.update(model="x" * 300), "model"),
    "a map elsewhere": (lambda a: a.update(map="../../secret"), "map"),
    "a map above": (lambda a: a.update(map=".."), "map"),
    "another input": (lambda a: a.update(input="cmyk"), "input"),
    "no config": (lambda a: a.pop("config"), "config"),
    "a config of nothing": (lambda a: a.update(config={"seed": "x"}), "config"),
    "no hash": (lambda a: a["data"].pop("hash"), "data.hash"),
    "val is text": (lambda a: a["data"].update(val="many"), "data.val"),
    "something more": (lambda a: a.update(evil=1), "evil"),
}


@pytest.mark.parametrize("case", ABOUTS)
def test_invalid_metadata_are_refused(case: str, run: Path) -> None:
    change, expected = ABOUTS[case]
    about = json.loads((run / "run.json").read_text())
    change(about)
    (run / "run.json").write_text(json.dumps(about))
    one_line(lambda: read_metadata(run), "run.json", expected)
    path = run / "best.safetensors"
    with safe_open(path, "pt") as file:
        metadata = file.metadata()
    save_file(load_file(path), path, {**metadata, "radhar": json.dumps(about)})
    one_line(lambda: load_best(run), "best.safetensors", expected)


@pytest.mark.parametrize("text", ["", "[" * 10**5, "[]", "3", "\xff", "{" * 10, " " * 2**21])
def test_files_that_are_no_metadata_are_refused(text: str, run: Path) -> None:
    (run / "run.json").write_bytes(text.encode("latin-1"))
    one_line(lambda: read_metadata(run), "run.json")


def weights(change: Callable[[dict[str, torch.Tensor]], object]) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        with safe_open(path, "pt") as file:
            metadata = file.metadata()
        tensors = load_file(path)
        change(tensors)
        save_file(tensors, path, metadata)

    return damage


def as_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def as_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def as_device(path: Path) -> None:
    path.unlink()
    path.symlink_to("/dev/zero")


def as_pickle(path: Path) -> None:
    path.write_bytes(b"\x80\x02}q\x00.")


def header(text: bytes, length: int | None = None) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        path.write_bytes(struct.pack("<Q", len(text) if length is None else length) + text)

    return damage


def _claims(path: Path) -> None:
    """The right header, but for a tensor that claims 40 GB."""
    data = path.read_bytes()
    size = struct.unpack("<Q", data[:8])[0]
    found = json.loads(data[8 : 8 + size])
    found["head.bias"] = {"dtype": "F32", "shape": [10**10], "data_offsets": [0, 4 * 10**10]}
    header(json.dumps(found).encode())(path)


FILES: dict[str, tuple[Callable[[Path], None], str]] = {
    "not finite": (weights(lambda w: w["head.bias"].fill_(torch.nan)), "head.bias holds a number"),
    "double": (weights(lambda w: w.update({"head.bias": torch.zeros(2).double()})), "float64"),
    "eight bits": (weights(lambda w: w.update({"head.bias": torch.zeros(2).char()})), "int8"),
    "a weight too few": (weights(lambda w: w.pop("head.bias")), "head.bias is missing"),
    "a weight too many": (weights(lambda w: w.update(evil=torch.zeros(7))), "evil is"),
    "another's": (
        lambda path: save_file({"a": torch.zeros(3)}, path),
        "not written by `radhar train`",
    ),
    "half": (lambda path: path.write_bytes(path.read_bytes()[:5000]), "truncated"),
    "too large": (weights(lambda w: w.update({"head.bias": torch.zeros(9)})), "(9,)"),
    "a header without end": (header(b"{}", 2**63), "claims a header of"),
    "a header of 90 MB": (header(b" " * 10, 90_000_000), "claims a header of"),
    "a deep header": (header(b"[" * 10**5), "not a safetensors file"),
    "no header": (header(b""), "not a safetensors file"),
    "a tensor that is not there": (_claims, "not a safetensors file"),
    "a folder": (as_folder, "regular file"),
    "a pipe": (as_pipe, "regular file"),
    "a device": (as_device, "regular file"),
}


@pytest.mark.parametrize("case", FILES)
def test_hostile_weights_are_refused(case: str, run: Path) -> None:
    damage, expected = FILES[case]
    damage(run / "best.safetensors")
    one_line(lambda: load_best(run), "best.safetensors", expected)


def test_predictions_that_are_not_finite_are_refused(run: Path, good_set: Path) -> None:
    huge = weights(lambda w: [t.fill_(3e38) for t in w.values() if t.is_floating_point()])
    huge(run / "best.safetensors")
    words = ["predict", str(run), str(good_set)]
    one_line(lambda: program()(words, standalone_mode=False), "logits are not finite")


def checkpoint(change: Change) -> Callable[[Path], None]:
    def damage(path: Path) -> None:
        found = torch.load(path, weights_only=True)
        change(found)
        torch.save(found, path)

    return damage


def _packed(path: Path) -> None:
    """A small file that becomes a large one."""
    packed = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED)
    with packed as file, file.open("a/data.pkl", "w") as content:
        for _ in range(2**6):
            content.write(bytes(2**20))


def _state(found: dict[str, Any], number: int, **values: Any) -> None:
    found["optimiser"]["state"][number].update(values)


CHECKPOINTS: dict[str, tuple[Callable[[Path], None], str]] = {
    "packed": (_packed, "more than its own size"),
    "half": (lambda path: path.write_bytes(path.read_bytes()[:5000]), "--overwrite"),
    "text": (lambda path: path.write_bytes(b"hello\n"), "not a checkpoint"),
    "numbers": (lambda path: torch.save([1, 2], path), "not a checkpoint"),
    "a pickle": (as_pickle, "not a checkpoint"),
    "a folder": (as_folder, "regular file"),
    "a pipe": (as_pipe, "regular file"),
    "no epochs": (checkpoint(lambda c: c.update(history=[])), "no epoch"),
    "epochs of text": (checkpoint(lambda c: c.update(history=["a"])), "does not fit"),
    "an epoch twice": (checkpoint(lambda c: c.update(history=c["history"][:1] * 2)), "epoch 2"),
    "no number": (checkpoint(lambda c: c["history"][0].update(val_loss=torch.nan)), "finite"),
    "a list": (checkpoint(lambda c: c.update(optimiser=[1, 2])), "does not fit"),
    "no state": (checkpoint(lambda c: c["optimiser"]["state"].clear()), "does not fit"),
    "a state too few": (checkpoint(lambda c: c["optimiser"]["state"][0].pop("step")), "fit it"),
    "a large state": (checkpoint(lambda c: _state(c, 0, exp_avg=torch.zeros(9))), "exp_avg"),
    "a state of text": (checkpoint(lambda c: _state(c, 0, exp_avg="a")), "does not fit"),
    "other settings": (
        checkpoint(lambda c: c["optimiser"]["param_groups"][0].update(eps=0.5)),
        "other settings",
    ),
    "weights of another": (checkpoint(lambda c: c["model"].popitem()), "does not fit"),
    "a run of nothing": (checkpoint(lambda c: c.update(metadata="{}")), "does not fit"),
}


@pytest.mark.parametrize("case", CHECKPOINTS)
def test_hostile_checkpoints_are_refused(case: str, run: Path, good_set: Path) -> None:
    damage, expected = CHECKPOINTS[case]
    damage(run / "last.ckpt")
    one_line(lambda: trained(good_set, run, epochs=2, model="smallnet"), "last.ckpt", expected)


@pytest.mark.parametrize("name", ["history.csv", "trained_on.csv", "run.json"])
@pytest.mark.parametrize("kind", ["pipe", "folder", "garbage"])
def test_invalid_tables_are_refused(name: str, kind: str, run: Path) -> None:
    path = run / name
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.write_bytes(b"epoch,pixels\n\xff,\x00\n" + b'"' + b"x" * 200_000)
    readers = {"history.csv": read_history, "trained_on.csv": read_trained_on}
    reader = readers.get(name, read_metadata)
    one_line(lambda: reader(run), name)
