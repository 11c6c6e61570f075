"""Streams and Samples in a DataLoader: the same samples whatever the workers, ranks and resumes."""

import math
import pickle
from itertools import islice
from typing import Any

import numpy as np
import pytest
import torch
from extending.test_extending import swinging
from torch.utils.data import DataLoader, DistributedSampler

import radhar_cli as radhar
from radhar_cli import activity
from radhar_cli.activity import add_activity
from radhar_cli.config.schema import Config
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.on_demand import sample
from radhar_cli.dataset.split import VALIDATION, split_rows
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.learning.stream import Samples, Stream

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
ONE_MAP = ["maps/stft"]


def config(**more):
    return Config.model_validate({**DOCUMENT, **more})


def keys(batch):
    return [tuple(pair) for pair in batch["sample_key"].tolist()]


def batches(count, workers, ranks=(0, 1), start=0, **more):
    stream = Stream(config(), fields=ONE_MAP, batch_size=4, shard=ranks, start=start)
    return [*islice(DataLoader(stream, 4, num_workers=workers, **more), count)]


def same(one, other):
    return len(one) == len(other) and all(
        a.keys() == b.keys() and all(torch.equal(a[name], b[name]) for name in a)
        for a, b in zip(one, other, strict=True)
    )


@pytest.fixture(scope="module")
def alone():
    """Six batches, made in this process."""
    return batches(6, 0)


def test_a_batch_has_levels_labels_and_keys(alone):
    first = alone[0]
    assert {*first} == {"label", "sample_key", "maps/stft"}
    assert first["maps/stft"].shape == (4, 16, 16)
    assert first["maps/stft"].dtype == torch.uint8
    assert first["label"].dtype == torch.int64
    stream = Stream(config())
    assert stream.class_slugs[first["label"][0]] in DOCUMENT["activities"] + ["walking_to_falling"]
    assert (first["label"] == first["sample_key"][:, 0]).all()


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_batches_are_the_same_for_any_number_of_workers(alone, workers):
    assert same(batches(6, workers), alone)


def test_spawned_workers_make_the_same_too(alone):
    assert same(batches(2, 1, multiprocessing_context="spawn"), alone[:2])


def test_ranks_share_the_batches(alone):
    shares = [batches(3, workers, (rank, 2)) for rank, workers in ((0, 0), (1, 2))]
    assert same([batch for pair in zip(*shares, strict=True) for batch in pair], alone)


def test_a_stream_resumed_at_a_sample_continues_unchanged(alone):
    assert same(batches(4, 2, start=2 * 4), alone[2:])
    assert same(batches(1, 0, (1, 2), start=2 * 4), [alone[3]])


def test_without_the_batch_size_workers_change_the_order_but_not_the_samples():
    def seen(workers, count):
        stream = Stream(config(), fields=ONE_MAP)
        found = islice(DataLoader(stream, 4, num_workers=workers), count)
        return {
            key: levels
            for batch in found
            for key, levels in zip(keys(batch), batch["maps/stft"], strict=True)
        }

    one, two = seen(0, 6), seen(2, 4)
    assert {*two} <= {*one}
    assert all(torch.equal(one[key], levels) for key, levels in two.items())


def test_a_stream_is_sample_by_name_and_index(alone):
    stream = Stream(config())
    for (label, index), levels in zip(keys(alone[1]), alone[1]["maps/stft"], strict=True):
        made = sample(config(), stream.class_slugs[label], index)
        assert np.array_equal(levels.numpy(), made["maps/stft"])


def test_another_seed_is_another_stream_with_an_identity_of_its_own():
    one, other, again = Stream(config()), Stream(config(), 8), Stream(config(seed=8))
    assert one.identity != other.identity == again.identity
    assert other.config.seed == 8
    first = [next(iter(DataLoader(stream, 4)))["maps/stft"] for stream in (one, other, again)]
    assert not torch.equal(first[0], first[1])
    assert torch.equal(first[1], first[2])


def test_ranks_are_those_of_torchrun_also_in_spawned_workers(monkeypatch):
    monkeypatch.setenv("RANK", "1")
    monkeypatch.setenv("WORLD_SIZE", "2")
    handed = pickle.dumps(Stream(config(), fields=ONE_MAP))
    here = next(iter(Stream(config(), fields=ONE_MAP)))
    monkeypatch.delenv("RANK")
    monkeypatch.delenv("WORLD_SIZE")
    there = next(iter(pickle.loads(handed)))
    order = [*islice(Stream(config(), fields=ONE_MAP), 2)]
    for made in (here, there):
        assert (made["sample_key"] == order[1]["sample_key"]).all()


