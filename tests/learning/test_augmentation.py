"""Changed copies of training images."""

from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from learning.patterns import same, settings, split_tree, trained

from radhar_cli.errors import ConfigError
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.settings import AugmentConfig, TrainConfig


def changed(levels, row=0, epoch=0, seed=1, **config):
    return Augmentation(AugmentConfig(**config), seed)(levels, row, epoch)


def blob(row, column, size=64):
    levels = np.zeros((size, size), np.uint8)
    levels[row - 2 : row + 3, column - 2 : column + 3] = 255
    return levels


def centre(levels):
    weights = levels.astype(float)
    rows, columns = np.indices(levels.shape)
    return (
        float((rows * weights).sum() / weights.sum()),
        float((columns * weights).sum() / weights.sum()),
    )


def test_no_augmentation_by_default():
    levels = np.random.default_rng(1).integers(0, 256, (16, 20), dtype=np.uint8)
    assert np.array_equal(changed(levels), levels)


def test_a_shift_moves_along_time_alone_and_stays_in_its_range():
    moves = [centre(changed(blob(31, 31), row, time_shift=0.25)) for row in range(60)]
    rows, columns = np.array(moves).T
    assert np.abs(rows - 31).max() < 0.1
    assert 10 < np.ptp(columns) <= 32
    assert np.abs(columns - 31).max() <= 16.1


def test_doppler_scale_keeps_zero_doppler_and_multiplies_the_rest():
    middle = 31.5
    above = np.array(
        [centre(changed(blob(16, 31), row, doppler_scale=0.3))[0] for row in range(60)]
    )
    factors = (above - middle) / (16 - middle)
    assert np.exp(-0.31) < factors.min() < 0.85
    assert 1.15 < factors.max() < np.exp(0.31)
    at_zero = np.zeros((63, 63), np.uint8)
    at_zero[31] = 200
    for row in range(5):
        found = changed(at_zero, row, doppler_scale=0.3)
        assert found[31].min() > 100
        assert not found[:29].any()
        assert not found[34:].any()


def test_time_stretch_keeps_the_middle_and_multiplies_the_distance_from_it():
    left, right = (
        np.array([centre(changed(blob(31, at), row, time_stretch=0.3)) for row in range(60)])
        for at in (21, 41)
    )
    factors = (right[:, 1] - left[:, 1]) / 20
    assert np.exp(-0.31) < factors.min() < 0.85
    assert 1.15 < factors.max() < np.exp(0.31)
    assert np.abs((left[:, 1] + right[:, 1]) / 2 - 31.5 + 0.5 * factors).max() < 0.3
    assert np.abs(left[:, 0] - 31).max() < 0.1, "nothing moves along Doppler"


def test_a_doppler_shift_moves_along_doppler_alone():
    moves = np.array([centre(changed(blob(31, 31), row, doppler_shift=0.1)) for row in range(60)])
    assert 5 < np.ptp(moves[:, 0]) <= 12.8
    assert np.abs(moves[:, 1] - 31).max() < 0.1


def test_contrast_is_another_snr():
    """Levels are decibels: the strongest stays, and the floor lies so many more or fewer below."""
    levels = np.tile(np.array([75, 155, 255], np.uint8), (8, 8))
    floors = np.array([int(changed(levels, row, contrast=0.4)[0, 0]) for row in range(60)])
    for row in range(60):
        strongest, middle = (changed(levels, row, contrast=0.4)[0, at] for at in (2, 1))
        assert strongest == 255
        assert (255 - middle) == pytest.approx((255 - floors[row]) * 100 / 180, abs=1)
    below = (255 - floors) / 180
    assert 0.6 <= below.min() + 0.01 < 0.75
    assert 1.25 < below.max() <= 1.41


def test_masks_grow_or_shrink_by_one_pixel():
    mask = blob(31, 31)  # 5 x 5 px
    sizes = set()
    for row in range(60):
        found = changed(mask, row, morphology=1) > 0
        height, width = (int(found.any(axis=axis).sum()) for axis in (1, 0))
        assert found.sum() == height * width, "it stays a rectangle"
        sizes.add((height, width))
    assert sizes == {(3, 3), (3, 5), (5, 3), (7, 7), (7, 5), (5, 7)}
    kept = [np.array_equal(changed(mask, row, morphology=0.5), mask) for row in range(200)]
    assert 0.35 < np.mean(kept) < 0.65


def test_noise_takes_levels_that_are_there():
    mask = (np.random.default_rng(2).random((64, 64)) < 0.3).astype(np.uint8) * 255
    found = changed(mask, 3, noise=0.4)
    assert set(np.unique(found).tolist()) == {0, 255}
    assert 0 < (found != mask).mean() < 0.4


