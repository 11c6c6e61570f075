"""Twins among images, across splits and classes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.study.audit.duplicates import (
    Pairs,
    count_across_splits,
    identical_pairs,
    near_pairs,
)


def thumbnails(count, seed=0):
    return np.random.default_rng(seed).integers(0, 255, (count, 32, 32)).astype(np.uint8)


@given(st.lists(st.sampled_from("abc"), max_size=12))
def test_every_image_with_a_twin_is_in_a_pair(digests):
    pairs = identical_pairs(digests)
    expected = {n for n, digest in enumerate(digests) if digests.count(digest) > 1}
    assert set(pairs.ravel().tolist()) == expected
    assert all(digests[a] == digests[b] for a, b in pairs)


def test_near_images_are_found_and_others_not():
    images = thumbnails(30)
    images[7] = images[21]
    images[7, 3, 4] ^= 1
    digests = [str(n) for n in range(30)]
    assert near_pairs(images, digests).tolist() == [[7, 21]]
    digests[7] = digests[21]
    assert not len(near_pairs(images, digests)), "identical ones are counted apart"


def test_flat_images_are_not_near():
    images = np.full((5, 32, 32), 9, np.uint8)
    images[np.arange(5), np.arange(5), 0] = 11
    assert not len(near_pairs(images, list("abcde")))


def test_few_images():
    assert not len(near_pairs(thumbnails(1), ["a"]))
    assert not len(near_pairs(thumbnails(2), ["a", "b"]))


def test_splits_and_classes_of_pairs():
    pairs = np.array([[0, 1], [2, 3]])
    label, split = np.array([0, 0, 0, 1]), np.array([0, 1, 0, 0], np.uint8)
    found = Pairs.of(pairs, label, split, list("abcd"))
    assert (found.count, found.across_splits, found.across_classes) == (4, 2, 2)
    assert found.examples[0] == ("c", "d"), "those of two classes come first"
    assert Pairs.of(pairs, label, None, list("abcd")).across_splits == 0


def test_names_in_several_splits():
    split = np.array([0, 1, 0, 2], np.uint8)
    assert count_across_splits(["p", "p", "q", "r"], split) == 1
    assert count_across_splits(None, split) is None
    assert count_across_splits(["p"], None) is None
