"""Draw docs/images/overview.png and gallery_*.png of docs/results/gallery.md: real builds.

    python scripts/draw_gallery.py [-o docs]

Scenes: configs/human/free_space_77GHz.yaml and through_wall_2GHz.yaml, one a class; then
configs/paper/figures_free_space.yaml and figures_through_wall.yaml.
"""

import argparse
import tempfile
from pathlib import Path
from textwrap import wrap

import h5py
from draw_pictures import LARGE, save_picture
from matplotlib import rc_context

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import MAP_NAMES, load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.layout import DATASET
from radhar_cli.figures.maps_panel import TITLES
from radhar_cli.figures.page import page
from radhar_cli.motion.activities.activity import ACTIVITIES

ROOT = Path(__file__).resolve().parents[1]
SCENARIOS = {
    "people": "people in free space, 77 GHz",
    "people_wall": "people through a wall, 2 GHz",
    "free_space": "the paper's motion in free space, 77 GHz",
    "through_wall": "the paper's motion through a wall, 2 GHz",
}
ONE_EACH = (
    "samples_per_class=1",
    "split={train: 1, validation: 0}",
    f"maps=[{', '.join(MAP_NAMES)}]",
    "motion.angle_deg=180",
    "motion.cross_range_m=0",
    "image.size_px=256",
)
CONFIGS = {
    "people": ("human/free_space_77GHz.yaml", ONE_EACH),
    "people_wall": ("human/through_wall_2GHz.yaml", ONE_EACH),
    "free_space": ("paper/figures_free_space.yaml", ()),
    "through_wall": ("paper/figures_through_wall.yaml", ()),
}
IN_KHZ = ("people", "free_space")
OVERVIEW = (
    ("people", "rtm", "people, 77 GHz\nrange (m)"),
    ("people", "stft", "people, 77 GHz\nDoppler (kHz)"),
    ("people_wall", "stft", "people, 2 GHz,\nwall (Hz)"),
    ("free_space", "stft", "paper's motion,\n77 GHz (kHz)"),
)


def draw(place: Path, rows: tuple[tuple[str, str, str], ...], height: float, out: Path) -> None:
    """Write a figure with a row for every (scenario, map, label) and a column for every class."""
    figure = page(19, height)
    axes = figure.subplots(len(rows), 12, sharex="row", sharey="row")
    for row, (scenario, name, label) in zip(axes, rows, strict=True):
        unit = 1e3 if scenario in IN_KHZ and name != "rtm" else 1.0
        with h5py.File(place / scenario / DATASET) as file:
            left, right, low, high = file[f"extent/{name}"][0]
            extent = (left, right, low / unit, high / unit)
            for panel, levels in zip(row, file[f"maps/{name}"], strict=True):
                drawn = panel.imshow(
                    levels / 5.1 - 50, extent=extent, aspect="auto", vmin=-50, vmax=0
                )
        if name == "rtm":
            row[0].set_ylim(0, 14 if scenario.startswith("people") else 7.4)
        row[0].set_ylabel(label)
    for panel, activity in zip(axes[0], ACTIVITIES, strict=True):
        words = f"{activity.label} {activity.slug.replace('_', ' ')}"
        panel.set_title("\n".join(wrap(words, 13)))
    for panel in axes[-1]:
        panel.set_xlabel("time (s)")
    figure.colorbar(drawn, ax=axes, pad=0.005, aspect=60, label="power (dB below level 255)")
    save_picture(figure, out, 80, "python scripts/draw_gallery.py")
    print(out)


def gallery_rows(scenario: str) -> tuple[tuple[str, str, str], ...]:
    unit = "kHz" if scenario in IN_KHZ else "Hz"
    labels = {name: f"{TITLES[name]}\n({unit})".replace(", ", ",\n") for name in MAP_NAMES}
    labels["rtm"] = "range (m)"
    return tuple((scenario, name, labels[name]) for name in MAP_NAMES)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs")
    out = parser.parse_args().out
    with tempfile.TemporaryDirectory() as name, rc_context(LARGE):
        place = Path(name)
        for scenario in SCENARIOS:
            path, overrides = CONFIGS[scenario]
            config = load_config(ROOT / "configs" / path, overrides)
            build(config, place / scenario, 1, BarProgress())
        draw(place, OVERVIEW, 7.2, out / "images/overview.png")
        for scenario in SCENARIOS:
            draw(place, gallery_rows(scenario), 15, out / f"images/gallery_{scenario}.png")


if __name__ == "__main__":
    main()
