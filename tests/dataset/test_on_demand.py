"""A sample on demand is the one of the data set, bit for bit, and all of its fields."""

import pickle

import numpy as np
import pytest
from helpers.command_line import process
from helpers.listener import Listener
from helpers.small import SMALL, small_config

import radhar_cli as radhar
from radhar_cli.config import load_config
from radhar_cli.dataset import on_demand
from radhar_cli.dataset.build import build
from radhar_cli.dataset.on_demand import Recipe, sample
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.scene.products.table import plan_images

EVERYTHING = """
on_invalid: redraw
output: {png: false, power: float16, slow_time: true, column_labels: true}
"""
PERSONS = "\nsplit: {train: 0.5, validation: 0.5, by: subject, subjects: 2}\n"


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    text = SMALL.replace("split: {train: 0.67, validation: 0.33}", "") + EVERYTHING + PERSONS
    return load_config(small_config(tmp_path_factory.mktemp("config"), text))


@pytest.fixture(scope="module")
def built(config, tmp_path_factory):
    folder = tmp_path_factory.mktemp("built")
    build(config, folder, 1, Listener())
    return folder


def stored(data, row, name):
    """What dataset.h5 has in a row, by the name of the dataset."""
    if name.startswith("scene/"):
        return data.scene[name.removeprefix("scene/")][row]
    if name in data.large:
        return data.large[name][row]
    if name in data.small:
        return data.small[name][:][row]
    return {"label": data.label, "sample_key": data.sample_key}[name][row]


def test_every_field_of_every_sample_is_that_of_the_data_set(config, built):
    with open_dataset(built) as data:
        first = sample(config, data.class_slugs[data.label[0]], 0)
        names = [name for name in first if not name.startswith("largest_db/")]
        assert {"maps/rtm", "power/stft", "slow_time", "entropy/rtm", "scene/snr"} <= {*names}
        for row in range(len(data)):
            number, index = data.sample_key[row]
            made = sample(config, data.class_slugs[number], int(index))
            for name in names:
                there, here = stored(data, row, name), np.asarray(made[name])
                assert here.tobytes() == np.asarray(there, here.dtype).tobytes(), (row, name)
                if name in data.large:
                    assert made[name].dtype == there.dtype
                    assert made[name].flags.c_contiguous


def test_seed_and_index_name_a_sample_beyond_the_data_set_too(config):
    def levels(seed, index):
        made = sample(config, "walking", index, seed)
        return bytes(made["maps/stft"].tobytes())

    other = config.model_copy(update={"seed": 99, "samples_per_class": 5000})
    assert levels(99, 4000) == sample(other, "walking", 4000)["maps/stft"].tobytes()
    assert len({levels(None, 0), levels(99, 0), levels(None, 4000), levels(99, 4000)}) == 4


def test_samples_can_be_pickled(config):
    recipe = Recipe.of(config)
    activity = config.chosen_activities[1]
    first = recipe(activity, 2)["maps/stft"]
    again = pickle.loads(pickle.dumps(recipe))
    assert again == recipe
    assert np.array_equal(again(activity, 2)["maps/stft"], first)


def test_the_plan_is_made_once_for_one_config(config, monkeypatch):
    made = []

    def counted(config):
        made.append(config)
        return plan_images(config)

    monkeypatch.setattr(on_demand, "plan_images", counted)
    own = config.model_copy(update={"seed": 3})
    for index in range(3):
        sample(own, "walking", index)
    assert made == [own]


def test_mistakes_are_refused_in_one_line(config):
    for more, words in (
        ({"index": -1}, "index = -1: should be a whole number from 0 to 2"),
        ({"index": 1.5}, "index = 1.5: should be a whole number"),
        ({"index": 2**70}, "index = 1180591620717411303424: should be"),
        ({"seed": -1}, "seed = -1: should be a whole number"),
        ({"seed": 1.5}, "seed = 1.5: should be a whole number"),
        ({"seed": 2**64}, "seed = 18446744073709551616: should be"),
        ({"seed": [1]}, "seed = .1.: should be"),
        ({"activity": 7}, "activity = 7: should be a slug"),
        ({"config": "x.yaml"}, r"x\.yaml: no such file"),
        ({"config": 7}, "config = 7: should be the path of a YAML file, a name that"),
    ):
        with pytest.raises(ConfigError, match=words):
            sample(**{"config": config, "activity": "walking", **more})
    with pytest.raises(ConfigError, match="'wlking' is not an activity"):
        sample(config, "wlking")


def test_a_config_may_be_a_path(tmp_path):
    path = small_config(tmp_path)
    right = sample(load_config(path), "punching", 1)["maps/stft"]
    for given in (path, str(path)):
        assert np.array_equal(sample(given, "punching", 1)["maps/stft"], right)
        assert Recipe.of(given) == Recipe.of(load_config(path))


def test_numpy_integers_are_accepted(config):
    one = sample(config, "walking", np.int64(2), np.uint8(5))
    other = sample(config, "walking", 2, 5)
    assert one["scene/height"] == other["scene/height"]
    assert sample(config, "walking", 2**63 - 1)["sample_key"].dtype == np.int64


def test_scenes_outside_the_model_are_refused_or_drawn_again_as_in_a_build(config):
    def within(on_invalid):
        motion = config.motion.model_copy(update={"range_m": 200.0})
        return config.model_copy(update={"on_invalid": on_invalid, "motion": motion})

    with pytest.raises(SceneError, match="no scene inside the model"):
        sample(within("redraw"), "walking", 0)
    with pytest.raises(SceneError, match="on_invalid: error"):
        sample(within("error"), "walking", 0)


def test_it_needs_no_torch_and_the_package_stays_light():
    done = process(
        "-c",
        "import sys, radhar_cli as radhar\n"
        "assert not {'numpy', 'torch'} & set(sys.modules)\n"
        "radhar.sample(radhar.load_config('configs/smoke.yaml'), 'walking')\n"
        "print('torch' in sys.modules)\n",
    )
    assert done.stdout.strip() == "False", done.stderr
    assert radhar.sample is sample


def test_without_torch_samples_say_what_to_install():
    done = process(
        "-c",
        "import sys, radhar_cli as radhar\n"
        "sys.modules['torch'] = None\n"
        "try:\n"
        "    radhar.Samples\n"
        "except ImportError as error:\n"
        "    print(error)\n",
    )
    assert done.stdout.startswith("radhar.Samples needs PyTorch: "), done.stderr
    assert done.stdout.endswith(" torch safetensors scikit-learn\n")
