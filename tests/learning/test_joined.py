"""Several data sets that are learned from as one."""

import numpy as np
import pytest
from learning.patterns import Watched, same_run, settings, split_tree

from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.batches import epoch_order
from radhar_cli.learning.images.joined import sampling_weights
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.run_folder import RunError
from radhar_cli.learning.training import checked_images, train


@pytest.fixture
def other(tmp_path):
    """A tree with one class of `data`'s, and one of its own."""
    return split_tree(tmp_path / "other", train=8, seed=7, classes=("walking", "wave"))


def test_a_joined_set_has_all_rows_and_classes(data, other):
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


def test_weights_of_sets_and_balance_of_classes(data, other):
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


def test_a_run_on_two_sets(data, other, tmp_path):
    watched = Watched()
    config = settings(epochs=1, data_weights=[1, 0.5], sampling="balanced")
    train(config, [data, other], tmp_path / "run", watched)
    assert watched.losses
    with pytest.raises(ConfigError, match="for each of the 2 data sets"):
        train(settings(data_weights=[1.0]), [data, other], tmp_path / "no", watched)


def test_an_epoch_shows_sets_by_their_weights_and_classes_equally_often(data, other):
    config = settings(data_weights=[3.0, 0.5], sampling="balanced")
    both = checked_images(config, [data, other])
    rows = both.rows("train")
    weights = sampling_weights(both, rows, config.data_weights, balanced=True)
    shown = np.concatenate([rows[epoch_order(weights, seed=1, epoch=e)] for e in range(50)])
    by_class = np.bincount(both.label[shown]) / 50
    assert by_class == pytest.approx([11] * 4, rel=0.1)
    walking = both.classes.index("walking")
    of_walking = shown[both.label[shown] == walking]
    by_set = np.bincount(both.source[of_walking])
    assert by_set[0] / by_set[1] == pytest.approx(3 * 4 / (0.5 * 8), rel=0.15)


def test_a_run_on_weighted_sets_resumes_to_the_same_weights(data, other, run_dir, tmp_path):
    config = settings(data_weights=[1, 0.5], sampling="balanced")
    train(config, [data, other], tmp_path / "whole", Watched(), start=run_dir)
    with pytest.raises(KeyboardInterrupt):
        train(config, [data, other], tmp_path / "cut", Watched(stop_after=1), start=run_dir)
    train(config, [data, other], tmp_path / "cut", Watched(), start=run_dir)
    assert same_run(tmp_path / "whole", tmp_path / "cut")
    with pytest.raises(RunError, match=r"start: .* there"):
        train(config, [data, other], tmp_path / "cut", Watched(), start=tmp_path / "whole")
    with pytest.raises(RunError, match=r"start: .* there, null here"):
        train(config, [data, other], tmp_path / "cut", Watched())


def test_images_of_two_sizes_are_refused(data, tmp_path):
    large = split_tree(tmp_path / "large", size=(64, 64))
    with pytest.raises(FolderError, match=r"64 x 64 px, those of .* 32 x 32"):
        checked_images(settings(), [data, large])
