"""Each config runs through every command, or is refused in a line by the first that reads it.

Options of every section are crossed pairwise. Where a row is refused, the option whose key the
refusal names is put back to its default, until the rest runs: no refusal hides other pairs.
"""

import copy
import json
import re
from itertools import combinations, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from helpers import boards
from helpers.command_line import Done, radhar
from helpers.covering import combinations_of, covering_rows
from helpers.random_configs import KEYS
from helpers.recorded import frames, write_bvh
from helpers.slow import slow, slow_but

from radhar_cli.config import load_config
from radhar_cli.errors import ConfigError

Document = dict[str, Any]

FMCW = {"carrier_hz": 5.8e9, "bandwidth_hz": 2e8, "prf_hz": 200, "adc_rate_hz": 5e5}
BAND = {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 200}
BASE: Document = {
    "seed": 5,
    "samples_per_class": 1,
    "duration_s": 0.4,
    "on_invalid": "keep",
    "image": {"size_px": 24},
    "split": {"train": 1.0, "validation": 0.0},
}
CFG = boards.CFG.replace("1 80 2499", "1 32 2499").replace(
    "frameCfg 0 2 32 0 100", "frameCfg 0 2 16 0 200"
)
BOARD = {"cfg": CFG, "device": "IWR1443BOOST"}
ARRAY = {"tx": [[0, 0], [2, 1], [4, 0]], "rx": [[0, 0], [1, 0], [2, 0], [3, 0]]}
FACES = {"floor": "concrete", "left": {"eps_r": 4}, "back": "metal"}
STANDING = {"range_m": 2.5}

