"""Plots of the page of a scene, as plotly's JSON, of plain arrays."""

import base64
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from radhar_cli.config.image import ImageConfig
from radhar_cli.figures.page_plots import (
    MAX_SIDE,
    LevelScale,
    MapLevels,
    PointFrames,
    plot_map,
    plot_space,
)
from radhar_cli.figures.scene_view import MovingBody, SceneView, frame_times
from radhar_cli.processing.power_map import Axis

SCALE = LevelScale.of(ImageConfig(dynamic_range_db=40), "decibel")
TIME = Axis("time", "s", np.linspace(0, 1, 8))


def values_of(z: dict[str, Any]) -> Any:
    """Values of a packed array of plotly."""
    shape = [int(side) for side in z["shape"].split(", ")]
    return np.frombuffer(base64.b64decode(z["bdata"]), z["dtype"]).reshape(shape)


def test_levels_stand_for_decibels_below_the_peak() -> None:
    levels = np.array([[[0, 255], [51, 102]]], np.uint8)
    rows, columns = Axis("range", "m", np.array([1.0, 2.0])), Axis("time", "s", np.array([0.0, 1]))
    plot = plot_map(SceneView(np.array([0.0])), MapLevels("rtm", levels, SCALE, columns, rows))
    (trace,) = plot["data"]
    assert_allclose(values_of(trace["z"]), [[-40, 0], [-32, -24]], rtol=1e-6)
    assert (trace["zmin"], trace["zmax"]) == (-40, 0)
    assert (trace["x0"], trace["dx"], trace["y0"], trace["dy"]) == (0, 1, 1, 1)
    assert plot["cursor"]


def test_doppler_is_drawn_as_speed_with_the_curves_of_the_joints() -> None:
    doppler = Axis("frequency", "Hz", np.linspace(-100, 100, 5))
    time = frame_times(0.0, 1.0)
    view = SceneView(time, curves={"torso": np.full(9, 50.0)}, prf=250.0, hertz=50.0)
    levels = np.zeros((1, 5, 8), np.uint8)
    plot = plot_map(view, MapLevels("stft", levels, SCALE, TIME, doppler))
    assert plot["layout"]["yaxis"]["title"]["text"] == "approaching (m/s), 1 m/s = 50 Hz"
    assert_allclose(plot["layout"]["yaxis"]["range"], (-2.5, 2.5))
    _, key, torso = plot["data"]
    assert key["name"] == "true Doppler: click"
    assert (torso["name"], set(torso["y"])) == ("torso", {1.0})


def test_a_large_map_is_thinned() -> None:
    levels = np.zeros((1, 3 * MAX_SIDE, 8), np.uint8)
    rows = Axis("range", "m", np.arange(3.0 * MAX_SIDE))
    plot = plot_map(SceneView(np.array([0.0])), MapLevels("rtm", levels, SCALE, TIME, rows))
    assert values_of(plot["data"][0]["z"]).shape == (MAX_SIDE, 8)


def test_a_frame_map_shows_the_nearest_frame() -> None:
    levels = np.zeros((3, 4, 5), np.uint8)
    rows, columns = Axis("range", "m", np.arange(4.0)), Axis("azimuth", "degree", np.arange(5.0))
    times = np.array([0.1, 0.5, 0.9])
    view = SceneView(np.array([0.0, 0.4, 1.0]))
    frames = MapLevels("range_azimuth", levels, SCALE, columns, rows, times)
    (move,) = plot_map(view, frames)["moves"]
    assert move["at"].tolist() == [0, 1, 2]
    assert len(move["frames"]["z"]) == 3


@pytest.mark.parametrize("with_body", [True, False])
def test_points_and_bodies_lie_in_the_box(with_body: bool) -> None:
    bones = np.zeros((2, 1, 2, 4))
    bones[..., :3] = 3.0
    body = MovingBody("S8 walking", ("head",), bones)
    view = SceneView(np.array([0.0, 1.0]), [body] if with_body else [])
    points = np.array([[5.0, 0.0, 1.0, 0.2], [5.0, 1.0, 1.0, -0.2]])
    cloud = PointFrames(np.array([0.0, 1.0]), np.array([0, 1, 2]), points)
    plot = plot_space(view, cloud, None)
    names = [trace["name"] for trace in plot["data"]]
    assert names == [*["S8 walking"] * with_body, "points", "radar"]
    low, high = plot["layout"]["scene"]["xaxis"]["range"]
    assert low == pytest.approx(-0.3)
    assert high == pytest.approx(3.3 if with_body else 5.3)
    assert plot["moves"][-1]["frames"]["x"] == [[5.0], [5.0]]
