"""Set every built-in radar beside its data sheet: the table of docs/guide/radars.md, its picture.

    python scripts/draw_radars.py COMMIT [-o docs/images] [--seed 7] [--pictures]

Each radar of `radhar config init --radar list` is asked for its figures (range step and end, speed
limit and step, rate, antennas, width of a beam), which stand beside those of its maker
(scripts/radars_by_data_sheet.yaml, typed, each with its source). The same person then walks past
each radar, 0.5 m to its left, from 4.2 m on. radars.png, and radars_ti.png of TI's boards, have
what it sees: ranges or a range-Doppler frame, speeds, and points from above where it has an array.
"""

import argparse
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from draw_pictures import save_picture
from matplotlib.axes import Axes
from page_parts import replace_part

from radhar_cli.config import Config, load_config
from radhar_cli.config.documents import RADARS, WRITTEN_RADARS
from radhar_cli.config.identity import yaml_text
from radhar_cli.config.radar import CwRadar
from radhar_cli.config.starting_file import of_board
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.figures.page import page
from radhar_cli.figures.style import SPEEDS
from radhar_cli.numerics.arrays import Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.scene.radar_figures import RadarFigures, describe_figures, figures_of
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.simulate import Simulation, simulate

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/guide/radars.md"
SHEETS = Path(__file__).with_name("radars_by_data_sheet.yaml")
FROM_M, LEFT_M, SECONDS = 4.2, 0.5, 2.5
NEAR_M = 3.0  # range of the torso at which levels are compared with the noise
# Radars of each picture: every written one, and of TI's boards one a device.
PICTURES = {
    "radars.png": tuple(WRITTEN_RADARS),
    "radars_ti.png": tuple(
        name for name in RADARS if name.endswith("_clouds") or name == "iwr1443boost"
    ),
}
HEAD = (
    "| name | range: step, to | speed: step, to | a second | antennas, beam "
    "| its maker | a walker at 3 m |\n| --- | --- | --- | --- | --- | --- | ---: |"
)
UNITS = {
    "range_step_m": "m steps",
    "last_range_m": "m",
    "speed_limit_mps": "m/s",
    "speed_step_mps": "m/s steps",
    "rate_hz": "Hz",
    "azimuth_deg": "degrees",
    "elements": "elements",
}
MEMORY, CALCULATED = "memory", "calculated"  # sources that nobody can look up


@dataclass(frozen=True)
class Sheet:
    """What a maker says of a radar.

    Attributes:
        band: Band that is used, in words.
        figures: {figure: (value, source)}, as of `RadarFigures`.
        antennas: Transmitters x receivers, and source.
    """

    band: str
    figures: Mapping[str, tuple[float, str]]
    antennas: tuple[str, str]


def read_sheets() -> tuple[dict[str, Sheet], dict[str, str], dict[str, float]]:
    """Read what makers say.

    Returns:
        Sheets by the names of radars, {source: where it is}, and {figure: tolerance}, as shares.
    """
    text, _ = parse_yaml(SHEETS.read_text(), SHEETS.name)
    names = {field.name for field in fields(RadarFigures)}
    sheets = {}
    for name, row in text["radars"].items():
        figures = {key: (float(row[key][0]), row[key][1]) for key in row if key in names}
        sheets[name] = Sheet(row["band"], figures, tuple(row["antennas"]))
    return sheets, text["sources"], text["tolerances"]


