"""Draw docs/images/angles_cadences.png of docs/guide/maps.md: two maps beside the truth.

    python scripts/draw_angles_cadences.py [-o docs/images]

A person walks across before a row of eight elements, and towards it.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from draw_pictures import save_picture
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from radhar_cli.config.data_set import Config
from radhar_cli.figures.page import page
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.image import decibels
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.scene.single.simulate import Simulation, simulate

ROOT = Path(__file__).resolve().parents[1]
RADAR = {
    "frame": {"chirps": 256, "interval_s": 100e-6},
    "carrier_hz": 77e9,
    "bandwidth_hz": 1e9,
    "adc_rate_hz": 2e6,
    "chirp_s": 64e-6,
    "array": {"tx": [[0, 0]], "rx": [[place, 0] for place in range(8)]},
    "position_m": [0, 0, 1],
}
ACROSS = {"range_m": 3.0, "cross_range_m": -2.2, "angle_deg": 90.0}
TOWARDS = {"range_m": 8.0, "cross_range_m": 0.0, "angle_deg": 180.0}
RANGE_DB = 40.0


def simulate_walk(motion: dict[str, float], name: str) -> Simulation:
    """Simulate a walk before the radar with one map."""
    document: dict[str, Any] = {"radar": RADAR, "activities": ["walking"], "motion": motion}
    document |= {"duration_s": 5.0, "maps": [name], "body": {"scatterers": "surfaces"}}
    return simulate(Config.model_validate(document), nominal=True)


def azimuth_of_torso(simulation: Simulation) -> Float:
    """True azimuth of the torso at every pulse, degrees, of a radar above the origin."""
    x, y = simulation.truth.positions[:, 0, :2].T
    azimuth: Float = np.degrees(np.arctan2(y, x))
    return azimuth


def step_rate(simulation: Simulation) -> float:
    """Rate of the true skeleton's steps, Hz: two in a swing of the right ankle about the torso."""
    joints, time = simulation.truth.positions, simulation.truth.time
    ankle = joints[:, simulation.motion.names.index("right_ankle"), 0] - joints[:, 0, 0]
    swing = (ankle - ankle.mean()) * np.hanning(ankle.size)
    spectrum = np.abs(np.fft.rfft(swing, 16 * swing.size))
    rates = np.fft.rfftfreq(16 * swing.size, float(time[1] - time[0]))
    return 2 * float(rates[spectrum.argmax()])


def draw(axes: Axes, power_map: PowerMap, unit: float = 1.0) -> AxesImage:
    """Draw a map in decibels below its peak, rows in a unit of their own."""
    left, right, low, high = power_map.extent
    return axes.imshow(
        decibels(power_map.power, RANGE_DB),
        extent=(left, right, low / unit, high / unit),
        origin="lower",
        aspect="auto",
        cmap="viridis",
        vmin=-RANGE_DB,
        vmax=0,
    )


def draw_figure() -> Figure:
    """Draw both maps with the truth over them."""
    figure = page(9.6, 3.8)
    first, second = figure.subplots(1, 2)
    across = simulate_walk(ACROSS, "azimuth_time")
    draw(first, across.maps["azimuth_time"])
    first.plot(across.truth.time, azimuth_of_torso(across), "w--", linewidth=1)
    first.set(xlabel="time (s)", ylabel="azimuth (degree)", title="azimuth_time, walking across")
    towards = simulate_walk(TOWARDS, "stft_cadence")
    drawn = draw(second, towards.maps["stft_cadence"], 2 * towards.waveform.f0 / SPEED_OF_LIGHT)
    second.axvline(step_rate(towards), color="white", linestyle="--", linewidth=1)
    title = f"stft_cadence, walking; {step_rate(towards):.2f} steps a second"
    second.set(ylim=(-1, 5), xlabel="cadence (Hz)", ylabel="approaching (m/s)", title=title)
    figure.colorbar(drawn, ax=[first, second], label="dB below the peak", pad=0.01)
    return figure


def main(arguments: list[str] | None = None) -> None:
    """Write the figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs/images")
    folder = parser.parse_args(arguments).out
    by = "python scripts/draw_angles_cadences.py"
    save_picture(draw_figure(), folder / "angles_cadences.png", 110, by)


if __name__ == "__main__":
    main()
