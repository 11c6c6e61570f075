"""Print the radar cross section of a body by aspect, as segments and as points: docs/bodies.md.

python scripts/body_cross_sections.py
"""

from pathlib import Path

import numpy as np

from radhar_cli.activity import activity_named
from radhar_cli.config import load_config
from radhar_cli.pipeline.run import record
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.scene import nominal_scene

CONFIG = Path(__file__).resolve().parents[1] / "configs" / "human" / "free_space_77GHz.yaml"
RANGE_M = 20.0
KINDS = {
    "segments": ["body.scatterers=segments"],
    "without shadows": ["body.scatterers=segments", "body.shadowing=false"],
    "points": ["body.scatterers=points"],
}


def dbsm(slug: str, angle_deg: float, overrides: list[str]) -> float:
    """Sum of the cross sections of all paths, mean over the recording, dBsm."""
    place = [f"motion.range_m={RANGE_M}", f"motion.angle_deg={angle_deg}", "subject.height_m=1.75"]
    config = load_config(CONFIG, ["radar.tx_m=[0,0,1]", "radar.rx_m=[0,0,1]", *place, *overrides])
    products = record(
        nominal_scene(config, activity_named(slug)), ["paths", "antennas", "waveform"]
    )
    paths = products["paths"](np.linspace(0, 1.2, 240))
    distance = paths.delay * SPEED_OF_LIGHT / 2
    wavelength = products["waveform"].wavelength
    field = paths.amplitude * distance**2 / (products["antennas"].gain * wavelength)
    return float(10 * np.log10(((4 * np.pi) ** 3 * field**2).sum(axis=0).mean()))


def main() -> None:
    print("| seen from | " + " | ".join(f"stands, {k} | walks, {k}" for k in KINDS) + " |")
    print("|---" * (2 * len(KINDS) + 1) + "|")
    for angle, name in (
        (180, "ahead"),
        (135, "45°"),
        (90, "the side"),
        (45, "135°"),
        (0, "behind"),
    ):
        cells = [
            f"{dbsm(slug, angle, overrides):.1f}"
            for overrides in KINDS.values()
            for slug in ("stationary", "walking")
        ]
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
