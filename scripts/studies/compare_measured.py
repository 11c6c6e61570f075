"""Compare measured Doppler-time maps of walkers with simulated ones: a table and a figure.

    python scripts/studies/compare_measured.py MAPS.npz -o OUT

MAPS.npz holds maps `view_*` [rows, columns] in dB, row 0 the fastest approach, zero Doppler in row
128, 0.047 m/s a row, 2.5 s long: four views of a walker of the data set MMRGait, as published with
JoeyBGOfficial/Low-Cost-Accurate-Radar-Based-Human-Motion-Direction-Determination. They are compared
with walkers of a config (the measured radar's by default) as segments, as points, and with the
paper's motion. Writes OUT/comparison.md, .json and .png; the second table says how many of the
simulated walkers lie outside the bands that measured ones lie in.
"""

import argparse
import json
from pathlib import Path
from typing import NamedTuple

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.scene.single.simulate import simulate
from radhar_cli.study.two_sample.map_statistics import DopplerMap, power_statistics

ROOT = Path(__file__).resolve().parents[2]
CONFIG = ROOT / "configs" / "measured" / "mmrgait_77GHz.yaml"
ZERO_ROW, ROW_MPS, SECONDS = 128, 12 / 256, 2.5
NOISE_MPS, ZERO_MPS, NEAR_MPS = 5.2, 0.15, 0.15
SHOWN_MPS = (-3.0, 6.0)
KINDS = {
    "human, segments": [],
    "human, points": ["body.scatterers=points"],
    "paper": ["motion.model=paper", "body.scatterers=points", "motion.walking.speed_mps=1.1"],
}
# Where the statistics of measured walkers lie, with some room.
BANDS = {
    "sd of the noise, dB": (0.7, 1.3),
    "limb below torso, dB": (8.0, np.inf),
    "energy above 1.8 x torso, %": (0.5, 3.0),
    "receding energy, %": (-np.inf, 2.0),
    "energy near the torso line, %": (55.0, 80.0),
    "occupied cells, %": (35.0, 60.0),
    "torso ripple, m/s": (0.25, 0.7),
}

Float = NDArray[np.float64]


class Map(NamedTuple):
    """Power [rows, columns] over speed and time.

    Approaching speeds [rows] (m/s) descend; times [columns] are in s.
    """

    power: Float
    speed: Float
    time: Float


def measured(path: Path) -> dict[str, Map]:
    """The views of an npz."""
    with np.load(path) as file:
        views = {name: file[name].astype(float) for name in sorted(file) if name[:5] == "view_"}
    return {
        name: Map(
            10 ** (view / 10),
            (ZERO_ROW - np.arange(view.shape[0])) * ROW_MPS,
            np.linspace(0, SECONDS, view.shape[1]),
        )
        for name, view in views.items()
    }


def simulated(config: Config, seed: int) -> Map:
    """The STFT of a walker."""
    numbers = simulate(config, "walking", seed, maps=("stft",))
    one = numbers.maps["stft"]
    speed = one.rows.values * SPEED_OF_LIGHT / (2 * numbers.waveform.f0)
    shown = speed > -ZERO_ROW / 2 * ROW_MPS  # as much as is measured
    return Map(one.power[shown][::-1], speed[shown][::-1], one.columns.values)


def statistics(one: Map) -> dict[str, float]:
    """What a radar engineer looks at in the map of a walker, in the units of the names."""
    v, power = one.speed, DopplerMap(one.power, one.speed)
    numbers = power_statistics(power, ZERO_MPS, NOISE_MPS, NEAR_MPS)
    occupied, band = power.signal_mask(NOISE_MPS), (v >= 0.2) & (v <= 4.5)
    envelope = v[np.argmax(occupied & (v < NOISE_MPS)[:, None], axis=0)]
    return {
        "peak over floor, dB": numbers["peak_over_floor"],
        "sd of the noise, dB": numbers["noise_sd"],
        "limb below torso, dB": numbers["limb_below_torso"],
        "energy above 1.8 x torso, %": numbers["fast_energy"],
        "receding energy, %": numbers["receding_energy"],
        "envelope (95 %) over torso": float(np.percentile(envelope, 95) / numbers["torso_median"]),
        "envelope, median, m/s": float(np.median(envelope)),
        "energy near the torso line, %": numbers["torso_energy"],
        "occupied cells, %": 100 * float(occupied[band].mean()),
        "torso ripple, m/s": numbers["torso_ripple"],
    }


