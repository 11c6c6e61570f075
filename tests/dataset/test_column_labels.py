"""Labels by column: what is done at the time that a column of an image shows."""

import shutil
from itertools import pairwise

import h5py
import numpy as np
import pytest
from helpers.listener import Listener
from helpers.small import fingerprint, small_config

from radhar_cli.config import Config, load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.column_labels import label_columns, label_names
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.verify import verify
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.motion.phases import PHASES
from radhar_cli.motion.protocol import ScattererSubset
from radhar_cli.processing.power_map import MapImage
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.simulate import simulate

TEXT = """
seed: 5
samples_per_class: {per_activity: {default: 3, walking: 1, coming_home: 2}}
classes: {coming_home: {sequence: [walking, sitting_down], durations_s: [1.5, null]}}
activities: [coming_home, walking, S12]
duration_s: 6
motion: {range_m: {per_activity: {default: 8, coming_home: 5}}, angle_deg: {uniform: [170, 190]}}
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
maps: [rtm, stft]
image: {size_px: [16, 40]}
split: {train: 0.5, validation: 0.5}
output: {column_labels: true, png: false}
"""


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    return load_config(small_config(tmp_path_factory.mktemp("labels"), TEXT))


@pytest.fixture(scope="module")
def whole(config, tmp_path_factory):
    folder = tmp_path_factory.mktemp("labels") / "set"
    build(config, folder, 1, Listener())
    return folder


def test_labels_are_those_of_the_truth_at_the_middle_of_each_column(config, whole):
    with h5py.File(whole / "dataset.h5") as file:
        keys = file["sample_key"][:].tolist()
        assert keys == [[0, 0], [0, 1], [1, 0], [2, 0], [2, 1], [2, 2]]
        for row, (label, index) in enumerate(keys):
            truth = simulate(config, config.every_class[label], index=index, maps=("stft",)).truth
            for name in ("rtm", "stft"):
                stored = file[f"column_label/{name}"]
                left, right = file[f"extent/{name}"][row, :2]
                edges = np.linspace(left, right, 41)
                pulses = np.searchsorted(truth.time, (edges[:-1] + edges[1:]) / 2) - 1
                names = [truth.phases[number] for number in truth.phase_label[pulses]]
                assert [stored.attrs["names"][number] for number in stored[row]] == names
        home = file["column_label/stft"][1].tolist()
        done = [PHASES[a] for a, b in pairwise([*home, -1]) if a != b]
        assert done == ["walking", "sitting down", "seated"]


def test_column_labels_do_not_depend_on_batches_and_are_optional(config, whole, tmp_path):
    build(config, tmp_path / "set", 1, Listener(), batch_size=1)
    assert fingerprint(tmp_path / "set") == fingerprint(whole)
    plain = load_config(small_config(tmp_path, TEXT), ["output.column_labels=false"])
    build(plain, tmp_path / "plain", 1, Listener())
    with open_dataset(whole) as labelled, open_dataset(tmp_path / "plain") as other:
        assert set(labelled.column_label) == {"rtm", "stft"}
        assert other.column_label == {}
    with h5py.File(tmp_path / "plain/dataset.h5") as file:
        assert "column_label" not in file


def test_verify_finds_a_changed_label(whole, tmp_path):
    assert verify(whole, 6).problems == []
    shutil.copytree(whole, tmp_path / "set")
    with h5py.File(tmp_path / "set/dataset.h5", "r+") as file:
        file["column_label/rtm"][1] = np.where(file["column_label/rtm"][1] == 3, 2, 3)
    assert any("40 wrong columns" in problem for problem in verify(tmp_path / "set", 6).problems)


@pytest.mark.parametrize("model", ["paper", "human"])
def test_every_phase_of_the_twelve_has_a_number(model):
    config = Config(motion={"model": model})
    for activity in ACTIVITIES:
        phases = motion_of(nominal_scene(config, activity).people[0]).phases
        assert phases[0][0] == -np.inf, "something is under way from the first instant on"
        assert {name for _, name in phases} <= set(PHASES), activity.slug


def test_every_phase_of_a_sequence_has_a_number():
    names = [name for name in MOVEMENTS if name != NOBODY]
    classes = {name: {"sequence": [name], "durations_s": [2.0]} for name in names}
    own = {f"own_{name}": one for name, one in classes.items()}
    config = Config(classes=own, activities=list(own))
    for activity in config.chosen_activities:
        phases = motion_of(nominal_scene(config, activity).people[0]).phases
        assert {name for _, name in phases} <= set(PHASES), activity.slug


def test_a_motion_without_phases_is_labelled_with_its_class(config):
    class Silent(ScattererSubset):
        phases = ()

    scene = nominal_scene(config, config.chosen_activities[0])
    image = MapImage(np.zeros((4, 6), np.uint8), 0.0, (0.0, 1.0, 0.0, 1.0))
    names = label_names(config)
    found = label_columns(scene, Silent(motion_of(scene.people[0]), (0,)), image, names)
    assert [names[number] for number in found] == ["coming_home"] * 6
