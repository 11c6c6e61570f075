"""Batches: every image once."""

import numpy as np
import torch
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from radhar_cli.learning.batches import Normalisation, Reader, epoch_batches, epoch_order
from radhar_cli.learning.images.opening import open_images


@examples(max_examples=200)
@given(count=st.integers(1, 200), size=st.integers(2, 64), epoch=st.integers(0, 5))
def test_every_image_exactly_once(count, size, epoch):
    batches = epoch_batches(epoch_order(np.ones(count), 3, epoch), size)
    assert sorted(np.concatenate(batches).tolist()) == list(range(count))
    assert all(batch.size == size for batch in batches[:-1])
    assert min(2, count) <= batches[-1].size <= size + 1


def test_order_depends_on_seed_and_epoch_alone():
    def order(seed, epoch):
        found: list[int] = epoch_order(np.ones(40), seed, epoch).tolist()
        return found

    assert order(1, 0) == order(1, 0)
    assert order(1, 0) != order(1, 1)
    assert order(1, 0) != order(2, 0)
    assert order(1, 0) != list(range(40))


def test_a_weight_is_how_often_an_epoch_shows_an_image():
    weights = np.array([0.0, 0.25, 1.0, 2.5])
    shown = np.zeros(4)
    for epoch in range(400):
        times = np.bincount(epoch_order(weights, 1, epoch), minlength=4)
        assert (np.floor(weights) <= times).all()
        assert (times <= np.ceil(weights)).all()
        shown += times
    assert np.abs(shown / 400 - weights).max() < 0.1


def test_levels_become_zero_mean_and_unit_spread_channel_by_channel():
    levels = torch.randint(0, 256, (2, 3, 4, 5), dtype=torch.uint8)
    found = Normalisation((0.1, 0.5, 0.9), (0.2, 1.0, 0.25))(levels)
    assert found.dtype == torch.float32
    for channel, (mean, sd) in enumerate(((0.1, 0.2), (0.5, 1.0), (0.9, 0.25))):
        expected = (levels[:, channel].double() / 255 - mean) / sd
        torch.testing.assert_close(found[:, channel].double(), expected, rtol=1e-5, atol=1e-5)


def test_reader_yields_rows_as_asked_channels_first(data):
    images = open_images(data, None, "rgb")
    labels = np.arange(len(images)) + 100
    reader = Reader(images.pixels, labels)
    for _ in range(2):
        (one, first), (two, second) = reader([np.array([5, 0, 7]), np.array([2])])
        assert first.tolist() == [105, 100, 107]
        assert second.tolist() == [102]
        assert (one.shape, one.dtype) == ((3, 3, 32, 32), torch.uint8)
        assert np.array_equal(one[0].numpy().transpose(1, 2, 0), images.pixels.read(5))
        assert np.array_equal(two[0].numpy().transpose(1, 2, 0), images.pixels.read(2))
