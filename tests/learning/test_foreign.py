"""Foreign data: images of another size, classes under other names."""

import json

import numpy as np
import pytest
from helpers.listener import Listener
from helpers.small import small_config
from learning.patterns import CLASSES, clear_line, one_clear_line, split_tree, tree
from PIL import Image
from typer.testing import CliRunner

from radhar_cli.cli import program
from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.errors import ConfigError, FolderError, RadharError
from radhar_cli.learning.images.classes import read_classes, renamed
from radhar_cli.learning.images.image_set import Resized
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.run_folder import read_metadata


class Planted:
    """Pixels of one image."""

    def __init__(self, rgb):
        self.rgb = rgb

    def read(self, row):
        return self.rgb


def radhar(*arguments):
    return CliRunner().invoke(program(), [str(argument) for argument in arguments])


def numbers(report):
    (one,) = json.loads((report / "report.json").read_text())["runs"].values()
    (found,) = one["data"].values()
    return dict(found)


def classes_file(folder, names):
    path = folder / "classes.yaml"
    path.write_text(json.dumps(names))
    return path


def test_resizing_keeps_what_is_even_and_smooths_what_is_fine():
    even = np.full((40, 24, 3), (9, 99, 200), np.uint8)
    assert (Resized(Planted(even), (32, 32)).read(0) == (9, 99, 200)).all()
    assert Resized(Planted(even), (40, 24)).read(0) is even
    fine = np.zeros((64, 64, 3), np.uint8)
    fine[::2, ::2] = fine[1::2, 1::2] = 255
    inside = Resized(Planted(fine), (16, 32)).read(0)
    assert inside.shape == (16, 32, 3)
    assert np.abs(inside[2:-2, 2:-2].astype(int) - 127).max() <= 3


@pytest.mark.parametrize("kind", ["rgb", "gray"])
def test_hdf5_and_png_are_resized_alike(tmp_path, kind):
    config = load_config(small_config(tmp_path), ["duration_s=1", "maps=[stft]"])
    build(config, tmp_path / "set", 1, Listener())
    stored = open_images(tmp_path / "set", None, kind, (32, 40))
    files = open_images(tmp_path / "set/png/stft", None, kind, (32, 40))
    for row, name in enumerate(stored.samples.name):
        read = stored.pixels.read(row)
        assert read.shape == (32, 40, 1 if kind == "gray" else 3)
        assert np.array_equal(read, files.pixels.read(files.samples.name.tolist().index(name)))


def test_eval_and_predict_take_other_sizes_with_resize_alone(run_dir, tmp_path):
    root = tree(tmp_path / "t", CLASSES, {"val": 2}, size=48)
    odd = root / "val/walking/999.png"
    Image.new("RGB", (20, 64)).save(odd)
    for command, path in (("eval", root), ("predict", root), ("predict", odd)):
        refused = radhar(command, run_dir, path)
        assert isinstance(refused.exception, RadharError)
        one_clear_line(refused.exception, path, "px", "--resize")
        out = ["-o", tmp_path / "report"] if command == "eval" else []
        done = radhar(command, run_dir, path, "--resize", *out)
        assert done.exit_code == 0, done.output
        if command == "predict":
            assert len(done.stdout.splitlines()) == (1 if path == odd else 7)
    assert json.loads((tmp_path / "report/report.json").read_text())["resize"] is True


def test_resize_leaves_images_of_the_right_size_unchanged(data, run_dir):
    plain, resized = (radhar("predict", run_dir, data, *more) for more in ((), ("--resize",)))
    assert plain.stdout == resized.stdout


def test_predict_on_a_data_set_passes_over_its_preview(run_dir, tmp_path):
    config = load_config(small_config(tmp_path), ["duration_s=1", "maps=[stft]"])
    build(config, tmp_path / "set", 1, Listener())
    Image.new("RGB", (9, 9)).save(tmp_path / "set/preview_stft.png")
    done = radhar("predict", run_dir, tmp_path / "set", "--resize")
    assert len(done.stdout.splitlines()) == 9


def test_unknown_classes_are_left_out_with_a_warning(run_dir, tmp_path):
    root = tree(tmp_path / "t", (*CLASSES, "zebra"), {"val": 2})
    out = tmp_path / "report"
    done = radhar("eval", run_dir, root, "-o", out)
    assert done.exit_code == 0, done.output
    assert "left out 2 images of classes that the model does not know: zebra (2)" in done.stderr
    assert "--classes FILE" in done.stderr
    assert "does not know: zebra (2)" in (out / "report.html").read_text()
    found = numbers(out)
    assert found["images"] == 6
    assert found["left_out"] == {"zebra": 2}


