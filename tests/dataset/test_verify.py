"""`verify` finds every change of a data set."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.listener import Listener
from helpers.small import SMALL, small_config
from PIL import Image

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import Config, load_config
from radhar_cli.config.identity import config_hash
from radhar_cli.dataset.build import build
from radhar_cli.dataset.png import colour_table, encode_png
from radhar_cli.dataset.summary import summarise
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import FolderError
from radhar_cli.readers.untrusted_hdf5 import DIGESTS, attribute_digests


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Config:
    return load_config(small_config(tmp_path_factory.mktemp("config")))


@pytest.fixture(scope="module")
def whole(config: Config, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("verify")
    build(config, place / "set", 1, BarProgress())
    return place / "set"


def test_untouched_data_set_is_right(whole: Path) -> None:
    report = verify(whole, 100)
    assert report.problems == []
    assert report.resynthesised == 9
    assert report.worst_level == 0
    assert report.pngs == 27


def _flip_level(file: h5py.File) -> None:
    file["maps/stft"][4, 20, 20] ^= 1


def _flip_level_and_checksum(file: h5py.File) -> None:
    import hashlib

    levels = file["maps/stft"][4]
    levels[20, 20] ^= 1
    file["maps/stft"][4] = levels
    file["sha256/stft"][4] = hashlib.sha256(levels.tobytes()).hexdigest()


def _relabel(file: h5py.File) -> None:
    file["label"][0] = 2


def _resplit(file: h5py.File) -> None:
    file["split"][:] = 1 - file["split"][:]


def _reseed(file: h5py.File) -> None:
    file.attrs["seed"] = 8


def _move(file: h5py.File) -> None:
    file["scene/range"][4] += 0.1


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        (_flip_level, "checksum"),
        (_flip_level_and_checksum, "differs by up to 1 grey level"),
        (_relabel, "/label: 1 wrong"),
        (_resplit, "/split"),
        (_reseed, "/: attributes differ"),
        (_move, "/scene/range[4]"),
    ],
)
def test_damage_is_found(
    whole: Path, tmp_path: Path, damage: Callable[[h5py.File], None], expected: str
) -> None:
    shutil.copytree(whole, tmp_path / "set")
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        damage(file)
    assert any(expected in problem for problem in verify(tmp_path / "set", 9).problems)


ATTRIBUTES = {
    "/": ("class_slugs", "class_names", "warnings", "identity", "columns_sha256"),
    "maps/stft": ("row_top", "row_unit", "dynamic_range_db", "kind", "levels"),
    "scene/snr": ("unit", "config_key"),
    "extent/stft": ("columns",),
}


@pytest.mark.parametrize("way", ["changed", "deleted"])
@pytest.mark.parametrize(
    ("place", "name"), [(place, name) for place, names in ATTRIBUTES.items() for name in names]
)
def test_attributes_are_those_that_were_built(
    whole: Path, tmp_path: Path, place: str, name: str, way: str
) -> None:
    shutil.copytree(whole, tmp_path / "set")
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        if way == "deleted" and name not in ("class_slugs", "class_names", "warnings", "identity"):
            del file[place].attrs[name]
        elif isinstance(file[place].attrs[name], str):
            text = file[place].attrs[name]
            file[place].attrs[name] = text.replace('"', "' '") if text[:1] in "{[" else text + "!"
        else:
            file[place].attrs[name] = 7
    try:
        problems = verify(tmp_path / "set", 1).problems
    except FolderError as error:  # of what nothing can be read without
        problems = [str(error)]
    assert problems


def test_what_was_not_built_is_named(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path / "set")
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        file["maps/foo"] = [1, 2]
    shutil.copytree(tmp_path / "set/png/stft", tmp_path / "set/png/stft2")
    shutil.rmtree(tmp_path / "set/png/rtm")
    problems = verify(tmp_path / "set", 1).problems
    assert "maps/foo: was not built" in problems
    assert "png/stft2: is no map of this data set" in problems
    assert "png/rtm: is missing" in problems
    shutil.rmtree(tmp_path / "set/png")
    problems = verify(tmp_path / "set", 1).problems
    assert "png: is missing; `radhar generate` makes it again" in problems


def test_an_empty_class_folder_is_none_of_its_own(whole: Path, tmp_path: Path) -> None:
    """ImageFolder would count it."""
    shutil.copytree(whole, tmp_path / "set")
    (tmp_path / "set/png/stft/train/dancing").mkdir()
    problems = verify(tmp_path / "set", 1).problems
    assert problems == ["png/stft/train/dancing: is no class of this data set"]


def test_tables_beside_the_images_are_checked(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path / "set")
    table = tmp_path / "set/png/stft/train/metadata.csv"
    table.write_text(table.read_text().replace("punching,", "walking,", 1))
    (tmp_path / "set/png/rtm/classes.txt").unlink()
    assert verify(tmp_path / "set", 0).problems == [
        "png/rtm/classes.txt: is missing; `radhar generate` makes it again",
        "png/stft/train/metadata.csv: is not that of dataset.h5",
    ]


def test_persons_are_those_of_the_config(tmp_path: Path) -> None:
    shares = "split: {by: subject, subjects: 3, train: 0.34, validation: 0.66}"
    text = SMALL.replace("split: {train: 0.67, validation: 0.33}", shares)
    build(load_config(small_config(tmp_path, text)), tmp_path / "set", 1, Listener())
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        file["scene/subject"][0] += 1
    assert "/scene/subject: 1 wrong values" in verify(tmp_path / "set", 0).problems


@pytest.mark.parametrize("name", ["columns_sha256", "attributes_sha256"])
def test_checksums_that_are_no_mapping_are_a_problem(
    whole: Path, tmp_path: Path, name: str
) -> None:
    shutil.copytree(whole, tmp_path / "set")
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        file.attrs[name] = "[]"
    assert f"attribute {name}: should be a mapping" in verify(tmp_path / "set", 0).problems


def test_files_that_a_virtual_dataset_names_are_not_opened(whole: Path, tmp_path: Path) -> None:
    """Opening a pipe that nobody writes to would wait for ever."""
    shutil.copytree(whole, tmp_path / "set")
    os.mkfifo(tmp_path / "pipe")
    layout = h5py.VirtualLayout((4,), "u1", maxshape=(None,))
    source = h5py.VirtualSource(str(tmp_path / "pipe"), "x", (4,), maxshape=(None,))
    layout[: h5py.h5s.UNLIMITED] = source[: h5py.h5s.UNLIMITED]
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        file.create_virtual_dataset("extra", layout)
    command = [sys.executable, "-m", "radhar_cli", "verify", str(tmp_path / "set"), "--samples"]
    done = subprocess.run([*command, "0"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 1
    assert "WRONG extra: was not built" in done.stdout + done.stderr


def _widen_an_extent(folder: Path) -> None:
    with h5py.File(folder / "dataset.h5", "r+") as file:
        file["extent/stft"][3, 1] += 0.5


def _change_an_entropy(folder: Path) -> None:
    with h5py.File(folder / "dataset.h5", "r+") as file:
        file["entropy/stft"][3] += 0.5


def _edit_the_table(folder: Path) -> None:
    lines = (folder / "scenes.csv").read_text().splitlines()
    cells = lines[2].split(",")
    cells[-1] = "7.25"
    (folder / "scenes.csv").write_text("\n".join([*lines[:2], ",".join(cells), *lines[3:], ""]))


def _lose_the_table(folder: Path) -> None:
    (folder / "scenes.csv").unlink()


def _seed_the_config(folder: Path) -> None:
    path = folder / "config.yaml"
    path.write_text(path.read_text().replace("seed: ", "seed: 1"))


def _add_an_image(folder: Path) -> None:
    image = next((folder / "png/stft").rglob("*.png"))
    shutil.copy(image, image.with_name("mine.png"))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (_widen_an_extent, "/extent/stft: does not match"),
        (_change_an_entropy, "/entropy/stft: does not match"),
        (_edit_the_table, "scenes.csv: is not that of"),
        (_lose_the_table, "scenes.csv: is missing"),
        (_seed_the_config, "config.yaml: is not the config"),
        (_add_an_image, "mine.png: is no image of this data set"),
    ],
)
def test_what_follows_from_the_data_set_is_compared_with_it(
    whole: Path, tmp_path: Path, change: Callable[[Path], None], expected: str
) -> None:
    shutil.copytree(whole, tmp_path / "set")
    assert verify(tmp_path / "set", 0).problems == []
    change(tmp_path / "set")
    problems = verify(tmp_path / "set", 0).problems
    assert any(expected in problem for problem in problems), problems


def test_the_largest_decibels_are_checked(config: Config, tmp_path: Path) -> None:
    output = config.output.model_copy(update={"power": "float16"})
    build(config.model_copy(update={"output": output}), tmp_path, 1, Listener())
    with h5py.File(tmp_path / "dataset.h5", "r+") as file:
        file["largest_db/stft"][1] += 3
    problems = verify(tmp_path, 0).problems
    assert problems == ["/largest_db/stft: does not match its checksum"]


def _digest_anew(file: h5py.File) -> None:
    """As where the attributes were built so."""
    file.attrs[DIGESTS] = json.dumps(attribute_digests(file))


def test_a_data_set_from_before_newer_keys_is_of_another_version_and_not_wrong(
    whole: Path, tmp_path: Path
) -> None:
    shutil.copytree(whole, tmp_path / "set")
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        stored = json.loads(file.attrs["config"])
        del stored["room"]["back_wall_m"]
        file.attrs["config"] = json.dumps(stored)
        file.attrs["config_hash"] = config_hash(stored)
        file.attrs["radhar_version"] = "0.1.0+before"
        _digest_anew(file)
    report = verify(tmp_path / "set", 2)
    assert report.problems == []
    assert report.other_versions[0].startswith("radhar 0.1.0+before there")


def test_other_versions_compare_within_one_level(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path / "set")
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        file.attrs["numpy_version"] = "1.0"
        _flip_level_and_checksum(file)
        _digest_anew(file)
    shutil.rmtree(tmp_path / "set/png")
    shutil.rmtree(tmp_path / "set/.radhar")
    report = verify(tmp_path / "set", 9)
    assert report.other_versions[0].startswith("numpy 1.0 there")
    assert report.problems == []
    assert report.worst_level == 1


def test_a_version_that_is_not_named_is_another(whole: Path, tmp_path: Path) -> None:
    """As isal's of what was built before it was used."""
    shutil.copyfile(whole / "dataset.h5", tmp_path / "dataset.h5")
    with h5py.File(tmp_path / "dataset.h5", "r+") as file:
        here = file.attrs["isal_version"]
        del file.attrs["isal_version"]
        _digest_anew(file)
    report = verify(tmp_path, 9)
    assert report.other_versions == [f"isal unknown there, {here} here"]
    assert report.problems == []
    found = summarise(tmp_path)["versions"]
    assert (found["isal"], found["numpy"]) == ("unknown", np.__version__)


