"""A board's elements, times and axes, against TI's numbers."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.boards import MARS

from radhar_cli.radar.board import DEVICES


def test_frequencies_and_steps_of_a_known_profile() -> None:
    assert MARS.centre_hz == pytest.approx(79.280632e9, rel=1e-8)
    assert MARS.unit == pytest.approx(1.890704e-3, rel=1e-6)
    assert MARS.range_step_m == pytest.approx(29.264897e-3, rel=1e-7)
    assert MARS.doppler_step_mps() == pytest.approx(0.345523, rel=1e-5)
    assert MARS.doppler_step_mps(MARS.start_hz) == pytest.approx(0.355757, rel=1e-5)


def test_virtual_elements_of_the_boost_are_a_row_of_eight_and_four_above() -> None:
    left, up = MARS.places.T
    np.testing.assert_allclose(left, [0, 1, 2, 3, 4, 5, 6, 7, 2, 3, 4, 5], atol=1e-12)
    np.testing.assert_allclose(up, [0] * 8 + [1] * 4, atol=1e-12)


def test_other_order_of_transmitters_swaps_their_blocks() -> None:
    swapped = replace(MARS, masks=(1, 2, 4))
    np.testing.assert_array_equal(swapped.places[4:8], MARS.places[8:])
    np.testing.assert_array_equal(swapped.places[8:], MARS.places[4:8])


def test_receivers_that_are_off_are_left_out() -> None:
    board = replace(MARS, receivers=(1, 3))
    np.testing.assert_allclose(board.places[:, 0], [1, 3, 5, 7, 3, 5], atol=1e-12)


def test_elements_turn_with_the_radar() -> None:
    """Looking to the left, left is back; looking down, up is ahead."""
    left = replace(MARS, position=(1, 2, 3), yaw=np.pi / 2)
    np.testing.assert_allclose(left.element((1, 0)), (1 - MARS.unit, 2, 3), atol=1e-12)
    down = replace(MARS, tilt=np.pi / 2)
    np.testing.assert_allclose(down.element((0, 1)), (MARS.unit, 0, 0), atol=1e-12)


@pytest.mark.parametrize(("yaw", "tilt"), [(0.0, 0.0), (0.4, 0.0), (0.0, 0.3), (-0.7, 0.5)])
def test_what_lies_on_boresight_is_ahead(yaw: float, tilt: float) -> None:
    board = replace(MARS, position=(1.0, 2.0, 1.5), yaw=yaw, tilt=tilt)
    ahead = np.array([np.cos(yaw) * np.cos(tilt), np.sin(yaw) * np.cos(tilt), -np.sin(tilt)])
    p = (np.array(board.position) + 2.5 * ahead)[:, None]
    np.testing.assert_allclose(board.aim.to_radar(p)[:, 0], [2.5, 0, 0], atol=1e-12)


def test_the_pattern_is_half_at_its_half_widths_one_way() -> None:
    """Two ways, and as an amplitude, that is again one half."""
    az, el = np.radians(28.0), np.radians(14.0)
    p = np.array([[1, np.cos(az), np.cos(el)], [0, np.sin(az), 0], [0, 0, np.sin(el)]])
    np.testing.assert_allclose(MARS.aim.two_way(p), [1, 0.5, 0.5], atol=1e-12)


def test_chirps_follow_frames_loops_and_turns() -> None:
    t = MARS.chirp_times()
    assert t.shape == (2, 32, 3)
    assert t[1, 2, 1] == pytest.approx(0.1 + (2 * 3 + 1) * 57e-6)
    np.testing.assert_allclose(MARS.waveform.times(np.arange(t.size)), t.ravel(), atol=1e-15)
    np.testing.assert_allclose(MARS.pulses.times(np.arange(64)), t[..., 0].ravel(), atol=1e-15)


def test_chirps_of_a_loop_may_start_at_any_times() -> None:
    board = replace(MARS, chirp_starts_s=(0.0, 60e-6, 800e-6), burst_s=900e-6)
    times = board.chirp_times()
    assert times.shape == (2, 32, 3)
    np.testing.assert_allclose(times[1, 3], 0.1 + 3 * 900e-6 + np.array(board.chirp_starts_s))
    numbers = np.arange(times.size, dtype=float)
    np.testing.assert_allclose(board.waveform.times(numbers), times.ravel(), rtol=0, atol=1e-15)


def test_frames_without_idle_time_have_no_gaps() -> None:
    assert len(replace(MARS, period_s=32 * 3 * 57e-6).pulses) == 1


TRANSMITTERS = {
    **dict.fromkeys(("IWR1642BOOST", "AWR1642BOOST", "IWRL6432BOOST"), 2),
    **dict.fromkeys(("AWR2944EVM", "IWRL6844EVM"), 4),
}


@pytest.mark.parametrize("device", DEVICES)
def test_every_device_has_a_sign_for_each_receiver(device: str) -> None:
    array = DEVICES[device].array
    assert len(array.rx_sign) == len(array.rx) == (3 if "6432" in device else 4)
    assert len(array.tx) == TRANSMITTERS.get(device, 3)
    assert len(array.tx_sign) in (0, len(array.tx))


OF_BOARDS: dict[str, tuple[str, str, str, str, tuple[float, float]]] = {
    # TX and RX (left, up), signs of RX and of TX, half-power half-widths (azimuth, elevation)
    "IWR1443BOOST": ("0,0 2,1 4,0", "0,0 1,0 2,0 3,0", "++++", "+++", (28, 14)),
    **dict.fromkeys(
        ("AWR1243BOOST", "AWR2243BOOST"),
        ("0,0 2,1 4,0", "0,0 1,0 2,0 3,0", "++++", "+++", (28, 14)),
    ),
    "IWR1642BOOST": ("0,0 4,0", "0,0 1,0 2,0 3,0", "++++", "++", (28, 14)),
    "IWR1843BOOST": ("0,0 2,1 4,0", "0,0 1,0 2,0 3,0", "++++", "+++", (28, 14)),
    "IWR6843ISK": ("0,-1 2,0 4,-1", "0,0 1,0 2,0 3,0", "++++", "+++", (60, 15)),
    "IWR6843ISK-ODS": ("0,0 2,0 2,-2", "0,0 0,-1 1,-1 1,0", "+--+", "+++", (60, 60)),
    "IWR6843AOP": ("0,0 2,-2 0,-2", "1,-1 1,0 0,-1 0,0", "+-+-", "+++", (60, 60)),
    "AWR2944EVM": ("0,0 2,1.6 4,0 8,0", "0,0 1,0 2,0 3,0", "++++", "++++", (28, 14)),
    "IWRL6432BOOST": ("0,0 1,0", "0,0 1,1 2,0", "+-+", "+-", (60, 30)),
    "IWRL6844EVM": ("2,2 0,2 0,0 2,0", "0,1 0,0 1,0 1,1", "++++", "-+-+", (60, 60)),
}


@pytest.mark.parametrize("device", DEVICES)
def test_elements_of_a_device_are_those_of_its_guide(device: str) -> None:
    """Places (left, up) in half wavelengths looking out, signs of the feeds, beam of an element."""
    name = device if device in OF_BOARDS else device.replace("AWR1", "IWR1")
    tx, rx, rx_signs, tx_signs, beam = OF_BOARDS[name]
    array = DEVICES[device].array
    for places, written in ((array.tx, tx), (array.rx, rx)):
        assert [*places] == [tuple(map(float, place.split(","))) for place in written.split()]
    assert "".join("-+"[sign > 0] for sign in array.rx_sign) == rx_signs
    assert "".join("-+"[sign > 0] for sign in array.tx_sign or (1,) * len(array.tx)) == tx_signs
    assert array.half_power_deg == beam
    assert array.unit_m == {"IWRL6432BOOST": 2.418e-3, "IWRL6844EVM": 2.54e-3}.get(name)
