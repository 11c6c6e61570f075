"""`radhar train --stream`: every image once, the same run whatever workers and interruptions."""

import json

import numpy as np
import pytest
from command_line import ok, radhar
from learning.patterns import Watched, clear_line, last_weights, same, same_run, settings
from listener import Listener

from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import ConfigError, FolderError, SceneError
from radhar_cli.learning import run_files, training
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.evaluation import open_for
from radhar_cli.learning.images.synthesised import (
    StoredPixels,
    SynthesisedPixels,
    stream_and_validation,
)
from radhar_cli.learning.training import train

CONFIG = """
seed: 7
samples_per_class: 6
activities: [punching, walking, S12]
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
motion: {model: paper, range_m: {uniform: [1, 3]}}
maps: [rtm, stft]
image: {size_px: 32}
split: {train: 0.67, validation: 0.33}
output: {png: false}
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a config and a run of three epochs on its stream."""
    folder = tmp_path_factory.mktemp("stream")
    (folder / "scenes.yaml").write_text(CONFIG)
    streamed(folder, "run")
    return folder


@pytest.fixture(scope="module")
def built(place):
    """The data set of the same config."""
    build(load_config(place / "scenes.yaml"), place / "built", 1, Listener())
    return place / "built"


def streamed(place, out, progress=None, data=(), scenes=(), **changes):
    config = load_config(place / "scenes.yaml", scenes)
    changed = settings(**{"map": "stft", **changes})
    return train(changed, data, place / out, progress or Watched(), stream=config)


def test_a_run_on_a_stream_has_the_files_of_any_run(place):
    out = place / "run"
    assert {p.name for p in out.iterdir()} - {".radhar"} == set(run_files.ALL)
    metrics = json.loads((out / run_files.METRICS).read_text())
    assert (metrics["data"]["train"], metrics["data"]["val"]) == (36, 6)
    assert metrics["classes"] == ["punching", "walking", "walking_to_falling"]
    assert metrics["map"] == "stft"
    assert "36 training and 6 validation images" in (out / run_files.SUMMARY).read_text()


def test_reading_by_workers_gives_the_same(place):
    streamed(place, "workers", workers=2)
    assert same_run(place / "run", place / "workers")


def test_resumed_after_an_epoch_gives_the_same_run(place):
    with pytest.raises(KeyboardInterrupt):
        streamed(place, "stopped", Watched(stop_after=1))
    progress = Watched()
    assert streamed(place, "stopped", progress).resumed == 1
    assert len(progress.best) == 2
    assert same_run(place / "run", place / "stopped")


def test_every_image_is_seen_once_and_none_that_is_held_back(place, built, monkeypatch):
    read: list[int] = []
    plain = SynthesisedPixels.read

    def noted(self, row):
        read.append(row)
        return plain(self, row)

    stream, validation = stream_and_validation(
        settings(map="stft"), load_config(place / "scenes.yaml"), [], {}, 0
    )
    monkeypatch.setattr(SynthesisedPixels, "read", noted)
    monkeypatch.setattr(training, "stream_and_validation", lambda *given: (stream, validation))
    streamed(place, "noted")
    assert sorted(read) == [*range(36)]
    assert same_run(place / "run", place / "noted")
    names = {f"{one.slug}/{index:05d}" for one, index in map(stream.order.__getitem__, read)}
    assert len(names) == 36
    with open_dataset(built) as data:
        slugs = [data.class_slugs[label] for label in data.label]
        held_back = {
            f"{slug}/{index:05d}"
            for slug, (_, index), split in zip(slugs, data.sample_key[:], data.split, strict=True)
            if split == 1
        }
    assert held_back == {*validation.names}
    assert not held_back & names


