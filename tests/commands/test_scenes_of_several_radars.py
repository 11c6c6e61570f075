"""Data sets of several radars in every kind of scene: built, verified, the same in all of them."""

import json

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.slow import slow

from radhar_cli.dataset.radar_folders import folders_of_radars

SMALL = "seed: 4\nimage: {size_px: 16}\nduration_s: 1.2\nactivities: [walking, %s]\n"
TWO = """
radar: {carrier_hz: 10e9, prf_hz: 500}
radars:
  side: {aspect: {angle_deg: 90, distance_m: 4, about_m: [3, 0]}, maps: [rtm, stft]}
  front: {}
"""
ONE_SIDE = """
radar: {carrier_hz: 2e9, bandwidth_hz: 1e9, prf_hz: 500}
radars:
  high: {}
  low: {tx_m: [0.4, -0.1, 0.8], rx_m: [0.4, 0.1, 0.8]}
"""
FIVE = """
radars:
  board: {cfg: iwr1843boost, device: IWR1843BOOST, maps: [range_doppler, points, stft]}
  frames: {frame: {chirps: 32}, carrier_hz: 60e9, bandwidth_hz: 1e9, prf_hz: 2000}
  uwb:
    {waveform: impulse, output: iq, carrier_hz: 7e9, bandwidth_hz: 1.5e9, prf_hz: 256,
     profile_m: [0.3, 12], maps: [rtm]}
  cw: {waveform: cw, carrier_hz: 24e9, prf_hz: 1000}
  stepped:
    {waveform: sfcw, carrier_hz: 2e9, prf_hz: 200, bandwidth_hz: 1e9, steps: 64, dwell_s: 2e-5}
"""
SCENES = {
    "people": SMALL % "grabbing" + "samples_per_class: 2\npeople: [{activity: walking}]\n" + TWO,
    "stream": SMALL % "grabbing" + "stream: {count: 2}\n" + TWO,
    "nobody": SMALL % "nobody" + "samples_per_class: 2\n" + TWO,
    "five": SMALL % "nobody" + "samples_per_class: 1\n" + FIVE,
    "wall": SMALL % "grabbing"
    + "samples_per_class: 1\nwall: {eps_r: 4, loss_tangent: 0.01, size_m: [0.2, 6, 4]}\n"
    + ONE_SIDE,
    "room": SMALL % "grabbing"
    + "samples_per_class: 1\nroom: {reflectors: [{position_m: [5, 2, 1], rcs_dbsm: -5}, {}],\n"
    + "  faces: {floor: concrete}}\n"
    + ONE_SIDE,
    "subjects": SMALL % "grabbing"
    + "samples_per_class: 4\nsplit: {by: subject, subjects: 4, train: 0.5, validation: 0.5}\n"
    + TWO,
}
FAST = "stream", "nobody"


@pytest.mark.parametrize("scene", [*FAST, *slow((one,) for one in SCENES if one not in FAST)])
def test_all_radars_have_one_scene_and_label_and_verify(scene, tmp_path):
    path, out = tmp_path / "several.yaml", tmp_path / "out"
    path.write_text(SCENES[scene])
    ok("generate", path, "-o", out, "--jobs", 1)
    done = ok("verify", out, "--samples", 1, "--json")
    assert len(json.loads(done.stdout)["radars"]) == len(folders_of_radars(out))
    first, *others = (h5py.File(one / "dataset.h5") for one in folders_of_radars(out).values())
    names = {name for name in ("label", "labels", "split", "segments") if name in first}
    names |= {f"scene/{name}" for name in first["scene"] if "height" in name or "range" in name}
    assert len(names) > 2
    for other in others:
        for name in names:
            assert np.array_equal(first[name][:], other[name][:], equal_nan=True), name


@pytest.mark.slow
def test_a_network_learns_to_count_of_one_of_the_radars(tmp_path):
    path, out = tmp_path / "several.yaml", tmp_path / "out"
    path.write_text(SCENES["nobody"].replace("_class: 2", "_class: 5"))
    ok("generate", path, "-o", out, "--jobs", 1)
    train = ("train", "--target", "count", "--set", "epochs=1")
    ok(*train, out / "side", "-o", tmp_path / "run")
    ok("eval", tmp_path / "run", out / "side")
    done = radhar("eval", tmp_path / "run", out, "-o", tmp_path / "report")
    assert done.returncode == 2
    assert f"give {out / 'front'}, {out / 'side'}" in done.stderr
