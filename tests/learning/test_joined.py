"""Several data sets that are learned from as one."""

import numpy as np
import pytest
from helpers.listener import Listener
from learning.patterns import Watched, clear_line, same_run, settings, split_tree

from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.batches import epoch_order
from radhar_cli.learning.images.joined import joined, sampling_weights
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.run_folder import RunError, load_best
from radhar_cli.learning.training import TrainOptions, train
from radhar_cli.learning.training_set import open_training_set


@pytest.fixture
def other(tmp_path):
    """A tree with one class of `data`'s, and one of its own."""
    return split_tree(tmp_path / "other", train=8, seed=7, classes=("walking", "wave"))


def test_a_joined_set_has_all_rows_and_classes(data, other):
    one, two = (open_images(path, None, "rgb") for path in (data, other))
    both = open_training_set(settings(), [data, other])
    assert len(both) == len(one) + len(two)
    assert set(both.classes) == {*one.classes, *two.classes}
    for row in range(len(both)):
        part, at = (one, row) if row < len(one) else (two, row - len(one))
        assert both.classes[both.samples.label[row]] == part.classes[part.samples.label[at]]
        assert both.samples.split is not None
        assert part.samples.split is not None
        assert both.samples.split[row] == part.samples.split[at]
        assert np.array_equal(both.pixels.read(row), part.pixels.read(at))
        assert both.samples.source[row] == (part is two)


def test_weights_of_sets_and_balance_of_classes(data, other):
    both = open_training_set(settings(), [data, other])
    rows = both.rows("train")
    plain = sampling_weights(both, rows, None, balanced=False)
    assert (plain == 1).all()
    weighted = sampling_weights(both, rows, (1.0, 0.25), balanced=False)
    assert weighted[both.samples.source[rows] == 1].tolist() == [0.25] * 16
    balanced = sampling_weights(both, rows, (1.0, 0.25), balanced=True)
    mass = np.bincount(both.samples.label[rows], balanced)
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
    both = open_training_set(config, [data, other])
    rows = both.rows("train")
    weights = sampling_weights(both, rows, config.data_weights, balanced=True)
    shown = np.concatenate([rows[epoch_order(weights, seed=1, epoch=e)] for e in range(50)])
    by_class = np.bincount(both.samples.label[shown]) / 50
    assert by_class == pytest.approx([11] * 4, rel=0.1)
    walking = both.classes.index("walking")
    of_walking = shown[both.samples.label[shown] == walking]
    by_set = np.bincount(both.samples.source[of_walking])
    assert by_set[0] / by_set[1] == pytest.approx(3 * 4 / (0.5 * 8), rel=0.15)


def test_a_run_on_weighted_sets_resumes_to_the_same_weights(data, other, run_dir, tmp_path):
    config = settings(data_weights=[1, 0.5], sampling="balanced")
    train(config, [data, other], tmp_path / "whole", Watched(), TrainOptions(start=run_dir))
    with pytest.raises(KeyboardInterrupt):
        train(
            config,
            [data, other],
            tmp_path / "cut",
            Watched(stop_after=1),
            TrainOptions(start=run_dir),
        )
    train(config, [data, other], tmp_path / "cut", Watched(), TrainOptions(start=run_dir))
    assert same_run(tmp_path / "whole", tmp_path / "cut")
    with pytest.raises(RunError, match=r"start: .* there"):
        train(
            config,
            [data, other],
            tmp_path / "cut",
            Watched(),
            TrainOptions(start=tmp_path / "whole"),
        )
    with pytest.raises(RunError, match=r"start: .* there, null here"):
        train(config, [data, other], tmp_path / "cut", Watched())


def test_images_of_two_sizes_are_refused(data, tmp_path):
    large = split_tree(tmp_path / "large", size=(64, 64))
    with pytest.raises(FolderError, match=r"64 x 64 px, those of .* 32 x 32"):
        open_training_set(settings(), [data, large])


def h5_set(folder, name, maps, colour_map="viridis"):
    text = SET.replace("MAPS", maps).replace("COLOURS", colour_map)
    path = folder / f"{name}.yaml"
    path.write_text(text)
    build(load_config(path), folder / name, progress=Listener(), jobs=1)
    return folder / name


SET = """
samples_per_class: 2
activities: [punching, walking]
duration_s: 1.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
motion: {range_m: 2}
maps: [MAPS]
image: {size_px: 32, colour_map: COLOURS}
output: {png: false}
split: {train: 0.5, validation: 0.5}
"""


def test_data_sets_of_two_maps_are_no_one_set_unless_a_map_is_named(tmp_path, data):
    """Without --map each data set would give its first one."""
    one, two = h5_set(tmp_path, "one", "stft"), h5_set(tmp_path, "two", "rtm, stft")
    with clear_line(FolderError, two, "its map is rtm", "stft", "--map"):
        open_training_set(settings(), [one, two])
    assert open_training_set(settings(map="stft"), [one, two]).map == "stft"
    mixed = open_training_set(settings(), [data, one])  # a tree says of no map
    assert mixed.map == "stft"
    with clear_line(FolderError, "its map is rtm"):
        open_training_set(settings(), [one, data, two])


def test_of_all_joined_sets_what_is_left_out_is_added_up(data, other):
    sets = [open_images(path, None, "rgb").renamed({"walking": None}) for path in (data, other)]
    both = joined([*sets, open_images(data, None, "rgb")])
    assert both.left_out == {"walking": 6 + 10}


def test_a_joined_set_is_named_after_all_of_its_parts(data, other, tmp_path):
    train(settings(epochs=1), [data, other], tmp_path / "run", Watched())
    assert load_best(tmp_path / "run")[0].data["path"] == f"{data} and {other}"


def test_joined_data_sets_have_the_colours_of_the_first(tmp_path):
    one = h5_set(tmp_path, "one", "stft")
    two = h5_set(tmp_path, "two", "stft", "jet")
    both = open_training_set(settings(), [one, two])
    assert both.colours == "viridis"
    assert any("drawn in jet, recoloured to viridis" in note for note in both.notes)
    for row in range(4):
        np.testing.assert_array_equal(both.pixels.read(row), both.pixels.read(row + 4))
