"""`output: {power, slow_time}`: what images lose, in dataset.h5 by the contract of the images."""

import hashlib

import h5py
import numpy as np
import pytest
from helpers.small import SMALL, edited, fingerprint, small_config

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset import verify as verification
from radhar_cli.dataset.build import build
from radhar_cli.dataset.estimate import estimate
from radhar_cli.dataset.layout import row_bytes
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import FolderError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.products.images import level_scale_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene

WITH_SIGNALS = SMALL + "output: {png: false, power: float16, slow_time: true}\n"
HALF_DB = 0.03  # half a step of float16 between 64 and 128 dB, and more


def config_of(folder, text=WITH_SIGNALS):
    return load_config(small_config(folder, text))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    place = tmp_path_factory.mktemp("signals")
    build(config_of(place), place / "set", 1, BarProgress())
    return place / "set"


def test_stored_signals_are_verified_and_do_not_depend_on_batches_or_workers(whole, tmp_path):
    report = verify(whole, 100)
    assert report.problems == []
    assert report.resynthesised == 9
    build(config_of(tmp_path), tmp_path / "set", 2, BarProgress(), batch_size=2)
    assert fingerprint(whole)["dataset.h5"] == fingerprint(tmp_path / "set")["dataset.h5"]


def test_power_is_that_of_the_map_without_clipping(whole):
    """Levels follow from it; with the largest power it is the map in absolute decibels."""
    with open_dataset(whole) as data, h5py.File(whole / "dataset.h5") as file:
        for name in data.config.maps:
            power = file[f"power/{name}"]
            assert (power.dtype, power.shape) == (np.float16, (9, 48, 48))
            assert power.chunks == (1, 48, 48)
            decibels = power[:].astype(float)
            assert (decibels.max(axis=(1, 2)) == 0).all()
            cells = 10 ** (decibels / 10)
            scale = level_scale_of(data.config)
            white_db = [10 * np.log10(scale.white(image)) for image in cells]
            level = 255 * np.clip((decibels - np.array(white_db)[:, None, None]) / 50 + 1, 0, 1)
            assert np.abs(level - data.maps[name][:]).max() <= 0.5 + 255 / 50 * 2 * HALF_DB
        assert file["power/stft"][:].min() < -55  # the image stops at 50 dB
        config, row = data.config, 4
        scene = draw_scene(config, data_activity(file, row), int(file["sample_key"][row, 1]))
        largest = 10 * np.log10(record(scene, ["stft"])["stft"].power.max())
        # Resizing takes a mean over some cells, which is below the largest of them.
        assert -6 < file["largest_db/stft"][row] - largest <= 1e-3


def data_activity(file, row):
    return activity_named(file.attrs["class_slugs"][file["sample_key"][row, 0]])


def test_the_signal_is_that_of_the_scene(whole):
    with open_dataset(whole) as data, h5py.File(whole / "dataset.h5") as file:
        stored = file["slow_time"]
        assert (stored.dtype, stored.shape) == (np.complex64, (9, 1999))
        assert stored.chunks == (1, 1999)
        for row in (0, 5):
            key = file["sample_key"][row]
            scene = draw_scene(data.config, data_activity(file, row), int(key[1]))
            right = record(scene, ["signal"])["signal"].x[0, 0]
            assert np.linalg.norm(stored[row] - right) <= 1e-7 * np.linalg.norm(right)


def test_masks_of_decibels_have_the_power_of_the_map_beside_them(tmp_path):
    masks = "{size_px: 48, kind: cfar, cfar: {guard: [1, 1], training: [5, 5]}}"
    text = WITH_SIGNALS.replace("{size_px: 48}", masks)
    for name, chosen in (("plain", WITH_SIGNALS), ("masks", text)):
        build(config_of(tmp_path, chosen), tmp_path / name, 1, BarProgress())
    with (
        h5py.File(tmp_path / "plain/dataset.h5") as a,
        h5py.File(tmp_path / "masks/dataset.h5") as b,
    ):
        assert np.array_equal(a["power/stft"], b["power/stft"])
        assert np.array_equal(a["largest_db/rtm"], b["largest_db/rtm"])
        assert set(np.unique(b["maps/stft"])) == {0, 255}


def test_shorter_recordings_end_in_nan(tmp_path):
    text = WITH_SIGNALS.replace("duration_s: 4.0", "duration_s: {choice: [2.0, 4.0]}")
    build(config_of(tmp_path, text), tmp_path / "set", 1, BarProgress())
    assert verify(tmp_path / "set", 100).problems == []
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        seconds, signals = file["scene/duration"][:], file["slow_time"][:]
    assert set(seconds) == {2.0, 4.0}
    for duration, x in zip(seconds, signals, strict=True):
        assert np.array_equal(np.isnan(x), np.arange(1999) >= duration * 500 - 1)


def _power(file):
    file["power/rtm"][2, 3, 4] -= np.float16(1)


def _signal(file):
    file["slow_time"][7, 100] *= -1


def _signal_and_checksum(file):
    signal = file["slow_time"][4]
    signal[100] *= -1
    file["slow_time"][4] = signal
    file["sha256/slow_time"][4] = hashlib.sha256(signal.tobytes()).hexdigest()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_power, "/power/rtm[2]: does not match"),
        (_signal, "/slow_time[7]: does not match"),
        (_signal_and_checksum, "/slow_time[4] (walking/1): differs"),
    ],
)
def test_changed_signals_are_found(change, words, whole, tmp_path):
    copy = tmp_path / "dataset.h5"
    with edited(whole / "dataset.h5", copy) as file:
        change(file)
    assert any(words in problem for problem in verify(copy, 9).problems)


def test_other_versions_may_round_differently(whole, tmp_path, monkeypatch):
    """A last bit of every sample is no problem under another version; a wrong one still is."""
    copy = tmp_path / "dataset.h5"
    with edited(whole / "dataset.h5", copy) as file:
        for name in ("slow_time", "power/stft"):
            values = file[name][:] * np.float16(1 + 2e-7 if name == "slow_time" else 1)
            if name == "power/stft":
                values = np.nextafter(values, np.float16(-np.inf))
            file[name][:] = values
            sums = [hashlib.sha256(one.tobytes()).hexdigest() for one in values]
            file[f"sha256/{name.removeprefix('maps/')}"][:] = np.array(sums, "S64")
    assert verify(copy, 9).problems
    there = verification.versions() | {"numpy": "1.0"}
    monkeypatch.setattr(verification, "versions", lambda: there)
    assert verify(copy, 9).problems == []
    with h5py.File(copy, "r+") as file:
        _signal_and_checksum(file)
    assert verify(copy, 9).problems != []


def test_the_estimate_counts_stored_signals(tmp_path):
    with_signals, plain = config_of(tmp_path), config_of(tmp_path, SMALL)
    more = estimate(with_signals, 1).hdf5_bytes - estimate(plain, 1).hdf5_bytes
    raw = row_bytes(with_signals) - row_bytes(plain)
    assert raw == 3 * 2 * 48 * 48 + 8 * 1999
    assert 0.5 * 9 * raw < more < 2 * 9 * raw


def test_their_keys_are_part_of_the_identity(whole, tmp_path):
    with pytest.raises(FolderError, match=r"output\.slow_time"):
        build(config_of(tmp_path, SMALL), whole, 1, BarProgress())
