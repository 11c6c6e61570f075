"""Files for the Hugging Face hub: data card, picture, metadata.csv."""

import csv
import math
import re
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
import yaml
from command_line import ROOT
from listener import Listener
from PIL import Image
from small import fingerprint, small_config

from radhar_cli.config import Config, load_config
from radhar_cli.dataset import layout
from radhar_cli.dataset.build import build
from radhar_cli.dataset.card import BIBTEX
from radhar_cli.dataset.identity import versions
from radhar_cli.dataset.verify import verify
from radhar_cli.learning.images.opening import open_images

CHANGES = [
    "maps=[rtm, stft]",
    "image.size_px=[12, 16]",
    "split={by: subject, subjects: 3, train: 0.34, validation: 0.33, test: 0.33}",
    "output.license=cc-by-4.0",
]
FOLDERS = {"train": "train", "validation": "val", "test": "test"}


def config(place: Path, *more: str) -> Config:
    return load_config(small_config(place), [*CHANGES, *more])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("hub")
    build(config(place), place / "set", 1, Listener())
    return place / "set"


@pytest.fixture
def copy(whole: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "set"))


def front(folder: Path) -> dict:
    _, text, _ = (folder / "README.md").read_text().split("---\n", 2)
    return yaml.safe_load(text)


def test_metadata_csv_agrees_with_dataset_h5(whole: Path) -> None:
    with h5py.File(whole / "dataset.h5") as file:
        key, split, scene = file["sample_key"][:], file["split"][:], file["scene"]
        slugs = file.attrs["class_slugs"]
        for name in ("rtm", "stft"):
            seen = []
            for number, folder in enumerate(FOLDERS.values()):
                place = whole / "png" / name / folder
                with (place / "metadata.csv").open(newline="") as text:
                    lines = list(csv.DictReader(text))
                images = {p.relative_to(place).as_posix() for p in place.rglob("*.png")}
                assert {line["file_name"] for line in lines} == images
                assert len({line["label"] for line in lines[:3]}) == 3, "classes take turns"
                for line in lines:
                    label = list(slugs).index(line["label"])
                    row = int(np.flatnonzero((key == [label, int(line["index"])]).all(axis=1))[0])
                    seen.append(row)
                    assert split[row] == number
                    assert int(line["subject"]) == scene["subject"][row]
                    with Image.open(place / line["file_name"]) as image:
                        assert np.array_equal(np.asarray(image), file[f"maps/{name}"][row])
                    assert "snr" in line
                    assert not {"carrier", "error_db"} & line.keys(), (
                        "the same in all, or not drawn"
                    )
                    for column in line.keys() - {"file_name", "label", "index"}:
                        value = float(line[column] or math.nan)
                        np.testing.assert_equal(value, float(scene[column][row]))
            assert sorted(seen) == list(range(9))


def test_the_card_has_a_configuration_a_map(whole: Path) -> None:
    found = front(whole)
    assert (found["license"], found["size_categories"]) == ("cc-by-4.0", ["n<1K"])
    assert [one["config_name"] for one in found["configs"]] == ["rtm", "stft"]
    for one in found["configs"]:
        for part in one["data_files"]:
            path = f"png/{one['config_name']}/{FOLDERS[part['split']]}/**"
            assert part["path"] == path
            assert any(whole.glob(f"{path}/*.png"))
    with (whole / "png/stft/train/metadata.csv").open(newline="") as text:
        columns = next(csv.reader(text))
    names = [feature["name"] for feature in found["configs"][1]["features"]]
    assert names == ["image", *columns[1:]]


def test_the_card_describes_the_data_set(whole: Path) -> None:
    text = (whole / "README.md").read_text()
    assert "| 7 | `walking` | 1 | 1 | 1 |" in text
    assert '\nmaps: ["rtm", "stft"]\n' in text
    assert "\nradar.carrier_hz: 10000000000.0\n" in text
    assert "none of the 3 is in two of its parts" in text
    assert "a joint moves faster than the Doppler PRF/2" in text
    assert "](gallery.png)" in text
    for library, version in versions().items():
        assert f"{library} {version}" in text
    with Image.open(whole / "gallery.png") as picture:
        assert picture.width > 3 * 72
        colours = len(picture.convert("RGB").getcolors(2**16))
    assert colours > 20, "there are maps in it"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("seed=7", True),
        ("processing={clutter: highpass, highpass: {cutoff_hz: 10}}", True),
        ("processing.clutter=mean", False),
        ("snr_db=null", False),
    ],
)
def test_the_card_says_what_noise_alone_tells(change: str, said: bool, tmp_path: Path) -> None:
    """Of a canceller that removes slow motion, where there is noise to be left."""
    build(config(tmp_path, change), tmp_path / "set", 1, Listener())
    found = "noise alone tells `stationary`" in (tmp_path / "set/README.md").read_text()
    assert found == said


