"""The data card, and PNG folders of large classes."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml
from helpers.command_line import ROOT
from helpers.listener import Listener
from helpers.small import fingerprint, small_config
from PIL import Image

from radhar_cli.config import Config, load_config
from radhar_cli.dataset import layout
from radhar_cli.dataset.build import build
from radhar_cli.dataset.card import BIBTEX
from radhar_cli.dataset.identity import versions
from radhar_cli.dataset.verify import verify
from radhar_cli.learning.images.opening import open_images

PEOPLE = """
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 1000}
activities: [punching]
samples_per_class: 4
duration_s: 1.5
motion: {range_m: 3}
people: [{activity: kicking, share: 0.5, motion: {range_m: 5}}]
image: {size_px: 16}
split: {train: 0.5, validation: 0.5}
"""
CHANGES = [
    "maps=[rtm, stft]",
    "image.size_px=[12, 16]",
    "split={by: subject, subjects: 3, train: 0.34, validation: 0.33, test: 0.33}",
    "output.license=cc-by-4.0",
]


def config(place: Path, *more: str) -> Config:
    return load_config(small_config(place), [*CHANGES, *more])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("card")
    build(config(place), place / "set", 1, Listener())
    return place / "set"


@pytest.fixture
def copy(whole: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "set"))


def test_the_card_describes_the_data_set(whole: Path) -> None:
    text = (whole / "README.md").read_text()
    assert "| 1 | `walking` | walks | 1 | 1 | 1 |" in text
    assert "none of the 3 is in two of its parts" in text
    assert "a joint moves faster than the Doppler PRF/2" in text
    for library, version in versions().items():
        assert f"{library} {version}" in text
    assert "(gallery.png)" in text
    with Image.open(whole / "gallery.png") as picture:
        assert picture.width >= 160


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
    found = "noise alone tells who hardly moves" in (tmp_path / "set/README.md").read_text()
    assert found == said


def test_the_citation_is_that_of_the_project() -> None:
    wanted = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    (paper,) = wanted["references"]
    who = paper["authors"][0]
    for text in (
        wanted["title"],
        paper["title"],
        str(paper["year"]),
        f"{who['family-names']}, {who['given-names']}",
    ):
        assert f"{{{text}}}" in BIBTEX


def test_a_missing_card_is_written_again(copy: Path, tmp_path: Path) -> None:
    before = fingerprint(copy)
    (copy / "README.md").unlink()
    build(config(tmp_path), copy, 1, Listener())
    assert fingerprint(copy) == before


def test_an_edited_card_is_kept_until_overwrite(copy: Path, tmp_path: Path) -> None:
    card = copy / "README.md"
    text = card.read_text().replace("cc-by-4.0", "mit").replace("# Simulated", "# My simulated")
    card.write_text(text)
    build(config(tmp_path), copy, 1, Listener())
    assert card.read_text() == text
    assert verify(copy, 0).problems == []
    build(config(tmp_path), copy, 1, Listener(), overwrite=True)
    assert "license: cc-by-4.0" in card.read_text()


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
    assert sorted(images.samples.name) == sorted(ours.samples.name)
    for row, name in enumerate(images.samples.name):
        same = ours.samples.name.tolist().index(name)
        assert images.classes[images.samples.label[row]] == ours.classes[ours.samples.label[same]]
        assert np.array_equal(images.pixels.read(row), ours.pixels.read(same))


def test_the_card_says_what_classes_mean_and_what_sides_of_images_are(whole: Path) -> None:
    text = (whole / "README.md").read_text()
    assert "| label | class | who |" in text
    assert "| `walking` | walks |" in text
    assert "| `walking_to_falling` | walks and falls |" in text
    assert "`stft`, across: slow time, " in text
    assert "dB below the noise floor of the image, brightest 30 dB" in text
    assert "an FMCW radar (" in text
    assert "url = {https://arxiv.org/abs/2509.06751}" in text
    assert "year = {2026}" in text


def test_an_audit_takes_the_place_that_the_card_leaves_for_it(whole: Path) -> None:
    from radhar_cli.study.audit.card import with_section

    text = with_section((whole / "README.md").read_text(), "## Who is told apart by what\n\nX.")
    assert text.count("## Who is told apart by what") == 1
    assert "Not audited yet" not in text


def test_the_card_of_a_board_counts_points_frames_and_skeletons(tmp_path: Path) -> None:
    from helpers.boards import CFG, CLOUDS

    (tmp_path / "board.cfg").write_text(CFG)
    (tmp_path / "config.yaml").write_text(CLOUDS)
    build(load_config(tmp_path / "config.yaml"), tmp_path / "set", 1, Listener())
    text = (tmp_path / "set/README.md").read_text()
    assert "point clouds and maps of human activities" in text
    for name in ("points", "points_start", "points_person", "skeleton", "range_doppler"):
        assert f"| `/products/{name}` |" in text
    assert "points on average" in text
    assert "never what it may see" in text


def test_the_card_counts_people(tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text(PEOPLE)
    build(load_config(path), tmp_path / "set", 1, Listener())
    text = (tmp_path / "set/README.md").read_text()
    assert "| people in the scene |" in text
    assert "-1 of who is not there" in text


def test_every_class_has_a_meaning_if_only_its_name() -> None:
    from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
    from radhar_cli.motion.activities.meanings import MEANINGS, meaning_of_class

    assert all(meaning_of_class(activity) == MEANINGS[activity.slug] for activity in ACTIVITIES)
    assert (
        meaning_of_class(activity_named("left_side_lunge")) == "lunges to the left, again and again"
    )


def test_every_movement_has_a_meaning_of_the_posture_in_which_it_is_made() -> None:
    from radhar_cli.motion.activities.activity import activity_named
    from radhar_cli.motion.activities.meanings import meaning_of_class
    from radhar_cli.motion.movements import gestures
    from radhar_cli.motion.movements.catalogue import MOVEMENTS

    meanings = {name: meaning_of_class(activity_named(name)) for name in MOVEMENTS}
    assert not [name for name, meaning in meanings.items() if meaning == name.replace("_", " ")]
    verbs = {"standing": "stands and ", "seated": "sits and "}
    for kind in gestures.MOVEMENTS:
        assert meanings[kind.name].startswith(verbs[kind.before])