def load_radar(name: str, more: Mapping[str, Any] | None = None) -> Config:
    """Load the config that `config init --radar` writes, with some sections replaced."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "radar.yaml"
        document, _ = parse_yaml(of_board(name, path.parent), name)
        path.write_text(yaml_text(document | dict(more or {})))
        return load_config(path)


def compute_figures(name: str) -> RadarFigures:
    """Compute the figures of a built-in radar."""
    config = load_radar(name)
    return figures_of(draw_scene(config, config.chosen_activities[0], 0))


def walk_to(name: str, seed: int) -> Simulation:
    """Simulate the person who walks to a radar, with the maps of its config and points."""
    walk = {
        "seed": seed,
        "activities": ["walking"],
        "duration_s": SECONDS,
        "motion": {"range_m": FROM_M, "cross_range_m": LEFT_M, "angle_deg": 180},
        "subject": {"height_m": 1.75},
        "body": {"scatterers": "surfaces"},
        "on_invalid": "keep",
    }
    config = load_radar(name, walk)
    return simulate(config, "walking")


def level_above_noise(simulation: Simulation) -> float:
    """Level of the walker at 3 m over the noise of a cell, dB.

    Its map is the range-Doppler frame, the range-time map, or without range the spectrogram; the
    noise is that of a cell's mean power, by the median of the map.
    """
    frames = simulation.frames.get("range_doppler")
    if frames is not None:
        moment = int(np.argmin(np.abs(_torso_at(simulation, frames.times) - NEAR_M)))
        power = frames.power[moment]
        return _decibels(power.max() / (np.median(power) / np.log(2)))
    shown = simulation.maps.get("rtm", simulation.maps.get("stft"))
    assert shown is not None
    near = np.abs(_torso_at(simulation, shown.columns.values) - NEAR_M) < 0.1
    return _decibels(shown.power[:, near].max() / (np.median(shown.power) / np.log(2)))


def _decibels(ratio: float) -> float:
    return float(10 * np.log10(ratio))


def _torso_at(simulation: Simulation, times: Float) -> Float:
    """Ranges of the torso at times, m."""
    truth = simulation.truth
    path = np.linalg.norm(truth.positions[:, 0] - _place_of(simulation), axis=-1)
    return np.interp(times, truth.time, path)


def _place_of(simulation: Simulation) -> Float:
    """Middle of the antennas, m."""
    antennas = simulation.antennas
    return (np.array(antennas.tx) + np.array(antennas.rx)) / 2


def table_row(name: str, figures: RadarFigures, sheet: Sheet, level_db: float) -> str:
    """Row of a radar in the table."""
    cells = [
        f"`{name}`",
        _range_cell(figures),
        _speed_cell(figures),
        f"{figures.rate_hz:.5g} {'frames' if figures.has_frames else 'pulses'}",
        _antenna_cell(figures),
        _sheet_cell(sheet),
        f"{level_db:.0f} dB",
    ]
    return f"| {' | '.join(cells)} |"


def _range_cell(figures: RadarFigures) -> str:
    if figures.range_step_m is None or figures.last_range_m is None:
        return "none"
    return f"{100 * figures.range_step_m:.3g} cm, {figures.last_range_m:.3g} m"


def _speed_cell(figures: RadarFigures) -> str:
    if figures.speed_limit_mps is None or figures.speed_step_mps is None:
        return "none"
    return f"{figures.speed_step_mps:.2g}, ±{figures.speed_limit_mps:.3g} m/s"


def _antenna_cell(figures: RadarFigures) -> str:
    parts = [f"{figures.transmitters} x {figures.receivers}"]
    if figures.elements > 1:
        parts.append(f"{figures.elements} elements")
    if figures.azimuth_deg is not None:
        parts.append(f"{figures.azimuth_deg:.0f}° wide")
    if figures.elevation_deg is not None:
        parts.append(f"{figures.elevation_deg:.0f}° high")
    return ", ".join(parts)


def _sheet_cell(sheet: Sheet) -> str:
    """What the maker says that was looked up; what is remembered; nothing that is calculated."""
    said = [f"{value:.5g} {UNITS[key]}" for key, (value, source) in _with_source(sheet, False)]
    remembered = [f"{value:.5g} {UNITS[key]}" for key, (value, source) in _with_source(sheet, True)]
    parts = [sheet.band, *said]
    if remembered:
        parts.append(f"from memory: {', '.join(remembered)}")
    return "; ".join(parts)


def _with_source(sheet: Sheet, is_memory: bool) -> list[tuple[str, tuple[float, str]]]:
    return [
        (key, figure)
        for key, figure in sheet.figures.items()
        if figure[1] != CALCULATED and (figure[1] == MEMORY) is is_memory and figure[1] != "ti"
    ]


def draw_panels(walks: Mapping[str, Simulation], path: Path) -> None:
    """Draw three panels a radar, one radar a row, in letters that a page's width leaves legible."""
    figure = page(9.6, 1.9 * len(walks) + 0.6)
    grid = figure.subplots(len(walks), 3, squeeze=False)
    for panels, (name, simulation) in zip(grid, walks.items(), strict=True):
        _draw_radar(panels, name, simulation)
    drawn = next(axes.images[0] for axes in grid.flat if axes.images)
    where: dict[str, Any] = {"ax": list(grid[0]), "location": "top", "shrink": 0.5, "aspect": 40}
    figure.colorbar(drawn, label="maps: dB below the peak of each", **where)
    save_picture(figure, path, 100, "python scripts/draw_radars.py --pictures COMMIT")


