"""Labelled images: dataset.h5 and trees of class folders say the same."""

import pickle
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.listener import Listener
from helpers.small import small_config
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from learning.patterns import clear_line, settings, split_tree, stripes, tree
from PIL import Image

from radhar_cli.config import load_config
from radhar_cli.dataset import reading
from radhar_cli.dataset.build import build
from radhar_cli.dataset.image_file import luminance, read_gray, read_rgb
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.images.image_set import ImageSet, check_split_name, labels_for
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.images.sample_table import SampleTable, objects
from radhar_cli.learning.images.scan import content_hash, scan
from radhar_cli.learning.training_set import open_training_set
from radhar_cli.numerics.rounding import half_up

SET = """
seed: 3
samples_per_class: 4
activities: [walking, S12, punching]
duration_s: 2.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
snr_db: 20
maps: [rtm, stft]
image: {size_px: 32}
split: {train: 0.5, validation: 0.25, test: 0.25}
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A data set of ours, classes named out of their order."""
    place = tmp_path_factory.mktemp("made")
    build(load_config(small_config(place, SET)), place / "set", progress=Listener(), jobs=1)
    return place / "set"


def pixels(images, rows):
    return np.stack([images.pixels.read(int(row)) for row in rows])


@pytest.mark.parametrize("kind", ["rgb", "gray"])
@pytest.mark.parametrize("map_name", ["rtm", "stft"])
def test_hdf5_and_png_are_the_same_images_in_the_same_order(made, kind, map_name):
    stored = open_images(made, map_name, kind)
    hashes = set()
    for place, name in ((made / "png", map_name), (made / "png" / map_name, None)):
        files = open_images(place, name, kind)
        assert files.classes == stored.classes == ("walking", "walking_to_falling", "punching")
        assert files.size == stored.size == (32, 32)
        for split, count in (("train", 6), ("val", 3), ("test", 3)):
            ours, theirs = stored.rows(split), files.rows(split)
            assert len(ours) == len(theirs) == count
            assert np.array_equal(stored.samples.label[ours], files.samples.label[theirs])
            assert [stored.samples.name[r] for r in ours] == [files.samples.name[r] for r in theirs]
            assert np.array_equal(pixels(stored, ours), pixels(files, theirs))
        for images in (stored, files):
            rows = np.concatenate([images.rows("train"), images.rows("val")])
            hashes.add(content_hash(images, rows, scan(images, rows).digests))
    assert len(hashes) == 1
    channels = pixels(stored, stored.rows("train"))
    assert channels.shape[-1] == stored.channels == (1 if kind == "gray" else 3)


def test_gray_is_the_stored_level(made):
    import h5py

    with h5py.File(made / "dataset.h5") as file:
        levels = file["maps/stft"][3]
    read = open_images(made, "stft", "gray").pixels.read(3)
    assert np.array_equal(read, levels[..., None])


def test_levels_of_radhar_pngs_are_read_without_their_data_set(made, tmp_path):
    """Of no other palette: a screenshot with 16 colours is read by its brightness."""
    own = next((made / "png/stft/train/walking").glob("*.png"))
    right = read_gray(own)
    shutil.copy(own, tmp_path / "moved.png")
    assert np.array_equal(read_gray(tmp_path / "moved.png"), right)
    with Image.open(own) as picture:
        picture.convert("RGB").quantize(16).save(tmp_path / "few.png")
    few = tmp_path / "few.png"
    assert np.array_equal(read_gray(few), luminance(read_rgb(few)))


def test_gray_of_a_foreign_image_is_its_brightness(tmp_path):
    split_tree(tmp_path / "t")
    rgb = open_images(tmp_path / "t", None, "rgb").pixels.read(0)
    gray = open_images(tmp_path / "t", None, "gray").pixels.read(0)
    expected = rgb @ np.array([0.299, 0.587, 0.114])
    assert np.abs(gray[..., 0] - expected).max() <= 0.5 + 1e-9
    assert luminance(np.full((1, 1, 3), 255, np.uint8))[0, 0] == 255


def test_hash_covers_pixels_labels_classes_and_splits(made):
    images = open_images(made, "stft", "rgb")
    rows = images.rows("train")
    digests = scan(images, rows).digests
    right = content_hash(images, rows, digests)

    def with_column(**column):
        return replace(images, samples=replace(images.samples, **column))

    assert content_hash(images, rows, digests) == right
    assert content_hash(images, rows, digests[::-1]) != right
    assert content_hash(with_column(label=images.samples.label[::-1]), rows, digests) != right
    assert content_hash(replace(images, classes=("a", "b", "c")), rows, digests) != right
    assert content_hash(with_column(split=1 - images.samples.split), rows, digests) != right


