"""Recordings of radar makers' software: what they say themselves is read, the rest asked for."""

import json

import numpy as np
import pytest
from helpers.foreign_targets import profiles
from helpers.recorders import (
    INFINEON,
    STEP,
    write_acconeer,
    write_infineon,
    write_x4_baseband,
    write_x4_floats,
    x4_waves,
)

from radhar_cli.capture.content import Beat, RangeProfiles
from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.constants import SPEED_OF_LIGHT


def taken(tmp_path, name, *overrides, header=None):
    """(recording's info, samples of all pulses) of a capture."""
    info = import_capture([tmp_path / name], tmp_path / "out.h5", read_settings(header, overrides))
    with Recording(tmp_path / "out.h5") as recording:
        return info, recording.beat(0, info.pulses)


@pytest.mark.parametrize("polar", [False, True])
def test_baseband_of_an_x4_has_its_ranges_and_carrier(tmp_path, polar):
    name = f"xethru_baseband_{'ap' if polar else 'iq'}_20250501_150837.dat"
    write_x4_baseband(tmp_path / name, polar=polar)
    with pytest.raises(
        CaptureError, match="prf_hz, bandwidth_hz are missing; of 1 receiver, 182 samples"
    ):
        taken(tmp_path, name)
    info, x = taken(tmp_path, name, "prf_hz=256", "bandwidth_hz=1.5e9")
    assert isinstance(info.content, RangeProfiles)
    assert info.content.is_iq
    assert info.content.first_range_m == pytest.approx(0.3)
    assert info.content.range_step_m == pytest.approx(0.05144)
    assert info.carrier_hz == pytest.approx(7.29e9)
    np.testing.assert_allclose(x[0], profiles().T, atol=1e-5)


def test_floats_of_an_x4_are_waves_or_i_and_q(tmp_path):
    x = profiles()
    write_x4_floats(tmp_path / "xethru_datafloat_1.dat", np.concatenate([x.real, x.imag], axis=1))
    with pytest.raises(
        CaptureError, match=r"I and then Q \(axes=\[pulse,iq,sample\]\), or wrote waves"
    ):
        taken(tmp_path, "xethru_datafloat_1.dat")
    iq, waves = "axes=[pulse,iq,sample]", "axes=[pulse,sample]"
    with pytest.raises(
        CaptureError, match="carrier_hz, prf_hz, bandwidth_hz, first_range_m are missing"
    ):
        taken(tmp_path, "xethru_datafloat_1.dat", iq)
    keys = ["carrier_hz=7.29e9", "prf_hz=256", "first_range_m=0.3", "bandwidth_hz=1.5e9"]
    info, values = taken(tmp_path, "xethru_datafloat_1.dat", iq, *keys)
    assert (info.content.is_iq, info.content.range_step_m) == (True, pytest.approx(8 * STEP))
    np.testing.assert_allclose(values[0], x.T, rtol=1e-6)
    write_x4_floats(tmp_path / "xethru_datafloat_2.dat", x4_waves())
    info, values = taken(tmp_path, "xethru_datafloat_2.dat", waves, *keys)
    assert (info.content.is_iq, info.content.range_step_m) == (False, pytest.approx(STEP))
    assert info.content.are_waves
    np.testing.assert_allclose(values[0], x4_waves().T, rtol=1e-6)


def test_recordings_of_an_x4_that_change_or_end_early(tmp_path):
    path = tmp_path / "xethru_baseband_iq_1.dat"
    write_x4_baseband(path)
    path.write_bytes(path.read_bytes()[:-100])
    info, _ = taken(tmp_path, path.name, "prf_hz=256", "bandwidth_hz=1.5e9")
    assert info.pulses == 639
    words = np.fromfile(path, "<u4")
    words[6 + 2 * 182 + 1] = 90
    words.tofile(path)
    with pytest.raises(CaptureError, match="profiles differ in their length"):
        taken(tmp_path, path.name, "prf_hz=256", "bandwidth_hz=1.5e9")


@pytest.mark.parametrize("root", ["session", "sessions/session_0"])
def test_frames_of_acconeer_need_no_keys(tmp_path, root):
    write_acconeer(tmp_path / "a121.h5", root=root)
    info, x = taken(tmp_path, "a121.h5")
    assert (info.pulses, info.segments, info.prf_hz) == (320, 20, 1000)
    assert info.content.first_range_m == pytest.approx(0.5)
    assert info.content.range_step_m == pytest.approx(0.06)
    assert x.shape == (1, 40, 320)
    strongest = 0.5 + 0.06 * np.abs(x[0]).argmax(axis=0)
    times = np.arange(20)[:, None] / 20 + np.arange(16) / 1000
    np.testing.assert_allclose(strongest, (1.2 - 0.5 * times).ravel(), atol=0.031)


@pytest.mark.parametrize("profile", [3, "PROFILE_3", "Profile.PROFILE_3", "profile 3", "3"])
def test_a_profile_of_acconeer_has_the_width_of_its_pulse(tmp_path, profile):
    write_acconeer(tmp_path / "a121.h5", profile=profile)
    info, _ = taken(tmp_path, "a121.h5")
    assert info.content.bandwidth_hz == pytest.approx(
        SPEED_OF_LIGHT / (2 * 0.14)
    )  # 0.14 m of profile 3