def test_bands_are_blank_from_edge_to_edge():
    full = np.full((64, 64), 255, np.uint8)
    for row in range(20):
        for bands, along in (("time_bands", 0), ("doppler_bands", 1)):
            found = changed(full, row, **{bands: 1, "band_width": 0.3})
            assert ((found == 0).all(axis=along) | (found == 255).all(axis=along)).all()
            assert (found == 0).mean() <= 0.3


@examples(max_examples=60)
@given(
    height=st.integers(1, 40),
    width=st.integers(1, 40),
    value=st.floats(0, 1),
    bands=st.integers(0, 3),
    row=st.integers(0, 1000),
)
def test_any_setting_gives_an_image_of_the_same_size_again_and_again(
    height, width, value, bands, row
):
    names = AugmentConfig.model_fields.keys() - {"time_bands", "doppler_bands"}
    config = {**dict.fromkeys(names, value), "time_bands": bands, "doppler_bands": bands}
    levels = np.random.default_rng(row).integers(0, 256, (height, width), dtype=np.uint8)
    one, again = (changed(levels, row, 3, **config) for _ in range(2))
    assert one.shape == levels.shape
    assert one.dtype == np.uint8
    assert np.array_equal(one, again)


def test_augmentation_differs_by_row_epoch_and_seed():
    levels = blob(20, 20)
    kinds = [
        changed(levels, row, epoch, seed, time_shift=0.3).tobytes()
        for row, epoch, seed in ((0, 0, 1), (1, 0, 1), (0, 1, 1), (0, 0, 2))
    ]
    assert len(set(kinds)) == 4


def test_coloured_images_are_refused():
    with pytest.raises(ValueError, match="input: gray"):
        TrainConfig.model_validate({"augment": {"noise": 0.1}})


AUGMENTED: dict[str, Any] = {"input": "gray", "augment": {"time_shift": 0.3, "noise": 0.1}}


def test_a_run_learns_from_changed_images_and_resumes_to_the_same_weights(data, tmp_path):
    from learning.patterns import Watched, last_weights

    whole = trained(data, tmp_path / "whole", **AUGMENTED)
    plain = trained(data, tmp_path / "plain", input="gray")
    assert not same(last_weights(whole.folder), last_weights(plain.folder))
    with pytest.raises(KeyboardInterrupt):
        trained(data, tmp_path / "cut", Watched(stop_after=1), **AUGMENTED)
    trained(data, tmp_path / "cut", **AUGMENTED)
    assert same(last_weights(whole.folder), last_weights(tmp_path / "cut"))


def test_workers_change_images_in_the_same_way(data, tmp_path):
    from learning.patterns import last_weights

    for workers in (0, 1):
        trained(data, tmp_path / str(workers), workers=workers, epochs=1, **AUGMENTED)
    assert same(last_weights(tmp_path / "0"), last_weights(tmp_path / "1"))


def test_init_starts_from_the_weights_and_normalisation_of_a_run(data, run_dir, tmp_path):
    from learning.patterns import Watched, best_weights

    from radhar_cli.learning.training import TrainOptions, train

    still = settings(learning_rate=1e-12, weight_decay=0.0, epochs=1, optimiser="sgd")
    other = split_tree(tmp_path / "other", seed=5)
    train(still, other, tmp_path / "out", Watched(), TrainOptions(start=run_dir))
    metadata, _ = load_best(tmp_path / "out")
    assert metadata.normalisation == load_best(run_dir)[0].normalisation
    learned, before = best_weights(tmp_path / "out"), best_weights(run_dir)
    for name, tensor in before.items():
        if "running" not in name and "batches" not in name:
            torch.testing.assert_close(learned[name], tensor, rtol=0, atol=1e-6)


def test_init_with_other_classes_learns_the_last_layer_anew(run_dir, tmp_path):
    from learning.patterns import Watched

    from radhar_cli.learning.training import TrainOptions, train

    other = split_tree(tmp_path / "other", classes=("walking", "wave"))
    watched = Watched()
    train(settings(epochs=1), other, tmp_path / "out", watched, TrainOptions(start=run_dir))
    assert any("last layer" in message for message in watched.messages)


def test_init_of_another_model_is_refused(run_dir, data, tmp_path):
    from learning.patterns import Watched

    from radhar_cli.learning.training import TrainOptions, train

    with pytest.raises(ConfigError, match=r"--init .*: its input is rgb, here it is gray"):
        train(
            settings(input="gray"), data, tmp_path / "out", Watched(), TrainOptions(start=run_dir)
        )