def test_first_map_is_read_if_none_is_named_and_a_wrong_one_is_suggested(made):
    assert open_images(made, None, "rgb").map == "rtm"
    with clear_line(FolderError, "did you mean 'stft'"):
        open_images(made, "stftt", "rgb")


def test_subjects_and_snr_are_read_from_the_scenes(made):
    images = open_images(made, None, "rgb")
    assert images.samples.scene is not None
    assert len(set(images.samples.scene)) == len(images)
    assert images.snr_db == 20.0


def test_labels_of_a_tree_are_those_of_its_classes_txt_or_of_the_alphabet(tmp_path):
    root = tree(tmp_path / "t", ("walking", "stationary", "apple"), {"train": 2, "val": 1})
    assert open_images(root, None, "rgb").classes == ("apple", "stationary", "walking")
    (root / "classes.txt").write_text("walking\nextra\napple\nstationary\n")
    for place in (root, root / "val"):
        assert open_images(place, None, "rgb").classes == (
            *("walking", "extra", "apple", "stationary"),
        )
    (root / "classes.txt").write_text("another\nlist\n")
    assert open_images(root, None, "rgb").classes == ("apple", "stationary", "walking")


def test_classes_are_matched_by_name_not_by_number(tmp_path):
    images = open_images(tree(tmp_path / "t", ("b", "d"), {"test": 2}), None, "rgb")
    assert images.samples.label.tolist() == [0, 0, 1, 1]
    assert labels_for(images, ("d", "c", "b")).tolist() == [2, 2, 0, 0]


@pytest.mark.parametrize("name", ["val", "validation", "valid", "Val"])
def test_folders_named_like_splits_are_splits(tmp_path, name):
    root = tree(tmp_path / "t", parts={"train": 3, name: 2, "test": 1})
    images = open_images(root, None, "rgb")
    assert images.samples.split is not None
    counts = [images.rows(split).size for split in ("train", "val", "test", "all")]
    assert counts == [9, 6, 3, 18]
    assert images.samples.name[0] == "kicking/000"


def test_a_tree_without_splits_is_split_by_class_reproducibly(tmp_path):
    root = tree(tmp_path / "t", ("a", "b"), {"": 10})
    images = open_images(root, None, "rgb")
    assert images.samples.split is None
    cut = images.cut(0.2, 1)
    assert np.bincount(cut.samples.label[cut.rows("val")]).tolist() == [2, 2]
    assert np.bincount(cut.samples.label[cut.rows("train")]).tolist() == [8, 8]
    assert cut.rows("val").tolist() == images.cut(0.2, 1).rows("val").tolist()
    others = {tuple(images.cut(0.2, seed).rows("val").tolist()) for seed in range(2, 6)}
    assert others - {tuple(cut.rows("val").tolist())}
    assert images.rows("all").size == 20
    for split in ("train", "val", "test"):
        with pytest.raises(FolderError, match=r"is not split into train and val; .* split = all"):
            images.rows(split)


@examples(max_examples=50)
@given(counts=st.lists(st.integers(2, 30), min_size=2, max_size=4), share=st.floats(0.01, 0.5))
def test_every_class_has_images_in_both_splits(counts, share):
    label = np.repeat(np.arange(len(counts)), counts)
    samples = SampleTable(label, name=objects(map(str, range(len(label)))), source=0 * label)
    kinds = tuple("abcd"[: len(counts)])
    images = ImageSet(Path("x"), None, kinds, samples, (32, 32), pixels=None)
    cut = images.cut(share, 0)
    for index, count in enumerate(counts):
        held = int((cut.samples.label[cut.rows("val")] == index).sum())
        assert held == min(max(1, half_up(share, count)), count - 1)
        assert held < count


def test_scan_gives_mean_and_spread_of_every_channel(tmp_path):
    images = open_images(split_tree(tmp_path / "t"), None, "rgb")
    rows = images.rows("train")
    found, levels = scan(images, rows), pixels(images, rows) / 255
    np.testing.assert_allclose(found.mean, levels.mean((0, 1, 2)), rtol=1e-12)
    np.testing.assert_allclose(found.sd, levels.std((0, 1, 2)), rtol=1e-9)
    assert len(set(found.mean)) == 3
    assert len(set(found.digests)) == rows.size


def test_constant_channel_has_unit_spread(tmp_path):
    folder = tmp_path / "a"
    folder.mkdir()
    Image.new("RGB", (32, 32), (9, 0, 255)).save(folder / "x.png")
    images = open_images(tmp_path, None, "rgb")
    assert scan(images, [0]).sd == (1.0, 1.0, 1.0)


def test_image_sets_are_pickled_without_open_files(made):
    images = open_images(made, "rtm", "rgb")
    first = images.pixels.read(1)
    again = pickle.loads(pickle.dumps(images.pixels))
    assert again._open == {}
    assert np.array_equal(again.read(1), first)


