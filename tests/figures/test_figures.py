"""Figures are drawn whole, for scenes that are ordinary and for scenes that are not."""

import weakref
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from radhar_cli.config import MAP_NAMES, load_config
from radhar_cli.config.image import ImageConfig
from radhar_cli.dataset.contact_sheet import draw_contact_sheet
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.figures.maps_panel import (
    MOST_COLUMNS,
    MapsPage,
    columns_that_show,
    decibels,
    describe_scene,
    draw_map,
    draw_maps,
    of_simulation,
)
from radhar_cli.figures.page import page
from radhar_cli.figures.sides import UNCHANGED, gif_blocks
from radhar_cli.figures.stickman import draw_stickman, frame_count
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.scene.radar import waveform_of
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.simulate import simulate

ROOT = Path(__file__).resolve().parents[2]
WALL = ROOT / "configs/paper/figures_through_wall.yaml"
FREE = ROOT / "configs/paper/free_space.yaml"


def colours(path):
    with Image.open(path) as picture:
        return len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0))


@pytest.mark.parametrize(
    ("activity", "overrides", "joint", "maps"),
    [
        ("S12", [], None, MAP_NAMES),
        ("S1", ["snr_db=null"], None, ("rtm",)),
        ("S8", ["wall=null"], "right_ankle", ("stft",)),
    ],
)
def test_maps_are_drawn(activity, overrides, joint, maps, tmp_path):
    simulation = simulate(load_config(WALL, overrides), activity, joint=joint, maps=maps)
    draw_maps(of_simulation(simulation, overlay=True), tmp_path / "maps.png")
    assert colours(tmp_path / "maps.png") > 200


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["snr_db={uniform: [15.01, 15.04]}"], "SNR 15 dB"),
        (["snr_db=-0.01"], "SNR 0 dB"),
        (["snr_db=25.3"], "SNR 25 dB"),
        (["snr_db=2.53"], "SNR 2.5 dB"),
        (["radar.carrier_hz=77.42e9", "radar.bandwidth_hz=2.89811e9"], "77.4 to 80.3 GHz, "),
        (["radar.prf_hz={uniform: [1333.31, 1333.33]}"], "PRF 1330 Hz"),
        (["radar.bandwidth_hz=76.75e6"], "77.000 to 77.077 GHz"),
    ],
)
def test_title_rounds_what_laws_have_drawn(overrides, words):
    scene = draw_scene(load_config(FREE, overrides), activity_named("walking"), 0)
    assert words in "   |   ".join(describe_scene(scene, waveform_of(scene)))


def test_stickman_plays_at_true_speed_and_moves(tmp_path):
    simulation = simulate(load_config(WALL, ["duration_s=0.7"]), "S12", maps=("stft",))
    done: list[int] = []
    draw_stickman(simulation, tmp_path / "stickman.gif", done.append)
    assert sum(done) == frame_count(simulation) == 14
    with Image.open(tmp_path / "stickman.gif") as film:
        assert film.n_frames * film.info["duration"] == 700
        first = np.asarray(film.convert("RGB")).astype(int)
        film.seek(13)
        later = np.asarray(film.convert("RGB")).astype(int)
    assert (np.abs(first - later).sum(axis=2) > 60).sum() > 500


def test_contact_sheet_shows_every_class(small_set, tmp_path):
    with open_dataset(small_set) as data:
        draw_contact_sheet(data, "stft", 2, tmp_path / "sheet.png")
        assert len(data) == 9
    assert colours(tmp_path / "sheet.png") > 100


def test_decibels_of_an_all_zero_map_are_the_floor():
    assert (decibels(np.zeros((3, 4)), 50.0) == -50).all()
    found = decibels(np.array([[1.0, 0.1, 0.0]]), 50.0)
    assert found == pytest.approx(np.array([[0, -10, -50]]), rel=1e-15, abs=0)
    assert found[0, 2] == -50


def test_a_film_holds_few_frames_at_a_time(tmp_path):
    """A GIF reads back as it was drawn, and what does not change is shown for longer."""
    rng = np.random.default_rng(0)
    palette = rng.integers(0, 256, 3 * UNCHANGED)
    alive, most = [], 0

    def frames():
        nonlocal most
        for number in range(40):
            picture = Image.fromarray(drawn[number], "P")
            picture.putpalette(palette.tolist())
            alive.append(weakref.ref(picture))
            most = max(most, sum(one() is not None for one in alive))
            yield picture
            del picture

    drawn = [np.zeros((30, 50), np.uint8)]
    for number in range(1, 40):
        drawn.append(drawn[-1].copy())
        if number % 5:
            drawn[-1][number % 20 : number % 20 + 7, number : number + 5] = rng.integers(0, 255)
    path = tmp_path / "film.gif"
    path.write_bytes(b"".join(gif_blocks(frames(), 50)))
    assert most <= 3
    shown = []
    with Image.open(path) as film:
        for number in range(film.n_frames):
            film.seek(number)
            shown += [np.asarray(film.convert("RGB"))] * (film.info["duration"] // 50)
    assert film.n_frames == 40 - 7
    colours = palette.reshape(-1, 3).astype(np.uint8)
    assert all((one == colours[two]).all() for one, two in zip(shown, drawn, strict=True))


@pytest.mark.parametrize(("highest", "unit", "edge"), [(200.0, "Hz", 225.0), (4000.0, "kHz", 4.5)])
def test_the_doppler_axis_is_in_the_unit_that_it_names(highest, unit, edge):
    rows = Axis("frequency", "Hz", np.linspace(-highest, highest, 9))
    power_map = PowerMap(np.ones((9, 5)), rows, Axis("time", "s", np.arange(5.0)))
    axes = page(4, 4).subplots()
    draw_map(axes, "stft", MapsPage({"stft": power_map}, ImageConfig(), 1e10, 5.0, "a title"))
    assert axes.get_ylabel() == f"Doppler ({unit})"
    assert axes.get_ylim() == pytest.approx((-edge, edge))
    assert axes.get_xlabel() == "time (s)"


def test_of_a_long_map_means_of_columns_are_drawn():
    cells = np.arange(2 * (3 * MOST_COLUMNS + 1)).reshape(2, -1).astype(float)
    drawn = columns_that_show(cells)
    assert drawn.shape == (2, 3 * MOST_COLUMNS // 4 + 1)
    assert drawn[0, :2].tolist() == [1.5, 5.5]
    assert drawn[1, -1] == cells[1, -1]
    assert columns_that_show(cells[:, :MOST_COLUMNS]).shape == (2, MOST_COLUMNS)
