"""maps.png: the maps of one scene, all nine or some, on one page."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from radhar_cli.config.image import ImageConfig
from radhar_cli.echo.bodies.motion_paths import point_delay
from radhar_cli.figures.page import page, write_figure
from radhar_cli.figures.style import SIGNED, decibels_in_words, describe_band, write_rounded
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.angle_time import ANGLE_TIME_KINDS
from radhar_cli.processing.image import decibels
from radhar_cli.processing.map_kind import treatment_of
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.scene.scene import Scene
from radhar_cli.scene.single.simulate import Simulation
from radhar_cli.schema.number import nominal

_DOPPLER_TIME_TITLES = {
    "stft": "STFT",
    "stft_denoised": "STFT, denoised",
    "stft_compensated": "STFT, compensated",
    "stft_compensated_denoised": "STFT, compensated, denoised",
    "fsst": "FSST",
    "fsst_denoised": "FSST, denoised",
    "fsst_compensated": "FSST, compensated",
    "fsst_compensated_denoised": "FSST, compensated, denoised",
}
TITLES: Mapping[str, str] = {
    "rtm": "range-time map",
    **_DOPPLER_TIME_TITLES,
    **{f"{name}_cadence": f"cadence of {title}" for name, title in _DOPPLER_TIME_TITLES.items()},
    **{kind.name: f"{kind.title} map" for kind in ANGLE_TIME_KINDS.values()},
}
ONE_ROW, TWO_ROWS = 4, 10
MOST_COLUMNS = 4096  # of a map that is drawn, ten times the pixels of a panel


@dataclass(frozen=True)
class MapsPage:
    """Content of a page of maps, simulated or measured."""

    maps: Mapping[str, PowerMap]
    image: ImageConfig  # dynamic range and colours
    f0: float  # frequency at which the Doppler is read, Hz
    farthest: float  # what the range-time map shows, m
    title: str  # one line above
    # draws more over a map: (axes, map name, Hz or m of a unit of the axis)
    over: Callable[[Axes, str, float], None] | None = None


def of_simulation(simulation: Simulation, overlay: bool) -> MapsPage:
    """Content of the page of a scene, with the true Doppler of every joint if `overlay`."""
    p = simulation.truth.positions.transpose(2, 1, 0)
    farthest = point_delay(p, simulation.antennas, simulation.wall).max() * SPEED_OF_LIGHT / 2
    return MapsPage(
        simulation.maps,
        simulation.config.image,
        simulation.waveform.f0,
        1.3 * float(farthest) + 0.5,
        title(simulation),
        partial(_draw_truth, simulation) if overlay else None,
    )


def draw_map(axes: Axes, name: str, page_content: MapsPage) -> AxesImage:
    """Draw the map of that name with its axes and its entropy."""
    image, power_map = page_content.image, page_content.maps[name]
    rows, columns = power_map.rows, power_map.columns
    is_range, is_doppler = rows.name == "range", rows.name == "frequency"
    unit = 1e3 if is_doppler and rows.values.max() >= 2000 else 1.0
    (left, right), (low, high) = columns.edges, rows.edges
    look: dict[str, Any] = {"cmap": image.colour_map, "origin": "lower", "aspect": "auto"}
    if power_map.real is None:
        cells = decibels(power_map.power, image.dynamic_range_db)
        look |= {"vmin": -image.dynamic_range_db, "vmax": 0}
    else:
        cells = power_map.real
        largest = float(np.quantile(np.abs(cells), 1 - image.clipped)) or 1.0
        look |= {"vmin": -largest, "vmax": largest, "cmap": SIGNED}
    cells = columns_that_show(cells)
    extent = (left, right, low / unit, high / unit)
    drawn = axes.imshow(cells, extent=extent, interpolation="antialiased", **look)
    axes.set_title(f"{TITLES.get(name, name)}, entropy {power_map.entropy:.1f} bit")
    axes.set_xlim(left, right)
    axes.set_xlabel(f"{columns.name} ({columns.unit})")
    if is_range:
        axes.set_ylabel("range (m)")
        axes.set_ylim(power_map.limits or (0, min(high, page_content.farthest)))
    elif not is_doppler:
        axes.set_ylabel(f"{rows.name} ({rows.unit})")
    else:
        axes.set_ylabel("Doppler (kHz)" if unit > 1 else "Doppler (Hz)")
        speed = SPEED_OF_LIGHT / (2 * page_content.f0) * unit
        scale = (partial(np.multiply, speed), partial(np.multiply, 1 / speed))
        second = axes.secondary_yaxis("right", functions=scale)
        second.set_ylabel("approaching (m/s)")
    if page_content.over is not None and columns.name == "time":
        page_content.over(axes, name, unit)
    return drawn


def columns_that_show(cells: Float) -> Float:
    """Average cells [row, column] to at most MOST_COLUMNS columns, each the mean of as many."""
    every = -(-cells.shape[1] // MOST_COLUMNS)
    if every == 1:
        return cells
    first = np.arange(0, cells.shape[1], every)
    sums: Float = np.add.reduceat(cells, first, axis=1)
    return sums / np.diff(np.append(first, cells.shape[1]))


def _draw_truth(simulation: Simulation, axes: Axes, map_name: str, unit: float) -> None:
    """Draw curves of everybody's true Doppler, aliased into +-PRF/2 as the map is."""
    if simulation.maps[map_name].rows.name != "frequency":
        return
    truth, prf = simulation.truth, simulation.waveform.prf
    joint, names = simulation.joint, simulation.motion.names
    drawn_joints = [number for number, name in enumerate(names) if joint in (None, name)]
    others = [one.truth.doppler for one in simulation.others if joint is None]
    doppler = np.concatenate([truth.doppler[:, drawn_joints], *others], axis=1)
    if treatment_of(map_name).compensated:
        doppler = doppler - truth.doppler[:, :1]
    every = max(1, truth.time.size // 1500)
    for curve in alias_doppler(doppler[::every], prf).T:
        look: dict[str, Any] = {"color": "white", "linewidth": 0.5, "alpha": 0.6}
        axes.plot(truth.time[::every], curve / unit, "--", scalex=False, scaley=False, **look)


def alias_doppler(doppler: Float, prf: float) -> Float:
    """Alias Doppler [time, curve], Hz, into +-PRF/2; NaN where a curve jumps to the other edge."""
    aliased: Float = (doppler + prf / 2) % prf - prf / 2
    aliased[1:][np.abs(np.diff(aliased, axis=0)) > prf / 2] = np.nan
    return aliased


def draw_maps(page_content: MapsPage, path: Path) -> None:
    """Write maps.png: all maps on one page, with a colour bar of powers, and one of amplitudes."""
    names = [
        name for name in dict.fromkeys((*TITLES, *page_content.maps)) if name in page_content.maps
    ]
    rows = 1 if len(names) <= ONE_ROW else 2 if len(names) <= TWO_ROWS else 3
    columns = -(-len(names) // rows)
    figure = page(max(11.0, 3.7 * columns + 1), 4.1 * rows, apart=0.12)
    panels = [figure.add_subplot(rows, columns, 1 + place) for place in range(len(names))]
    drawn = [draw_map(axes, name, page_content) for axes, name in zip(panels, names, strict=True)]
    is_signed = [page_content.maps[name].real is not None for name in names]
    for signed in sorted(set(is_signed)):
        label = "amplitude, clipped" if signed else "power (dB below the largest of each map)"
        figure.colorbar(
            drawn[is_signed.index(signed)], ax=panels, shrink=0.8, pad=0.01, label=label
        )
    figure.suptitle(page_content.title)
    write_figure(figure, path, 90)


def title(simulation: Simulation) -> str:
    """Describe a simulation in a line."""
    alone = simulation.joint
    more = [] if alone is None else [f"{alone.replace('_', ' ')} alone"]
    return "   |   ".join([*describe_scene(simulation.scene, simulation.waveform), *more])


def describe_scene(scene: Scene, waveform: Waveform) -> list[str]:
    """Describe a scene: activity, radar, surroundings, noise and seed, a few words each."""
    snr, figure = scene.config.snr_db, scene.config.receiver.noise_figure_db
    noise = "no noise" if figure is None else f"noise figure {decibels_in_words(nominal(figure))}"
    band = f"{write_rounded(waveform.fc / 1e9, 5)} GHz CW"
    if scene.radar.has_range:
        band = describe_band(waveform.fc, waveform.fc + waveform.bandwidth)
        band += " impulses" if scene.radar.kind == "impulse" else ""
    rooms = scene.config.room.faces is not None
    return [
        f"{scene.activity.label} {scene.activity.slug.replace('_', ' ')}",
        f"{band}, PRF {write_rounded(waveform.prf)} Hz",
        "through a wall" if scene.config.wall else "in a room" if rooms else "free space",
        noise if snr is None else f"SNR {decibels_in_words(nominal(snr))}",
        f"seed {scene.config.seed}",
    ]
