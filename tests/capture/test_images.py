"""Images that exist already become a data set of the same contract."""

import json
import shlex
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import radhar
from PIL import Image

from radhar_cli.capture import images
from radhar_cli.capture.images import are_images, list_images
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import CaptureError

CONFIG = """
maps: [stft]
recordings: {window_s: 5, rows: [-500, 500]}
split: {train: 0.5, validation: 0.5}
"""
CLASSES = ("Walking", "picking-up", "falling")


def masks() -> np.ndarray:
    return (np.random.default_rng(0).random((12, 16, 24)) < 0.3).astype(np.uint8)


@pytest.fixture
def config(tmp_path: Path) -> Path:
    (tmp_path / "c.yaml").write_text(CONFIG)
    return tmp_path / "c.yaml"


def generated(config: Path, source: Path, *more: str) -> Path:
    out = config.parent / "set"
    done = radhar("generate", config, "--recordings", source, "-o", out, "--jobs", 1, *more)
    assert done.returncode == 0, done.stderr
    return out


@pytest.mark.parametrize("packed", [False, True])
def test_masks_of_an_npz(config: Path, packed: bool) -> None:
    x, label = masks(), np.arange(12) % 3
    stored = np.packbits(x, axis=2) if packed else x
    source = config.parent / "masks.npz"
    np.savez_compressed(source, masks=stored, label=label, classes=np.array(CLASSES))
    more = ["--set", "recordings.packed=true"] if packed else []
    out = generated(config, source, *more)
    with open_dataset(out) as data:
        slugs = np.array(data.class_slugs)[data.label]
        part = data.scene["part"][:].astype(int)
        assert np.array_equal(data.maps["stft"][:], x[part] * 255)
        names = [CLASSES[label[n]].lower().replace("-", "_") for n in part]
        assert slugs.tolist() == names
        assert data.extent("stft") == (0, 5, -500, 500)
    for command in (("verify", out), ("inspect", out), ("preview", out), ("view", out)):
        done = radhar(*command)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("shape", "more", "packed"),
    [((16, 2), "", True), ((16, 2), "true", False), ((16, 24), "", False)],
)
def test_masks_that_look_packed_are_warned_of(
    config: Path, shape: tuple[int, int], more: str, packed: bool
) -> None:
    """A hop shorter than the window, which images do not have, is no warning."""
    source = config.parent / "masks.npz"
    np.savez(source, masks=np.full((12, *shape), 7, np.uint8), label=np.array(["falling"] * 12))
    given = ["--set", f"recordings.packed={more}"] if more else []
    command = ("generate", config, "--recordings", source, "-o", config.parent / "set", *given)
    done = radhar(*command, "--dry-run", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["classes"] == {"falling": 12}
    assert ("recordings.packed=true makes 16 x 16" in done.stderr) == packed
    assert "windows of one recording" not in done.stderr


def test_a_tree_of_images(config: Path) -> None:
    x = masks()
    for n, one in enumerate(x):
        folder = config.parent / "tree" / CLASSES[n % 3]
        folder.mkdir(parents=True, exist_ok=True)
        Image.fromarray(one * np.uint8(200)).save(folder / f"{n:02d}.png")
    out = generated(config, config.parent / "tree")
    with open_dataset(out) as data:
        walking = data.label == data.class_slugs.index("walking")
        assert np.array_equal(data.maps["stft"][np.flatnonzero(walking)], x[::3] * 200)


WRONG = [
    ({"masks": masks(), "label": np.arange(12)}, "indices into classes"),
    ({"masks": masks(), "label": np.array(["a"] * 5)}, "each of 12 images"),
    ({"masks": masks().astype(float), "label": np.array(["a"] * 12)}, "one array of images"),
    ({"masks": masks()}, "and label"),
    ({"masks": masks(), "label": np.array([None] * 12)}, "cannot be read"),
]


@pytest.mark.parametrize(("arrays", "expected"), WRONG)
def test_wrong_npz_is_refused_in_one_line(
    config: Path, arrays: dict[str, np.ndarray], expected: str
) -> None:
    source = config.parent / "x.npz"
    np.savez(source, **arrays)  # type: ignore[arg-type]
    done = radhar("generate", config, "--recordings", source, "-o", config.parent / "set")
    assert done.returncode == 2
    assert expected in done.stderr
    assert "Traceback" not in done.stderr


def test_missing_axes_are_asked_for(config: Path) -> None:
    source = config.parent / "masks.npz"
    np.savez(source, masks=masks(), label=np.array(["a"] * 12))
    command = ("generate", config, "--recordings", source, "-o", config.parent / "set")
    done = radhar(*command, "--set", "recordings.rows=null")
    assert done.returncode == 2
    assert "recordings.rows=[low, high]" in done.stderr


def test_an_npz_that_promises_or_holds_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "{'descr': '|u1', 'fortran_order': False, 'shape': (999, 2048, 256), }".ljust(117)
    header = b"\x93NUMPY\x01\x00" + len(text + "\n").to_bytes(2, "little") + f"{text}\n".encode()
    with zipfile.ZipFile(tmp_path / "x.npz", "w") as archive:
        archive.writestr("masks.npy", header)
    with pytest.raises(CaptureError, match=r"x\.npz: .*too few bytes"):
        list_images(tmp_path / "x.npz", packed=False)
    monkeypatch.setattr(images, "MAX_NPZ", 1000)
    np.savez(tmp_path / "large.npz", masks=masks(), label=np.array(["a"] * 12))
    with pytest.raises(CaptureError, match=r"large\.npz: .*more than 1000 bytes of images"):
        list_images(tmp_path / "large.npz", packed=False)


def test_masks_are_taken_by_name_and_bytes_are_text(tmp_path: Path) -> None:
    np.savez(
        tmp_path / "x.npz",
        masks=masks(),
        noise=masks(),
        label=np.array([b"falling"] * 12),
        person=np.array([b"p1"] * 12),
    )
    part = list_images(tmp_path / "x.npz", packed=False).parts[0]
    assert (part["label"], part["person"]) == ("falling", "p1")


def save_pictures(folder: Path, end: str = ".png") -> list[str]:
    """Write the masks as pictures of 0 and 200; return their names."""
    folder.mkdir(parents=True, exist_ok=True)
    names = [f"{n:02d}{end}" for n in range(12)]
    for name, one in zip(names, masks(), strict=True):
        Image.fromarray(one * np.uint8(200)).save(folder / name)
    return names


TABLES = {
    "labels.csv": ("file,label,person", "{name},{label},{person}", ""),
    "excel.csv": ("\ufeffFilename;Subject;Class", "{name};{person};{label}", ""),
    "tabs.tsv": ("image\tactivity\tsubject_id", "{name}\t{label}\t{person}", ""),
    "deep.txt": ("path,class_name,participant,date", "a/b/{name},{label},{person},2024", "a/b"),
    "windows.csv": ("file,label,person", "a\\{name},{label},{person}", "a"),
    "stems.csv": ("name,target,person", "{stem},{label},{person}", ""),
    "paths.csv": ("image_path,activity,subject_id", "{name},{label},{person}", ""),
    "spaces.csv": ("Image Path,Class Name,Person-ID", "{name},{label},{person}", ""),
    "list.yaml": ("", "- {{file: {name}, label: {label}, person: {person}}}", ""),
}


@pytest.mark.parametrize("end", [".png", ".jpg"])
@pytest.mark.parametrize("table", TABLES)
def test_pictures_of_a_table_are_read_with_their_persons(
    tmp_path: Path, table: str, end: str
) -> None:
    heading, row, place = TABLES[table]
    names = save_pictures(tmp_path / place, end)
    lines = [
        row.format(name=name, stem=name[:2], label=CLASSES[n % 3], person=f"P{n % 4}")
        for n, name in enumerate(names)
    ]
    (tmp_path / table).write_text("\n".join(filter(None, [heading, *lines])) + "\n")
    assert are_images(tmp_path / table)
    found = list_images(tmp_path / table, packed=False)
    assert [part["label"] for part in found.parts] == [CLASSES[n % 3] for n in range(12)]
    assert [part["person"] for part in found.parts] == [f"P{n % 4}" for n in range(12)]
    assert found.size == (16, 24)
    for part, one in zip(found.parts, masks(), strict=True):
        levels = images.read_image(tmp_path, part["file"], found.size, packed=False)
        assert np.abs(levels - one * 200.0).mean() < (1e-9 if end == ".png" else 20)


def test_a_table_of_pictures_becomes_a_data_set_split_by_person(config: Path) -> None:
    names = save_pictures(config.parent / "images")
    rows = [f"images/{name},{CLASSES[n % 3]},P{n // 3}" for n, name in enumerate(names)]
    (config.parent / "labels.csv").write_text("\n".join(["file,label,person", *rows]))
    more = ["--set", "split={by: subject, subjects: 4, train: 0.5, validation: 0.5}"]
    out = generated(config, config.parent / "labels.csv", *more)
    with open_dataset(out) as data:
        part = data.scene["part"][:].astype(int)
        assert np.array_equal(data.maps["stft"][:], masks()[part] * 200)
        persons = [data.config.recordings.parts[n].person for n in part]
        train = {p for p, split in zip(persons, data.split, strict=True) if split == 0}
        assert len(train) == 2
        assert all((p in train) == (s == 0) for p, s in zip(persons, data.split, strict=True))
        assert data.config.recordings.sha256.keys() == {"labels.csv"}


WRONG_TABLES = [
    ("file,person\n00.png,1\n", "one should be label"),
    ("file,label\n00.png,walking\nno.png,walking\n", "row 3: file = 'no.png': is no image file"),
    ("file,label\n00.png,walking\n00.png,falling\n", "row 3: file = '00.png': stands there twice"),
    ("file,label\n00.png,walking\n01.png,\n", "row 3: label is missing"),
    ("file,label\n00.png,walking\n../x.png,falling\n", "x.png: is a link to"),
    ("file,label\n00.png,7\n01.png,8\n", "label = '7'"),
]


@pytest.mark.parametrize(("text", "expected"), WRONG_TABLES)
def test_wrong_tables_are_refused_in_one_line(config: Path, text: str, expected: str) -> None:
    folder = config.parent / "pictures"
    save_pictures(folder)
    (folder / "labels.csv").write_text(text)
    command = ("generate", config, "--recordings", folder / "labels.csv", "-o", folder / "set")
    done = radhar(*command)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert expected in line


LABELS = np.array([CLASSES[n % 3] for n in range(12)])
NAMED = [
    {"images": masks(), "labels": LABELS, "subject": np.arange(12) % 4},
    {"x": masks(), "y": LABELS, "subjects": np.arange(12) % 4},
    {"x_train": masks(), "y_train": LABELS, "person": np.arange(12) % 4},
    {"X": masks()[..., None], "Y": LABELS, "person": np.arange(12) % 4},
    {"images": np.repeat(masks()[..., None], 3, 3), "labels": LABELS, "person": np.arange(12) % 4},
    {
        "data": masks(),
        "target": np.arange(12) % 3,
        "target_names": np.array(CLASSES),
        "person": np.arange(12) % 4,
    },
]


@pytest.mark.parametrize("arrays", NAMED, ids=lambda arrays: " ".join(arrays))
def test_arrays_have_the_names_in_use(tmp_path: Path, arrays: dict[str, np.ndarray]) -> None:
    np.savez(tmp_path / "x.npz", **arrays)  # type: ignore[arg-type]
    found = list_images(tmp_path / "x.npz", packed=False)
    assert [part["label"] for part in found.parts] == LABELS.tolist()
    assert [part["person"] for part in found.parts] == [str(n % 4) for n in range(12)]
    for n, one in enumerate(masks()):
        levels = images.read_image(tmp_path, f"x.npz/{n}", (16, 24), packed=False)
        assert np.array_equal(levels, one * 255)


@pytest.mark.parametrize("name", ["FILE.npz", "my masks.npz"])
@pytest.mark.parametrize("kind", [int, float, str, bytes])
def test_numbers_without_names_are_refused_with_a_command_that_adds_them(
    tmp_path: Path, kind: type, name: str
) -> None:
    """The command makes a file that is read, whatever type the numbers have."""
    label = (np.arange(12) % 3).astype(str if kind is bytes else kind)
    if kind is bytes:
        label = label.astype("S1")
    np.savez(tmp_path / name, x_train=masks(), y_train=label)
    with pytest.raises(CaptureError, match="y_train has the numbers 0 to 2") as caught:
        list_images(tmp_path / name, packed=False)
    assert "\n" not in str(caught.value)
    run_command_of(str(caught.value), tmp_path)
    labels = [part["label"] for part in list_images(tmp_path / "named.npz", packed=False).parts]
    assert labels == [f"class_{n % 3}" for n in range(12)]


@pytest.mark.parametrize("kind", [np.uint8, float, bool])
@pytest.mark.parametrize("classes", [None, CLASSES])
def test_one_hot_labels_are_refused_with_a_command_that_makes_indices(
    tmp_path: Path, classes: tuple[str, ...] | None, kind: type
) -> None:
    more = {} if classes is None else {"classes": np.array(classes)}
    label = np.eye(3, dtype=kind)[np.arange(12) % 3]
    np.savez(tmp_path / "hot.npz", images=masks(), labels=label, **more)
    with pytest.raises(
        CaptureError, match=r"is one-hot; should be np.argmax\(labels, 1\)"
    ) as caught:
        list_images(tmp_path / "hot.npz", packed=False)
    run_command_of(str(caught.value), tmp_path)
    labels = [part["label"] for part in list_images(tmp_path / "named.npz", packed=False).parts]
    names = classes or ("class_0", "class_1", "class_2")
    assert labels == [names[n % 3] for n in range(12)]


@pytest.mark.parametrize(
    ("label", "message"),
    [
        (np.array(["1 walking", "falling"] * 6), "labels = '1 walking': should be the name of a"),
        (np.array(["", "falling"] * 6), "labels = '': should be the name of a class"),
        (np.ones((12, 3)), "labels should name the class of each of 12 images"),
        (np.full(12, np.nan), "labels should name the class of each of 12 images"),
        (np.array(["9" * 30] * 12), "labels = '999"),
    ],
)
def test_labels_that_name_no_class_are_a_line(
    tmp_path: Path, label: np.ndarray, message: str
) -> None:
    np.savez(tmp_path / "x.npz", images=masks(), labels=label, classes=np.array(CLASSES))
    with pytest.raises(CaptureError, match=message) as caught:
        list_images(tmp_path / "x.npz", packed=False)
    assert "\n" not in str(caught.value)


def test_texts_of_digits_are_indices_into_classes(tmp_path: Path) -> None:
    label = (np.arange(12) % 3).astype(str)
    np.savez(tmp_path / "x.npz", images=masks(), labels=label, classes=np.array(CLASSES))
    labels = [part["label"] for part in list_images(tmp_path / "x.npz", packed=False).parts]
    assert labels == [CLASSES[n % 3] for n in range(12)]


def test_two_parts_of_keras_are_parts_of_the_split(tmp_path: Path) -> None:
    x = masks()
    arrays = {"x_train": x[:8], "y_train": LABELS[:8], "x_test": x[8:], "y_test": LABELS[8:]}
    np.savez(tmp_path / "keras.npz", **arrays)  # type: ignore[arg-type]
    parts = list_images(tmp_path / "keras.npz", packed=False).parts
    assert [part["label"] for part in parts] == LABELS.tolist()
    assert [part["split"] for part in parts] == 8 * ["train"] + 4 * ["test"]
    read = images.read_image(tmp_path, "keras.npz/9", x.shape[1:], packed=False)
    assert np.array_equal(read, 255 * x[9])
    np.savez(tmp_path / "keras.npz", **arrays | {"x_test": x[8:, :4]})  # type: ignore[arg-type]
    with pytest.raises(CaptureError, match="x_train and x_test differ in size"):
        list_images(tmp_path / "keras.npz", packed=False)


def run_command_of(message: str, folder: Path) -> None:
    """Run the command between backquotes of a message, by this Python."""
    words = shlex.split(message.split("`")[1])
    subprocess.run([sys.executable, *words[1:]], cwd=folder, check=True)
