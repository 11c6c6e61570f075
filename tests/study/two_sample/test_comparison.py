"""Two data sets of maps, as they lie on disk, compared."""

import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.listener import Listener
from PIL import Image

from radhar_cli.errors import FolderError
from radhar_cli.study.two_sample.comparison import COARSE, _features, compare
from radhar_cli.study.two_sample.sides import open_sides

SIZE = 64


def mask(rng, high=12, size=SIZE):
    """A zero line and a bump of a random height and place."""
    cells = np.zeros((size, size), np.uint8)
    middle, start = size // 2, int(rng.integers(5, size // 2))
    tall = round(rng.normal(high, 2))
    cells[middle - 2 : middle + 2] = 255
    cells[middle - tall : middle, start : start + int(rng.integers(8, 20))] = 255
    return cells


def tree(root, seed, draw, *classes):
    """40 images a class in a tree."""
    rng = np.random.default_rng(seed)
    for name in classes:
        (root / name).mkdir(parents=True)
        for number in range(40):
            Image.fromarray(draw(rng)).save(root / name / f"{number:02d}.png")
    return root


def compared(one, other, **options):
    return compare(one, other, Listener(), **options)


def test_halves_of_one_set_cannot_be_told_apart(tmp_path):
    one = tree(tmp_path / "a", 1, mask, "falling", "walking")
    other = tree(tmp_path / "b", 2, mask, "walking", "falling")
    found = compared(one, other)
    numbers = found.numbers()
    low, high = numbers["test"]["accuracy_95"]
    assert low < 0.5 < high
    assert numbers["test"]["images"] == 160
    assert [c.name for c in found.classes] == ["falling", "walking"]
    for one_class in numbers["classes"].values():
        assert max(s["distance"] or 0 for s in one_class["statistics"].values()) < 0.6
    assert any("has no axes" in warning for warning in found.warnings)


def test_the_largest_differences_come_first(tmp_path):
    one = tree(tmp_path / "a", 1, lambda rng: mask(rng, 22), "walking")
    other = tree(tmp_path / "b", 2, mask, "walking")
    (found,) = compared(one, other).classes
    first, *_ = found.differences
    assert first in ("upper_envelope", "width")
    distances = [
        value.distance for value in found.differences.values() if np.isfinite(value.distance)
    ]
    assert distances == sorted(distances, reverse=True)
    assert found.differences["upper_envelope"].simulated.mean == pytest.approx(22, abs=1)
    assert found.differences["upper_envelope"].measured.mean == pytest.approx(12, abs=1)
    assert found.differences["active"].distance < 0.6
    assert found.tested is not None
    assert found.tested[0] > 0.95 * 80


def test_the_classifier_sees_rows_as_rows(tmp_path):
    """An image of stripes along time stays one in 32 rows and 16 columns."""
    stripes = np.repeat(np.arange(SIZE, dtype=np.uint8)[:, None] * 4, SIZE, axis=1)
    root = tree(tmp_path / "stripes", 0, lambda rng: stripes, "a")
    pair = open_sides(root, root, None, {})
    pixels = _features(pair.sides[0], 0, pair)[-32 * 16 :].reshape(32, 16)
    assert COARSE == (32, 16)
    assert np.ptp(pixels, axis=1).max() == 0
    assert (np.diff(pixels[:, 0]) > 0).all()


def test_classes_are_matched_and_the_others_named(tmp_path):
    one = tree(tmp_path / "a", 1, mask, "grabbing", "kicking")
    other = tree(tmp_path / "b", 2, mask, "picking_up", "drinking")
    with pytest.raises(FolderError, match=r"its classes \(grabbing, kicking\) are none of those"):
        compared(one, other)
    found = compared(one, other, names={"picking_up": "grabbing", "drinking": None})
    assert [c.name for c in found.classes] == ["grabbing"]
    assert any("kicking (40)" in warning for warning in found.warnings)
    assert any("drinking (40)" in warning for warning in found.warnings)
    with pytest.raises(FolderError, match="no class 'walkin'"):
        compared(one, other, names={"walkin": "walking"})


def test_images_are_brought_to_the_measured_size(tmp_path):
    one = tree(tmp_path / "a", 1, mask, "walking")
    other = tree(tmp_path / "b", 2, lambda rng: mask(rng, 12, 128), "walking")
    found = compared(one, other)
    assert [side.levels(0).shape for side in found.pair.sides] == [(128, 128)] * 2
    assert any("64 x 64 px are brought to 128 x 128" in warning for warning in found.warnings)


def test_maps_are_subsampled_by_seed(tmp_path):
    one, other = (tree(tmp_path / name, n, mask, "a") for n, name in enumerate("xy"))
    first, again = (compared(one, other, max_maps=12).numbers() for _ in range(2))
    assert first == again
    assert first["classes"]["a"]["maps"] == 12
    assert compared(one, other, max_maps=12, seed=2).numbers() != first


def test_one_map_a_class_is_described_but_not_tested(tmp_path):
    one, other = (tree(tmp_path / name, n, mask, "a") for n, name in enumerate("xy"))
    for number in range(1, 40):
        (one / f"a/{number:02d}.png").unlink()
    found = compared(one, other)
    assert found.numbers()["test"] is None
    assert any("a: no test" in warning for warning in found.warnings)


@pytest.fixture
def recorded(tmp_path):
    """Masks of three persons as a data set with axes."""
    rng = np.random.default_rng(0)
    np.savez(
        tmp_path / "masks.npz",
        masks=np.array([mask(rng) for _ in range(36)]),
        label=np.repeat(["walking", "falling"], 18),
        person=np.tile(["ann", "bob", "eve"], 12),
    )
    (tmp_path / "c.yaml").write_text(
        "maps: [stft]\nrecordings: {window_s: 5, rows: [-500, 500]}\n"
        "split: {train: 0.5, validation: 0.5}\n"
    )
    ok(
        "generate", tmp_path / "c.yaml", "--recordings", tmp_path / "masks.npz", "-o",
        tmp_path / "set", "--jobs", 1,
    )  # fmt: skip
    return tmp_path / "set"


def test_axes_and_persons_of_a_data_set(recorded):
    pair = open_sides(recorded, recorded, None, {})
    side, _ = pair.sides
    assert pair.edges(side, 3) == (0, 5, -500, 500)
    assert side.masks
    assert np.unique(side.group).size == 3
    found = compared(recorded, recorded)
    units = [found.unit(name) for name in ("active", "width", "stray")]
    assert units == ["s", "Hz", "%"]
    assert not found.warnings
    assert found.classes[0].differences["active"].measured.mean == pytest.approx(
        13 / 64 * 5, rel=0.2
    )
    assert found.classes[0].differences["upper_envelope"].measured.mean == pytest.approx(
        12 * 1000 / 64, rel=0.1
    )


def test_different_axes_are_reported(recorded, tmp_path):
    other = tmp_path / "other"
    more = ("--set", "recordings.window_s=10", "--jobs", 1)
    source = (tmp_path / "c.yaml", "--recordings", tmp_path / "masks.npz")
    assert radhar("generate", *source, "-o", other, *more).returncode == 0
    (message, *_) = compared(recorded, other).warnings
    assert message == (
        "falling: axes differ, 5 s, -500 to 500 Hz simulated, 10 s, -500 to 500 Hz measured"
    ) or message.startswith("walking: axes differ, 5 s")
