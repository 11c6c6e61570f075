"""Recordings as the software of radar makers writes them, of point targets in profiles or beats."""

import json

import h5py
import numpy as np
from helpers.foreign_targets import C, profiles

STEP = C / (2 * 23.328e9)


def write_x4_baseband(path, x=None, polar=False):
    """Write XeThru's `xethru_baseband_iq`, or `_ap` with amplitude and phase."""
    x = profiles() if x is None else x
    head = np.dtype([("n", "<u4"), ("bins", "<u4"), ("numbers", "<f4", 4)])
    records = np.zeros(len(x), [("head", head), ("values", "<f4", (2, x.shape[1]))])
    records["head"]["n"], records["head"]["bins"] = np.arange(len(x)), x.shape[1]
    records["head"]["numbers"] = 0.05144, 23.328e9, 7.29e9, 0.3
    parts = (np.abs(x), np.angle(x)) if polar else (x.real, x.imag)
    records["values"] = np.stack(parts, axis=1)
    records.tofile(path)


def write_x4_floats(path, values):
    """Write XeThru's `xethru_datafloat` of floats [pulse, number]."""
    records = np.zeros(len(values), [("head", "<u4", 3), ("values", "<f4", values.shape[1])])
    records["head"][:, 1], records["head"][:, 2] = np.arange(len(values)), values.shape[1]
    records["values"] = values
    records.tofile(path)


def x4_waves(bins=1024, pulses=64):
    """Profiles of an X4 without down-conversion [pulse, bin], of one at 2 m, from 0.4 m on."""
    r = 0.4 + STEP * np.arange(bins) - 2.0
    wave = np.exp(-(r**2) / 0.01) * np.cos(4 * np.pi * 7.29e9 / C * r)
    noise = np.random.default_rng(0).standard_normal((pulses, bins))
    return (wave + 0.001 * noise).astype("f4")


def write_acconeer(path, sweeps=16, frames=20, root="session", profile=3, sensors=1, halves=False):
    """Write a recording of acconeer's Exploration Tool: one who comes from 1.2 m at 0.5 m/s.

    Of two halves the second subsweep has a profile 5 and steps of twice the length.
    """
    subsweeps = [
        {"start_point": 200, "step_length": 24, "num_points": 40, "profile": profile, "hwaas": 8}
    ]
    steps = 24 * np.arange(40)
    if halves:
        subsweeps[0]["num_points"] = 20
        subsweeps += [{**subsweeps[0], "start_point": 440, "step_length": 48, "num_points": 9,
                       "profile": "PROFILE_5"}]  # fmt: skip
        steps = np.concatenate([steps[:20], 240 + 48 * np.arange(9)])
    sensor = {
        "subsweeps": subsweeps,
        "sweeps_per_frame": sweeps, "sweep_rate": 1000.0 if sweeps > 1 else None,
        "frame_rate": 20.0, "continuous_sweep_mode": False,
    }  # fmt: skip
    ranges = 0.0025 * (200 + steps)
    times = np.arange(frames)[:, None] / 20 + np.arange(sweeps) / 1000
    r = 1.2 - 0.5 * times[..., None]
    x = 3000 * np.exp(-((ranges - r) ** 2) / 0.01 - 4j * np.pi * 60.5e9 / C * r)
    values = np.zeros(x.shape, [("real", "<i2"), ("imag", "<i2")])
    values["real"], values["imag"] = np.round(x.real), np.round(x.imag)
    with h5py.File(path, "w") as file:
        for entry in (f"{root}/group_0/entry_{n}" for n in range(sensors)):
            file[f"{entry}/result/frame"] = values
            file[f"{entry}/result/tick"] = np.arange(frames) * 50000
            file[f"{entry}/result/temperature"] = np.full(frames, 25, "<i2")
            file[f"{entry}/metadata"] = json.dumps(
                {"base_step_length_m": 0.0025, "max_sweep_rate": 2000.0, "tick_period": 50}
            )
        file[f"{root}/session_config"] = json.dumps(
            {"groups": [{str(n + 1): sensor for n in range(sensors)}], "update_rate": None}
        )
        file["server_info"] = json.dumps({"ticks_per_second": 1000000})


INFINEON = {
    "device_config": {
        "fmcw_single_shape": {
            "rx_antennas": [1, 2, 3], "tx_antennas": [1], "mimo_mode": "off",
            "start_frequency_Hz": 60e9, "end_frequency_Hz": 61e9, "num_chirps_per_frame": 32,
            "num_samples_per_chirp": 64, "chirp_repetition_time_s": 0.0005,
            "frame_repetition_time_s": 0.1, "sample_rate_Hz": 2000000,
        }
    }
}  # fmt: skip


def write_infineon(folder):
    """Write `radar.npy` [frame, receiver, chirp, sample] and `config.json` of Infineon's SDK."""
    (folder / "config.json").write_text(json.dumps(INFINEON))
    t = np.arange(10)[:, None, None] * 0.1 + np.arange(32)[:, None] * 0.0005
    r, n = 3.0 - 1.0 * t, np.arange(64) / 2e6
    phase = 4 * np.pi / C * r * (60e9 + 1e9 / (64 / 2e6) * n)
    beat = 0.5 + 0.2 * np.cos(phase)
    np.save(folder / "radar.npy", np.stack([beat] * 3, axis=1).astype("f4"))
