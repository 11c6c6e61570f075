"""Draw what scenes add to a map: docs/images/crossing.png, corner.png, ringing.png.

    python scripts/draw_scenes.py [-o docs/images]

crossing: two people who pass each other, and how much of its echo each keeps behind the other.
corner: a walk by two walls with and without echoes by way of them. ringing: a walk behind a wall,
with and without the reflections inside it. Nominal scenes of this file, without noise.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from draw_pictures import save_picture
from matplotlib.axes import Axes

from radhar_cli.config import Config
from radhar_cli.figures.page import page
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.layers import Layer, Layers
from radhar_cli.radar.propagation import leg
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.radar import antennas_of
from radhar_cli.scene.room import ways_of
from radhar_cli.scene.scene import Scene, nominal_scene

ROOT = Path(__file__).resolve().parents[1]
BY = "python scripts/draw_scenes.py"
WALKING = activity_named("walking")
WALK: dict[str, Any] = {"activities": ["walking"], "snr_db": None, "on_invalid": "keep"}
CROSSING: dict[str, Any] = {
    "radar": {"carrier_hz": 24e9, "bandwidth_hz": 2e9, "prf_hz": 2000},
    "duration_s": 4,
    "motion": {
        "range_m": 2.0,
        "cross_range_m": -0.9,
        "angle_deg": 31,
        "walking": {"speed_mps": 1.17},
    },
    "people": [
        {
            "motion": {
                "range_m": 7,
                "cross_range_m": 0.9,
                "angle_deg": 211,
                "walking": {"speed_mps": 1.17},
            }
        }
    ],
}
CORNER: dict[str, Any] = {
    "image": {"range_limits_m": [0, 13]},
    "radar": {"carrier_hz": 24e9, "bandwidth_hz": 2e9, "prf_hz": 2000},
    "duration_s": 4,
    "motion": {
        "range_m": 5.5,
        "cross_range_m": -1.5,
        "angle_deg": 150,
        "walking": {"speed_mps": 1.0},
    },
}
CORNER_WALLS = {
    "box_m": {"x": [-1, 7], "y": [-9, 1.5], "height": 2.8},
    "faces": {"left": "concrete", "back": "concrete"},
    "order": 2,
}
RINGING: dict[str, Any] = {
    "radar": {"carrier_hz": 1e9, "bandwidth_hz": 2e9, "prf_hz": 256, "adc_rate_hz": 5e6},
    "duration_s": 4,
    "motion": {"range_m": 6, "angle_deg": 180, "walking": {"speed_mps": 0.8}},
    "engine": {"kind": "cube"},
}
WALL = {"center_m": [1, 0, 1.25], "size_m": [0.24, 8, 3], "eps_r": 6, "loss_tangent": 0.03}
WALLS = {
    "0.24 m, eps 6": Layers((Layer(0.24, 6 * (1 - 0.03j)),), False),
    "cavity of brick": Layers((Layer(0.1, "brick"), Layer(0.1, 1), Layer(0.1, "brick")), False),
    "none": Layers((Layer(0.24, 1),), False),
}


def scene_of(document: dict[str, Any], **more: Any) -> Scene:
    return nominal_scene(Config.model_validate(WALK | document | more), WALKING)


def show(panel: Axes, shown: PowerMap, title: str, least: float, most: float) -> None:
    """The rows of a map between two values, the strongest 50 dB, with a colour bar."""
    rows = shown.rows.values
    kept = (rows >= least) & (rows <= most)
    level = 10 * np.log10(np.maximum(shown.power[kept], 1e-300) / shown.power.max())
    times = shown.columns.values
    extent = (times[0], times[-1], rows[kept][0], rows[kept][-1])
    drawn = panel.imshow(level, origin="lower", aspect="auto", vmin=-50, vmax=0, extent=extent)
    panel.set(title=title, xlabel="time (s)", ylabel=f"{shown.rows.name} ({shown.rows.unit})")
    figure = panel.get_figure(root=True)
    assert figure is not None
    figure.colorbar(drawn, ax=panel, label="dB below the largest")


def crossing(path: Path) -> None:
    """Plan, range-time, Doppler, and what shadows leave of each person's echo."""
    figure = page(9.6, 6.6)
    (plan, ranges), (kept, doppler) = figure.subplots(2, 2)
    scene = scene_of(CROSSING, body={"scatterers": "segments"})
    maps = record(scene, ["rtm", "stft"])
    show(ranges, maps["rtm"], "range-time", 0, 9)
    show(doppler, maps["stft"], "Doppler-time", -700, 700)
    t = np.linspace(0, 4, 400)
    one, two = (
        record(scene_of(CROSSING, body={"shadowing": on}), ["paths"])["paths"](t).amplitude
        for on in (True, False)
    )
    for person, (name, colour) in zip(scene.people, (("own", "C0"), ("other", "C3")), strict=True):
        x, y, _ = motion_of(person).torso(t)[:, 0]
        plan.plot(y, x, colour, label=name)
        plan.plot(y[::100], x[::100], "o", color=colour)
        mine = slice(13 * person.number, 13 * person.number + 13)
        left = (one[mine] ** 2).sum(axis=0) / (two[mine] ** 2).sum(axis=0)
        kept.plot(t, 10 * np.log10(left), colour, label=name)
    plan.plot(0, 0.4, "k^")
    plan.set(title="plan, a mark each second", xlabel="left (m)", ylabel="ahead (m)", xlim=(-2, 2))
    plan.invert_xaxis()
    kept.set(title="echo kept behind the other (dB)", xlabel="time (s)")
    kept.legend()
    save_picture(figure, path, 110, BY)