def test_classes_are_mapped_and_left_out_as_the_file_says(run_dir, tmp_path):
    root = tree(tmp_path / "t", ("box", "go", "hop", "kicking", "stroll"), {"val": 2})
    names = {"box": "punching", "go": "walking", "stroll": "walking", "hop": None}
    out = tmp_path / "report"
    done = radhar(*("eval", run_dir, root, "-o", out, "--classes", classes_file(tmp_path, names)))
    assert done.exit_code == 0, done.output
    assert "left out" not in done.stderr
    found = numbers(out)
    assert {name: c["images"] for name, c in found["classes"].items()} == {
        "punching": 2,
        "kicking": 2,
        "walking": 4,
    }
    assert found["left_out"] == {"hop": 2}


def test_other_words_of_the_same_meaning_are_taken_and_said(run_dir, tmp_path):
    root = tree(tmp_path / "t", ("Boxing", "kick", "walking", "strolling"), {"val": 2})
    out = tmp_path / "report"
    done = radhar("eval", run_dir, root, "-o", out)
    assert done.exit_code == 0, done.output
    assert "Boxing is taken for punching, kick is taken for kicking" in done.stderr
    assert "strolling (2)" in done.stderr  # walking is there itself
    assert {name: c["images"] for name, c in numbers(out)["classes"].items()} == {
        "punching": 2,
        "kicking": 2,
        "walking": 2,
    }


def test_kept_rows_have_their_pixels_names_and_splits(tmp_path):
    images = open_images(split_tree(tmp_path / "t", 2, 1, classes=("a", "b", "c")), None, "rgb")
    left = images.renamed({"a": None, "c": "walking", "b": "punching"})
    assert left.classes == ("punching", "walking")
    assert left.left_out == {"a": 3}
    rows = [row for row in range(len(images)) if images.classes[images.samples.label[row]] != "a"]
    assert left.samples.name.tolist() == images.samples.name[rows].tolist()
    assert images.samples.split is not None
    assert left.samples.split is not None
    assert left.samples.split.tolist() == images.samples.split[rows].tolist()
    for new, row in enumerate(rows):
        assert np.array_equal(left.pixels.read(new), images.pixels.read(row))
    with pytest.raises(FolderError, match="leaves no class"):
        images.renamed(dict.fromkeys("abc"))


def test_train_uses_the_class_names_of_the_file_and_resumes(tmp_path):
    root = split_tree(tmp_path / "t", classes=("box", "go", "hop"))
    file = classes_file(tmp_path, {"box": "punching", "go": "walking", "hop": None})
    command = ["train", root, "-o", tmp_path / "mine", "--classes", file, "--model", "smallnet"]
    command += ["--set", "epochs=1", "--set", "batch_size=8", "--set", "threads=1"]
    first = radhar(*command)
    assert first.exit_code == 0, first.output
    assert read_metadata(tmp_path / "mine").classes == ("punching", "walking")
    assert "nothing to do" in radhar(*command).stdout
    other = radhar(*[word for word in command if word not in ("--classes", file)])
    assert isinstance(other.exception, RadharError)
    one_clear_line(other.exception, "holds another run", "classes")
    done = radhar("eval", tmp_path / "mine", root, "--classes", file)
    assert done.exit_code == 0, done.output
    assert numbers(tmp_path / "mine/eval")["images"] == 4


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("box: 3", ["classes.yaml", "box = 3", "name of a class"]),
        ("box: ''", ["box = ''"]),
        ("- box", ["mapping of keys"]),
        ("1: walking", ["the key 1 should be text"]),
    ],
)
def test_a_file_that_maps_no_names_is_refused(tmp_path, text, words):
    (tmp_path / "classes.yaml").write_text(text)
    with clear_line(ConfigError, *words):
        read_classes(tmp_path / "classes.yaml")


def test_a_missing_class_is_refused(tmp_path):
    images = open_images(tree(tmp_path / "t"), None, "rgb")
    with clear_line(FolderError, "no class 'walkin'", "did you mean 'walking'?"):
        renamed(images, {"walkin": "walking"})
