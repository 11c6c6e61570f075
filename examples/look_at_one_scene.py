"""One scene, three maps, and the true Doppler of the torso drawn over one of them.

    python examples/look_at_one_scene.py [walking.png]

Somebody walks past a 77 GHz radar. Needs this file and an installed radhar, nothing else.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import radhar

CONFIG = """\
radar: {prf_hz: 2000, bandwidth_hz: 1e9}
duration_s: 3
image: {size_px: 128}
"""
MAPS = ("rtm", "stft", "fsst_compensated")


def main(out: Path) -> None:
    """Simulate, say what came out, and draw it."""
    config_path = out.with_suffix(".yaml")
    config_path.write_text(CONFIG)
    config = radhar.load_config(config_path, ["snr_db=20"])
    result = radhar.simulate(config, "walking", seed=7, maps=MAPS)
    doppler = result.truth.doppler[:, 0]  # of the torso, Hz
    print(f"torso from {doppler.min():.0f} to {doppler.max():.0f} Hz")

    figure, axes = plt.subplots(1, len(MAPS), figsize=(12, 3.6), layout="constrained")
    for axis, name in zip(axes, MAPS, strict=True):
        one = result.maps[name]
        decibel = 10 * np.log10(one.power + 1e-12 * one.power.max())
        brightest = decibel.max()
        axis.imshow(
            decibel,
            extent=one.extent,
            aspect="auto",
            origin="lower",
            vmin=brightest - 40,
            vmax=brightest,
        )
        axis.set(title=name, xlabel="s", ylabel="m" if name == "rtm" else "Hz")
        if name == "stft":  # compensated, it is 0
            axis.plot(result.truth.time, doppler, "w--", linewidth=1)
    figure.savefig(out)
    print(out)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "walking.png"))