@pytest.mark.parametrize("profile", [None, "PROFILE_7", "wide", True])
def test_an_unknown_profile_is_asked_for(tmp_path, profile):
    write_acconeer(tmp_path / "a121.h5", profile=profile)
    with pytest.raises(CaptureError, match=r"bandwidth_hz is missing.*--set bandwidth_hz="):
        taken(tmp_path, "a121.h5")


def test_of_several_subsweeps_one_is_read(tmp_path):
    write_acconeer(tmp_path / "a121.h5", halves=True)
    with pytest.raises(CaptureError) as error:
        taken(tmp_path, "a121.h5")
    assert "is an acconeer recording of 2 subsweeps" in str(error.value)
    assert "0: 20 points every 60 mm from 0.5 m; 1: 9 points every 120 mm from 1.1 m" in str(
        error.value
    )
    assert "--set subsweep=N" in str(error.value)
    write_acconeer(tmp_path / "whole.h5")
    _, whole = taken(tmp_path, "whole.h5")
    for number, points, step_m, width_m in (
        (0, slice(0, 20), 0.06, 0.14),
        (1, slice(10, 28, 2), 0.12, 0.32),
    ):
        info, x = taken(tmp_path, "a121.h5", f"subsweep={number}")
        np.testing.assert_array_equal(x, whole[:, points])
        assert info.content.range_step_m == pytest.approx(step_m)
        assert info.content.first_range_m == pytest.approx(0.5 if number == 0 else 1.1)
        assert info.content.bandwidth_hz == pytest.approx(SPEED_OF_LIGHT / (2 * width_m))
    with pytest.raises(CaptureError, match="from 0 to 1"):
        taken(tmp_path, "a121.h5", "subsweep=2")
    with pytest.raises(
        CaptureError, match=r"of 1 subsweep \(0: .*; --set subsweep=N should be 0 or"
    ):
        taken(tmp_path, "whole.h5", "subsweep=2")


def test_of_several_sensors_of_acconeer_one_is_asked_for(tmp_path):
    write_acconeer(tmp_path / "a121.h5", sensors=2)
    with pytest.raises(
        CaptureError, match=r"of 2 sensors.*entry_0/result/frame, .*entry_1/result/"
    ):
        taken(tmp_path, "a121.h5")
    info, x = taken(tmp_path, "a121.h5", "dataset=session/group_0/entry_1/result/frame")
    assert info.content.first_range_m == pytest.approx(0.5)
    assert (info.segments, x.shape) == (20, (1, 40, 320))


def test_range_profiles_without_a_bandwidth_are_asked_for_it(tmp_path):
    """Their step is none: waves of a pulse are sampled many times finer than it resolves."""
    np.save(tmp_path / "rf.npy", np.sin(np.arange(600.0 * 256)).reshape(600, 256))
    keys = ("carrier_hz=7.29e9", "prf_hz=100", "axes=[pulse,sample]", "first_range_m=0.3")
    with pytest.raises(CaptureError) as error:
        taken(tmp_path, "rf.npy", *keys, "range_step_m=0.0064")
    assert "bandwidth_hz is missing" in str(error.value)
    assert "--set bandwidth_hz=" in str(error.value)
    info, _ = taken(tmp_path, "rf.npy", *keys, "range_step_m=0.0064", "bandwidth_hz=1.4e9")
    assert info.content.are_waves


def test_a_sweep_a_frame_of_acconeer_is_slow_time_without_gaps(tmp_path):
    write_acconeer(tmp_path / "a121.h5", sweeps=1, frames=60)
    info, x = taken(tmp_path, "a121.h5")
    assert (info.pulses, info.segments, info.prf_hz, x.shape) == (60, 1, 20, (1, 40, 60))


def test_infineon_s_json_is_a_header(tmp_path):
    write_infineon(tmp_path)
    info, x = taken(tmp_path, "radar.npy", header=tmp_path / "config.json")
    assert isinstance(info.content, Beat)
    assert (info.pulses, info.segments, info.receivers) == (320, 10, 3)
    content = info.content
    assert (content.carrier_hz, content.bandwidth_hz) == (60e9, pytest.approx(1e9))
    spectrum = np.abs(np.fft.rfft(x[0].real - x[0].real.mean(axis=0), axis=0)).mean(axis=1)
    assert spectrum.argmax() * 3e8 / 2e9 == pytest.approx(2.5, abs=0.3)  # m, in the mean


def test_json_that_lacks_keys_says_all_at_once(tmp_path):
    write_infineon(tmp_path)
    document = json.loads(json.dumps(INFINEON))
    shape = document["device_config"]["fmcw_single_shape"]
    del shape["num_chirps_per_frame"], shape["frame_repetition_time_s"]
    (tmp_path / "config.json").write_text(json.dumps(document))
    with pytest.raises(
        CaptureError, match=r"num_chirps_per_frame or num_chirps, frame_rep.* above"
    ):
        read_settings(tmp_path / "config.json", [])