# {factor: {option: what it says}}; the first option of each is what is put back.
FACTORS: dict[str, dict[str, Document]] = {
    "radar": {
        "fmcw": {"radar": FMCW},
        "beam": {"radar": {**FMCW, "beam": {"pan_deg": 10}, "residual_video_phase": True}},
        "padded": {
            "radar": {**FMCW, "polarisation": "horizontal"},
            "processing": {
                "range_fft_length": 64,
                "range_reference": "start",
                "range_window": "rectangular",
            },
        },
        "sfcw": {"radar": {**BAND, "waveform": "sfcw", "steps": 20, "dwell_s": 2e-6}},
        "cw": {"radar": {"carrier_hz": 24e9, "prf_hz": 400, "waveform": "cw"}},
        "cw real": {
            "radar": {"carrier_hz": 24e9, "prf_hz": 400, "waveform": "cw", "output": "real"}
        },
        "impulse": {
            "radar": {**BAND, "waveform": "impulse", "profile_m": [0.2, 6], "profile_samples": 500},
            "processing": {"range_sum": "gated"},
        },
        "impulse iq": {
            "radar": {
                **{**BAND, "waveform": "impulse", "output": "iq"},
                **{"profile_m": [0.2, 6], "profile_samples": 100},
            },
        },
        "board": {"radar": BOARD},
        "array": {"radar": {"cfg": CFG, "array": ARRAY, "yaw_deg": 5}},
    },
    "maps": {
        "stft": {"maps": ["stft"]},
        "rtm": {"maps": ["rtm"]},
        "fsst": {"maps": ["fsst", "fsst_denoised"]},
        "compensated": {"maps": ["stft_compensated", "stft_compensated_denoised"]},
        "frames": {"maps": ["stft", "range_doppler", "range_azimuth"]},
        "points": {"maps": ["points"], "cloud": {"chain": "board"}},
    },
    "sum": {
        "coherent": {},
        "gated": {"processing": {"range_sum": "gated"}},
        "fixed gate": {"processing": {"range_sum": "gated", "gate_m": [1, 4]}},
        "magnitudes": {"processing": {"range_sum": "gated", "gate_sum": "magnitude"}},
    },
    "clutter": {
        "default": {},
        "mean": {"processing": {"clutter": "mean"}},
        "high-pass": {"processing": {"clutter": "highpass"}},
        "none": {"processing": {"clutter": "none"}},
    },
    "windows": {
        "default": {},
        "one column": {"processing": {"window_s": 0.395}},
        "short": {"processing": {"window_s": 0.04, "overlap_fraction": 0.0}},
        "long filter": {"processing": {"savgol": {"order": 3, "frame": 61}}},
        "padded": {"processing": {"stft_fft_length": 128, "fsst_hop_pulses": 1}},
    },
    "engine": {
        "direct": {},
        "cube": {"engine": {"kind": "cube"}},
        "in chirp": {"engine": {"kind": "cube", "motion_in_chirp": True}},
        "fallback": {"engine": {"tolerance_db": -300, "fallback": "cube"}},
    },
    "motion": {
        "human": {"activities": ["punching"], "motion": STANDING},
        "twelve": {"activities": ["walking", "grabbing"], "motion": {"range_m": 4}},
        "paper": {"activities": ["S4"], "motion": {"model": "paper", **STANDING}},
        "sequence": {
            "classes": {"grab": {"sequence": ["squatting"], "pauses_s": [0.1]}},
            "activities": ["grab", "grabbing"],
            "motion": STANDING,
        },
        "nobody": {
            "activities": ["nobody", "walking"],
            "motion": STANDING,
        },
        "files": {
            "classes": {"seat": ["walk.bvh"]},
            "activities": ["seat", "sitting_down"],
            "motion": STANDING,
        },
    },
    "body": {
        "points": {},
        "segments": {"body": {"scatterers": "segments", "points_per_segment": 4}},
        "surfaces": {"body": {"scatterers": "surfaces"}},
    },
    "people": {
        "alone": {},
        "another": {"people": [{"motion": {"range_m": 4, "cross_range_m": 1.2}}]},
        "perhaps": {
            "people": [
                {
                    "activity": {"choice": ["walking", "kicking"]},
                    "share": 0.5,
                    "motion": {"range_m": 3.5, "cross_range_m": -1.2},
                }
            ]
        },
    },
    "room": {
        "empty": {},
        "reflectors": {"room": {"reflectors": [{}, {"residual_m": 0.001}]}},
        "back wall": {"room": {"back_wall_m": 12}},
        "floor": {"room": {"faces": {"floor": "wood"}, "order": 2}},
        "faces": {"room": {"faces": FACES, "box_m": {"x": [-1, 9], "y": [-4, 4]}}},
    },
    "wall": {
        "none": {},
        "slab": {"wall": {}},
        "opaque": {"wall": {"loss_tangent": 10}, "snr_reference": "received"},
        "refracted": {"wall": {"rays": "refracted", "fresnel": "parallel"}},
        "layers": {
            "wall": {
                "echoes": "exact",
                "layers": [{"material": "plasterboard"}, {"eps_r": 3, "loss_tangent": 0.01}],
            }
        },
    },
    "noise": {
        "default": {},
        "none": {"snr_db": None},
        "drawn": {"snr_db": {"uniform": [0, 20]}},
        "thermal": {"snr_db": None, "receiver": {"noise_figure_db": 10}},
        "interference": {
            "receiver": {"noise_corner_hz": 20, "tones": [{"doppler_hz": 50, "off_s": 0.2}]}
        },
    },
    "image": {
        "decibels": {},
        "masks": {
            "image": {"kind": "cfar", "cfar": {"guard": [1, 1], "training": [4, 4]}},
        },
        "signed": {"image": {"kind": "signed"}},
        "limits": {"image": {"doppler_limits_mps": [-2, 3], "range_limits_m": [0.5, 3]}},
        "colours": {"image": {"colour_map": "jet", "size_px": [16, 32]}},
    },
    "output": {
        "images": {},
        "power": {"output": {"power": "float16", "png": False}},
        "slow time": {"output": {"slow_time": True}},
        "labels": {"output": {"column_labels": True}, "samples_per_class": 2},
        "signal": {"output": {"products": ["signal"], "hdf5_level": 0}},
        "no array": {"output": {"products": ["echo"]}},
        "persons": {"split": {"by": "subject", "subjects": 2}, "samples_per_class": 2},
    },
    "command": {"simulate": {}, "generate": {}, "raw": {}, "dry run": {}},
}
NAMES = list(FACTORS)
OPTIONS = [list(options) for options in FACTORS.values()]
SIZES = [len(options) for options in OPTIONS]
NAMES_A_KEY = re.compile("|".join(sorted(map(re.escape, KEYS), key=len, reverse=True)))
PARTS = 4


def merged(*documents: Document) -> Document:
    """Documents laid over each other, section by section."""
    found: Document = {}
    for document in documents:
        for key, value in document.items():
            inner = found.get(key)
            both = isinstance(value, dict) and isinstance(inner, dict)
            found[key] = merged(inner, value) if both and key != "classes" else copy.deepcopy(value)
    return found


def document_of(row: dict[str, str]) -> Document:
    return merged(BASE, *(FACTORS[name][option] for name, option in row.items()))


def keys_of(document: Document, prefix: str = "") -> list[str]:
    """Dotted keys of what a document says."""
    found = list[str]()
    for key, value in document.items():
        found.append(prefix + key)
        if isinstance(value, dict):
            found += keys_of(value, f"{prefix}{key}.")
    return found


def put_back(row: dict[str, str], keys: list[str]) -> bool:
    """Put the option that says one of these keys, or is about it, back to its default.

    The last factor that does is put back; False where none does.
    """
    for key in keys:
        for name in reversed(NAMES):
            said, first = keys_of(FACTORS[name][row[name]]), next(iter(FACTORS[name]))
            about = any(f"{one}.".startswith(f"{key}.") for one in said) or key in said
            if about and row[name] != first:
                row[name] = first
                return True
    return False


