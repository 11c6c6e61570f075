"""Draw docs/images/overview.png and gallery_*.png, write docs/results/gallery.md: real builds.

    python scripts/draw_gallery.py [-o docs]

Scenes: configs/human/free_space_77GHz.yaml and through_wall_2GHz.yaml, one a class; then
configs/paper/figures_free_space.yaml and figures_through_wall.yaml.
"""

import argparse
import tempfile
import textwrap
from pathlib import Path

import h5py
import matplotlib
import matplotlib.pyplot as plt
from PIL import Image

from radhar_cli.activity import ACTIVITIES
from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import MAP_NAMES, load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.layout import DATASET
from radhar_cli.figures.maps_panel import TITLES

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
WORDS = {
    1: (
        "Nothing moves and the MTI leaves nothing of the body: noise alone, shaped by the first "
        "difference, dark at zero Doppler."
    ),
    2: (
        "Two arms in antiphase: forearms reach about 400 Hz towards and 700 Hz away from the radar "
        "at 77 GHz, repeating every second. Torso and legs are static and invisible."
    ),
    3: (
        "One leg: the ankle's swing fills the whole Doppler band at 77 GHz (5.1 m/s, it touches "
        "PRF/2), the knee lies inside it; the range map shows the two sinusoids."
    ),
    4: (
        "The trunk bends to pi and back once a second about the torso point: head and arms on both "
        "signs of Doppler at once, feet and hips planted."
    ),
    5: (
        "One slow hump from 0.5 to 2.5 s: the torso moves back towards the radar (positive "
        "Doppler), then settles; compensation flattens it to a line."
    ),
    6: "The same hump backwards: away from the radar first as the person rises, then at rest.",
    7: (
        "Shoulders and arms circle the torso's axis in antiphase: two interleaved chains, "
        "symmetric about zero; the torso itself is static."
    ),
    8: (
        "A steady torso line at -2 v f0/c: -790 Hz at 77 GHz + 2 GHz, -25 Hz at 2.5 GHz, with the "
        "limbs' pulses around it twice a second; ankles alias at the top edge. Compensation puts "
        "the torso at zero. Range grows by 1.5 m/s and power falls by 12 dB a doubling of range."
    ),
    9: (
        "The hump of rising until 2 s, then the gait fades in. Through the wall, joints that "
        "cross its far face change amplitude at once: the bright stripes."
    ),
    10: "Gait until 2 s, fading out within 0.3 s, then the faint hump of sitting down far away.",
    11: (
        "A fan from 0.5 to 2 s: lying flat, the body turns up about the torso, head and feet in "
        "opposite senses; then the gait."
    ),
    12: (
        "Gait until 2 s, then a fast fan of 0.8 s: the feet swing back towards the radar (positive "
        "Doppler) while the head goes forward and down."
    ),
}


def draw(place: Path, rows: tuple[tuple[str, str, str], ...], height: float, out: Path) -> None:
    """Write a figure with a row for every (scenario, map, label) and a column for every class."""
    figure, axes = plt.subplots(
        len(rows), 12, figsize=(19, height), sharex="row", sharey="row", layout="constrained"
    )
    for row, (scenario, name, label) in zip(axes, rows, strict=True):
        unit = 1e3 if scenario in IN_KHZ and name != "rtm" else 1.0
        with h5py.File(place / scenario / DATASET) as file:
            left, right, low, high = file[f"extent/{name}"][0]
            extent = (left, right, low / unit, high / unit)
            for panel, levels in zip(row, file[f"maps/{name}"], strict=True):
                panel.imshow(levels, extent=extent, aspect="auto", cmap="viridis")
                panel.tick_params(labelsize=7)
        if name == "rtm":
            row[0].set_ylim(0, 11 if scenario.startswith("people") else 7.4)
        row[0].set_ylabel(label, fontsize=8)
    for panel, activity in zip(axes[0], ACTIVITIES, strict=True):
        panel.set_title(f"{activity.label} {activity.slug.replace('_', ' ')}", fontsize=9)
    for panel in axes[-1]:
        panel.set_xlabel("time (s)", fontsize=8)
    figure.savefig(out, dpi=80)
    plt.close(figure)
    with Image.open(out) as picture:
        picture.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(out, optimize=True)
    print(out)


def gallery_rows(scenario: str) -> tuple[tuple[str, str, str], ...]:
    unit = "kHz" if scenario in IN_KHZ else "Hz"
    labels = {name: f"{TITLES[name]}\n({unit})".replace(", ", ",\n") for name in MAP_NAMES}
    labels["rtm"] = "range (m)"
    return tuple((scenario, name, labels[name]) for name in MAP_NAMES)


INTRODUCTION = """
# Gallery

After this page you know what each of the nine maps shows of each of the twelve classes.

All nine maps of all twelve classes, 50 dB from dark to bright, drawn and written by
`python scripts/draw_gallery.py`. First people as they move (`motion.model: human`,
[motion](../guide/motion.md)), one of each class of the human configs, facing the radar; then
the paper's motion in the scenes of its two figures: a person of 1.8 m at 2 m (S1 to S7) or 1 m
(S8 to S12).
"""
END = """
Denoising (rows 3, 5, 7, 9) is a low-pass at 0.32 of PRF/2: it takes the fast limbs with it. The
FSST (rows 6 to 9) is thinner than the STFT: a tone falls into one bin. Through the wall, the
walkers of S8 to S12 start inside it (x = 1 m): their first moments are bright, and what follows
lies 10 dB of wall and the growing range below. See also the limits in
[the model](../physics/model.md).
"""


def words() -> str:
    lines = [INTRODUCTION.strip(), ""]
    for scenario, title in SCENARIOS.items():
        lines += [f"## {title[0].upper()}{title[1:]}", ""]
        lines += [f"![{title}](../images/gallery_{scenario}.png)", ""]
    lines += ["## What each class shows, with the paper's motion", ""]
    for activity in ACTIVITIES:
        name = f"**{activity.label} {activity.slug.replace('_', ' ')}.**"
        lines.append(
            textwrap.fill(f"- {name} {WORDS[activity.number]}", 100, subsequent_indent="  ")
        )
    return "\n".join([*lines, END])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs")
    out = parser.parse_args().out
    matplotlib.use("Agg")
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        for scenario in SCENARIOS:
            path, overrides = CONFIGS[scenario]
            config = load_config(ROOT / "configs" / path, overrides)
            build(config, place / scenario, 1, BarProgress())
        draw(place, OVERVIEW, 7.2, out / "images/overview.png")
        for scenario in SCENARIOS:
            draw(place, gallery_rows(scenario), 15, out / f"images/gallery_{scenario}.png")
    (out / "results/gallery.md").write_text(words())


if __name__ == "__main__":
    main()
