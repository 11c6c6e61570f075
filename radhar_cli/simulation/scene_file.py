"""scene.h5 and scene.json: one simulated scene on disk."""

import json
from math import isfinite
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from radhar_cli import __version__
from radhar_cli.body.skeleton import JOINTS
from radhar_cli.config.identity import resolved
from radhar_cli.errors import UnfinishedError
from radhar_cli.simulation.simulate import PowerMap, Simulation
from radhar_cli.simulation.truth import MOVEMENTS

SCENE_FILE = "scene.h5"
SCENE_JSON = "scene.json"


def write_scene(simulation: Simulation, path: Path) -> None:
    """Write scene.h5 under another name, then rename it into place."""
    unfinished = path.with_suffix(".unfinished")
    try:
        with h5py.File(unfinished, "w") as file:
            for power_map in simulation.maps.values():
                _write_map(file, power_map)
            for name, signal in simulation.slow_time.items():
                file[f"slow_time/{name}"] = signal
            _write_truth(file, simulation)
            if simulation.beat is not None:
                file.create_dataset("echo/beat", data=simulation.beat, compression="gzip")
                file["echo/beat"].attrs["axes"] = ["fast-time sample", "pulse"]
            file.attrs["scene"] = json.dumps(describe(simulation))
            file.attrs["config"] = json.dumps(resolved(simulation.config))
            file.attrs["radhar_version"] = __version__
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def _write_map(file: h5py.File, power_map: PowerMap) -> None:
    dataset = file.create_dataset(
        f"maps/{power_map.name}", data=_float32(power_map.power), compression="gzip"
    )
    vertical, unit = ("range", "m") if power_map.is_range else ("frequency", "Hz")
    axes = ((vertical, power_map.vertical, unit), ("time", power_map.time, "s"))
    for dimension, (name, values, unit) in enumerate(axes):
        scale = file.create_dataset(f"axes/{power_map.name}/{name}", data=values)
        scale.make_scale(f"{name} ({unit})")
        scale.attrs["unit"] = unit
        dataset.dims[dimension].attach_scale(scale)
        dataset.dims[dimension].label = name
    dataset.attrs["entropy_bits"] = power_map.entropy
    dataset.attrs["meaning"] = "power for unit transmit power, [frequency or range, time]"


def _float32(power: np.ndarray[Any, Any]) -> np.ndarray[Any, np.dtype[np.float32]]:
    limits = np.finfo(np.float32)
    single: np.ndarray[Any, np.dtype[np.float32]] = np.clip(power, 0, limits.max).astype(np.float32)
    return single


def _write_truth(file: h5py.File, simulation: Simulation) -> None:
    truth = simulation.truth
    file["truth/time"] = truth.time
    file["truth/time"].attrs["unit"] = "s"
    file["truth/positions"] = truth.positions
    file["truth/positions"].attrs["unit"] = "m"
    file["truth/positions"].attrs["axes"] = ["pulse", "joint", "x y z"]
    file["truth/radial_velocity"] = truth.radial_velocity
    file["truth/radial_velocity"].attrs["unit"] = "m/s, positive receding"
    file["truth/doppler"] = truth.doppler
    file["truth/doppler"].attrs["unit"] = "Hz, positive approaching, before aliasing"
    file["truth/phase_label"] = truth.phase_label
    file["truth/phase_label"].attrs["meaning"] = list(MOVEMENTS)
    file["truth"].attrs["joints"] = list(JOINTS)


def describe(simulation: Simulation) -> dict[str, Any]:
    """Every parameter with its unit, warnings, entropies and times, as plain values."""
    waveform, scene = simulation.waveform, simulation.scene
    return {
        "activity": {"label": scene.activity.label, "slug": scene.activity.slug},
        "seed": scene.seed,
        "joint": simulation.joint,
        "engine": _engine(simulation),
        "accuracy": _accuracy(simulation),
        "parameters": dict(scene.values),
        "derived": {
            "n_adc": waveform.n_adc,
            "n_pulses": waveform.n_pulses,
            "n_fft": waveform.n_fft,
            "doppler_carrier_hz": waveform.f0,
            "range_step_m": waveform.range_step,
            "half_band_range_m": waveform.half_band_range,
            "highest_speed_mps": waveform.highest_speed,
        },
        "warnings": simulation.warnings,
        "entropy_bits": {name: one.entropy for name, one in simulation.maps.items()},
        "seconds": simulation.seconds,
    }


def _engine(simulation: Simulation) -> str:
    kind = simulation.config.engine.kind
    return "cube (fallback)" if kind == "direct" and simulation.accuracy is None else kind


def _accuracy(simulation: Simulation) -> dict[str, Any] | None:
    """Settings of the direct engine and its measured error; null of a scene without motion."""
    accuracy = simulation.accuracy
    if accuracy is None:
        return None
    return {
        "tolerance_db": simulation.config.engine.tolerance_db,
        "error_db": accuracy.error_db if isfinite(accuracy.error_db) else None,
        "kinematics_hz": simulation.waveform.prf / accuracy.step,
        "table_oversampling": accuracy.table_oversampling,
        "precision": "single" if accuracy.single else "double",
    }


def write_all(simulation: Simulation, folder: Path) -> list[Path]:
    """Write scene.h5 and scene.json into a folder; return their paths.

    Raises:
        UnfinishedError: the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_scene(simulation, folder / SCENE_FILE)
        (folder / SCENE_JSON).write_text(json.dumps(describe(simulation), indent=2) + "\n")
    except OSError as error:
        raise UnfinishedError(
            f"{error.filename or folder}: {error.strerror or error}; nothing else was written"
        ) from None
    return [folder / SCENE_FILE, folder / SCENE_JSON]
