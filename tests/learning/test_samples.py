"""Samples in a DataLoader: the same whatever the workers and ranks."""

import math
import pickle
from typing import Any

import numpy as np
import pytest
import torch
from extending.test_extending import swinging
from torch.utils.data import DataLoader, DistributedSampler

import radhar_cli as radhar
from radhar_cli.config.data_set import Config
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.on_demand import sample
from radhar_cli.dataset.split import VALIDATION, split_rows
from radhar_cli.errors import RadharError, SceneError
from radhar_cli.learning.samples import Samples
from radhar_cli.motion.activities import activity
from radhar_cli.motion.activities.activity import add_activity

pytestmark = pytest.mark.filterwarnings("ignore:This DataLoader will create")  # on few cores
DOCUMENT: dict[str, Any] = {
    "seed": 7,
    "samples_per_class": 4,
    "activities": ["punching", "walking", "S12"],
    "radar": {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500},
    "motion": {"model": "paper", "range_m": {"per_activity": {"default": 2, "walking": 3}}},
    "maps": ["rtm", "stft"],
    "image": {"size_px": 16},
    "split": {"train": 0.5, "validation": 0.5},
}


def config(**more):
    return Config.model_validate({**DOCUMENT, **more})


def keys(batch):
    return [tuple(pair) for pair in batch["sample_key"].tolist()]


def test_samples_are_the_rows_of_the_data_set():
    samples, rows = Samples(config()), Rows.of(config())
    assert len(samples) == 12
    found = dict(enumerate(DataLoader(samples, batch_size=None, num_workers=2)))
    for row, made in found.items():
        one, index = rows[row]
        assert made["sample_key"].tolist() == [config().activities.index(one.slug), index]
        assert samples.label[row] == made["label"] == made["sample_key"][0]
        there = sample(config(), one, index)
        assert np.array_equal(made["maps/stft"], there["maps/stft"])


def test_samples_of_a_split_are_those_rows_alone():
    samples = Samples(config(), split="val")
    rows = np.flatnonzero(split_rows(config()) == VALIDATION)
    assert len(samples) == rows.size
    order = Rows.of(config())
    for number, row in enumerate(rows):
        made = samples[number]
        assert tuple(made["sample_key"]) == (order.label[row], order[int(row)][1])


def test_a_distributed_sampler_shares_the_rows():
    samples = Samples(config())
    found: list[tuple[int, int]] = []
    for rank in range(2):
        sampler = DistributedSampler(samples, 2, rank, shuffle=True, seed=3)
        sampler.set_epoch(1)
        for batch in DataLoader(samples, 3, sampler=sampler, num_workers=1):
            found += keys(batch)
    assert len(found) == len({*found}) == len(samples)


def test_power_and_slow_time_come_as_tensors():
    whole = config(output={"power": "float16", "slow_time": True})
    batch = next(iter(DataLoader(Samples(whole), 2)))
    assert batch["power/stft"].dtype == torch.float16
    assert batch["slow_time"].dtype == torch.complex64
    assert batch["slow_time"].shape[1] == 2000 - 1


@pytest.mark.parametrize("workers", [0, 1])
def test_on_invalid_error_ends_a_loader(workers):
    far = config(motion={"model": "paper", "range_m": {"uniform": [1, 40]}}, on_invalid="error")
    samples = Samples(far)
    with pytest.raises(SceneError, match=r"sample \w+/\d+: a scatterer leaves the range half-band"):
        [*DataLoader(samples, 2, num_workers=workers)]
    again = Samples(far.model_copy(update={"on_invalid": "redraw"}))
    assert all(math.isfinite(again[row]["scene/range"]) for row in range(len(again)))


def test_another_seed_is_another_data_set_with_an_identity_of_its_own():
    one, other, again = Samples(config()), Samples(config(), 8), Samples(config(seed=8))
    assert one.identity != other.identity == again.identity
    assert other.config.seed == 8
    assert not np.array_equal(one[0]["maps/stft"], other[0]["maps/stft"])
    assert np.array_equal(other[0]["maps/stft"], again[0]["maps/stft"])


def test_user_defined_classes_are_known_to_workers(monkeypatch):
    """A spawned worker begins without it, and gets the samples as bytes."""
    monkeypatch.setattr(activity, "_ADDED", {})
    add_activity("swinging_ball", swinging)
    samples = Samples(config(activities=["walking", "swinging_ball"]))
    here, handed = [samples[0], samples[4]], pickle.dumps(samples)
    monkeypatch.setattr(activity, "_ADDED", {})
    there = [pickle.loads(handed)[row] for row in (0, 4)]
    assert sorted(made["label"] for made in there) == [0, 1]
    for one, other in zip(here, there, strict=True):
        assert np.array_equal(one["maps/stft"], other["maps/stft"])


def test_mistakes_are_refused_in_one_line():
    for make, words in (
        (lambda: Samples(config(), seed=-1), "seed = -1: should be a whole number from 0 to 2"),
        (lambda: Samples(config(), 2**63), "seed = 9223372036854775808: should be"),
        (lambda: Samples("x.yaml"), r"x\.yaml: no such file"),
        (lambda: Samples(7), "config = 7: should be the path"),
        (
            lambda: Samples(config(split={"train": 1, "validation": 0}), split="val"),
            r"^split\.validation: leaves no sample",
        ),
        (lambda: Samples(config(), split="foo"), "^split = 'foo': is not a split; the splits are"),
    ):
        with pytest.raises(RadharError, match=words):
            make()


def test_public_names_of_the_package():
    assert radhar.Samples is Samples
