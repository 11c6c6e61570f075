"""Draw docs/overview.png: twelve classes in both of the paper's scenarios, from a real build.

    python scripts/draw_overview.py [-o docs/overview.png]
"""

import argparse
import tempfile
from pathlib import Path

import h5py
import matplotlib
import matplotlib.pyplot as plt

from radhar_cli.activity import ACTIVITIES
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.layout import DATASET

ROOT = Path(__file__).resolve().parents[1]
ROWS = (
    ("free_space", "rtm", "77 GHz\nrange (m)", 1.0),
    ("free_space", "stft", "77 GHz\nDoppler (kHz)", 1e3),
    ("free_space", "fsst_compensated", "77 GHz, FSST,\ncompensated (kHz)", 1e3),
    ("through_wall", "stft", "2 GHz, wall\nDoppler (Hz)", 1.0),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs/overview.png")
    out = parser.parse_args().out
    matplotlib.use("Agg")
    maps = f"maps=[{', '.join(sorted({row[1] for row in ROWS}))}]"
    figure, axes = plt.subplots(
        len(ROWS), 12, figsize=(19, 7.2), sharex=True, sharey="row", layout="constrained"
    )
    with tempfile.TemporaryDirectory() as place:
        for scenario in ("free_space", "through_wall"):
            config = load_config(ROOT / f"configs/paper/figures_{scenario}.yaml", [maps])
            build(config, Path(place, scenario), 1, BarProgress())
        for row, (scenario, name, label, unit) in zip(axes, ROWS, strict=True):
            with h5py.File(Path(place, scenario, DATASET)) as file:
                left, right, low, high = file[f"extent/{name}"][0]
                extent = (left, right, low / unit, high / unit)
                for panel, levels in zip(row, file[f"maps/{name}"], strict=True):
                    panel.imshow(levels, extent=extent, aspect="auto", cmap="viridis")
            row[0].set_ylabel(label)
    axes[0, 0].set_ylim(0, 7.4)
    for panel, activity in zip(axes[0], ACTIVITIES, strict=True):
        panel.set_title(f"{activity.label} {activity.slug.replace('_', ' ')}", fontsize=9)
    for panel in axes[-1]:
        panel.set_xlabel("time (s)", fontsize=9)
    figure.savefig(out, dpi=80, pil_kwargs={"compress_level": 9})
    print(out)


if __name__ == "__main__":
    main()