@pytest.mark.parametrize("kind", ["rgb", "gray"])
def test_streamed_images_are_those_of_the_built_data_set(place, built, tmp_path, kind):
    config = load_config(place / "scenes.yaml")
    stream, validation = stream_and_validation(settings(map="stft", input=kind), config, [], {}, 0)
    metadata = run.read_metadata(place / "run")
    config_of_run = {**metadata.config, "input": kind}
    metadata = metadata.model_copy(update={"input": kind, "config": config_of_run})
    there = open_for(metadata, built, "stft")
    row_of = {name: row for row, name in enumerate(there.names)}
    assert isinstance(validation.pixels, StoredPixels)
    assert {*validation.names} == {there.names[row] for row in there.rows("val")}
    for row, name in enumerate(validation.names):
        other = row_of[name]
        assert np.array_equal(validation.pixels.read(row), there.pixels.read(other))
        assert validation.classes[validation.label[row]] == there.classes[there.label[other]]
    larger = load_config(place / "scenes.yaml", ["samples_per_class=8"])
    build(larger, tmp_path / "larger", 1, Listener())
    there = open_for(metadata, tmp_path / "larger", "stft")
    row_of = {name: row for row, name in enumerate(there.names)}
    for row in range(6):
        one, index = stream.order[row]
        other = row_of[f"{one.slug}/{index:05d}"]
        assert np.array_equal(stream.pixels.read(row), there.pixels.read(other))
        assert validation.classes[stream[row]] == one.slug


def test_validation_on_a_data_set_gives_the_same_weights(place, built):
    progress = Watched()
    done = streamed(place, "given", progress, data=(built,))
    assert same(last_weights(place / "given"), last_weights(place / "run"))
    own = run.read_history(place / "run")
    assert [row.val_accuracy for row in done.history] == [row.val_accuracy for row in own]
    assert not any("person and motion" in line for line in progress.messages)


def test_refusing_other_data_names_the_run_on_a_stream(place, built):
    with pytest.raises(
        run.RunError, match=r'data: \["a stream, .*"\] there, \["/.*built", .* here'
    ):
        train(settings(map="stft"), built, place / "run", Watched())


def test_an_epoch_may_have_any_number_of_samples(place):
    progress = Watched()
    streamed(place, "short", progress, stream={"samples_per_epoch": 13}, epochs=2)
    assert progress.steps == [2, 2], "13 samples in batches of 6: a single one joins the last"


def test_validation_of_its_own_has_a_largest_number_a_class(place):
    config = load_config(place / "scenes.yaml", ["samples_per_class=30"])
    _, validation = stream_and_validation(
        settings(map="stft", stream={"validation_per_class": 4}), config, [], {}, 0
    )
    assert np.bincount(validation.label).tolist() == [4, 4, 4]


def test_another_config_is_another_run(place):
    with pytest.raises(run.RunError, match="data: "):
        streamed(place, "run", scenes=("snr_db=5",))


@pytest.mark.parametrize(
    ("scenes", "changes", "words"),
    [
        ((), {"map": "fsst"}, ["map", "'fsst'", "rtm, stft"]),
        (("activities=[walking]",), {}, ["activities", "'walking' alone"]),
        (("split={train: 1, validation: 0}",), {}, ["split.validation", "name a data set"]),
        ((), {"data_weights": [1.0]}, ["data_weights"]),
        (("motion.range_m=200", "on_invalid=error"), {}, ["half-band"]),
    ],
    ids=["map", "class", "validation", "weights", "scene"],
)
def test_what_cannot_be_streamed_is_refused_in_one_line(place, scenes, changes, words):
    with clear_line((ConfigError, SceneError), *words):
        streamed(place, "refused", scenes=scenes, **changes)


def test_data_that_does_not_fit_the_stream_is_refused_in_one_line(place, built):
    with pytest.raises(FolderError, match="32 x 32 px, those of the stream 64 x 64"):
        streamed(place, "refused", data=(built,), scenes=("image.size_px=64",))
    with pytest.raises(FolderError, match="shows rtm, the stream stft; --map"):
        streamed(place, "refused", data=(built,), scenes=("maps=[stft]",), map=None)
    with pytest.raises(FolderError, match="class 'punching' is unknown"):
        streamed(place, "refused", data=(built,), scenes=("activities=[walking, S12]",))


def test_train_command_on_a_stream(place):
    (place / "train.json").write_text(json.dumps(settings(map="stft").model_dump()))
    done = ok(
        *("train", "--stream", place / "scenes.yaml", "-o", place / "told"),
        *("--config", place / "train.json", "--set", "epochs=1"),
    )
    assert "reading 6 validation images; 12 samples an epoch are synthesised" in done.stderr
    assert "best epoch 1" in done.stdout
    done = radhar("train", "-o", place / "none")
    assert done.returncode == 2
    assert "DATA is missing" in done.stderr