@pytest.mark.parametrize(("kind", "channels"), [("rgb", 3), ("gray", 1)])
def test_a_data_set_is_opened_once_in_a_process(made, monkeypatch, kind, channels):
    opened, validate = [], reading.validated

    def counted(*arguments):
        opened.append(arguments)
        return validate(*arguments)

    monkeypatch.setattr(reading, "validated", counted)
    images = open_images(made, "rtm", kind)
    assert images.pixels.read(0).shape == (*images.size, channels)
    assert images.take(np.array([1, 2])).pixels.read(1).nbytes == 32 * 32 * channels
    assert len(opened) == 1


def look_at_all(root):
    images = open_images(root, None, "rgb")
    scan(images, images.rows("all"))


def broken(tmp_path, what):
    """Trees and files that cannot be used, and what the message should name."""
    root = tmp_path / "t"
    if what == "nothing there":
        return root, ["no such file or folder"]
    if what == "empty folder":
        root.mkdir()
        return root, ["no class folders", "dataset.h5"]
    if what == "folders without images":
        (root / "old").mkdir(parents=True)
        return root, ["no class folders with images"]
    split_tree(root)
    first = root / "train/kicking/000.png"
    if what == "empty class":
        (root / "train/zebra").mkdir()
        return root, ["'zebra' has no image"]
    if what == "text as image":
        first.write_text("no image")
        return root, [str(first), "is not an image, or is truncated"]
    if what == "another size":
        Image.new("RGB", (64, 32)).save(first.with_name("999.png"))
        return root, ["999.png", "is 32 x 64 px; should be 32 x 32"]
    raise AssertionError(what)


@pytest.mark.parametrize(
    "what",
    [
        *("nothing there", "empty folder", "folders without images", "empty class"),
        *("text as image", "another size"),
    ],
)
def test_unusable_data_is_named(tmp_path, what):
    root, expected = broken(tmp_path, what)
    with clear_line(FolderError, *expected):
        look_at_all(root)


@pytest.mark.parametrize(
    ("with_images", "advice"),
    [
        (["images"], "'images' alone has images, so this may be no data set; should be dataset.h5"),
        (["images", "logos"], "every folder beside those of the classes should hold images"),
    ],
)
def test_a_folder_of_documents_is_told_from_a_data_set(tmp_path, with_images, advice):
    """As `radhar train docs/`, whose folders of text would be classes without images."""
    (tmp_path / "guide").mkdir()
    (tmp_path / "guide/index.md").write_text("# Guide")
    for name in with_images:
        (tmp_path / name).mkdir()
        Image.new("RGB", (32, 32)).save(tmp_path / name / "picture.png")
    with pytest.raises(FolderError) as error:
        open_training_set(settings(), tmp_path)
    assert "the class 'guide' has no image; " + advice in str(error.value)


def test_gray_and_other_formats_are_read_as_rgb(tmp_path):
    rng = np.random.default_rng(0)
    picture = Image.fromarray(stripes(0, rng))
    (tmp_path / "a").mkdir()
    picture.convert("L").save(tmp_path / "a/0.png")
    picture.convert("RGBA").save(tmp_path / "a/1.png")
    picture.save(tmp_path / "a/2.bmp")
    picture.save(tmp_path / "a/3.JPG", format="jpeg")
    (tmp_path / "a/notes.txt").write_text("not an image")
    images = open_images(tmp_path, None, "rgb")
    assert len(images) == 4
    read = pixels(images, images.rows("all"))
    assert read.shape == (4, 32, 32, 3)
    assert np.array_equal(read[1], read[2])
    assert (read[0][..., 0] == read[0][..., 2]).all()


@pytest.mark.parametrize(
    ("parts", "classes", "size", "expected"),
    [
        ({"train": 2, "val": 1}, ("a",), 32, "the class 'a' alone"),
        ({"train": 2, "test": 1}, ("a", "b"), 32, "no val images (it has 4 train, 2 test)"),
        ({"val": 2, "test": 1}, ("a", "b"), 32, "no train images"),
        ({"": 1}, ("a", "b"), 32, "the class 'a' has one image; should have two"),
    ],
)
def test_unusable_training_data_is_refused(tmp_path, parts, classes, size, expected):
    root = tree(tmp_path / "t", classes, parts, size)
    with clear_line(FolderError, expected, root):
        open_training_set(settings(), root)


def test_a_class_without_training_images_is_named(tmp_path):
    root = split_tree(tmp_path / "t", classes=("a", "b"))
    (root / "val/c").mkdir()
    Image.new("RGB", (32, 32)).save(root / "val/c/0.png")
    with pytest.raises(FolderError, match="'c' has no training image"):
        open_training_set(settings(), root)


