"""scene.h5 and scene.json: one simulated scene on disk."""

import json
from contextlib import suppress
from math import isfinite
from pathlib import Path
from typing import Any

import h5py

from radhar_cli import __version__
from radhar_cli.config.identity import as_yaml, resolved
from radhar_cli.config.motion_files import keep_used_files
from radhar_cli.echo.accuracy import error_as_stored
from radhar_cli.errors import UnfinishedError
from radhar_cli.files.new_hdf5 import new_hdf5
from radhar_cli.files.replacing import replacing, write_text
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.recorded.motion import FileMotion
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.scene.room import names_of_ways
from radhar_cli.scene.scene import scene_numbers
from radhar_cli.scene.single.board_file import write_frames
from radhar_cli.scene.single.simulate import Simulation
from radhar_cli.scene.single.single_precision import in_single
from radhar_cli.scene.single.truth import Truth

SCENE_FILE = "scene.h5"
SCENE_JSON = "scene.json"
SCENE_YAML = "scene.yaml"
MAPS, ANIMATION = "maps.png", "stickman.gif"
FRAMES, CLOUD, PAGE = "frames.png", "cloud.gif", "view.html"
DRAWN = (MAPS, ANIMATION, FRAMES, CLOUD, PAGE)
FILES = (SCENE_FILE, SCENE_JSON, SCENE_YAML, *DRAWN)


def write_scene(simulation: Simulation, path: Path) -> None:
    """Write a simulated scene to scene.h5 at a path."""
    with replacing(path) as unfinished, new_hdf5(unfinished, path) as (file, _):
        for name, power_map in simulation.maps.items():
            write_map(file, name, power_map)
        for name, signal in simulation.signals.items():
            file[f"slow_time/{name}"] = signal.x[0, 0]
        if simulation.board is not None:
            ways = names_of_ways(simulation.scene)
            write_frames(file, simulation.all_subframes, simulation.config.radar, ways)
        _write_truth(file, simulation)
        file.attrs["scene"] = json.dumps(describe(simulation))
        config = keep_used_files(simulation.config, simulation.activity.slug)
        file.attrs["config"] = json.dumps(resolved(config))
        file.attrs["radhar_version"] = __version__


def write_map(file: h5py.File, name: str, power_map: PowerMap) -> None:
    """Write a map to /maps/<name>, and its axes to /axes/<name>."""
    stored = in_single(power_map.shown)
    dataset = file.create_dataset(f"maps/{name}", data=stored, compression="gzip")
    for dimension, axis in enumerate((power_map.rows, power_map.columns)):
        scale = file.create_dataset(f"axes/{name}/{axis.name}", data=axis.values)
        scale.make_scale(f"{axis.name} ({axis.unit})")
        scale.attrs["unit"] = axis.unit
        dataset.dims[dimension].attach_scale(scale)
        dataset.dims[dimension].label = axis.name
    dataset.attrs["entropy_bits"] = power_map.entropy
    dataset.attrs["meaning"] = (
        f"power for unit transmit power, [{power_map.rows.name}, {power_map.columns.name}]"
    )


def _write_truth(file: h5py.File, simulation: Simulation) -> None:
    """Write the truth of everybody in a scene, and of its paths, to /truth."""
    _write_person(file.create_group("truth"), simulation.truth, simulation.motion)
    for person, motion, truth in simulation.others:
        group = file.create_group(f"truth/person_{person.number}")
        group.attrs["activity"] = person.activity.slug
        _write_person(group, truth, motion)
    if simulation.paths is not None:
        group = file.create_group("truth/paths")
        for name, values in simulation.paths._asdict().items():
            group[name] = values
        for name, unit in (("time", "s"), ("delay", "s"), ("amplitude", "sqrt of power")):
            group[name].attrs["unit"] = unit


def _write_person(group: h5py.Group, truth: Truth, motion: Motion) -> None:
    """Write the truth of one person to a group."""
    attributes_of: dict[str, dict[str, Any]] = {
        "time": {"unit": "s"},
        "positions": {"unit": "m", "axes": ["pulse", "joint", "x y z"]},
        "hip_joints": {"unit": "m", "axes": ["pulse", "right left", "x y z"]},
        "radial_velocity": {"unit": "m/s, positive receding"},
        "doppler": {"unit": "Hz, positive approaching, before aliasing"},
        "aspect": {"unit": "rad, from where the person faces to the radar, positive to the left"},
        "phase_label": {"meaning": list(truth.phases)},
    }
    for name, attributes in attributes_of.items():
        if (values := getattr(truth, name)) is not None:
            group[name] = values
            group[name].attrs.update(attributes)
    group.attrs["joints"] = list(motion.names)