def assert_refused(done: Done, where: str) -> list[str]:
    """That a command was refused in lines that name keys; the keys."""
    assert done.returncode == 2, f"{where}: status {done.returncode}\n{done.stdout}{done.stderr}"
    said = [one for one in done.stderr.splitlines() if not one.startswith("warning: ")]
    assert said, where
    assert "Traceback" not in done.stderr, f"{where}\n{done.stderr}"
    found = [key for one in said for key in NAMES_A_KEY.findall(one)]
    assert all(one.startswith("radhar: ") for one in said), f"{where}: {said}"
    assert found, f"{where}: {said} names no key"
    return found


def refusal(path: Path, where: str) -> list[str] | None:
    """Keys of what is wrong with a config; None where it is accepted."""
    try:
        load_config(path)
    except ConfigError as error:
        lines = str(error).splitlines()
        found = [re.match(r"^\S*c\.yaml\S*: ([\w.]+) = .+: .+", line) for line in lines]
        assert all(found), f"{where}: {lines}"
        named = [one[1] for one in found if one]
        return named + [key for line in lines for key in NAMES_A_KEY.findall(line)]
    return None


def run_command(name: str, path: Path, slug: str, folder: Path) -> list[Done]:
    """What the commands said, up to the first that did not end well."""
    out, scene, maps = (folder / name for name in ("set", "scene", "maps"))
    steps = {
        "dry run": [("generate", path, "-o", out, "--jobs", 1, "--dry-run")],
        "generate": [("generate", path, "-o", out, "--jobs", 1), ("verify", out)],
        "simulate": [("simulate", path, "-a", slug, "-o", scene, "--no-figures")],
        "raw": [
            ("simulate", path, "-a", slug, "-o", scene, "--no-figures", "--raw"),
            ("process", scene / "recording.h5", "--config", path, "-o", maps, "--no-figures"),
        ],
    }[name]
    said = list[Done]()
    for step in steps:
        said.append(radhar(*step))
        if said[-1].returncode:
            break
    return said


def cross(row: dict[str, str], folder: Path) -> str:
    """Run a row, put back where it is refused; what became of it: its command, or "refused"."""
    asked, path = dict(row), folder / "c.yaml"
    for _ in NAMES:
        document, where = document_of(row), json.dumps(row)
        path.write_text(yaml.safe_dump(document))
        keys = refusal(path, where)
        if keys is None:
            break
        if not put_back(row, keys):
            assert row["radar"] != "fmcw", f"{where}: {keys} cannot be put back; asked: {asked}"
            row["radar"] = "fmcw"
    else:
        raise AssertionError(f"{asked}: cannot be made to run")
    said = run_command(row["command"], path, document["activities"][0], folder)
    if said[-1].returncode:
        assert_refused(said[-1], f"{row['command']} of {where}")
        return "refused"
    return row["command"]


def named(levels: tuple[int, ...]) -> dict[str, str]:
    return {
        name: OPTIONS[n][level] for n, (name, level) in enumerate(zip(NAMES, levels, strict=True))
    }


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a motion file."""
    write_bvh(tmp_path / "walk.bvh", frames("walking", 2.0))
    return tmp_path


def run_all(rows: list[dict[str, str]], folder: Path) -> dict[str, int]:
    """How many rows ended how; files of a row are removed after it."""
    import shutil

    found: dict[str, int] = {}
    for row in rows:
        ended = cross(row, folder)
        found[ended] = found.get(ended, 0) + 1
        for name in ("set", "scene", "maps"):
            shutil.rmtree(folder / name, ignore_errors=True)
    return found


PAIRS = covering_rows(SIZES)


def test_rows_hold_all_pairs() -> None:
    every = {
        ((one, other), levels)
        for one, other in combinations(range(len(SIZES)), 2)
        for levels in product(range(SIZES[one]), range(SIZES[other]))
    }
    assert {pair for row in PAIRS for pair in combinations_of(row, 2)} == every
    assert len(PAIRS) < 2 * SIZES[0] * sorted(SIZES)[-2]


@pytest.mark.parametrize("part", slow_but(range(PARTS), (0, 2)))
def test_every_pair_of_options_runs_or_is_refused_in_a_line(part: int, folder: Path) -> None:
    rows = [named(levels) for levels in PAIRS[part::PARTS]]
    ended = run_all(rows, folder)
    print(ended)
    assert ended.get("refused", 0) <= len(rows) / 2


RANDOM_PARTS, RANDOM_ROWS = 8, 40


@pytest.mark.parametrize("part", slow(range(RANDOM_PARTS)))
def test_random_options_run_or_are_refused_in_a_line(part: int, folder: Path) -> None:
    rng = np.random.default_rng([20261126, part])
    levels = [tuple(int(rng.integers(size)) for size in SIZES) for _ in range(RANDOM_ROWS)]
    run_all([named(one) for one in levels], folder)