def test_an_unknown_split_is_refused_with_a_suggestion():
    assert check_split_name("all") == "all"
    with pytest.raises(ConfigError, match="did you mean 'train'"):
        check_split_name("trian")


def test_persons_come_from_data_sets(tmp_path):
    by_person = "split={by: subject, subjects: 3, train: 0.34, validation: 0.33, test: 0.33}"
    sets = ("samples_per_class=5", "activities=[walking, punching]", "maps=[stft]", by_person)
    out, plain = tmp_path / "set", tmp_path / "plain"
    command = ("generate", "configs/quickstart.yaml", "--jobs", 1, "--set", "image.size_px=32")
    command = (*command, "--set", "output.png=false", "--set", "duration_s=1")
    assert radhar(*command, "-o", out, *(x for s in sets for x in ("--set", s))).returncode == 0
    ok(*command, "-o", plain, *(x for s in sets[:3] for x in ("--set", s)))
    images = open_images(out, None, "gray")
    of = [f"person {number} (seed 1)" for number in (0, 1, 2, 0, 1)]
    assert images.samples.person.tolist() == of * 2
    walking = images.renamed({"punching": None})
    assert walking.samples.person.tolist() == of
    assert open_images(plain, None, "gray").samples.person is None


@pytest.mark.parametrize("named", [True, False])
def test_persons_or_recordings_come_from_recorded_sets(tmp_path, named):
    x = (np.random.default_rng(0).random((6, 32, 32)) < 0.3).astype(np.uint8)
    who = {"person": np.array(list("aabbcc"))} if named else {}
    np.savez(tmp_path / "m.npz", masks=x, label=np.array(["walking", "falling"] * 3), **who)
    (tmp_path / "c.yaml").write_text(
        "maps: [stft]\nrecordings: {window_s: 5, rows: [-500, 500]}\n"
        "split: {train: 0.5, validation: 0.5}\n"
    )
    out = tmp_path / "set"
    ok("generate", tmp_path / "c.yaml", "--recordings", tmp_path / "m.npz", "-o", out)
    persons = open_images(out, None, "gray").samples.person
    assert persons is not None
    assert set(persons) == (set("abc") if named else {f"file m.npz/{n}" for n in range(6)})


OTHER_SCENES = [  # changes to SET, whose scenes then have other people or movements
    (
        "classes={sits: {sequence: [stationary, sitting_down], durations_s: [0.5, 1.2]}}",
        "classes={sits: {sequence: [stationary, sitting_down], durations_s: [0.9, 1.2]}}",
    ),
    (
        "people=[{activity: stationary, motion: {range_m: 9}}]",
        "people=[{activity: stationary, motion: {range_m: 10}}]",
    ),
    (
        "people=[{activity: stationary, motion: {range_m: 9}}]",
        "people=[{activity: punching, motion: {range_m: 9}}]",
    ),
]
FIXED = ("activities=[{}]", "samples_per_class=2", "subject.height_m=1.8", "maps=[stft]")


def fingerprints(folder, *changes):
    """Fingerprints of the scenes of SET with changes, by name."""
    config = load_config(small_config(folder.parent, SET), list(changes))
    build(config, folder, 1, Listener())
    images = open_images(folder, None, "gray")
    assert images.samples.scene is not None
    return dict(zip(images.samples.name, images.samples.scene, strict=True))


@pytest.mark.parametrize("pair", OTHER_SCENES)
def test_scenes_of_other_movements_or_people_are_not_the_same(tmp_path, pair):
    slug = "sits" if "sits" in pair[0] else "punching"
    fixed = [one.format(slug) for one in FIXED]
    first, other = (
        fingerprints(tmp_path / str(number), *fixed, changed) for number, changed in enumerate(pair)
    )
    assert first.keys() == other.keys()
    assert not set(first.values()) & set(other.values())


def test_a_scene_is_the_same_for_another_radar_and_beside_other_classes(tmp_path):
    own, sits = OTHER_SCENES[0][0], "activities=[punching, sits]"
    alone = fingerprints(tmp_path / "alone", "activities=[punching]")
    assert len(set(alone.values())) == len(alone) == 4
    beside = fingerprints(tmp_path / "beside", own, sits, "radar.bandwidth_hz=5e8", "snr_db=3")
    assert {name: beside[name] for name in alone} == alone


def test_a_scene_is_the_same_for_a_radar_that_takes_the_name_of_a_column(tmp_path):
    grabbing = ("activities=[grabbing]", "samples_per_class=2", "maps=[stft]")
    sfcw = ("radar.waveform=sfcw", "radar.steps=200", "radar.dwell_s=2e-6")
    by_fmcw = fingerprints(tmp_path / "fmcw", *grabbing)
    assert fingerprints(tmp_path / "sfcw", *grabbing, *sfcw) == by_fmcw
