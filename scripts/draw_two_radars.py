"""Draw docs/images/two_radars.png: one scene as two radars see it, and how well they agree.

    python scripts/draw_two_radars.py

The upper rows are of two aspects of a walk, 90 degrees apart; the lowest is of two boards at one
place, one of them rolled by 90 degrees. The ranges that both aspects measure are turned into a
place in the room and compared with the true torso.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from draw_pictures import save_picture

from radhar_cli.config import Config, load_radars
from radhar_cli.figures.page import page
from radhar_cli.scene.single.simulate import Simulation, simulate

PICTURE = Path(__file__).resolve().parents[1] / "docs/images/two_radars.png"
ASPECTS = """
seed: 5
activities: [walking]
duration_s: 4
radar: {prf_hz: 5000, aspect: {distance_m: 4, about_m: [3, 0], height_m: 1.0}}
radars:
  front: {aspect: {angle_deg: 0}}
  side: {aspect: {angle_deg: 90}}
motion: {place: {range_m: 3, cross_range_m: 0}, angle_deg: 0}
maps: [stft, rtm]
"""
BOARDS = """
seed: 5
activities: [punching]
duration_s: 2
radar: {device: IWR1843BOOST, cfg: iwr1843boost, position_m: [0, 0, 1]}
radars:
  azimuth: {maps: [range_azimuth]}
  elevation: {roll_deg: 90, maps: [range_elevation]}
motion: {place: {range_m: 2.5, cross_range_m: 0.8}}
body: {scatterers: surfaces}
"""
SPAN_DB = 40.0


def main() -> None:
    """Simulate both scenes, draw them, and print how far the radars agree."""
    aspects, boards = (simulate_each(text) for text in (ASPECTS, BOARDS))
    figure = page(9.6, 9.6)
    axes = figure.subplots(3, 2)
    for column, (name, simulation) in enumerate(aspects.items()):
        drawn = draw_aspect(axes[0, column], axes[1, column], simulation, name)
    for column, (name, simulation) in enumerate(boards.items()):
        drawn_board = draw_board(axes[2, column], simulation, name)
    figure.colorbar(drawn, ax=list(axes[:2].flat), label="dB below the peak", pad=0.01, shrink=0.6)
    figure.colorbar(drawn_board, ax=list(axes[2]), label="dB below the peak", pad=0.01)
    save_picture(figure, PICTURE, 110, "python scripts/draw_two_radars.py")
    errors = place_errors(aspects)
    median, most = np.quantile(errors, [0.5, 0.9])
    print(f"torso by both ranges: off by {median:.3f} m in the median, 90 % below {most:.3f} m")
    for name, simulation in aspects.items():
        print(f"{name}: mean Doppler {mean_doppler(simulation):+.0f} Hz")


def simulate_each(text: str) -> dict[str, Simulation]:
    """Simulate the first sample of a config for each of its radars."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "config.yaml"
        path.write_text(text)
        configs: dict[str, Config] = load_radars(path)
    return {name: simulate(config) for name, config in configs.items()}


def decibels(power: Any) -> Any:
    """Power in dB below its largest value."""
    return 10 * np.log10(np.maximum(power / power.max(), 1e-12))


def true_range(simulation: Simulation) -> tuple[Any, Any]:
    """Times (s) and distance of the torso from the middle of the antennas (m), at every pulse."""
    truth, middle = simulation.truth, np.mean(simulation.antennas.places, axis=0)
    torso = truth.positions[:, simulation.motion.names.index("torso")]
    return truth.time, np.linalg.norm(torso - middle, axis=1)


