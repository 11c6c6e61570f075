"""A range-time image of an impulse radar through a wall, beside simulated ones.

    python scripts/studies/throughwall_against_measured.py Example_Datas_RW_RTM.png -o OUT

The picture is that of JoeyBGOfficial's through-wall data (jet colours, no axes): 256 samples over
256 profiles, near the radar at the bottom. A person of segments walks away from 0.7 to 2.3 GHz
behind nothing, a wall without and with its reflections, with a floor, and in a room of order 1.
OUT/beside.png shows all. The table has, for each, by how much the trail differs from the
measured one: rms over the 17 stripes behind the first return, in dB of the mean amplitude.
"""

import argparse
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib import colormaps
from matplotlib import pyplot as plt
from PIL import Image

from radhar_cli.config.data_set import Config
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene

SIZE, STRIPE_M, STRIPE_ROWS, STRIPES = 256, 0.1, 5.96, 17
SECONDS, NEAREST_M, REACH_M = 2.0, 0.6, SIZE * STRIPE_M / STRIPE_ROWS
CONCRETE = dict.fromkeys(("floor", "ceiling", "left", "right", "back"), "concrete")
WALL = {"center_m": [0.6, 0, 1.25], "size_m": [0.24, 8, 3], "eps_r": 6, "loss_tangent": 0.03}
EXACT = {"wall": WALL | {"echoes": "exact"}}
BOX = {"x": [0.5, 6.5], "y": [-2.5, 2.5], "height": 2.6}
SCENES: dict[str, dict[str, Any]] = {
    "in the open": {"wall": None},
    "a wall, one pass": {"wall": WALL},
    "its reflections, too": EXACT,
    "and a floor": EXACT | {"room": {"faces": {"floor": "concrete"}}},
    "and a room": EXACT | {"room": {"faces": CONCRETE, "box_m": BOX}},
}


def simulated(scene: dict[str, Any], seed: int) -> Float:
    """A signed range-time image [256, 256] from -1 to 1, near the radar first."""
    radar = {"carrier_hz": 0.7e9, "bandwidth_hz": 1.6e9, "prf_hz": 128, "waveform": "impulse"}
    place = {"tx_m": [0.2, -0.1, 1.3], "rx_m": [0.2, 0.1, 1.3]}
    shown_m = [NEAREST_M, NEAREST_M + REACH_M]
    document = {
        "seed": seed,
        "duration_s": SECONDS,
        "activities": ["walking"],
        "radar": radar | place | {"profile_m": shown_m, "profile_samples": SIZE},
        "motion": {"range_m": {"uniform": [1.6, 2.0]}, "angle_deg": 0},
        "timing": {"visible": 1},
        "body": {"scatterers": "segments"},
        "processing": {"clutter": "mean", "range_gain_power": 2},
        "snr_db": 40,
        "maps": ["rtm"],
        "image": {"kind": "signed", "size_px": SIZE, "range_limits_m": shown_m},
    }
    config = Config.model_validate(document | scene)
    drawn = draw_scene(config, activity_named("walking"), 0)
    levels = record(drawn, ["image:rtm"])["image:rtm"].levels
    return levels[::-1] / 127.5 - 1


def measured(path: Path) -> Float:
    """The picture's values [256, 256] from -1 to 1, near the radar first."""
    with Image.open(path) as image:
        pixels = np.asarray(image.convert("RGB").resize((SIZE, SIZE), Image.Resampling.NEAREST))
    palette = np.array(colormaps["jet"](np.arange(SIZE))[:, :3] * 255)
    apart = ((pixels[:, :, None].astype(float) - palette) ** 2).sum(axis=-1)
    return apart.argmin(axis=-1)[::-1] / 127.5 - 1


def trail(image: Float) -> Float:
    """Mean amplitude of the stripes behind the first return [17], dB below that."""
    rows = np.arange(STRIPES + 1) * STRIPE_ROWS
    found = []
    for column in image.T:
        strong = np.flatnonzero(np.abs(column) > 0.5)
        if strong.size and strong[0] + rows[-1] + STRIPE_ROWS < SIZE:
            at = strong[0] + rows
            pieces = [np.abs(column[int(a) : int(a + STRIPE_ROWS)]).mean() for a in at]
            found.append(pieces)
    mean = np.mean(found, axis=0)
    return 20 * np.log10(mean[1:] / mean[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("picture", type=Path, nargs="?", help="without it nothing is compared")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--seeds", type=int, default=5)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    shown: dict[str, Float] = {}
    right = None if given.picture is None else measured(given.picture)
    for name, scene in SCENES.items():
        images = [simulated(scene, seed) for seed in range(1, given.seeds + 1)]
        shown[name] = images[0]
        if right is not None:
            apart = [np.sqrt(np.mean((trail(one) - trail(right)) ** 2)) for one in images]
            print(f"{name:22s} {np.mean(apart):4.1f} dB ({min(apart):.1f} to {max(apart):.1f})")
    if right is not None:
        shown["measured"] = right
    matplotlib.use("Agg")
    figure, panels = plt.subplots(
        1, len(shown), figsize=(2.2 * len(shown), 2.6), sharey=True, layout="constrained"
    )
    extent = (0, SECONDS, NEAREST_M, NEAREST_M + REACH_M)
    for panel, (title, image) in zip(panels, shown.items(), strict=True):
        drawn = panel.imshow(
            image, origin="lower", aspect="auto", cmap="RdBu_r", vmin=-1, vmax=1, extent=extent
        )
        panel.set(title=title, xlabel="time (s)")
    panels[0].set_ylabel("range (m)")
    figure.colorbar(drawn, ax=panels, label="amplitude over the largest")
    figure.savefig(given.out / "beside.png", dpi=110)


if __name__ == "__main__":
    main()