def _draw_radar(panels: Any, name: str, simulation: Simulation) -> None:
    """Draw what a radar sees: ranges, speeds, and points or its figures in words."""
    _draw_ranges(panels[0], simulation)
    panels[0].set_title(name, loc="left", weight="bold")
    if "stft" in simulation.maps:
        spectrogram = simulation.maps["stft"]
        hertz = SPEED_OF_LIGHT / (2 * simulation.waveform.f0)
        left, right, low, high = spectrogram.extent
        _draw_map(panels[1], spectrogram.power, (left, right, low * hertz, high * hertz))
        panels[1].set(xlabel="time (s)", ylabel="approaching (m/s)", xlim=(0, SECONDS))
    else:
        _write_instead(panels[1], "no Doppler")
    if "cloud" in simulation.frames:
        _draw_cloud(panels[2], simulation)
    else:
        words = describe_figures(compute_figures(name)).replace("+-", "±")
        _write_instead(panels[2], words.replace(", ", "\n").replace(" in ", "\nin "))


def _draw_ranges(axes: Axes, simulation: Simulation) -> None:
    """Draw the range-Doppler frame with the torso at 3 m, or ranges over time."""
    frames = simulation.frames.get("range_doppler")
    if frames is not None:
        moment = int(np.argmin(np.abs(_torso_at(simulation, frames.times) - NEAR_M)))
        _draw_map(axes, frames.shown.power[moment], frames.extent)
        axes.set(xlabel="approaching (m/s)", ylabel="range (m)", ylim=(0, 6))
    elif "rtm" in simulation.maps:
        shown = simulation.maps["rtm"]
        _draw_map(axes, shown.power, shown.extent)
        highest = min(6.0, shown.extent[3])
        axes.set(xlabel="time (s)", ylabel="range (m)", xlim=(0, SECONDS), ylim=(0, highest))
    else:
        assert isinstance(simulation.config.radar, CwRadar)
        _write_instead(axes, "no range")


def _write_instead(axes: Axes, words: str) -> None:
    """Write words in the middle of a panel that has nothing to draw."""
    axes.set_axis_off()
    where = {"ha": "center", "va": "center", "transform": axes.transAxes}
    axes.text(0.5, 0.5, words, fontsize=10, linespacing=1.4, **where)


def _draw_map(axes: Axes, power: Float, extent: tuple[float, float, float, float]) -> None:
    """Draw a map in dB below its peak, to -50 dB."""
    with np.errstate(divide="ignore"):
        level = 10 * np.log10(power / power.max())
    look: dict[str, Any] = {"cmap": "viridis", "origin": "lower", "aspect": "auto"}
    axes.imshow(level, extent=extent, vmin=-50, vmax=0, interpolation="nearest", **look)


def _draw_cloud(axes: Axes, simulation: Simulation) -> None:
    """Draw the points of all frames from above over the torso's way; left of the radar is left."""
    cloud, skeletons = simulation.frames["cloud"], simulation.frames.get("skeletons")
    ahead, left = cloud.points[:, 0], cloud.points[:, 1]
    axes.scatter(left, ahead, s=5, c=cloud.points[:, 3], cmap=SPEEDS, vmin=-2, vmax=2)
    if skeletons is not None:
        torso = skeletons.positions[:, 0, 0]
        axes.plot(torso[:, 1], torso[:, 0], color="0.4", linewidth=1)
    axes.set(xlim=(2, -2), ylim=(0, 6), xlabel="left (m)", ylabel="ahead (m)")


def main() -> None:
    """Write the table and draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commit", help="commit that is measured")
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs/images")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--pictures", action="store_true", help="leave the page as it is")
    arguments = parser.parse_args()
    sheets, sources, _ = read_sheets()
    drawn, rows = {*chain.from_iterable(PICTURES.values())}, []
    walks = dict[str, Simulation]()
    for name in (*WRITTEN_RADARS, *RADARS):
        if arguments.pictures and name not in drawn:
            continue
        walk = walk_to(name, arguments.seed)
        rows.append(table_row(name, compute_figures(name), sheets[name], level_above_noise(walk)))
        print(rows[-1], flush=True)
        if name in drawn:
            walks[name] = walk
    for picture, names in PICTURES.items():
        draw_panels({name: walks[name] for name in names}, arguments.out / picture)
    if arguments.pictures:
        return
    command = f"python scripts/draw_radars.py COMMIT --seed {arguments.seed}"
    note = f"(`{command}`, at {arguments.commit})"
    text = replace_part(PAGE.read_text(), "radars", "\n".join((HEAD, *rows, "", note)))
    listed = [f"- {name}: {where}" for name, where in sources.items() if name != CALCULATED]
    PAGE.write_text(replace_part(text, "sources", "\n".join(listed)))


if __name__ == "__main__":
    main()
