"""The board that a .cfg describes: what is read, honoured, refused."""

from dataclasses import replace

import pytest
from helpers.boards import CFG, MARS

from radhar_cli.config.ti_header import board_header
from radhar_cli.errors import CaptureError
from radhar_cli.radar.detection import CA, CASO, Cfar


def test_what_a_cfg_says() -> None:
    board = board_header(CFG)
    assert (board.start_hz, board.carrier_hz, board.slope_hz) == (77e9, 77.7e9, 100e12)
    assert (board.samples, board.adc_rate_hz) == (80, 2.499e6)
    assert board.slot_s == pytest.approx(57e-6)
    assert (board.order, board.receivers) == (MARS.order, MARS.receivers)
    assert (board.loops, board.frames, board.period_s) == (32, 0, pytest.approx(0.1))
    assert board.unknown == ()
    detection = board.detection
    assert detection.along_range == Cfar(CASO, 8, 4, False, pytest.approx(17.717, abs=1e-3))
    assert (detection.first_bin, detection.last_bin, detection.grouping) == (1, 114, (False, False))
    assert (detection.second_peak, detection.remove_mean) == (0.5, True)


def test_newer_sdks_have_decibels_and_sub_frames() -> None:
    lines = """
cfarCfg -1 0 0 8 4 4 1 15.0 1
cfarCfg -1 1 0 4 2 3 1 12.5 0
multiObjBeamForming -1 1 0.4
clutterRemoval -1 0
aoaFovCfg -1 -60 60 -30 30
cfarFovCfg -1 0 0.5 6
cfarFovCfg -1 1 -3 3
"""
    detection = board_header(CFG + lines).detection
    assert detection.along_range == Cfar(CA, 8, 4, True, 15.0)
    assert detection.along_doppler == Cfar(CA, 4, 2, True, 12.5)
    assert detection.grouping == (True, False)
    assert (detection.second_peak, detection.remove_mean) == (0.4, False)
    assert (detection.azimuth_deg, detection.elevation_deg) == ((-60, 60), (-30, 30))
    assert (detection.range_m, detection.doppler_mps) == ((0.5, 6), (-3, 3))


def test_calibration_of_the_channels() -> None:
    pairs = " ".join(f"{n} 0.5" for n in range(12))
    detection = board_header(f"{CFG}compRangeBiasAndRxChanPhase 0.07 {pairs}").detection
    assert detection.bias == 0.07
    assert detection.coefficients[:2] == (0.5j, 1 + 0.5j)
    same = board_header(f"{CFG}compRangeBiasAndRxChanPhase 0.0 {'1 0 ' * 12}").detection
    assert same == replace(same, coefficients=())


def test_lines_that_nobody_knows_are_named() -> None:
    header = board_header(CFG + "quantumCfg 1 2 3\nsensorStart\n% a comment\n")
    assert header.unknown == ("quantumCfg",)


@pytest.mark.parametrize(
    ("off", "on"),
    [
        ("extendedMaxVelocity -1 0", "extendedMaxVelocity -1 1"),
        ("extendedMaxVelocity 0", "extendedMaxVelocity 1"),
        ("bpmCfg -1 0 0 1", "bpmCfg -1 1 0 1"),
        ("nearFieldCfg -1 0 0 0", "nearFieldCfg -1 1 0 0"),
        ("calibDcRangeSig -1 0 -5 8 256", "calibDcRangeSig -1 1 -5 8 256"),
        ("measureRangeBiasAndRxChanPhase 0 1.5 0.2", "measureRangeBiasAndRxChanPhase 1 1.5 0.2"),
    ],
)
def test_what_is_switched_on_and_not_simulated_is_named_once(off: str, on: str) -> None:
    assert board_header(f"{CFG}{off}\n").not_simulated == ()
    header = board_header(f"{CFG}{on}\n{on}\n")
    assert (header.not_simulated, header.unknown) == ((on.split()[0],), ())


def test_less_power_than_the_transmitters_have_is_named() -> None:
    less = CFG.replace("7 40 0 0 100", "7 40 6 0 100")
    assert board_header(less).not_simulated == ("profileCfg",)
    assert board_header(CFG).not_simulated == ()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("adcCfg 2 1", "adcCfg 2 2", "adcCfg 2 2: should be 2 1"),
        ("chirpCfg 1 1 0 0 0 0 0 4", "chirpCfg 1 1 0 0 0 0 0 5", "one transmitter a chirp"),
        ("chirpCfg 2 2 0 0 0 0 0 2", "chirpCfg 2 2 0 0 0 0 0 4", "once a loop"),
        ("chirpCfg 2 2 0 0 0 0 0 2", "chirpCfg 2 2 0 0 1 0 0 2", "freqSlopeVar"),
        ("frameCfg 0 2 32 0 100 1 0", "frameCfg 0 2 32 0 5 1 0", "should be at least 5.472 ms"),
        ("frameCfg 0 2 32 0 100 1 0", "", "frameCfg is missing"),
        ("channelCfg 15 7 0", "channelCfg 0 7 0", "a receiver that is on"),
        ("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg 0 2 8", "cfarCfg 0 2 8: should have 7 or 8 numbers"),
        ("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg 0 7 8 4 3 0 1130", "cfarCfg 0 7"),
        ("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg 0 2 90 4 3 0 1130", "94 cells on each side"),
        ("clutterRemoval 1", "clutterRemoval on", "clutterRemoval on: should have 1 number"),
        ("profileCfg 0 77 17", "profileCfg 0 77 -17", "idleTimeConst"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(old: str, new: str, said: str) -> None:
    with pytest.raises(CaptureError, match=r"radar\.cfg") as caught:
        board_header(CFG.replace(old, new))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
