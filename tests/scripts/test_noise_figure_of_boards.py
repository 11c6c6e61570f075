"""scripts/studies/noise_figure_of_boards.py: counts, the choice, and tables of made-up clouds."""

from typing import NamedTuple

import noise_figure_of_boards as study
import numpy as np
import pytest
from helpers.boards import CFG
from helpers.command_line import ROOT

from radhar_cli.config.data_set import Config
from radhar_cli.scene import nominal_scene


class Points(NamedTuple):
    points: np.ndarray
    start: np.ndarray


def test_the_figure_nearest_in_the_half_that_chooses_is_chosen() -> None:
    counts = {figure: [study.Count(40.0 - figure, 1.0)] for figure in study.FIGURES_DB}
    chooses = study.Comparison("a", True, study.Count(19.0, 1.0), counts)
    reports = study.Comparison("b", False, study.Count(5.0, 1.0), counts)
    assert study.choose([chooses, reports]) == 20
    assert chooses.distance(20) == pytest.approx(np.log2(20 / 19))
    lines = study.describe_comparisons([chooses, reports])
    assert any("19.0; 1.0" in line and "chooses" in line for line in lines)


def test_points_outside_the_person_and_other_frames_do_not_count() -> None:
    frame = np.array([0, 0, 1, 1, 3])
    points = np.zeros((5, 6))
    points[:, 5] = 1.5, 9.0, 1.5, 1.5, 1.5  # range
    points[:, 3] = 0.615, 0.615, 0.01, -0.615, 0.615
    speeds = study.person_speeds(frame, points, 0, 3)
    assert [len(one) for one in speeds] == [1, 2, 0]
    assert study.count(speeds) == (1.0, pytest.approx(2 / 3))


def test_moving_points_are_counted_in_each_frame() -> None:
    points = np.zeros((4, 8))
    points[:, 3] = 0.5, 0, 0, -0.5
    points[:, 5] = 10, 20, 30, 40
    counts, snr = study.moving_points(Points(points, np.array([0, 2, 2, 4])))
    assert counts.tolist() == [1, 0, 1]
    assert snr.tolist() == [10, 40]


def test_more_noise_on_the_same_echo_leaves_fewer_points() -> None:
    document = {
        "radar": {"device": "IWR1443BOOST", "cfg": CFG},
        "activities": ["punching"],
        "duration_s": 0.5,
        "body": {"scatterers": "surfaces"},
        "maps": ["points"],
    }
    config = Config.model_validate(document)
    scene = nominal_scene(config, config.chosen_activities[0])
    clouds = dict(study.clouds_by_figure(scene))
    counts = [len(clouds[figure].points) for figure in study.FIGURES_DB]
    assert sorted(clouds) == list(study.FIGURES_DB)
    assert counts[0] > counts[3] > counts[-1]


def test_walkers_are_two_people_before_an_1843() -> None:
    text = (ROOT / "radhar_cli/config/radars/iwr1843boost.cfg").read_text()
    config = Config.model_validate(study.walkers_document(text, 3))
    assert config.radar.device == "IWR1843BOOST"
    assert len(config.people) == 1
    assert config.receiver.noise_figure_db == 30
