"""Changed copies of training images."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from learning.patterns import same, settings, split_tree, trained

from radhar_cli.arrays import Levels
from radhar_cli.errors import ConfigError
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.settings import AugmentConfig, TrainConfig


def changed(levels: Levels, row: int = 0, epoch: int = 0, seed: int = 1, **config: Any) -> Levels:
    return Augmentation(AugmentConfig(**config), seed)(levels, row, epoch)


def blob(row: int, column: int, size: int = 64) -> Levels:
    levels = np.zeros((size, size), np.uint8)
    levels[row - 2 : row + 3, column - 2 : column + 3] = 255
    return levels


def centre(levels: Levels) -> tuple[float, float]:
    weights = levels.astype(float)
    rows, columns = np.indices(levels.shape)
    return (
        float((rows * weights).sum() / weights.sum()),
        float((columns * weights).sum() / weights.sum()),
    )


def test_nothing_asked_changes_nothing() -> None:
    levels = np.random.default_rng(1).integers(0, 256, (16, 20), dtype=np.uint8)
    assert np.array_equal(changed(levels), levels)


def test_a_shift_moves_along_time_alone_and_stays_in_its_range() -> None:
    moves = [centre(changed(blob(31, 31), row, time_shift=0.25)) for row in range(60)]
    rows, columns = np.array(moves).T
    assert np.abs(rows - 31).max() < 0.1
    assert 10 < np.ptp(columns) <= 32
    assert np.abs(columns - 31).max() <= 16.1


def test_doppler_scale_keeps_zero_doppler_and_multiplies_the_rest() -> None:
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


def test_noise_takes_levels_that_are_there() -> None:
    mask = (np.random.default_rng(2).random((64, 64)) < 0.3).astype(np.uint8) * 255
    found = changed(mask, 3, noise=0.4)
    assert set(np.unique(found).tolist()) == {0, 255}
    assert 0 < (found != mask).mean() < 0.4


def test_bands_are_blank_from_edge_to_edge() -> None:
    full = np.full((64, 64), 255, np.uint8)
    for row in range(20):
        found = changed(full, row, time_bands=1, band_width=0.3)
        assert ((found == 0).all(axis=0) | (found == 255).all(axis=0)).all()
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
    height: int, width: int, value: float, bands: int, row: int
) -> None:
    names = AugmentConfig.model_fields.keys() - {"time_bands", "doppler_bands"}
    config = {**dict.fromkeys(names, value), "time_bands": bands, "doppler_bands": bands}
    levels = np.random.default_rng(row).integers(0, 256, (height, width), dtype=np.uint8)
    one, again = (changed(levels, row, 3, **config) for _ in range(2))
    assert one.shape == levels.shape
    assert one.dtype == np.uint8
    assert np.array_equal(one, again)


def test_rows_epochs_and_seeds_differ() -> None:
    levels = blob(20, 20)
    kinds = [
        changed(levels, row, epoch, seed, time_shift=0.3).tobytes()
        for row, epoch, seed in ((0, 0, 1), (1, 0, 1), (0, 1, 1), (0, 0, 2))
    ]
    assert len(set(kinds)) == 4


def test_coloured_images_are_refused() -> None:
    with pytest.raises(ValueError, match="input: gray"):
        TrainConfig.model_validate({"augment": {"noise": 0.1}})


AUGMENTED: dict[str, Any] = {"input": "gray", "augment": {"time_shift": 0.3, "noise": 0.1}}


def test_a_run_learns_from_changed_images_and_resumes_to_the_same_weights(
    data: Path, tmp_path: Path
) -> None:
    from learning.patterns import Watched, last_weights

    whole = trained(data, tmp_path / "whole", **AUGMENTED)
    plain = trained(data, tmp_path / "plain", input="gray")
    assert not same(last_weights(whole.folder), last_weights(plain.folder))
    with pytest.raises(KeyboardInterrupt):
        trained(data, tmp_path / "cut", Watched(stop_after=1), **AUGMENTED)
    trained(data, tmp_path / "cut", **AUGMENTED)
    assert same(last_weights(whole.folder), last_weights(tmp_path / "cut"))


def test_workers_change_images_in_the_same_way(data: Path, tmp_path: Path) -> None:
    from learning.patterns import last_weights

    for workers in (0, 1):
        trained(data, tmp_path / str(workers), workers=workers, epochs=1, **AUGMENTED)
    assert same(last_weights(tmp_path / "0"), last_weights(tmp_path / "1"))


def test_init_starts_from_the_weights_and_normalisation_of_a_run(
    data: Path, run_dir: Path, tmp_path: Path
) -> None:
    from learning.patterns import Watched, best_weights

    from radhar_cli.learning.training import train

    still = settings(learning_rate=1e-12, weight_decay=0.0, epochs=1, optimiser="sgd")
    other = split_tree(tmp_path / "other", seed=5)
    train(still, other, tmp_path / "out", Watched(), start=run_dir)
    metadata, _ = load_best(tmp_path / "out")
    assert metadata.normalisation == load_best(run_dir)[0].normalisation
    learned, before = best_weights(tmp_path / "out"), best_weights(run_dir)
    for name, tensor in before.items():
        if "running" not in name and "batches" not in name:
            torch.testing.assert_close(learned[name], tensor, rtol=0, atol=1e-6)


def test_init_with_other_classes_learns_the_last_layer_anew(run_dir: Path, tmp_path: Path) -> None:
    from learning.patterns import Watched

    from radhar_cli.learning.training import train

    other = split_tree(tmp_path / "other", classes=("walking", "wave"))
    watched = Watched()
    train(settings(epochs=1), other, tmp_path / "out", watched, start=run_dir)
    assert any("last layer" in message for message in watched.said)


def test_init_of_another_model_is_refused(run_dir: Path, data: Path, tmp_path: Path) -> None:
    from learning.patterns import Watched

    from radhar_cli.learning.training import train

    with pytest.raises(ConfigError, match=r"--init .*: its input is rgb, here it is gray"):
        train(settings(input="gray"), data, tmp_path / "out", Watched(), start=run_dir)
