"""The firmware's point clouds: thresholds, places, directions and biases of its chain."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers.boards import MARS, cube_of
from hypothesis import example, given, settings
from hypothesis import strategies as st

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.points import COLUMNS, _peaks, board_points
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.detection import (
    CA,
    CAGO,
    CASO,
    Cfar,
    Demo,
    Detection,
    demo_of_sdk3,
    ti_threshold_db,
)
from radhar_cli.readers.ti.ti_commands import split_lines
from radhar_cli.readers.ti.ti_detection import read_detection

DETECTION = Detection(
    Cfar(CASO, 8, 4, False, ti_threshold_db(1130, 12)),
    first_bin=1,
    last_bin=114,
    second_peak=0.5,
    remove_mean=True,
)
STANDING = replace(DETECTION, remove_mean=False)


def points(p: Any, v: Any, detection: Detection = DETECTION, **more: Any) -> Float:
    """Of one frame, the strongest first."""
    quantise, carrier = more.pop("quantise", True), more.pop("carrier", None)
    cube, board = cube_of(p, v, **more)
    found = board_points(cube, board, detection, quantise, carrier).points
    return found[np.argsort(-found[:, 4], kind="stable")]


def test_thresholds_of_the_sdk() -> None:
    assert ti_threshold_db(1130, 12) == pytest.approx(17.717, abs=1e-3)
    assert ti_threshold_db(384, 12) == pytest.approx(20 * np.log10(2))
    assert ti_threshold_db(512, 8) == pytest.approx(20 * np.log10(2))


def test_an_approaching_scatterer() -> None:
    best = points((2, 0, 0), (-1, 0, 0))[0]
    assert np.hypot(*best[:2]) == pytest.approx(2, abs=0.0146 + 0.04)
    assert best[3] == pytest.approx(1.0366, abs=1e-4)
    assert best[7] == 3
    started = points((2, 0, 0), (-1, 0, 0), carrier=MARS.start_hz)[0]
    assert started[3] == pytest.approx(1.0673, abs=1e-4)


@example(r=1.0, az=1.0625, el=0.0, seed=0)  # near: waves are not plane
@settings(max_examples=40)
@given(r=st.floats(1, 3), az=st.floats(-60, 60), el=st.floats(-20, 25), seed=st.integers(0, 1000))
def test_places_of_what_stands_still(r: float, az: float, el: float, seed: int) -> None:
    az, el = np.radians(az), np.radians(el)
    u = np.array([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), np.sin(el)])
    best = points(r * u, (0, 0, 0), STANDING, seed=seed)[0]
    distance = np.linalg.norm(best[:3])
    assert distance == pytest.approx(r, abs=0.0146 + 0.02 * r)
    assert best[1] / distance == pytest.approx(u[1], abs=0.6 / 32 + 1e-3)
    assert best[2] / distance == pytest.approx(u[2], abs=0.005 + 1e-3)


@pytest.mark.parametrize("bins", range(-9, 10))
def test_whole_doppler_bins_do_not_bias_the_direction(bins: int) -> None:
    """Turns of the transmitters are taken out; left in they would bias z by d/32."""
    speed = bins * MARS.doppler_step_mps()
    at = (2.0 + MARS.loops * MARS.loop_s / 2 * speed, 0, 0)
    best = points(at, (-speed, 0, 0), STANDING)[0]
    assert best[7] == bins
    assert best[2] / 2 == pytest.approx(0, abs=0.004)
    assert best[1] / 2 == pytest.approx(0, abs=0.53 / 32)


def test_two_in_a_cell_at_equal_angles() -> None:
    u = np.array([(np.cos(a), np.sin(a), 0) for a in np.radians((10, -10))])
    best = points(2 * u, -u)
    cell = best[(best[:, 6] == best[0, 6]) & (best[:, 7] == best[0, 7])]
    assert sorted(np.degrees(np.arcsin(cell[:, 1] / np.linalg.norm(cell[:, :3], axis=1)))) == (
        pytest.approx([-10.8, 10.8], abs=0.1)
    )


def test_the_order_of_transmitters_does_not_matter() -> None:
    orders = (1, 4, 2), (1, 2, 4)
    one, other = (points((2, 0.5, 0.2), (0, 0, 0), STANDING, masks=m)[0] for m in orders)
    np.testing.assert_allclose(one[:4], other[:4], atol=0.01)


@pytest.mark.parametrize("device", ["IWR1443BOOST", "IWR6843ISK", "IWR6843ISK-ODS", "IWR6843AOP"])
def test_every_device_sees_left_and_up(device: str) -> None:
    best = points((2, 0.4, 0.3), (0, 0, 0), STANDING, array=DEVICES[device].array)[0]
    np.testing.assert_allclose(best[:3], (2, 0.4, 0.3), atol=0.09)


def test_noise_alone_has_hardly_a_point() -> None:
    cube, board = cube_of((2, 0, 0), (0, 0, 0), snr_db=-90, frames=40)
    assert board_points(cube, board, DETECTION, True).start[-1] < 0.05 * 40 + 1


def test_rounding_makes_places_whole_and_intensities_integers() -> None:
    best = points((2, 0.3, 0.2), (-1, 0, 0))
    np.testing.assert_array_equal(best[:, 4], np.floor(best[:, 4]))
    np.testing.assert_allclose(best[:, :3] * 1024, np.round(best[:, :3] * 1024), atol=1e-3)
    smooth = points((2, 0.3, 0.2), (-1, 0, 0), quantise=False)
    assert (smooth[:, 4] != np.floor(smooth[:, 4])).any()


def test_grouping_keeps_peaks_alone() -> None:
    every = points((2, 0, 0), (-1, 0, 0))
    peaks = points((2, 0, 0), (-1, 0, 0), replace(DETECTION, grouping=(True, True)))
    assert 1 <= len(peaks) < len(every) / 4
    np.testing.assert_array_equal(peaks[0], every[0])


def test_frames_keep_their_first_64_points() -> None:
    low = replace(STANDING, along_range=Cfar(CASO, 8, 4, False, -30), second_peak=None)
    assert len(points((2, 0, 0), (0, 0, 0), low)) == 64


@pytest.mark.parametrize("mode", [CA, CAGO, CASO])
@pytest.mark.parametrize("cyclic", [False, True])
def test_every_kind_of_cfar_finds_a_scatterer(mode: int, cyclic: bool) -> None:
    cfar = replace(STANDING, along_range=Cfar(mode, 8, 4, cyclic, 15))
    assert len(points((2, 0, 0), (0, 0, 0), cfar))
    both = replace(cfar, along_doppler=Cfar(mode, 4, 2, True, 10))
    assert 0 < len(points((2, 0, 0), (0, 0, 0), both)) <= len(points((2, 0, 0), (0, 0, 0), cfar))


def test_fields_of_view_and_bias() -> None:
    left = replace(STANDING, azimuth_deg=(-45.0, 0.0))  # TI's azimuth is positive to the right
    assert (points((2, 0.6, 0), (0, 0, 0), left)[:, 1] >= 0).all()
    assert len(points((2, 0.6, 0), (0, 0, 0), left))
    assert not len(points((2, -0.6, 0), (0, 0, 0), replace(left, second_peak=None)))
    near = points((2, 0, 0), (0, 0, 0), replace(STANDING, bias=0.1))[0]
    assert np.linalg.norm(near[:3]) == pytest.approx(1.9, abs=0.05)


def test_no_echo_has_no_points() -> None:
    cube, board = cube_of((2, 0, 0), (0, 0, 0), snr_db=None, frames=3)
    cloud = board_points(0 * cube, board, DETECTION, True)
    assert cloud.points.shape == (0, len(COLUMNS))
    assert cloud.start.tolist() == [0, 0, 0, 0]


def test_signs_of_the_feeds_are_taken_out_once() -> None:
    """TI's .cfg of such boards holds them in the coefficients, that of its people tracking not."""
    array = DEVICES["IWR6843AOP"].array
    signs = 3 * tuple(map(complex, array.rx_sign))
    for coefficients in ((), 12 * (1 + 0j,), signs):
        detection = replace(STANDING, coefficients=coefficients)
        best = points((2, 0.4, 0.3), (0, 0, 0), detection, array=array)[0]
        np.testing.assert_allclose(best[:3], (2, 0.4, 0.3), atol=0.09)