def spread(rows: list[dict[str, float]]) -> dict[str, tuple[float, float, float]]:
    """{statistic: mean, least, most}."""
    return {
        name: (
            float(np.mean(values)),
            min(values),
            max(values),
        )
        for name in rows[0]
        for values in [[row[name] for row in rows if np.isfinite(row[name])]]
    }


def table(columns: dict[str, dict[str, tuple[float, float, float]]]) -> str:
    """Markdown: mean (least..most) of every statistic."""
    lines = [
        "| mean (least..most) | " + " | ".join(columns) + " |",
        "|---" * (len(columns) + 1) + "|",
    ]
    for name in next(iter(columns.values())):
        cells = ["{:.3g} ({:.3g}..{:.3g})".format(*column[name]) for column in columns.values()]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def outside(columns: dict[str, list[dict[str, float]]]) -> str:
    """Markdown: mean, standard deviation and how many are outside the band, of every statistic."""
    lines = ["| mean, sd, outside | band | " + " | ".join(columns) + " |"]
    lines.append("|---" * (len(columns) + 2) + "|")
    for name, (low, high) in BANDS.items():
        cells = []
        for rows in columns.values():
            x = np.array([row[name] for row in rows if np.isfinite(row[name])])
            out = np.count_nonzero((x < low) | (x > high))
            cells.append(f"{x.mean():.3g}, {x.std():.2g}, {out} of {x.size}")
        lines.append(f"| {name} | {low:g} to {high:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def draw(rows: dict[str, list[Map]], path: Path) -> None:
    """A column for each kind, two maps each, from their floors to their peaks."""
    figure, axes = plt.subplots(
        2, len(rows), figsize=(4 * len(rows), 7), sharey=True, layout="constrained", squeeze=False
    )
    for column, (kind, maps) in enumerate(rows.items()):
        for one, panel in zip(maps, axes[:, column], strict=False):
            level = 10 * np.log10(np.maximum(one.power, 1e-30))
            floor = float(np.median(level[one.speed > NOISE_MPS]))
            extent = (one.time[0], one.time[-1], one.speed[-1], one.speed[0])
            panel.imshow(
                level, extent=extent, aspect="auto", vmin=floor - 3, vmax=np.percentile(level, 99.9)
            )
            panel.set_ylim(SHOWN_MPS)
            panel.set_xlabel("time (s)")
        axes[0, column].set_title(kind)
    axes[0, 0].set_ylabel("approaching speed (m/s)")
    figure.savefig(path, dpi=90)
    plt.close(figure)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("maps", type=Path, help="npz of measured maps")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--config", type=Path, default=CONFIG)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--seeds", type=int, default=8)
    options = parser.parse_args()
    matplotlib.use("Agg")
    views = measured(options.maps)
    shown: dict[str, list[Map]] = {"measured": list(views.values())}
    numbers = {name: statistics(view) for name, view in views.items()}
    columns = {"measured": spread(list(numbers.values()))}
    each = {}
    for kind, overrides in KINDS.items():
        config = load_config(options.config, [*options.set, *overrides])
        shown[kind] = [simulated(config, seed) for seed in range(1, options.seeds + 1)]
        each[kind] = [statistics(one) for one in shown[kind]]
        columns[kind] = spread(each[kind])
    options.out.mkdir(parents=True, exist_ok=True)
    text = f"{table(columns)}\n{outside(each)}"
    (options.out / "comparison.md").write_text(text)
    everything = {"views": numbers} | columns
    (options.out / "comparison.json").write_text(json.dumps(everything, indent=2) + "\n")
    draw(shown, options.out / "comparison.png")
    print(text)


if __name__ == "__main__":
    main()