def test_the_citation_is_that_of_the_project() -> None:
    wanted = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    paper = wanted["preferred-citation"]
    who = paper["authors"][0]
    for text in (
        wanted["title"],
        paper["title"],
        str(paper["year"]),
        f"{who['family-names']}, {who['given-names']}",
    ):
        assert f"{{{text}}}" in BIBTEX


def test_missing_hub_files_are_written_again(copy: Path, tmp_path: Path) -> None:
    before = fingerprint(copy)
    for name in ("README.md", "gallery.png", "png/rtm/val/metadata.csv"):
        (copy / name).unlink()
    build(config(tmp_path), copy, 1, Listener())
    assert fingerprint(copy) == before


def test_images_that_are_added_later_come_with_their_metadata(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / "set"
    build(config(tmp_path, "output.png=false"), folder, 1, Listener())
    assert "configs" not in front(folder)
    build(config(tmp_path), folder, 1, Listener())
    right, found = fingerprint(whole), fingerprint(folder)
    for name in ("dataset.h5", "config.yaml"):  # which say how the folder was asked for first
        del right[name], found[name]
    assert found == right


def test_an_edited_card_is_kept_until_overwrite(copy: Path, tmp_path: Path) -> None:
    card = copy / "README.md"
    text = card.read_text().replace("cc-by-4.0", "mit").replace("# Simulated", "# My simulated")
    card.write_text(text)
    build(config(tmp_path), copy, 1, Listener())
    assert card.read_text() == text
    assert verify(copy, 0).problems == []
    build(config(tmp_path), copy, 1, Listener(), overwrite=True)
    assert "license: cc-by-4.0" in card.read_text()


def _digit(path: Path) -> None:
    text = path.read_text()
    end = text.index("\n", text.index("\npunching/") + 1)
    path.write_text(f"{text[:end]}1{text[end:]}")


def _cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-5])


def _more(path: Path) -> None:
    path.write_text(path.read_text() + "walking/00009.png\n")


@pytest.mark.parametrize(
    ("name", "damage", "expected"),
    [
        ("png/rtm/val/metadata.csv", _digit, "does not say what dataset.h5 does"),
        ("png/stft/train/metadata.csv", _cut, "does not say"),
        ("png/stft/test/metadata.csv", _more, "does not say"),
        ("png/stft/test/metadata.csv", Path.unlink, "cannot be read"),
        ("README.md", lambda p: p.write_text(p.read_text().replace("/train", "/t")), "configs"),
        ("README.md", lambda p: p.write_text("---\n{\n---\n"), "cannot be read"),
        ("README.md", lambda p: p.write_text("hello\n"), "configs"),
        ("README.md", lambda p: p.write_text(f"hello\n{p.read_text()}"), "configs"),
        ("README.md", lambda p: p.write_bytes(p.read_bytes().replace(b"\n", b"\r\n")), None),
        ("README.md", Path.unlink, "cannot be read .no such file"),
        ("gallery.png", _cut, None),
        ("gallery.png", lambda p: p.write_bytes(b"no image"), "not an image"),
    ],
)
def test_verify_finds_damage(copy: Path, name: str, damage, expected: str | None) -> None:
    damage(copy / name)
    problems = verify(copy, 0).problems
    assert len(problems) == (expected is not None), problems
    if expected is not None:
        assert name in problems[0]
        assert re.search(expected, problems[0])


def test_every_reader_finds_the_subfolders_of_large_classes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(layout, "PNGS_A_FOLDER", 2)
    folder = tmp_path / "set"
    sizes = "samples_per_class={per_activity: {default: 2, walking: 5}}"
    few = config(tmp_path, sizes, "split={train: 0.6, validation: 0.4}")
    build(few, folder, 1, Listener())
    tree = folder / "png/stft"
    named = sorted(p.relative_to(tree).as_posix().split("/", 1)[1] for p in tree.rglob("*.png"))
    assert named == [
        *(f"punching/0000{n}.png" for n in (0, 1)),
        *(f"walking/000{n // 2}/0000{n}.png" for n in range(5)),
        *(f"walking_to_falling/0000{n}.png" for n in (0, 1)),
    ]
    report = verify(folder, 0)
    assert (report.pngs, report.problems) == (18, [])
    before = fingerprint(folder)
    for path in sorted(folder.rglob("00003.png")):
        path.unlink()
    assert build(few, folder, 1, Listener()).pngs == 2
    assert fingerprint(folder) == before
    images, ours = open_images(tree, None, "gray"), open_images(folder, "stft", "gray")
    assert sorted(images.names) == sorted(ours.names)
    for row, name in enumerate(images.names):
        same = ours.names.index(name)
        assert images.classes[images.label[row]] == ours.classes[ours.label[same]]
        assert np.array_equal(images.pixels.read(row), ours.pixels.read(same))