def corner(path: Path) -> None:
    """Range-time and Doppler without and with two walls; where each kind of path should be."""
    figure = page(9.6, 6.4)
    panels = figure.subplots(2, 2)
    for walls, (ranges, doppler) in zip(({}, CORNER_WALLS), panels, strict=True):
        scene = scene_of(CORNER, body={"scatterers": "segments"}, room=walls)
        maps, name = record(scene, ["rtm", "stft"]), "two walls" if walls else "in the open"
        show(ranges, maps["rtm"], name, 0, 13)
        show(doppler, maps["stft"], name, -400, 400)
        t, antennas = np.array([0.0, 4.0]), antennas_of(scene)
        p = motion_of(scene.people[0]).torso(t)
        for tx, rx in ways_of(scene):
            way = (leg(tx.image(p), antennas.tx) + leg(rx.image(p), antennas.rx))[0] / 2
            if tx.name <= rx.name and "+" not in rx.name:  # the other way round is as long
                ranges.text(
                    3.92,
                    way[1],
                    f"{tx.name}/{rx.name}",
                    fontsize=8,
                    va="center",
                    ha="right",
                    color="w",
                )
                ranges.plot(4.0, way[1], "k<", markersize=3, clip_on=False)
        ranges.set_xlim(0, 4)
    save_picture(figure, path, 110, BY)


def ringing(path: Path) -> None:
    """Range-time with one pass of the wall and with all, and what a still point looks like."""
    figure = page(9.6, 3.4)
    panels = figure.subplots(1, 3)
    for echoes, panel, name in zip(
        ("none", "exact"), panels, ("one pass", "all passes"), strict=False
    ):
        scene = scene_of(RINGING, wall={**WALL, "echoes": echoes})
        show(panel, record(scene, ["rtm"])["rtm"], f"behind a wall, {name}", 1, 8)
    f = np.linspace(1e9, 3e9, 400)
    away = np.linspace(-0.5, 2.5, 600)
    turn = np.exp(4j * np.pi / SPEED_OF_LIGHT * f * away[:, None])
    for name, wall in WALLS.items():
        left = np.abs(turn @ (np.hanning(f.size) * wall.transfer_function(f, np.ones(1)) ** 2))
        panels[2].plot(away, 20 * np.log10(left / left.max()), label=name)
    panels[2].set(title="a point behind a wall (dB)", xlabel="range behind it (m)")
    panels[2].set(ylim=(-60, 2))
    panels[2].legend()
    save_picture(figure, path, 110, BY)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs/images")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    for draw in (crossing, corner, ringing):
        draw(out / f"{draw.__name__}.png")


if __name__ == "__main__":
    main()
