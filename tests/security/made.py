"""A data set and a training run of ours, small, for others to be made from."""

from pathlib import Path

from learning.patterns import trained

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset.build import build

SET = """
seed: 5
samples_per_class: 3
activities: [punching, walking]
duration_s: 2.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
snr_db: {uniform: [10, 30]}
maps: [stft]
image: {size_px: 32}
split: {train: 0.67, validation: 0.33}
output: {png: false}
"""


def data_set(place: Path) -> Path:
    """Build six samples in two classes; return their folder. The config lies beside it."""
    (place / "set.yaml").write_text(SET)
    build(load_config(place / "set.yaml"), place / "set", 1, BarProgress())
    return place / "set"


def training_run(place: Path, data: Path) -> Path:
    """Train for two epochs on it; return the folder of the run."""
    trained(data, place / "run", epochs=2, model="smallnet")
    return place / "run"
