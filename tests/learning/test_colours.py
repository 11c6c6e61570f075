"""Pictures of another colour map, and of another size, for a network that learned from radhar's."""

import numpy as np
import pytest
import torch
from helpers.command_line import radhar
from learning.patterns import CLASSES, Watched, clear_line, plant, settings, tree
from PIL import Image

import radhar_cli
from radhar_cli.dataset.png import colour_table
from radhar_cli.errors import ConfigError
from radhar_cli.learning.evaluation import open_for_model, predict_classes
from radhar_cli.learning.images.colour_maps import KNOWN, colour_map_of, levels_behind
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.training import TrainOptions, train

CPU = torch.device("cpu")


def gray_tree(root, **more):
    """The tree of stripes, in grey."""
    tree(root, **more)
    for path in root.rglob("*.png"):
        Image.open(path).convert("L").save(path)
    return root


def drawn(source, root, name, size=None, suffix=".png"):
    """A copy of a grey tree, drawn in a colour map."""
    for path in source.rglob("*.png"):
        new = (root / path.relative_to(source)).with_suffix(suffix)
        new.parent.mkdir(parents=True, exist_ok=True)
        picture = Image.fromarray(colour_table(name)[np.asarray(Image.open(path))])
        fine = {"quality": 95, "subsampling": 0} if suffix == ".jpg" else {}
        (picture if size is None else picture.resize(size[::-1])).save(new, **fine)
    return root


@pytest.fixture(scope="module")
def viridis(tmp_path_factory):
    """(grey tree, run on it in viridis that is right about all of it)."""
    place = tmp_path_factory.mktemp("viridis")
    source = gray_tree(place / "gray")
    data = drawn(source, place / "data", "viridis")
    train(settings(epochs=1), data, place / "run", Watched())
    plant(place / "run", data)
    return source, place / "run"


def accuracy(run, data, **more):
    metadata, model = load_best(run)
    images = open_for_model(metadata, data, None, **more)
    found = predict_classes(model, metadata, images, np.arange(len(images)), CPU, 8)
    return float((found.predicted == found.truth).mean()), images


@pytest.mark.parametrize("name", KNOWN)
def test_a_colour_map_is_recognised_and_taken_off(name):
    rng = np.random.default_rng(0)
    wave = np.sin(np.linspace(0, 9, 64))[:, None] * np.cos(np.linspace(0, 7, 48))
    levels = np.clip(128 + 120 * wave + rng.normal(0, 4, wave.shape), 0, 255).astype(np.uint8)
    picture = colour_table(name)[levels]
    assert colour_map_of([picture]) == name
    np.testing.assert_allclose(
        levels_behind(picture, name).astype(int),
        levels,
        atol=2,  # some maps have a colour twice
    )


def test_photographs_and_plain_pictures_have_no_colour_map():
    rng = np.random.default_rng(0)
    assert colour_map_of([rng.integers(0, 256, (32, 32, 3), dtype=np.uint8)]) is None
    assert colour_map_of([np.zeros((32, 32, 3), np.uint8)]) is None
    assert colour_map_of([]) is None


@pytest.mark.parametrize(("name", "suffix"), [("jet", ".png"), ("gray", ".png"), ("jet", ".jpg")])
def test_pictures_of_another_colour_map_are_recoloured(viridis, tmp_path, name, suffix):
    source, run = viridis
    data = drawn(source, tmp_path / name, name, suffix=suffix)
    assert open_images(data, None, "rgb").colours == name
    share, images = accuracy(run, data)
    assert share == 1 if suffix == ".png" else share > 0.9
    assert images.notes == (f"{data}: drawn in {name}, recoloured to viridis as in training",)
    done = radhar("predict", run, data / "walking", "--device", "cpu")
    assert "recoloured to viridis" in done.stderr
    if suffix == ".png":
        assert all(": walking " in line for line in done.stdout.splitlines())
    done = radhar("eval", run, data, "-o", tmp_path / "out", "--device", "cpu")
    assert "recoloured to viridis" in done.stderr


def test_colours_of_no_known_map_are_warned_of(viridis, tmp_path):
    data = tree(tmp_path / "stripes")
    _, images = accuracy(viridis[1], data)
    (note,) = images.notes
    assert note.startswith("warning:")
    assert "no known colour map" in note


def test_grey_levels_of_a_rainbow_are_those_behind_it(viridis, tmp_path):
    source, _ = viridis
    data = drawn(source, tmp_path / "jet", "jet")
    found, wanted = (open_images(path, None, "gray") for path in (data, source))
    for row in range(0, len(wanted), 5):
        one, other = (images.pixels.read(row).astype(int) for images in (found, wanted))
        np.testing.assert_allclose(one, other, atol=2)
    assert "drawn in jet" in found.notes[0]


def test_fine_tuning_on_pictures_of_another_size_and_colour_map(viridis, tmp_path):
    source, run = viridis
    data = drawn(source, tmp_path / "jet", "jet", size=(48, 40))
    with clear_line(ConfigError, "(32, 32)", "(48, 40)", "--resize"):
        train(settings(epochs=1), data, tmp_path / "no", Watched(), TrainOptions(start=run))
    with clear_line(ConfigError, "--resize: needs --init"):
        train(settings(epochs=1), data, tmp_path / "no", Watched(), TrainOptions(resize=True))
    watched = Watched()
    train(
        settings(epochs=1), data, tmp_path / "tuned", watched, TrainOptions(start=run, resize=True)
    )
    assert any("recoloured to viridis" in line for line in watched.messages)
    about = load_best(tmp_path / "tuned")[0]
    assert (about.size, about.colours) == ((32, 32), "viridis")
    _, images = accuracy(tmp_path / "tuned", data, resize=True)
    assert images.size == (32, 32)
    # Recoloured before it is resized: a mean of two colours of jet is none of it.
    level = levels_behind(images.pixels.read(0), "viridis")
    smooth = Image.open(sorted((source / CLASSES[0]).glob("*.png"))[0])
    expected = np.asarray(smooth.resize((40, 48)).resize((32, 32), Image.Resampling.BILINEAR))
    assert np.abs(level.astype(int) - expected).mean() < 25


def test_a_run_is_asked_in_python(viridis, tmp_path):
    source, run = viridis
    loaded = radhar_cli.load_run(run, device="cpu")
    assert loaded.classes == CLASSES
    assert loaded.joints == ()
    found = loaded.predict(drawn(source, tmp_path / "data", "viridis"))
    assert [name in sample for name, sample in zip(found.likeliest, found.samples, strict=True)]
    assert found.probabilities.shape == (24, 3)
    images = torch.zeros(2, 3, 32, 32, dtype=torch.uint8)
    torch.testing.assert_close(loaded(images).sum(1), torch.ones(2))
    assert "3 classes" in repr(loaded)
    for path, words in ((tmp_path / "none", "no such file"), (source, "holds no best")):
        with pytest.raises(radhar_cli.errors.RadharError, match=words):
            radhar_cli.load_run(path)
