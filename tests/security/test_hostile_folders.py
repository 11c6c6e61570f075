"""Untrusted output folders: nothing outside of them is written, deleted, or waited for."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from security.made import SET

from radhar_cli.cli import program
from radhar_cli.config import load_config
from radhar_cli.dataset import scene_fields, shards
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.errors import RadharError

Plant = Callable[[Path, Path], None]


def radhar(*words: object) -> str:
    """The one line that a command is refused with."""
    with pytest.raises(RadharError) as caught:
        program()([str(word) for word in words], standalone_mode=False)
    assert len(str(caught.value).splitlines()) == 1
    return str(caught.value)


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """Files outside the folder, as a malicious link might name them."""
    place = tmp_path / "outside"
    for name in ("lock", "built", "identity.json", "unfinished/x", "shards/rows-000000000-1.h5"):
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_text("precious")
    return place


def untouched(place: Path) -> bool:
    found = {str(p.relative_to(place)): p.read_text() for p in place.rglob("*") if p.is_file()}
    return set(found.values()) == {"precious"} and len(found) == 5


def linked(name: str, target: str = "") -> Plant:
    """A link in the work folder, or the folder itself, to something outside."""

    def plant(folder: Path, outside: Path) -> None:
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.symlink_to(outside / target)

    plant.__name__ = f"{name} -> {target or 'outside'}"
    return plant


def piped(name: str) -> Plant:
    def plant(folder: Path, _: Path) -> None:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        os.mkfifo(folder / name)

    plant.__name__ = f"{name} is a pipe"
    return plant


LINKS = [
    linked(".radhar"),
    linked(".radhar/lock", "lock"),
    linked(".radhar/built", "built"),
    linked(".radhar/identity.json", "identity.json"),
    linked(".radhar/sweep.json", "identity.json"),
    linked(".radhar/shards", "shards"),
    linked(".radhar/unfinished"),
    linked(".radhar/measured"),
    linked(".radhar/accuracy"),
    linked(".radhar/shards/rows-000000000-000000001.h5", "lock"),
    linked(".radhar/nowhere", "not there"),
    piped(".radhar/identity.json"),
    piped(".radhar/lock"),
    piped(".radhar/shards/rows-000000000-000000001.h5"),
]


@pytest.mark.parametrize("plant", LINKS, ids=lambda p: p.__name__)
def test_links_in_the_work_folder_are_refused(plant: Plant, tmp_path: Path, outside: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    plant(folder, outside)
    before = sorted(folder.rglob("*"))
    with pytest.raises(RadharError, match=r"\.radhar.*link"), folder_lock(folder):
        pass
    assert untouched(outside)
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("more", [[], ["--overwrite"]], ids=["again", "overwrite"])
@pytest.mark.parametrize("command", ["generate", "train"])
def test_every_writing_command_checks_the_folder_first(
    command: str, more: list[str], tmp_path: Path, outside: Path, good_set: Path
) -> None:
    (tmp_path / "c.yaml").write_text(SET)
    linked(".radhar")(tmp_path / "out", outside)
    source = good_set if command == "train" else tmp_path / "c.yaml"
    message = radhar(command, source, "-o", tmp_path / "out", *more)
    assert ".radhar: is a symbolic link" in message
    assert untouched(outside)


def test_images_are_not_written_through_a_link(
    good_set: Path, tmp_path: Path, outside: Path
) -> None:
    (tmp_path / "c.yaml").write_text(SET.replace("png: false", "png: true"))
    for number, name in enumerate(("png", "png/stft", "png/stft/train/walking")):
        folder = Path(shutil.copytree(good_set, tmp_path / str(number)))
        linked(name)(folder, outside)
        message = radhar("generate", tmp_path / "c.yaml", "-o", folder, "--jobs", 1)
        assert f"{folder / name}: is a symbolic link" in message
        assert untouched(outside)


def test_overwrite_removes_a_link_and_not_what_it_names(
    good_set: Path, tmp_path: Path, outside: Path
) -> None:
    folder = Path(shutil.copytree(good_set, tmp_path / "set"))
    for name in ("png", "scenes.csv"):
        (folder / name).unlink(missing_ok=True)
        (folder / name).symlink_to(outside / ("lock" if name == "scenes.csv" else ""))
    (tmp_path / "c.yaml").write_text(SET.replace("seed: 5", "seed: 6"))
    program()(
        ["generate", str(tmp_path / "c.yaml"), "-o", str(folder), "--overwrite", "--jobs", "1"],
        standalone_mode=False,
    )
    assert untouched(outside)
    assert not (folder / "png").exists()


def test_preview_report_and_simulation_are_not_written_through_a_link(
    good_set: Path, good_run: Path, tmp_path: Path, outside: Path
) -> None:
    data = Path(shutil.copytree(good_set, tmp_path / "set"))
    (data / "preview_stft.png").symlink_to(outside / "lock")
    assert "preview_stft.png: is a symbolic link" in radhar("preview", data)
    run = Path(shutil.copytree(good_run, tmp_path / "run"))
    (run / "eval").symlink_to(outside)
    assert "eval: is a symbolic link" in radhar("eval", run, data)
    (tmp_path / "c.yaml").write_text(SET)
    for name in ("scene.json", "maps.png", "stickman.gif"):
        (tmp_path / name[:-4]).mkdir()
        (tmp_path / name[:-4] / name).symlink_to(outside / "lock")
        message = radhar("simulate", tmp_path / "c.yaml", "-a", "S8", "-o", tmp_path / name[:-4])
        assert f"{name}: is a symbolic link" in message
    assert untouched(outside)


IDENTITIES = {
    "not json": "{",
    "deep": "[" * 50_000,
    "a list": "[]",
    "no keys": '{"versions": {}}',
    "keys are text": '{"keys": "a", "versions": {}}',
    "no config": '{"keys": {}, "versions": {}}',
    "not utf-8": b"\xff".decode("latin-1"),
}


@pytest.mark.parametrize("case", IDENTITIES)
def test_a_damaged_identity_is_refused(case: str, tmp_path: Path) -> None:
    (tmp_path / "c.yaml").write_text(SET)
    place = tmp_path / "out/.radhar/identity.json"
    place.parent.mkdir(parents=True)
    place.write_bytes(IDENTITIES[case].encode("latin-1"))
    (tmp_path / "out/png").mkdir()  # without samples the folder would be free
    assert str(tmp_path / "out") in radhar("inspect", tmp_path / "out")
    with pytest.raises(RadharError) as caught:
        program()(
            ["generate", str(tmp_path / "c.yaml"), "-o", str(tmp_path / "out")],
            standalone_mode=False,
        )
    assert "identity.json: is damaged" in str(caught.value) or "differs in" in str(caught.value)


def shard(folder: Path, change: Callable[[h5py.File], None]) -> None:
    """A shard of rows 0 to 5 with the right checksum and malicious content."""
    path = folder / ".radhar/shards/rows-000000000-000000006.h5"
    path.parent.mkdir(parents=True)
    config = load_config(folder.parent / "c.yaml")
    with h5py.File(path, "w", userblock_size=shards.USER_BLOCK) as file:
        file.create_dataset("maps/stft", (6, 32, 32), "u1", chunks=(1, 32, 32), compression="gzip")
        file["maps/stft"][:] = 1
        file["entropy/stft"] = np.zeros(6, "f4")
        file["sha256/stft"] = np.zeros(6, "S64")
        file["extent/stft"] = np.zeros((6, 4))
        file["scene"] = np.zeros((6, len(scene_fields.fields(config))))
        file["flags"] = np.zeros(6, "u2")
        change(file)
    whose = identity_hash(identity(config))
    data = path.read_bytes()
    checksum = shards._checksum(whose, 0, 6, memoryview(data)[shards.USER_BLOCK :])
    header = f"radhar shard of {whose}\nrows 0 6\nsha256 {checksum}\n".encode()
    path.write_bytes(header.ljust(shards.USER_BLOCK, b"\0") + data[shards.USER_BLOCK :])


def _external(file: h5py.File) -> None:
    del file["maps/stft"]
    file["maps/stft"] = h5py.ExternalLink("/dev/zero", "/")


def _labels(file: h5py.File) -> None:
    del file["entropy/stft"]
    file["entropy/stft"] = ["a"] * 6


def _short(file: h5py.File) -> None:
    del file["maps/stft"]
    file.create_dataset("maps/stft", (5, 32, 32), "u1", chunks=(1, 32, 32))


def _huge(file: h5py.File) -> None:
    del file["scene"]
    file.create_dataset("scene", (10**9, 10), "f8")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (_external, "/maps/stft: is a link"),
        (_labels, "/entropy/stft: is of the type"),
        (_short, "/maps/stft: has the shape"),
        (_huge, "/scene: has the shape"),
    ],
)
def test_shards_are_checked_like_data_sets(
    change: Callable[[h5py.File], None], expected: str, tmp_path: Path
) -> None:
    (tmp_path / "c.yaml").write_text(SET)
    folder = tmp_path / "out"
    shard(folder, change)
    named = identity(load_config(tmp_path / "c.yaml"))
    (folder / ".radhar/identity.json").write_text(json.dumps(named))
    message = radhar("generate", tmp_path / "c.yaml", "-o", folder, "--jobs", 1)
    assert f"rows-000000000-000000006.h5: {expected}" in message
    assert not (folder / "dataset.h5").exists()
