"""`radhar.torch_dataset`, and what the objects of the Python interface say of themselves."""

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from helpers.command_line import radhar as run
from torch.utils.data import DataLoader

import radhar_cli as radhar
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.images.opening import open_images

YAML = """\
samples_per_class: 4
activities: [walking, punching]
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
maps: [rtm, stft]
image: {size_px: 16}
split: {train: 0.5, validation: 0.5}
"""


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("config") / "two.yaml"
    path.write_text(YAML)
    return path


@pytest.fixture(scope="module")
def data(config: Path) -> Path:
    run("generate", config, "-o", config.parent / "data")
    return config.parent / "data"


@pytest.mark.slow
def test_workers_read_what_training_reads(data: Path) -> None:
    images = open_images(data, "stft", "rgb")
    found = radhar.torch_dataset(str(data), "stft", split="val")
    assert found.classes == ("walking", "punching")
    rows = images.rows("val")
    loader = DataLoader(found, 2, num_workers=2, multiprocessing_context="spawn")
    read, labels = (torch.cat(parts) for parts in zip(*loader, strict=True))
    assert read.dtype == torch.float32
    assert labels.tolist() == images.samples.label[rows].tolist()
    for row, image in zip(rows, read, strict=True):
        levels = (image * 255).round().to(torch.uint8).permute(1, 2, 0).numpy()
        assert np.array_equal(levels, images.pixels.read(int(row)))


def test_a_copy_for_a_worker_reads_the_same(data: Path) -> None:
    found = radhar.torch_dataset(str(data), "stft", split="val")
    (image, label), (copied, label_there) = found[1], pickle.loads(pickle.dumps(found))[1]
    assert torch.equal(image, copied)
    assert label == label_there


def test_gray_levels_are_one_channel_and_a_transform_is_applied(data: Path) -> None:
    with radhar.open_dataset(data) as opened:
        levels = opened.maps["rtm"][7]
    (image, _), (flipped, _) = (
        radhar.torch_dataset(data, input="gray", transform=transform)[-1]
        for transform in (None, lambda one: one.flip(1))
    )
    assert image.shape == (1, 16, 16)
    assert torch.equal((image[0] * 255).round(), torch.from_numpy(levels).float())
    assert torch.equal(flipped, image.flip(1))


def test_mistakes_say_what_there_is(data: Path) -> None:
    for arguments, error, words in (
        ({"map": "fsst"}, FolderError, "no map 'fsst'; .*stft"),
        ({"split": "test"}, FolderError, r"no test images \(it has 4 train, 4 validation\)"),
        ({"split": "tset"}, ConfigError, "split = 'tset': is not a split; did you mean 'test'"),
        ({"input": "red"}, ConfigError, "input = 'red': should be rgb or gray"),
    ):
        with pytest.raises(error, match=words):
            radhar.torch_dataset(data, **arguments)


def test_every_object_says_in_a_line_what_is_in_it(config: Path, data: Path) -> None:
    with radhar.open_dataset(data) as opened:
        assert repr(opened) == (
            f"<Dataset {data}/dataset.h5: 8 samples (4 train, 4 validation) of walking, punching; "
            "maps rtm, stft of 16 x 16 px>"
        )
    assert repr(radhar.torch_dataset(data, split="val")) == (
        f"<LabelledImages {data}: 4 x float32 [3, 16, 16] of map rtm; classes walking, punching>"
    )
    assert repr(radhar.Samples(config, seed=3, split="train")) == (
        "<Samples: 4 of walking, punching, synthesised from seed 3; maps rtm, stft>"
    )
    one = repr(radhar.sample(config, "walking"))
    assert one.startswith("<Sample: maps/rtm [16, 16], maps/stft [16, 16]; ")
    made = radhar.simulate(str(config), "walking", maps=("stft",))
    rows, columns = made.maps["stft"].power.shape
    assert repr(made).startswith(f"<Simulation walking/0, seed 1, 6 s: stft [{rows}, {columns}]; ")


def test_the_interface_is_listed_before_it_is_loaded() -> None:
    code = "import radhar_cli; print(*dir(radhar_cli))"
    done = subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.PIPE)
    names = {"Samples", "Sequences", "load_config", "open_dataset", "sample", "simulate"}
    assert names | {"torch_dataset"} <= {*done.stdout.decode().split()}