def describe(simulation: Simulation) -> dict[str, Any]:
    """Describe a scene for scene.json: every parameter with its unit, warnings and entropies."""
    waveform, scene, kind = simulation.waveform, simulation.scene, simulation.config.engine.kind
    fallback = kind == "direct" and simulation.accuracy is None
    return {
        "activity": {"label": scene.activity.label, "slug": scene.activity.slug},
        "seed": scene.config.seed,
        **({"radar": name} if (name := scene.config.radar_name) is not None else {}),
        "people": [other.person.activity.slug for other in simulation.others],
        "motion_file": _motion_file(simulation.motion),
        "joint": simulation.joint,
        "engine": "cube (fallback)" if fallback else kind,
        "accuracy": _accuracy(simulation),
        "parameters": scene_numbers(scene),
        "derived": {
            "n_adc": waveform.n_adc,
            "n_pulses": waveform.n_pulses,
            "n_fft": waveform.n_fft,
            "doppler_carrier_hz": waveform.f0,
            "range_step_m": waveform.range_step,
            "half_band_range_m": waveform.half_band_range,
            "highest_speed_mps": waveform.highest_speed,
            "movement_onset_s": getattr(simulation.motion, "onset", None),
        },
        "warnings": simulation.warnings,
        "entropy_bits": {name: power_map.entropy for name, power_map in simulation.maps.items()},
    }


def _motion_file(motion: Motion) -> dict[str, Any] | None:
    """Describe which part of which file was the motion; None where a model made it."""
    if not isinstance(motion, FileMotion):
        return None
    cycle = motion.cycle
    return {
        "path": motion.clip.where,
        "start_s": motion.begin,  # second of the file at the start of the recording
        "begin_s": motion.begin if cycle is None else min(motion.begin, cycle.begin),
        "end_s": motion.end_used,
        "loops": cycle is not None,
        "up": motion.clip.up,
        "unit_m": motion.clip.unit,
        "rate_hz": motion.clip.rate,
        "lasts_s": motion.clip.seconds,
        "stature_m": motion.clip.stature,
    }


def _accuracy(simulation: Simulation) -> dict[str, Any] | None:
    """Describe how the direct engine made the signal, and its error; None for the exact engine.

    Cubes of a board are stored in single precision, whose rounding is part of their error.
    """
    accuracy = simulation.accuracy
    if accuracy is None:
        return None
    error_db = accuracy.error_db
    if simulation.board is not None and not accuracy.single:
        error_db = error_as_stored(error_db)
    return {
        "tolerance_db": simulation.config.engine.tolerance_db,
        "error_db": error_db if isfinite(error_db) else None,
        "kinematics_hz": simulation.waveform.prf / accuracy.step,
        "table_oversampling": accuracy.table_oversampling,
        "precision": "single" if accuracy.single else "double",
    }


def write_all(simulation: Simulation, folder: Path) -> list[Path]:
    """Write scene.h5, scene.json and scene.yaml into a folder; return their paths.

    Figures of an earlier scene are removed.

    Raises:
        UnfinishedError: the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_scene(simulation, folder / SCENE_FILE)
        write_text(folder / SCENE_JSON, json.dumps(describe(simulation), indent=2) + "\n")
        config = keep_used_files(simulation.config, simulation.activity.slug)
        command = f"radhar simulate {SCENE_YAML} -o OUT --index {simulation.scene.index}"
        head = f"# One scene, nothing left to draw: {command}\n"
        write_text(folder / SCENE_YAML, head + as_yaml(config))
        for drawn in DRAWN:  # of an earlier scene
            (folder / drawn).unlink(missing_ok=True)
    except OSError as error:
        raise UnfinishedError(
            f"{error.filename or folder}: {error.strerror or error}; nothing else was written"
        ) from None
    finally:
        with suppress(OSError):  # a folder that nothing came into
            folder.rmdir()
    return [folder / name for name in (SCENE_FILE, SCENE_JSON, SCENE_YAML)]
