"""Images that exist already become a data set of the same contract."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import radhar
from PIL import Image

from radhar_cli.capture import images
from radhar_cli.capture.images import list_images
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
