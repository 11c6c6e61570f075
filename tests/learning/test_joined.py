"""Several data sets that are learned from as one."""

from pathlib import Path

import numpy as np
import pytest
from learning.patterns import Watched, settings, split_tree

from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.images.joined import sampling_weights
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.training import checked_images, train


@pytest.fixture
def other(tmp_path: Path) -> Path:
    """A tree with one class of `data`'s, and one of its own."""
    return split_tree(tmp_path / "other", train=8, seed=7, classes=("walking", "wave"))


def test_rows_and_classes_of_all_are_there(data: Path, other: Path) -> None:
    one, two = (open_images(path, None, "rgb") for path in (data, other))
    both = checked_images(settings(), [data, other])
    assert len(both) == len(one) + len(two)
    assert set(both.classes) == {*one.classes, *two.classes}
    for row in range(len(both)):
        part, at = (one, row) if row < len(one) else (two, row - len(one))
        assert both.classes[both.label[row]] == part.classes[part.label[at]]
        assert both.split is not None
        assert part.split is not None
        assert both.split[row] == part.split[at]
        assert np.array_equal(both.pixels.read(row), part.pixels.read(at))
        assert both.source[row] == (part is two)


def test_weights_of_sets_and_balance_of_classes(data: Path, other: Path) -> None:
    both = checked_images(settings(), [data, other])
    rows = both.rows("train")
    plain = sampling_weights(both, rows, None, balanced=False)
    assert (plain == 1).all()
    weighted = sampling_weights(both, rows, (1.0, 0.25), balanced=False)
    assert weighted[both.source[rows] == 1].tolist() == [0.25] * 16
    balanced = sampling_weights(both, rows, (1.0, 0.25), balanced=True)
    mass = np.bincount(both.label[rows], balanced)
    assert np.allclose(mass, mass[0])
    assert np.isclose(balanced.sum(), weighted.sum())


def test_a_run_on_two_sets(data: Path, other: Path, tmp_path: Path) -> None:
    watched = Watched()
    config = settings(epochs=1, data_weights=[1, 0.5], sampling="balanced")
    train(config, [data, other], tmp_path / "run", watched)
    assert watched.losses
    with pytest.raises(ConfigError, match="for each of the 2 data sets"):
        train(settings(data_weights=[1.0]), [data, other], tmp_path / "no", watched)


def test_images_of_two_sizes_are_refused(data: Path, tmp_path: Path) -> None:
    large = split_tree(tmp_path / "large", size=(64, 64))
    with pytest.raises(FolderError, match=r"64 x 64 px, those of .* 32 x 32"):
        checked_images(settings(), [data, large])
