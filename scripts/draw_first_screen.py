"""Draw docs/images/first_screen.png, the picture of the README: four movements and their maps.

    python scripts/draw_first_screen.py [-o docs/images/first_screen.png]

Scenes are those of the preset human/free_space_77GHz, but everybody faces the radar, 6 m from it.
Right limbs are green, left ones orange.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from draw_pictures import LARGE, save_picture
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from radhar_cli.config import load_config
from radhar_cli.figures.page import page
from radhar_cli.figures.sides import limbs
from radhar_cli.figures.style import RADAR, joint_colours
from radhar_cli.processing.image import decibels
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.scene.single.simulate import Simulation, simulate

ROOT = Path(__file__).resolve().parents[1]
CONFIG = ROOT / "configs/human/free_space_77GHz.yaml"
SETTINGS = (
    "motion.angle_deg=180",
    "motion.place.range_m=6",
    "motion.place.cross_range_m=0",
    "motion.falling.direction=forward",
    "timing.visible=1",
    "timing.onset=0.4",
)
# Instants at which the body is drawn, s.
ACTIVITIES = {
    "walking": (0.6, 1.8, 3.0, 4.2, 5.4),
    "falling": (0.6, 1.7, 2.5, 4.3),
    "sitting_down": (0.6, 1.5, 2.3, 3.5, 4.8),
    "punching": (0.6, 1.8, 3.0, 4.2, 5.4),
}
METRES_A_SECOND = 0.55  # of the axis of the bodies
DYNAMIC_RANGE_DB = 45.0
SECONDS = 6.0
SPEEDS_MPS = (-3.0, 5.0)


def draw(out: Path) -> None:
    """Write a figure with a column for every activity: the body above, its map below."""
    figure = page(13, 5.8)
    axes = figure.subplots(2, len(ACTIVITIES), height_ratios=(1, 1.8), sharex="row", sharey="row")
    for body, panel, activity in zip(*axes, ACTIVITIES, strict=True):
        simulation = simulate(load_config(CONFIG, SETTINGS), activity, maps=("stft",))
        drawn = draw_speeds(panel, simulation)
        draw_body(body, simulation, ACTIVITIES[activity])
        body.set_title(activity.replace("_", " "))
        panel.set_xlabel("time (s)")
    axes[0, 0].text(0, 1.8, "\N{LEFTWARDS ARROW} radar", color=RADAR)
    axes[1, 0].set_ylabel("approaching (m/s)")
    figure.colorbar(drawn, ax=axes[1], pad=0.01, label="power (dB)")
    save_picture(figure, out, 100, "python scripts/draw_first_screen.py")


def draw_speeds(panel: Axes, simulation: Simulation) -> Any:
    """Draw the Doppler-time map of a scene over the speed towards the radar, m/s."""
    stft = simulation.maps["stft"]
    left, right, low, high = stft.extent
    speed = SPEED_OF_LIGHT / (2 * simulation.waveform.f0)
    drawn = panel.imshow(
        decibels(stft.power, DYNAMIC_RANGE_DB),
        extent=(left, right, low * speed, high * speed),
        origin="lower",
        aspect="auto",
        vmin=-DYNAMIC_RANGE_DB,
        vmax=0,
    )
    panel.set(xlim=(0, SECONDS), ylim=SPEEDS_MPS)
    return drawn


def draw_body(panel: Axes, simulation: Simulation, instants: tuple[float, ...]) -> None:
    """Draw the body from its side at some instants (s), each at its time on the axis of the map."""
    truth = simulation.truth
    for instant in instants:
        pulse = int(np.searchsorted(truth.time, instant))
        joints = truth.positions[pulse]
        hips = None if truth.hip_joints is None else truth.hip_joints[pulse]
        ends = limbs(joints, simulation.motion.parents, hips)[..., [0, 2]]
        ends[..., 0] = instant + (ends[..., 0] - joints[:, 0].mean()) / METRES_A_SECOND
        colours = joint_colours(simulation.motion.names)
        panel.add_collection(LineCollection(list(ends), colors=colours, linewidths=2.5))
    panel.axhline(0, color="0.6")
    panel.set(aspect=1 / METRES_A_SECOND, xlim=(0, SECONDS), ylim=(-0.05, 1.95))
    panel.set_axis_off()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs/images/first_screen.png")
    out = parser.parse_args().out
    with rc_context(LARGE):
        draw(out)


if __name__ == "__main__":
    main()
