"""Two data sets of maps, as they lie on disk, compared."""

import numpy as np
import pytest
from command_line import ok, radhar
from listener import Listener
from PIL import Image

from radhar_cli.errors import FolderError, RadharError
from radhar_cli.two_sample import report
from radhar_cli.two_sample.comparison import Options, compare
from radhar_cli.two_sample.description import Scale
from radhar_cli.two_sample.map_statistics import STATISTICS
from radhar_cli.two_sample.sides import open_sides

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
    return compare(one, other, Options(**options), Listener())


def test_halves_of_one_set_cannot_be_told_apart(tmp_path):
    one = tree(tmp_path / "a", 1, mask, "falling", "walking")
    other = tree(tmp_path / "b", 2, mask, "walking", "falling")
    found = compared(one, other)
    numbers = found.numbers()
    low, high = numbers["test"]["accuracy_95"]
    assert low < 0.5 < high
    assert numbers["test"]["images"] == 160
    assert numbers["coverage"] > 0.9
    assert [c.name for c in found.classes] == ["falling", "walking"]
    for one_class in numbers["classes"].values():
        assert max(s["distance"] or 0 for s in one_class["statistics"].values()) < 0.6
    assert any("has no axes" in warning for warning in found.warnings)


def test_the_largest_differences_come_first(tmp_path):
    one = tree(tmp_path / "a", 1, lambda rng: mask(rng, 22), "walking")
    other = tree(tmp_path / "b", 2, mask, "walking")
    (found,) = compared(one, other).classes
    first, *_ = found.differences
    assert first in ("upper_envelope", "width", "column_height", "ripple")
    distances = [
        value.distance for value in found.differences.values() if np.isfinite(value.distance)
    ]
    assert distances == sorted(distances, reverse=True)
    assert found.differences["upper_envelope"].simulated.mean == pytest.approx(22, abs=1)
    assert found.differences["upper_envelope"].measured.mean == pytest.approx(12, abs=1)
    assert found.differences["active"].distance < 0.6
    assert found.tested is not None
    assert found.tested.right > 0.95 * 80


def test_outlying_maps_are_named(tmp_path):
    one, other = (tree(tmp_path / name, n, mask, "a") for n, name in enumerate("xy"))
    rng = np.random.default_rng(5)
    Image.fromarray(mask(rng, 29)).save(one / "a/07.png")
    Image.fromarray(mask(rng, 29)[::-1]).save(other / "a/11.png")
    numbers = compared(one, other).numbers()["classes"]["a"]
    assert numbers["surest_simulated"][0] == "a/07"
    assert numbers["least_covered"][0] == "a/11"


def test_classes_are_matched_and_the_others_named(tmp_path):
    one = tree(tmp_path / "a", 1, mask, "grabbing", "kicking")
    other = tree(tmp_path / "b", 2, mask, "picking_up", "drinking")
    with pytest.raises(FolderError, match=r"its classes \(kicking, grabbing\) are none of those"):
        compared(one, other)
    found = compared(one, other, names={"picking_up": "grabbing", "drinking": None})
    assert [c.name for c in found.classes] == ["grabbing"]
    assert any("kicking (40)" in warning for warning in found.warnings)
    assert any("drinking (40)" in warning for warning in found.warnings)
    with pytest.raises(FolderError, match="no class 'walkin'"):
        compared(one, other, names={"walkin": "walking"})


def test_other_sizes_need_resize(tmp_path):
    one = tree(tmp_path / "a", 1, mask, "walking")
    other = tree(tmp_path / "b", 2, lambda rng: mask(rng, 12, 128), "walking")
    with pytest.raises(FolderError, match=r"images are 64 x 64 px, .* --resize"):
        compared(one, other)
    found = compared(one, other, resize=True)
    assert [side.images.size for side in found.sides] == [(128, 128)] * 2


def test_maps_are_subsampled_by_seed(tmp_path):
    one, other = (tree(tmp_path / name, n, mask, "a") for n, name in enumerate("xy"))
    first, again = (compared(one, other, most=12).numbers() for _ in range(2))
    assert first == again
    assert first["classes"]["a"]["simulated"] == 12
    assert compared(one, other, most=12, seed=2).numbers() != first


def test_one_map_a_class_is_described_but_not_tested(tmp_path):
    one, other = (tree(tmp_path / name, n, mask, "a") for n, name in enumerate("xy"))
    for number in range(1, 40):
        (one / f"a/{number:02d}.png").unlink()
    found = compared(one, other)
    assert found.numbers()["test"] is None
    assert any("a: no test" in warning for warning in found.warnings)


def test_a_zero_line_as_wide_as_the_map_is_refused(tmp_path):
    one, other = (tree(tmp_path / name, n, mask, "a") for n, name in enumerate("xy"))
    for zero in (1e9, 28, np.inf, np.nan):
        with pytest.raises(RadharError, match=r"--zero \S+: should be below 27.74 px"):
            compared(one, other, zero=zero)
    assert compared(one, other, zero=20).classes


def test_images_that_both_sides_hold_are_said(tmp_path):
    one, other = (tree(tmp_path / name, n, mask, "a") for n, name in enumerate("xy"))
    blank = Image.fromarray(np.zeros((SIZE, SIZE), np.uint8))
    for place in (one, other):
        blank.save(place / "a/00.png")
    assert not any("pixel by pixel" in warning for warning in compared(one, other).warnings)
    (other / "a/01.png").write_bytes((one / "a/03.png").read_bytes())
    assert any("1 of 40 images of" in warning for warning in compared(one, other).warnings)
    assert any("39 of 40 images of" in warning for warning in compared(one, one).warnings)


def test_statistics_that_no_class_has_are_not_drawn(tmp_path, monkeypatch):
    still = mask(np.random.default_rng(1), 0)
    one, other = (tree(tmp_path / name, n, lambda rng: still, "a") for n, name in enumerate("xy"))
    found, drawn = compared(one, other), list[str]()

    def draws(distances, rows, columns):
        assert np.isfinite(distances).any(axis=1).all()
        drawn.extend(rows)
        return b""

    monkeypatch.setattr(report, "distances_png", draws)
    report.write(found, tmp_path / "out")
    assert STATISTICS["occupied"].words in drawn
    assert STATISTICS["ripple"].words not in drawn, "nothing moves"


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
    sides = open_sides(recorded, recorded, None, {}, False)
    scale = Scale.of(sides, None)
    assert scale.edges(sides[0], 3) == (0, 5, -500, 500)
    assert (scale.unit("active"), scale.unit("width"), scale.unit("stray")) == ("s", "Hz", "%")
    assert sides[0].persons
    assert sides[0].masks
    assert np.unique(sides[0].group).size == 3
    found = compared(recorded, recorded)
    (same,) = found.warnings
    assert "pixel by pixel" in same
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
