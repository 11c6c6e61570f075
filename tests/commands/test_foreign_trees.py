"""`inspect` of anyone's tree of class folders."""

import json

import pytest
from PIL import Image
from typer.testing import CliRunner

from radhar_cli.cli import program
from radhar_cli.errors import FolderError


def radhar(*arguments):
    return CliRunner().invoke(program(), [str(argument) for argument in arguments])


def picture(path, size, colour):
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.new("RGB", size[::-1], colour).save(path)


@pytest.fixture
def photos(tmp_path):
    """Two classes in two splits, two formats, two sizes."""
    root = tmp_path / "photos"
    for number in range(3):
        picture(root / f"train/cats/{number}.jpg", (40, 30), (200, 30, 30))
        picture(root / f"train/big_dogs/{number}.png", (40, 30), (30, 200, 30))
    picture(root / "val/big_dogs/a.png", (64, 64), (30, 30, 200))
    return root


def test_inspect_counts_classes_splits_and_sizes(photos):
    found = json.loads(radhar("inspect", photos, "--json").stdout)
    assert found["kind"] == "tree of images"
    assert found["samples"] == 7
    assert found["bytes"] == sum(p.stat().st_size for p in photos.rglob("*.*"))
    assert found["classes"] == {
        "big_dogs": {"train": 3, "validation": 1, "test": 0},
        "cats": {"train": 3, "validation": 0, "test": 0},
    }
    assert found["sizes"] == [{"size": [40, 30], "images": 6}, {"size": [64, 64], "images": 1}]
    table = " ".join(radhar("inspect", photos).stdout.split())
    for word in ("samples: 7", "size: [40, 30] images: 6", "big_dogs", "validation"):
        assert word in table


def test_inspect_of_a_tree_without_splits(photos):
    found = json.loads(radhar("inspect", photos / "train", "--json").stdout)
    assert found["classes"] == {"big_dogs": {"images": 3}, "cats": {"images": 3}}


def test_paths_that_are_no_trees_are_named(tmp_path, photos):
    (tmp_path / "empty").mkdir()
    (photos / "train/cats/broken.png").write_bytes(b"no image")
    for command, path, expected in (
        ("inspect", tmp_path / "empty", "holds no class folders with images"),
        ("preview", photos, "no such file"),
        ("inspect", photos, "broken.png: is not an image"),
    ):
        error = radhar(command, path).exception
        assert isinstance(error, FolderError)
        assert expected in str(error)
