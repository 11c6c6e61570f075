"""Configs of measured sets beside their recordings: what is simulated lies where the measured is.

The recordings are not part of the project. Their ranges are numbers here: of MMRGait's walkers
those of docs/results/walkers.md with some room, of the others computed once by the same statistics.
"""

import sys
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import radhar

from radhar_cli.config import load_config
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.study.two_sample.map_statistics import mask_statistics

ROOT = Path(__file__).parents[3]
CONFIGS = ROOT / "configs" / "measured"
sys.path.insert(0, str(ROOT / "scripts" / "studies"))

WALKERS = 6
# 5 to 95 % of the measured masks of a class: 144, 144, 143, 143 and 98 of them, walking within its
# first 5 s, as `mask_statistics` has them with the line at zero within 24 Hz.
GLASGOW = {
    "walking": {
        "occupied": (1.8, 6.1),
        "receding": (45.3, 98.0),
        "width": (49.4, 197.9),
        "upper_envelope": (25.5, 111.2),
        "lower_envelope": (-123.5, -52.9),
        "active": (3.4, 5.0),
        "zero_line": (92.2, 100),
    },
    "sitting_down": {
        "occupied": (0.2, 1.4),
        "receding": (67.5, 98.1),
        "width": (28.6, 111.7),
        "upper_envelope": (21.6, 49.0),
        "lower_envelope": (-76.5, -33.3),
        "active": (1.0, 2.9),
        "zero_line": (95.7, 100),
    },
    "standing_up": {
        "occupied": (0.2, 1.3),
        "receding": (4.9, 44.6),
        "width": (63.1, 112.8),
        "upper_envelope": (33.7, 72.9),
        "lower_envelope": (-50.4, -25.5),
        "active": (0.9, 2.8),
        "zero_line": (96.1, 100),
    },
    "grabbing": {
        "occupied": (0.3, 1.8),
        "receding": (31.4, 68.0),
        "width": (66.7, 129.4),
        "upper_envelope": (33.3, 64.7),
        "lower_envelope": (-72.0, -29.5),
        "active": (1.1, 3.6),
        "zero_line": (98.9, 100),
    },
    "falling": {
        "occupied": (0.9, 2.8),
        "receding": (1.9, 30.5),
        "width": (73.7, 208.4),
        "upper_envelope": (64.7, 160.6),
        "lower_envelope": (-81.5, -25.5),
        "active": (1.4, 3.5),
        "zero_line": (59.8, 100),
    },
}
# Of points 0.7 to 2.9 m away without the room's, in 4 s: standard deviation of heights (m), 99 % of
# speeds (m/s, in steps of 0.6) and share that moves (%), least and most with a third to spare.
RADHAR = {
    "boxing": ((0.14, 0.32), (1.2, 4.1)),
    "jack": ((0.17, 0.36), (1.2, 2.5)),
    "jump": ((0.12, 0.27), (0.4, 0.9), (3, 13)),
    "squats": ((0.14, 0.31), (0, 0.9)),
    "walk": ((0.12, 0.33), (0.4, 1.7), (19, 100)),
}
LINE_HZ, BAND_HZ, SECONDS, MASKS = 24.0, 500.0, 5.0, 12


@pytest.mark.slow
def test_walkers_of_mmrgait_are_where_the_measured_are() -> None:
    """Each of them: a walker who stands for a while is far out in the ripple of the torso."""
    from compare_measured import BANDS, simulated, statistics

    config = load_config(CONFIGS / "mmrgait_77GHz.yaml")
    found = [statistics(simulated(config, seed)) for seed in range(1, WALKERS + 1)]
    for name, (low, high) in BANDS.items():
        values = [one[name] for one in found]
        assert low <= np.mean(values) <= high, name
        if name == "torso ripple, m/s":
            assert low <= min(values) <= max(values) <= high


def test_masks_of_glasgow_are_where_the_measured_are(tmp_path: Path) -> None:
    """The median of each class lies between 5 and 95 % of the measured."""
    settings = f"activities=[{', '.join(GLASGOW)}]", f"samples_per_class={MASKS}"
    sets = [word for one in settings for word in ("--set", one)]
    path, out = CONFIGS / "glasgow_5p8GHz.yaml", tmp_path / "masks"
    done = radhar("generate", path, "-o", out, "--jobs", 1, *sets)
    assert done.returncode == 0, done.stderr
    found: dict[str, list[dict[str, float]]] = {slug: [] for slug in GLASGOW}
    with open_dataset(out) as data:
        doppler = np.linspace(BAND_HZ, -BAND_HZ, data.maps["stft"].shape[1])
        for mask, label in zip(data.maps["stft"][:], data.label[:], strict=True):
            numbers = mask_statistics(mask > 0, doppler, SECONDS, LINE_HZ)
            found[data.classes[label]].append(numbers)
    for slug, ranges in GLASGOW.items():
        assert len(found[slug]) == MASKS
        for name, (low, high) in ranges.items():
            median = np.nanmedian([one[name] for one in found[slug]])
            assert low <= median <= high, (slug, name, median)


@pytest.mark.slow
def test_clouds_of_radhar_are_where_the_measured_are(tmp_path: Path) -> None:
    """Heights and speeds of all, and how much of a walker and a jumper moves.

    Points a frame and where people walk are others than measured (docs/results/transfer.md).
    """
    out = tmp_path / "clouds"
    path, sets = CONFIGS / "radhar_1443.yaml", ("--set", "samples_per_class=2")
    done = radhar("generate", path, "-o", out, "--jobs", 1, *sets)
    assert done.returncode == 0, done.stderr
    found: dict[str, list[tuple[float, float, float]]] = {slug: [] for slug in RADHAR}
    with open_dataset(out) as data:
        for row, label in enumerate(data.label[:]):
            count = data.products["points_start"][row][-1]
            points = np.asarray(data.products["points"][row], float)[:count]
            distance = np.linalg.norm(points[:, :3], axis=1)
            body = (distance > 0.7) & (distance < 2.9) & (np.abs(points[:, 2]) < 0.9)
            speed, height = np.abs(points[body, 3]), points[body, 2]
            numbers = height.std(), np.percentile(speed, 99), 100 * np.mean(speed > 0.3)
            found[data.classes[label]].append(tuple(map(float, numbers)))
    for slug, ranges in RADHAR.items():
        for number, (low, high) in enumerate(ranges):
            mean = np.mean([one[number] for one in found[slug]])
            assert low <= mean <= high, (slug, number, mean)