def draw_aspect(above: Any, below: Any, simulation: Simulation, name: str) -> Any:
    """Draw Doppler and range over time of one radar, with what the torso really did."""
    angle = {"front": 0, "side": 90}[name]
    torso = simulation.motion.names.index("torso")
    tracks = simulation.truth.doppler[:, torso], true_range(simulation)[1]
    for axis, key, track in ((above, "stft", tracks[0]), (below, "rtm", tracks[1])):
        shown = simulation.maps[key]
        extent = (*shown.columns.edges, *shown.rows.edges)
        levels = {"vmin": -SPAN_DB, "vmax": 0}
        drawn = axis.imshow(
            decibels(shown.shown), aspect="auto", origin="lower", extent=extent, **levels
        )
        axis.plot(simulation.truth.time, track, "w--", lw=1)
        axis.set(xlabel="time (s)", xlim=(0, 4))
    above.set(title=f"{name}: looks along {angle} degrees", ylabel="Doppler (Hz)")
    above.set_ylim(-2500, 2500)  # +-PRF/2: no foot leaves the map
    below.set(ylabel="range (m)", ylim=(0, 10))
    return drawn


def draw_board(axis: Any, simulation: Simulation, name: str) -> Any:
    """Draw the strongest frame of a board's range-angle map, with the true joints at its time."""
    key = f"range_{name}"
    maps = simulation.frames[key].shown
    strongest = int(maps.power.sum(axis=(1, 2)).argmax())
    power = maps.power[strongest]
    cells = maps.columns.values, maps.rows.values, decibels(power)
    drawn = axis.pcolormesh(*cells, vmin=-30, vmax=0, shading="nearest")
    board = simulation.board
    assert board is not None
    middle = int(np.abs(simulation.truth.time - maps.times[strongest]).argmin())
    offset = simulation.truth.positions[middle] - np.array(board.position)
    x, y, z = offset.T
    angle = np.degrees(np.arctan2(y, x) if name == "azimuth" else np.arctan2(z, np.hypot(x, y)))
    distance = np.linalg.norm(offset, axis=1)
    unit = maps.columns.unit
    axis.plot(angle if unit.startswith("deg") else np.radians(angle), distance, "w.", ms=4)
    axis.set(
        title=f"{name}, {maps.times[strongest]:.2f} s: joints are dots",
        xlabel=f"{maps.columns.name} ({unit})",
        ylabel=f"{maps.rows.name} ({maps.rows.unit})",
        ylim=(1, 4),
    )
    if name == "azimuth":  # left of the radar is left
        axis.invert_xaxis()
    return drawn


def measured_range(simulation: Simulation) -> tuple[Any, Any]:
    """Times (s) and range of the strongest cell of the rtm (m) in each of its columns."""
    rtm = simulation.maps["rtm"]
    return rtm.columns.values, rtm.rows.values[rtm.power.argmax(axis=0)]


def place_errors(aspects: dict[str, Simulation]) -> Any:
    """Distances (m) of the torso from where the ranges of both aspects meet, at each column."""
    front, side = aspects["front"], aspects["side"]
    (t, r1), (_, r2) = measured_range(front), measured_range(side)
    (x1, y1), (x2, y2) = (np.mean(one.antennas.places, axis=0)[:2] for one in (front, side))
    torso = front.truth.positions[:, front.motion.names.index("torso")]
    at = np.stack([np.interp(t, front.truth.time, torso[:, axis]) for axis in range(3)], axis=1)
    lift = (at[:, 2] - 1.0) ** 2
    a, b = np.sqrt(np.maximum(r1**2 - lift, 0)), np.sqrt(np.maximum(r2**2 - lift, 0))
    base, (ex, ey) = np.hypot(x2 - x1, y2 - y1), np.array([x2 - x1, y2 - y1])
    along = (a**2 - b**2 + base**2) / (2 * base)
    across = np.sqrt(np.maximum(a**2 - along**2, 0))
    ex, ey = ex / base, ey / base
    place = np.stack([x1 + along * ex - across * ey, y1 + along * ey + across * ex], axis=1)
    return np.hypot(*(place - at[:, :2]).T)


def mean_doppler(simulation: Simulation) -> float:
    """Mean of the Doppler (Hz) that the torso has by the truth."""
    torso = simulation.motion.names.index("torso")
    return float(simulation.truth.doppler[:, torso].mean())


if __name__ == "__main__":
    main()
