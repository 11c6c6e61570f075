"""Columns of /scene have names of their own, for every kind of radar and every class."""

from pathlib import Path
from typing import Any

import h5py
import pytest
import yaml
from helpers.command_line import ok

from radhar_cli.config import load_config
from radhar_cli.dataset.scene_fields import TAKEN, fields
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.movements.catalogue import MOVEMENTS

LAW = {"uniform": [0.3, 0.5]}
RADARS = {
    "fmcw": {"beam": {"azimuth_deg": 60, "pan_deg": {"uniform": [-5, 5]}}},
    "sfcw": {"waveform": "sfcw", "prf_hz": 100, "steps": 64, "dwell_s": 2e-5},
    "cw": {"waveform": "cw", "prf_hz": 2000, "tx_m": [LAW, -0.1, 1.5]},
    "impulse": {
        **{"waveform": "impulse", "output": "iq", "carrier_hz": 7e9, "prf_hz": 256},
        **{"bandwidth_hz": 1.5e9, "profile_m": [0.3, 12]},
    },
    "board": {"device": "IWR1843BOOST", "cfg": "iwr1843boost", "yaw_deg": {"uniform": [-5, 5]}},
    "frames": {
        **{"frame": {"chirps": 32}, "carrier_hz": 60e9, "bandwidth_hz": 1e9, "prf_hz": 2000},
        "array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [2, 0]]},
    },
}
SCENES = {
    "alone": {},
    "people": {"people": [{"activity": "grabbing"}, {"activity": "walking", "share": 0.5}]},
    "room": {
        "room": {
            "box_m": {"x": [-3, 12], "y": [-9, 9], "height": {"uniform": [2.6, 3]}},
            "faces": {"floor": "concrete", "left": {"eps_r": LAW | {"uniform": [3, 5]}}},
            "reflectors": [{"position_m": [5, {"uniform": [1, 2]}, 1]}, {}],
        },
    },
    "tones": {"receiver": {"tones": [{"doppler_hz": {"uniform": [10, 20]}}]}},
    "wall": {"wall": {"eps_r": {"uniform": [3, 5]}, "size_m": [{"uniform": [0.1, 0.2]}, 6, 4]}},
    "subjects": {"split": {"by": "subject", "subjects": 4, "train": 0.5, "validation": 0.5}},
    "one_of_several": {"radar_name": "a", "other_radars": {"b": {"waveform": "cw"}}},
}
CLASSES = [*dict.fromkeys([*(one.slug for one in ACTIVITIES), *MOVEMENTS, "nobody"])]


def write_config(folder: Path, radar: str, scene: str, **more: Any) -> Path:
    path = folder / "one.yaml"
    document = {"radar": RADARS[radar], "maps": ["stft"], **SCENES[scene], **more}
    path.write_text(yaml.safe_dump(document))
    return path


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("radar", RADARS)
def test_no_name_is_that_of_another_column(radar, scene, tmp_path):
    if radar in ("board", "frames") and scene in ("wall", "tones"):
        pytest.skip("radars with arrays have neither")
    alone = [[one] for one in CLASSES] if (radar, scene) == ("sfcw", "alone") else []
    for classes in (CLASSES, *alone):
        path = write_config(tmp_path, radar, scene, activities=classes)
        names = [field.name for field in fields(load_config(path))]
        assert len(names) == len({*names})
        assert not TAKEN & {*names}
        assert not [name for name in names if "/" in name]


@pytest.mark.parametrize("radar", RADARS)
def test_a_data_set_of_it_is_built(radar, tmp_path):
    """With a movement whose keys end as those of the radar do, and with somebody else."""
    sizes = {"samples_per_class": 1, "duration_s": 1, "image": {"size_px": 16}}
    path = write_config(tmp_path, radar, "people", activities=["grabbing", "nobody"], **sizes)
    ok("generate", path, "-o", tmp_path / "set", "--jobs", 1)
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        assert {field.name for field in fields(load_config(path))} == {*file["scene"]}
