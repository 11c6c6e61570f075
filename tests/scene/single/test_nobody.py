"""Scenes in which nobody is: the room and the noise alone, for every product that people have."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import boards
from helpers.command_line import ok, radhar
from pydantic import ValidationError

from radhar_cli.config import Config, load_config
from radhar_cli.config.checks.doubts import word_warnings
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.sample import labels_of
from radhar_cli.figures.frames_panel import draw_cloud, draw_frames
from radhar_cli.figures.frames_panel import of_simulation as frames_of_simulation
from radhar_cli.figures.scene_page import of_simulation, write_page
from radhar_cli.figures.stickman import draw_stickman
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.tasks.count import Count
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene, nominal_scene
from radhar_cli.scene.single.simulate import simulate

FMCW = {"carrier_hz": 5.8e9, "bandwidth_hz": 2e8, "prf_hz": 200, "adc_rate_hz": 5e5}
BAND = {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 200}
RADARS: dict[str, dict[str, Any]] = {
    "fmcw": FMCW,
    "sfcw": {**BAND, "waveform": "sfcw", "steps": 40, "dwell_s": 2e-6},
    "cw": {"carrier_hz": 24e9, "prf_hz": 400, "waveform": "cw"},
    "impulse": {**BAND, "waveform": "impulse", "profile_m": [0.2, 6], "profile_samples": 500},
    "impulse iq": {
        **{**BAND, "waveform": "impulse", "output": "iq"},
        **{"profile_m": [0.2, 6], "profile_samples": 80},
    },
    "board": {"cfg": boards.CFG, "device": "IWR1443BOOST"},
}


def config_of(radar: str = "fmcw", **more: Any) -> Config:
    document: dict[str, Any] = {
        "duration_s": 1,
        "samples_per_class": 3,
        "radar": RADARS[radar],
        "activities": ["nobody", "stationary"],
        "motion": {"range_m": 2},
        "snr_db": 10,
        "image": {"size_px": 32},
    }
    document |= more
    if radar == "impulse":
        document["processing"] = {"range_sum": "gated", **document.get("processing", {})}
    if radar.startswith("impulse"):
        document.pop("engine", None)
    return Config(**document)


@pytest.mark.parametrize("radar", RADARS)
@pytest.mark.parametrize("engine", ["direct", "cube"])
@pytest.mark.parametrize("room", [{}, {"reflectors": [{}]}])
def test_noise_is_that_of_who_would_stand_there(radar: str, engine: str, room: Any) -> None:
    config = config_of(radar, engine={"kind": engine}, room=room, snr_reference="received")
    nobody, stander = config.chosen_activities
    sigma, stander_sigma = (
        record(nominal_scene(config, activity), ["noise_sigma"])["noise_sigma"]
        for activity in (nobody, stander)
    )
    assert sigma > 0
    assert sigma == pytest.approx(stander_sigma, rel=1e-3)


@pytest.mark.parametrize("radar", [radar for radar in RADARS if radar != "board"])
def test_nothing_but_the_room_makes_an_echo(radar: str) -> None:
    silent: dict[str, Any] = {"snr_db": None, "processing": {"clutter": "none"}}
    config = config_of(radar, **silent)
    isolated = config.radar.model_copy(update={"antenna_isolation_db": 300.0})  # 1e-15 leaks
    empty = simulate(config.model_copy(update={"radar": isolated}), "nobody")
    assert all(np.abs(signal.x).max() < 1e-11 for signal in empty.signals.values())
    assert not empty.warnings
    reflectors = {"reflectors": [{"position_m": [2, 1, 1], "rcs_dbsm": 0}]}
    with_room = simulate(config_of(radar, room=reflectors, **silent), "nobody")
    assert all(signal.x.any() for signal in with_room.signals.values())


def test_a_person_scene_is_the_same_beside_the_class_of_nobody() -> None:
    config = config_of(activities=["stationary"])
    beside = config_of()
    alone, other = (simulate(one, "stationary").maps["stft"].power for one in (config, beside))
    assert np.array_equal(alone, other)


def test_truth_and_figures_of_a_board_know_nobody(tmp_path: Path) -> None:
    config = config_of("board", maps=["range_doppler", "points", "stft"], snr_db=40)
    empty = simulate(config, "nobody")
    assert np.isnan(empty.truth.positions).all()
    assert empty.truth.phases == ("nobody",)
    assert np.isnan(empty.frames["skeletons"].positions).all()
    assert (empty.frames["points_person"] == -1).all()

    def advance(steps: int) -> None:
        assert steps == 1

    draw_frames(frames_of_simulation(empty), tmp_path / "frames.png")
    draw_cloud(frames_of_simulation(empty), tmp_path / "cloud.gif", advance)
    draw_stickman(empty, tmp_path / "stickman.gif", advance)
    write_page([of_simulation(empty)], tmp_path / "view.html")


@pytest.mark.parametrize("model", ["paper", "file"])
def test_other_models_of_motion_have_nobody_too(model: str) -> None:
    config = config_of(activities=["nobody"], motion={"model": model, "range_m": 2})
    empty = simulate(config, "nobody")
    assert empty.maps["stft"].power.any()


def test_others_stay_away_from_an_empty_scene() -> None:
    people = [{"motion": {"range_m": 5}}, {"activity": "kicking", "motion": {"range_m": 7}}]
    config = config_of(people=people, activities=["nobody", "stationary"])
    nobody, stander = config.chosen_activities
    empty, full = (draw_scene(config, activity, 0) for activity in (nobody, stander))
    assert len(empty.people) == 1
    assert empty.present == ()
    assert len(full.present) == 3
    of_empty, of_full = (labels_of(scene, config) for scene in (empty, full))
    slugs = [activity.slug for activity in config.every_class]
    assert (of_empty["person_label"] == -1).all()
    assert np.flatnonzero(of_empty["labels"]).tolist() == [slugs.index("nobody")]
    assert (of_full["person_label"] >= 0).all()


def test_nobody_counts_as_none(tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text(
        "duration_s: 0.5\nsamples_per_class: 3\nsplit: {train: 1.0, validation: 0.0}\n"
        "radar: {carrier_hz: 5.8e9, bandwidth_hz: 2e8, prf_hz: 200, adc_rate_hz: 5e5}\n"
        "activities: [nobody, walking]\n"
        "motion: {range_m: 3}\nimage: {size_px: 24}\noutput: {column_labels: true}\n"
        "people: [{motion: {range_m: 5}}]\n"
    )
    ok("generate", path, "-o", tmp_path / "set", "--jobs", 1)
    ok("verify", tmp_path / "set")
    ok("view", tmp_path / "set", "-o", tmp_path / "v.html")
    with open_dataset(tmp_path / "set") as data:
        names = data.file.json("label_names") if data.file.has_attribute("label_names") else None
        labels = data.column_label["stft"][:]
        assert names is None or names[labels[0, 0]] == "nobody"
        assert (labels[data.label == 0] == labels[0, 0]).all()
    images = open_images(tmp_path / "set", None, "rgb")
    counted = Count.relabel(None, images)  # type: ignore[arg-type]
    assert counted.classes == ("0 people", "2 people")
    assert [counted.classes[n] for n in counted.samples.label[:3]] == ["0 people"] * 3


def test_who_is_not_there_has_no_motion_to_write(tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text("activities: [nobody]\n")
    for command in (("motion",), ("simulate", "--joint", "head", "--no-figures")):
        done = radhar(command[0], path, "-o", tmp_path / "out.bvh", *command[1:])
        assert done.returncode == 2
        assert "nobody is there" in done.stderr


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"classes": {"empty": {"sequence": []}}, "activities": ["empty"]}, "activities: [nobody"),
        ({"classes": {"empty": {"sequence": ["nobody"]}}}, "should be called nobody"),
        ({"classes": {"x": {"sequence": ["walking", "nobody"]}}}, "without nobody"),
        ({"people": [{"activity": "nobody"}]}, "share is how often"),
    ],
)
def test_nobody_is_a_class_alone(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message.replace("[", re.escape("["))):
        config_of(**wrong)


def test_another_word_for_nobody_advises_no_class_that_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text("activities: [empty_room, walking]\n")
    (warning,) = word_warnings(load_config(path))
    assert warning == "empty_room is taken for nobody"