def test_samples_are_the_rows_of_the_data_set():
    samples, rows = Samples(config(), fields=ONE_MAP), Rows.of(config())
    assert len(samples) == 12
    found = dict(enumerate(DataLoader(samples, batch_size=None, num_workers=2)))
    for row, made in found.items():
        one, index = rows[row]
        assert made["sample_key"].tolist() == [one.index, index]
        assert samples.label[row] == made["label"] == one.index
        there = sample(config(), one, index, ONE_MAP)
        assert np.array_equal(made["maps/stft"], there["maps/stft"])


def test_samples_of_a_split_are_those_rows_alone():
    samples = Samples(config(), split="val", fields=["scene/height"])
    rows = np.flatnonzero(split_rows(config()) == VALIDATION)
    assert len(samples) == rows.size
    order = Rows.of(config())
    for number, row in enumerate(rows):
        made = samples[number]
        assert tuple(made["sample_key"]) == (order[int(row)][0].index, order[int(row)][1])
    train = Stream(config(), split="train", fields=["scene/height"])
    held_back = {tuple(samples[number]["sample_key"].tolist()) for number in range(len(samples))}
    seen = {tuple(made["sample_key"].tolist()) for made in islice(train, 30)}
    assert not held_back & seen


def test_a_distributed_sampler_shares_the_rows():
    samples = Samples(config(), fields=["scene/height"])
    found: list[tuple[int, int]] = []
    for rank in range(2):
        sampler = DistributedSampler(samples, 2, rank, shuffle=True, seed=3)
        sampler.set_epoch(1)
        for batch in DataLoader(samples, 3, sampler=sampler, num_workers=1):
            found += keys(batch)
    assert len(found) == len({*found}) == len(samples)


def test_power_and_slow_time_come_as_tensors():
    whole = config(output={"power": "float16", "slow_time": True})
    batch = next(iter(DataLoader(Stream(whole), 2)))
    assert batch["power/stft"].dtype == torch.float16
    assert batch["slow_time"].dtype == torch.complex64
    assert batch["slow_time"].shape[1] == 2000 - 1


@pytest.mark.parametrize("workers", [0, 1])
def test_on_invalid_error_ends_a_stream(workers):
    far = config(motion={"model": "paper", "range_m": {"uniform": [1, 40]}}, on_invalid="error")
    stream = Stream(far, fields=["scene/range"])
    with pytest.raises(SceneError, match=r"sample \w+/\d+: a scatterer leaves the range half-band"):
        [*islice(DataLoader(stream, 2, num_workers=workers), 20)]
    again = Stream(far.model_copy(update={"on_invalid": "redraw"}), fields=["scene/range"])
    assert all(math.isfinite(made["scene/range"]) for made in islice(again, 10))


def test_user_defined_classes_are_known_to_workers(monkeypatch):
    """A spawned worker begins without it, and gets the stream as bytes."""
    monkeypatch.setattr(activity, "_OWN", {})
    add_activity("swinging_ball", swinging)
    stream = Stream(config(activities=["walking", "swinging_ball"]), fields=ONE_MAP)
    here, handed = [*islice(stream, 2)], pickle.dumps(stream)
    monkeypatch.setattr(activity, "_OWN", {})
    there = [*islice(pickle.loads(handed), 2)]
    assert sorted(made["label"] for made in there) == [7, 12]
    for one, other in zip(here, there, strict=True):
        assert np.array_equal(one["maps/stft"], other["maps/stft"])


def test_mistakes_are_refused_in_one_line():
    for make, words in (
        (lambda: Stream(config(), batch_size=0), "batch_size = 0: should be a whole number from 1"),
        (lambda: Stream(config(), start=-1), "start = -1: should be a whole number from 0"),
        (lambda: Stream(config(), batch_size=2.5), "batch_size = 2.5"),
        (lambda: Stream(config(), seed=-1), "seed = -1: should be a whole number from 0 to 2"),
        (lambda: Samples(config(), 2**63), "seed = 9223372036854775808: should be"),
        (lambda: Stream("x.yaml"), r"x\.yaml: no such file"),
        (lambda: Samples(7), "config = 7: should be the path"),
        *(
            (lambda shard=shard: Stream(config(), shard=shard), "shard = .*should be .rank, ranks")
            for shard in ((5, 2), (2, 2), (0, 0), (-1, 2), (0.5, 2), (1,), 3)
        ),
        (lambda: Stream(config(), split="val"), "should be all or train"),
        (lambda: Stream(config(), fields=["maps/fsst"]), "is not in this data set"),
        (lambda: Samples(config(split={"train": 1, "validation": 0}), split="val"), "no sample"),
    ):
        with pytest.raises(ConfigError, match=words):
            make()


def test_public_names_of_the_package():
    assert radhar.Stream is Stream
    assert radhar.Samples is Samples
