"""The chain of people tracking, step by step, against numbers of an independent reference."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.scatterers import ISK, ODS, echo_of, repeatable_noise

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.people_tracking.capon import spectrum, weights, whitening
from radhar_cli.processing.people_tracking.chain import (
    PeopleTracker,
    firmware_doppler_step,
    track_people,
)
from radhar_cli.processing.people_tracking.detected_points import DetectedPoints
from radhar_cli.processing.people_tracking.grid import steering
from radhar_cli.processing.people_tracking.spectrum import decode_bpm, range_bins
from radhar_cli.processing.people_tracking.two_pass_cfar import (
    Cells,
    angle_noise,
    detect_moving,
    detect_static,
    range_noise,
)
from radhar_cli.radar.board import Board
from radhar_cli.radar.people_tracking import PeopleTracking
from radhar_cli.readers.ti.ti_commands import split_lines
from radhar_cli.readers.ti.ti_people import last_lines, read_people_tracking

VECTORS = json.loads((Path(__file__).parent / "vectors.json").read_text())
CASES: Mapping[str, Any] = {case["name"]: case for case in VECTORS["cases"]}
TOLERANCE = VECTORS["tolerances"]
HALF_DIGIT = 1e-8  # of nine printed digits


def complex_of(pairs: Any) -> Complex:
    values: Complex = np.array(pairs) @ np.array([1, 1j])
    return values


class Case:
    """A case of the vectors: its board, settings, samples and points."""

    def __init__(self, name: str) -> None:
        self.case = CASES[name]
        text = "\n".join(self.case["cfg"])
        lines = split_lines(text, name)
        words = {line.name: line.words for line in lines}
        self.masks = [int(line.words[-1]) for line in lines if line.name == "chirpCfg"]
        self.bpm = (int(words["bpmCfg"][2]), int(words["bpmCfg"][3])) if "bpmCfg" in words else None
        device = ISK if self.case["board"] == "ISK" else ODS
        self.board: Board = replace(
            device, samples=48, loops=24, bpm=self.bpm, masks=tuple(self.masks)
        )
        self.settings: PeopleTracking = read_people_tracking(
            last_lines(lines), 12, self.board.n_fft
        )
        cube = echo_of(self.board, self.case["scatterers"], self.masks, self.bpm)
        noise = self.case["noise"]
        self.cube = cube + repeatable_noise(cube.shape, noise["power"], noise["seed"])

    def moving(self, tracker: PeopleTracker) -> tuple[Complex, Float]:
        return tracker.map_of(self.bins(tracker).moving)

    def bins(self, tracker: PeopleTracker) -> Any:
        frame = decode_bpm(self.cube, self.board.sums, self.board.differences)
        return range_bins(frame, np.blackman(self.board.samples), tracker.turned)

    def points(self) -> DetectedPoints:
        tracker = PeopleTracker.of(self.settings)
        return tracker.find(self.bins(tracker), self.board.n_doppler)


def test_capon_spectrum_and_weights() -> None:
    vector = VECTORS["capon"]
    whitener = whitening(complex_of(vector["covariance"]), vector["gamma"])
    nu = np.array(vector["nu"])
    vectors = steering(-np.arange(4.0), np.zeros(4), nu, 0.0)
    assert spectrum(whitener, vectors) == pytest.approx(vector["spectrum"], rel=HALF_DIGIT)
    looking = weights(whitener, vectors[nu.tolist().index(0.3)])
    assert np.abs(looking - complex_of(vector["weights_at_nu_0_3"])).max() < 1e-12


def cfar_map() -> tuple[Float, Any]:
    vector = VECTORS["cfar"]
    lines = [line for line in CASES["walker_1"]["cfg"] if not line.startswith("dynamicRAC")]
    text = "\n".join([*lines, vector["line"]])
    settings = read_people_tracking(last_lines(split_lines(text, "cfar")), 12, 64)
    return np.array(vector["map"]), settings.dynamic


def test_noise_of_the_cfar_at_its_edges() -> None:
    power, cfar = cfar_map()
    noise = range_noise(power, cfar)[8]
    for k, value in VECTORS["cfar"]["range_noise_of_angle_8"].items():
        assert noise[int(k) - cfar.skip_range[0]] == pytest.approx(value, rel=HALF_DIGIT), k
    rows = VECTORS["cfar"]["angle_noise"]
    angles, bins = (np.array([row[name] for row in rows]) for name in ("angle", "bin"))
    cells = Cells(angles, bins, power[angles, bins], power[angles, bins])
    expected = [row["value"] for row in rows]
    assert angle_noise(power, cells, cfar) == pytest.approx(expected, rel=HALF_DIGIT)


@pytest.mark.parametrize(
    "name", ["detections", "detections_without_second_pass", "detections_static_rule"]
)
def test_detections_of_the_cfar(name: str) -> None:
    power, cfar = cfar_map()
    if name == "detections_static_rule":
        cells = detect_static(power, cfar)
    else:
        cells = detect_moving(power, replace(cfar, second_pass=name == "detections"))
    rows = np.column_stack([cells.bin, cells.angle, cells.power / cells.noise, cells.noise])
    expected = np.array(VECTORS["cfar"][name])
    assert rows.shape == expected.shape
    assert rows == pytest.approx(expected, rel=HALF_DIGIT)


@pytest.mark.parametrize("name", CASES)
def test_samples_sizes_map_and_cells(name: str) -> None:
    case = Case(name)
    for sample in case.case["cube"]:
        found = case.cube[tuple(sample["index"])]
        assert abs(found - complex(*sample["value"])) < TOLERANCE["cube"]
    tracker, sizes = PeopleTracker.of(case.settings), case.case["sizes"]
    assert len(tracker.vectors) == sizes["angles"]
    assert (case.board.n_fft, case.board.n_doppler) == (sizes["bins"], sizes["doppler_bins"])
    assert case.board.range_step_m == pytest.approx(sizes["range_step_m"], abs=1e-12)
    assert firmware_doppler_step(case.board) == pytest.approx(sizes["doppler_step_mps"], abs=1e-12)
    _, power = case.moving(tracker)
    for cell in case.case["power"]:
        expected = pytest.approx(cell["value"], rel=TOLERANCE["power_relative"])
        assert power[cell["angle"], cell["bin"]] == expected
    cells = detect_moving(power, case.settings.dynamic)
    assert cells.bin.size == case.case["cells_detected"]
    margin = np.abs(cells.power / (case.settings.dynamic.threshold[0] * cells.noise) - 1).min()
    assert margin > 0.9 * case.case["threshold_margin"]


@pytest.mark.parametrize("name", CASES)
def test_points(name: str) -> None:
    case = Case(name)
    points, expected = case.points(), np.array(case.case["points"])
    assert points.bin.size == len(expected)
    assert points.bin.tolist() == expected[:, 5].tolist()
    assert points.doppler.tolist() == expected[:, 6].tolist()
    assert points.azimuth == pytest.approx(expected[:, 1], abs=TOLERANCE["angle_rad"])
    assert points.elevation == pytest.approx(expected[:, 2], abs=TOLERANCE["angle_rad"])
    assert points.snr == pytest.approx(expected[:, 4], rel=TOLERANCE["snr_relative"])


@pytest.mark.parametrize("name", CASES)
def test_a_cloud_of_a_cube_in_single_precision_has_the_axes_of_the_radar(name: str) -> None:
    case = Case(name)
    cube = case.cube[None].astype(np.complex64)
    cloud = track_people(cube, case.board, case.settings)
    expected = np.array(case.case["points"])
    r, az, el, doppler, snr = expected[:, :5].T
    places = np.column_stack(
        [r * np.cos(el) * np.cos(az), -r * np.cos(el) * np.sin(az), r * np.sin(el), -doppler]
    )
    assert cloud.start.tolist() == [0, len(expected)]
    assert cloud.points[:, :4] == pytest.approx(places, abs=1e-4)
    assert cloud.points[:, 5] == pytest.approx(10 * np.log10(snr), abs=5e-3)
    assert cloud.points[:, 6].tolist() == expected[:, 5].tolist()