SDK_3 = replace(DETECTION, grouping=(True, True), demo=demo_of_sdk3(12))


def test_grouping_of_sdk_3_compares_four_neighbours() -> None:
    d = np.zeros((8, 16))
    d[2, 5], d[3, 6], d[2, 7] = 20.0, 15.0, 12.0  # each a neighbour of the one before
    assert np.argwhere(_peaks(d, (True, True), True) & (d > 0)).tolist() == [[2, 5]]
    four = np.argwhere(_peaks(d, (True, True), False) & (d > 0))
    assert four.tolist() == [[2, 5], [2, 7], [3, 6]]


def test_points_of_sdk_3_have_the_snr_of_its_column() -> None:
    scatterers = [[1.5 + 0.2 * n, 0.3 * n - 1, 0.1] for n in range(8)]
    cube, board = cube_of(scatterers, [[0.6, 0, 0]] * 8, snr_db=0.0)
    as_sdk_1 = board_points(cube, board, replace(SDK_3, demo=Demo(500, False)), True).points
    as_sdk_3 = board_points(cube, board, SDK_3, True).points
    assert len(as_sdk_3) == len(as_sdk_1) > 3
    np.testing.assert_allclose(as_sdk_3[:, 5], as_sdk_1[:, 5] * 0.75, atol=0.051)
    np.testing.assert_allclose(as_sdk_3[:, 5] * 10, np.round(as_sdk_3[:, 5] * 10), atol=1e-4)
    assert as_sdk_3[:, 5].min() >= 0.75 * SDK_3.along_range.threshold_db - 0.05
    unrounded = board_points(cube, board, SDK_3, False).points
    assert (np.abs(unrounded[:, 5] * 10 - np.round(unrounded[:, 5] * 10)) > 1e-3).any()


def test_frames_of_sdk_3_have_more_than_64_points() -> None:
    lines = split_lines("cfarCfg -1 0 0 8 4 4 0 1 0\ncfarCfg -1 1 0 8 4 4 1 1 0\n", "cfg")
    detection = read_detection(lines, 12, 128)
    assert (detection.demo.max_points, detection.demo.snr_scale) == (500, 0.75)
    assert read_detection(lines, 8, 128).demo.snr_scale == 1
    cube, board = cube_of([[2.0, 0, 0]], [[0.6, 0, 0]], snr_db=-10.0)
    assert 64 < board_points(cube, board, detection, True).start[-1] <= 500
