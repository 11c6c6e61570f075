"""What was simulated is read off its recordings."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from command_line import radhar

from radhar_cli.capture.fitting import fit
from radhar_cli.capture.importing import write_simulated
from radhar_cli.capture.recording import Label
from radhar_cli.config import load_config
from radhar_cli.errors import CaptureError
from radhar_cli.simulation.simulate import simulate

CONFIG = """
duration_s: 4
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 1000, adc_rate_hz: 2.5e6}
motion: {range_m: {uniform: [2, 3]}, angle_deg: 0}
engine: {kind: cube}
"""


def recorded(folder: Path, snr_db: float, activity: str = "walking", seed: int = 1) -> Path:
    (folder / "c.yaml").write_text(CONFIG)
    config = load_config(folder / "c.yaml", [f"snr_db={snr_db}"])
    scene = simulate(config, activity, seed, maps=("stft",), raw=True)
    assert scene.beat is not None
    path = folder / f"{activity}{seed}{snr_db:g}.h5"
    write_simulated(path, scene.beat, scene.waveform, Label(label=activity))
    return path


@pytest.mark.parametrize("snr_db", [20.0, 5.0, -5.0])
def test_snr_and_range_are_recovered(tmp_path: Path, snr_db: float) -> None:
    found = fit([recorded(tmp_path, snr_db)])
    assert found.document["snr_db"] == pytest.approx(snr_db, abs=1.0)
    assert abs(found.slope_db) < 1, "white noise has no colour"
    low, high = found.document["motion"]["range_m"]["uniform"]
    assert 1.5 < low < 4
    assert low + 2 < high < 9


def test_the_fitted_config_can_be_simulated(tmp_path: Path) -> None:
    paths = [recorded(tmp_path, snr, seed=n) for n, snr in enumerate((5.0, 10.0, 15.0))]
    done = radhar("fit", *paths, "-o", tmp_path / "fit.yaml")
    assert done.returncode == 0, done.stderr
    document = yaml.safe_load((tmp_path / "fit.yaml").read_text())
    middle, spread = document["snr_db"]["normal"]
    assert middle == pytest.approx(10, abs=1)
    assert spread == pytest.approx(np.std([5, 10, 15]), abs=1)
    config = load_config(tmp_path / "fit.yaml")
    assert config.radar.carrier_hz == 24e9
    assert config.radar.chirp_s == pytest.approx(40e-6)
    assert (tmp_path / "fit.png").stat().st_size > 10_000


def test_recordings_of_two_radars_are_refused(tmp_path: Path) -> None:
    one = recorded(tmp_path, 10)
    (tmp_path / "other").mkdir()
    config = load_config(tmp_path / "c.yaml", ["radar.prf_hz=500"])
    scene = simulate(config, "walking", 1, maps=("stft",), raw=True)
    assert scene.beat is not None
    write_simulated(tmp_path / "o.h5", scene.beat, scene.waveform, Label(label="walking"))
    with pytest.raises(CaptureError, match="another radar"):
        fit([one, tmp_path / "o.h5"])
