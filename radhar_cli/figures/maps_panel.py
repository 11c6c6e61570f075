"""maps.png: the nine maps of one scene on one page."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from radhar_cli.figures.page import page
from radhar_cli.pipeline.motion_paths import point_delay
from radhar_cli.processing.image import decibels
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.simulation.simulate import Simulation

TITLES: Mapping[str, str] = {
    "rtm": "range-time map",
    "stft": "STFT",
    "stft_denoised": "STFT, denoised",
    "stft_compensated": "STFT, compensated",
    "stft_compensated_denoised": "STFT, compensated, denoised",
    "fsst": "FSST",
    "fsst_denoised": "FSST, denoised",
    "fsst_compensated": "FSST, compensated",
    "fsst_compensated_denoised": "FSST, compensated, denoised",
}
# A column for each signal, a row for each transform; the range-time map has the left side.
PLACES = (
    ("stft", "stft_denoised", "stft_compensated", "stft_compensated_denoised"),
    ("fsst", "fsst_denoised", "fsst_compensated", "fsst_compensated_denoised"),
)


def draw_map(axes: Axes, name: str, simulation: Simulation, overlay: bool) -> AxesImage:
    """Draw one map with its axes, its entropy, and if asked the true Doppler of every joint."""
    image, power_map = simulation.config.image, simulation.maps[name]
    is_range = power_map.rows.name == "range"
    unit = 1.0 if is_range or power_map.rows.values.max() < 2000 else 1e3
    left, right, low, high = power_map.extent
    drawn = axes.imshow(
        decibels(power_map.power, image.dynamic_range_db),
        extent=(left, right, low / unit, high / unit),
        origin="lower",
        aspect="auto",
        cmap=image.colour_map,
        interpolation="antialiased",
        vmin=-image.dynamic_range_db,
        vmax=0,
    )
    axes.set_title(f"{TITLES[name]}   {power_map.entropy:.2f} bit", fontsize=9)
    axes.set_xlim(left, right)
    axes.set_xlabel("time (s)", fontsize=8)
    axes.tick_params(labelsize=7)
    if is_range:
        axes.set_ylabel("range (m)", fontsize=8)
        axes.set_ylim(0, min(high, 1.3 * _farthest(simulation) + 0.5))
        return drawn
    axes.set_ylabel("Doppler (kHz)" if unit > 1 else "Doppler (Hz)", fontsize=8)
    speed = SPEED_OF_LIGHT / (2 * simulation.waveform.f0) * unit
    scale = (partial(np.multiply, speed), partial(np.multiply, 1 / speed))
    second = axes.secondary_yaxis("right", functions=scale)
    second.set_ylabel("approaching (m/s)", fontsize=8)
    second.tick_params(labelsize=7)
    if overlay:
        _draw_truth(axes, name, simulation, unit)
    return drawn


def _farthest(simulation: Simulation) -> float:
    p = simulation.truth.positions.transpose(2, 1, 0)
    tau = point_delay(p, simulation.antennas, simulation.wall)
    return float(tau.max()) * SPEED_OF_LIGHT / 2


def _draw_truth(axes: Axes, map_name: str, simulation: Simulation, unit: float) -> None:
    """Curves of the true Doppler, folded into +-PRF/2 as the map is."""
    truth, prf = simulation.truth, simulation.waveform.prf
    doppler = truth.doppler
    if "compensated" in map_name:
        doppler = doppler - doppler[:, :1]
    every = max(1, truth.time.size // 1500)
    for number, name in enumerate(simulation.motion.names):
        if simulation.joint is not None and name != simulation.joint:
            continue
        curve = doppler[::every, number]
        folded = (curve + prf / 2) % prf - prf / 2
        folded[1:][np.abs(np.diff(folded)) > prf / 2] = np.nan
        axes.plot(
            truth.time[::every],
            folded / unit,
            scalex=False,
            scaley=False,
            color="white",
            linewidth=0.5,
            alpha=0.6,
            linestyle="--",
        )


def draw_maps(simulation: Simulation, path: Path, overlay: bool) -> None:
    """Write maps.png: the maps that were computed, one colour bar in dB."""
    figure = page(19, 8.2)
    grid = figure.add_gridspec(2, 5)
    drawn, panels = None, []
    if "rtm" in simulation.maps:
        panels.append(figure.add_subplot(grid[:, 0]))
        drawn = draw_map(panels[-1], "rtm", simulation, overlay)
    for row, names in enumerate(PLACES):
        for column, name in enumerate(names):
            if name in simulation.maps:
                panels.append(figure.add_subplot(grid[row, column + 1]))
                drawn = draw_map(panels[-1], name, simulation, overlay)
    if drawn is not None:
        bar = figure.colorbar(drawn, ax=panels, shrink=0.8, pad=0.01)
        bar.set_label("power (dB below the largest of each map)", fontsize=9)
    figure.suptitle(title(simulation), fontsize=11)
    figure.savefig(path, dpi=90)


def title(simulation: Simulation) -> str:
    """One line that says what was simulated."""
    scene, waveform = simulation.scene, simulation.waveform
    snr = scene.config.snr_db
    parts = [
        f"{scene.activity.label} {scene.activity.slug.replace('_', ' ')}",
        f"{waveform.fc / 1e9:g} GHz + {waveform.bandwidth / 1e9:g} GHz, PRF {waveform.prf:g} Hz",
        "through a wall" if simulation.config.wall is not None else "free space",
        "no noise" if snr is None else f"SNR {snr:g} dB",
        f"seed {scene.config.seed}",
    ]
    if simulation.joint is not None:
        parts.append(f"{simulation.joint.replace('_', ' ')} alone")
    return "   |   ".join(parts)