def test_changed_and_missing_pngs_are_found(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path / "set")
    first, second, third, fourth = sorted((tmp_path / "set/png/rtm").rglob("*.png"))[:4]
    Image.fromarray(np.zeros((48, 48, 3), np.uint8)).save(first)
    second.unlink()
    with Image.open(third) as picture:  # the same colours, no levels
        picture.convert("RGB").save(third)
    with Image.open(fourth) as picture:
        levels = np.asarray(picture)
    fourth.write_bytes(encode_png(levels, colour_table("gray"), 1))
    problems = verify(tmp_path / "set", 0).problems
    assert len(problems) == 4
    assert any("cannot be read" in problem for problem in problems)


def test_a_folder_of_motion_files_that_is_not_there_is_refused(whole: Path, tmp_path: Path) -> None:
    with pytest.raises(FolderError, match="nowhere: no such folder"):
        verify(whole, 0, tmp_path / "nowhere")


def test_what_is_no_data_set_is_refused(whole: Path, tmp_path: Path) -> None:
    with pytest.raises(FolderError, match="no such file"):
        verify(tmp_path, 1)
    (tmp_path / "dataset.h5").write_bytes((whole / "dataset.h5").read_bytes()[:5000])
    with pytest.raises(FolderError, match="not an HDF5 file, or is truncated"):
        verify(tmp_path, 1)
