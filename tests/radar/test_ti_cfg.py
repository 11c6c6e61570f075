"""The board that a .cfg describes: what is read, honoured, refused."""

from dataclasses import replace

import pytest
from helpers.boards import CFG, MARS
from helpers.scatterers import ISK_CFG

from radhar_cli.errors import CaptureError
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.detection import CA, CASO, Cfar
from radhar_cli.radar.ti_family import Family
from radhar_cli.readers.ti.ti_cfg import BoardPose, parse_ti_cfg

PEOPLE = CFG.replace("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg 6 4 4 0 0 16 16 4 4 50 62 0")
PEOPLE = PEOPLE.replace("clutterRemoval 1", "doaCfg 600 1875 30 1")


def test_what_a_cfg_says() -> None:
    board = parse_ti_cfg(CFG)
    assert (board.timing.start_hz, board.timing.carrier_hz, board.timing.slope_hz) == (
        77e9,
        77.7e9,
        100e12,
    )
    assert (board.timing.samples, board.timing.adc_rate_hz) == (80, 2.499e6)
    assert board.timing.slot_s == pytest.approx(57e-6)
    assert (board.timing.order, board.timing.receivers) == (MARS.order, MARS.receivers)
    assert (board.timing.loops, board.timing.frames, board.timing.period_s) == (
        32,
        0,
        pytest.approx(0.1),
    )
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
    detection = parse_ti_cfg(CFG + lines).detection
    assert detection.along_range == Cfar(CA, 8, 4, True, 15.0)
    assert detection.along_doppler == Cfar(CA, 4, 2, True, 12.5)
    assert detection.grouping == (True, False)
    assert (detection.second_peak, detection.remove_mean) == (0.4, False)
    assert (detection.azimuth_deg, detection.elevation_deg) == ((-60, 60), (-30, 30))
    assert (detection.range_m, detection.doppler_mps) == ((0.5, 6), (-3, 3))


def test_text_is_read_as_boards_read_it() -> None:
    """A byte-order mark, the ends of lines, blanks, and what programs write behind a command."""
    lines = "\r\n".join(f"\t{line.replace(' ', '  ')}  // said" for line in CFG.splitlines())
    assert parse_ti_cfg(f"\ufeff{lines}\r\n# all\r\n") == parse_ti_cfg(CFG)
    assert parse_ti_cfg(CFG.replace("channelCfg 15 7", "channelCfg 0xF 0x7")) == parse_ti_cfg(CFG)


def test_family_decides_what_twelve_numbers_of_cfarCfg_are() -> None:
    header = parse_ti_cfg(PEOPLE)
    assert (header.family, header.detection.remove_mean) == (Family.PEOPLE, True)
    assert (header.not_simulated, header.firmware) == ((), "people_counting")
    newer = CFG.replace("frameCfg 0 2 32 0 100 1 0", "frameCfg 0 2 32 0 80 100 1 0")
    newer = newer.replace("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg -1 0 2 16 4 4 1 12 1 0 0 1")
    header = parse_ti_cfg(newer)
    assert (header.family, header.not_simulated) == (Family.MCU_PLUS, ("cfarCfg",))
    assert header.detection.along_range == Cfar(CASO, 16, 4, True, 12.0)


@pytest.mark.parametrize(
    ("lines", "family"),
    [
        ("cfarCfg -1 0 2 8 4 3 0 15 1", Family.SDK_3),
        ("cfarCfg -1 0 2 8 4 3 0 15", Family.SDK_2),
        ("cfarCfg 0 2 8 4 3 0 1130", Family.SDK_1),
        ("subDataFrameCfg 0 80 96 1", Family.MCU_PLUS),
        (
            "dynamicRACfarCfg -1 4 4 2 2 8 12 4 8 4 8 0.4 1 1\ndynamicRangeAngleCfg -1 7 0.1 2 0",
            Family.PEOPLE_3D,
        ),
        ("", Family.ANY),
    ],
)
def test_family_is_known_by_its_commands(lines: str, family: Family) -> None:
    without_cfar = CFG.replace("cfarCfg 0 2 8 4 3 0 1130\n", "")
    assert parse_ti_cfg(f"{without_cfar}{lines}\n").family is family


@pytest.mark.parametrize(
    ("cfg", "missing", "firmware"),
    [
        (ISK_CFG.replace("fovCfg -1", "fovCfg 1"), "fovCfg", None),  # of another subframe
        (PEOPLE.replace("cfarCfg 6 4 4 0 0 16 16 4 4 50 62 0", ""), "cfarCfg", None),
        (f"{PEOPLE}cfarCfg 0 2 8 4 3 0 1130\n", "cfarCfg", "sdk1"),  # of another family
    ],
)
def test_commands_that_a_chain_of_people_needs_may_be_missing(
    cfg: str, missing: str, firmware: str | None
) -> None:
    header = parse_ti_cfg(cfg)
    assert (header.people, header.firmware) == (None, firmware)
    assert [words.split()[0] for words in header.why_no_chain] == [missing]


def test_frameCfg_counts_in_mode_1_whatever_stands_beside_it() -> None:
    beside = "dfeDataOutputMode 1\nadvFrameCfg 2 0 0 1 0\nsubFrameCfg 0 0 0 1 64 50 0 1 1 50\n"
    assert parse_ti_cfg(CFG + beside) == parse_ti_cfg(CFG)


def test_calibration_of_the_channels() -> None:
    pairs = " ".join(f"{n} 0.5" for n in range(12))
    detection = parse_ti_cfg(f"{CFG}compRangeBiasAndRxChanPhase 0.07 {pairs}").detection
    assert detection.bias == 0.07
    assert detection.coefficients[:2] == (0.5j, 1 + 0.5j)
    same = parse_ti_cfg(f"{CFG}compRangeBiasAndRxChanPhase 0.0 {'1 0 ' * 12}").detection
    assert same == replace(same, coefficients=())


def test_lines_that_nobody_knows_are_named() -> None:
    header = parse_ti_cfg(CFG + "quantumCfg 1 2 3\nsensorStart\n% a comment\n")
    assert header.unknown == ("quantumCfg",)


@pytest.mark.parametrize(
    ("off", "on"),
    [
        ("extendedMaxVelocity -1 0", "extendedMaxVelocity -1 1"),
        ("extendedMaxVelocity 0", "extendedMaxVelocity 1"),
        ("nearFieldCfg -1 0 0 0", "nearFieldCfg -1 1 0 0"),
        ("calibDcRangeSig -1 0 -5 8 256", "calibDcRangeSig -1 1 -5 8 256"),
        ("measureRangeBiasAndRxChanPhase 0 1.5 0.2", "measureRangeBiasAndRxChanPhase 1 1.5 0.2"),
    ],
)
def test_what_is_switched_on_and_not_simulated_is_named_once(off: str, on: str) -> None:
    assert parse_ti_cfg(f"{CFG}{off}\n").not_simulated == ()
    header = parse_ti_cfg(f"{CFG}{on}\n{on}\n")
    assert (header.not_simulated, header.unknown) == ((on.split()[0],), ())


def test_a_pose_is_height_and_angles_to_the_right_and_down() -> None:
    assert parse_ti_cfg(CFG).pose is None
    header = parse_ti_cfg(f"{CFG}sensorPosition 2.5 10 15\n")
    assert header.pose == BoardPose((0.0, 0.0, 2.5), -10.0, 15.0)
    assert (header.unknown, header.not_simulated) == ((), ())


@pytest.mark.parametrize("third", ["", " 0", " 15"])
def test_a_pose_may_have_a_place_and_a_third_angle(third: str) -> None:
    for text in (XWRL, ISK_CFG):
        header = parse_ti_cfg(f"{text}sensorPosition 0.5 1 1.2 30 10{third}\n")
        assert header.pose == BoardPose((1.0, -0.5, 1.2), -30.0, 10.0)
        assert header.not_simulated == ("sensorPosition thirdTilt",) * (third == " 15")


def test_fewer_bits_than_16_are_named() -> None:
    header = parse_ti_cfg(CFG.replace("adcCfg 2 1", "adcCfg 1 1"))
    assert (header.timing.adc_bits, header.not_simulated) == (14, ("adcCfg",))


def test_transmitters_may_send_less_power() -> None:
    """A byte for each, the first lowest: 0x060606 are 6 dB each, as in TI's people tracking."""
    less = parse_ti_cfg(CFG.replace("7 40 0 0 100", "7 40 394758 0 100"))
    assert (less.timing.backoff_db, less.not_simulated) == ((6, 6, 6, 0), ())
    alone = parse_ti_cfg(CFG.replace("7 40 0 0 100", "7 40 0x0300 0 100"))
    assert alone.timing.backoff_db == (0, 3, 0, 0)
    assert parse_ti_cfg(CFG).timing.backoff_db == ()


def test_turned_phases_are_named() -> None:
    turned = CFG.replace("7 40 0 0 100", "7 40 0 4 100")
    assert parse_ti_cfg(turned).not_simulated == ("profileCfg",)


WRONG = [
    ("adcCfg 2 1", "adcCfg 2 3", "3: adcCfg adcOutputFmt = 3: should be 0, 1 or 2 (real, complex"),
    ("adcCfg 2 1", "adcCfg 3 1", "numADCBits = 3: should be 0, 1 or 2 (12, 14"),
    (
        "adcCfg 2 1",
        "adcCfg 2",
        "3: adcCfg has 1 numbers: should be 2: adcCfg numADCBits adcOutputFmt",
    ),
    (
        "chirpCfg 1 1 0 0 0 0 0 4",
        "chirpCfg 1 1 0 0 0 0 0 5",
        "txEnable = 5: should be one transmitter a chirp (the TDM demo's profile)",
    ),
    ("chirpCfg 2 2 0 0 0 0 0 2", "chirpCfg 2 2 0 0 0 0 0 4", "= 1 4 4: should be each transmitter"),
    (
        "chirpCfg 2 2 0 0 0 0 0 2",
        "chirpCfg 2 2 0 0 1 0 0 2",
        "8: chirpCfg freqSlopeVar = 1: should be 0",
    ),
    (
        "chirpCfg 2 2 0 0 0 0 0 2",
        "chirpCfg 2 2 7 0 0 0 0 2",
        "8: chirpCfg profileId = 7: should be one",
    ),
    (
        "frameCfg 0 2 32 0 100 1 0",
        "frameCfg 0 3 32 0 100 1 0",
        "9: frameCfg chirpStartIdx chirpEndIdx = 0 3",
    ),
    ("frameCfg 0 2 32 0 100 1 0", "frameCfg 0 2 32 0 5 1 0", "= 5: should be at least 5.472 ms"),
    (
        "frameCfg 0 2 32 0 100 1 0",
        "frameCfg 0 2 32 0 90 100 1 0",
        "numAdcSamples = 90: should be 80",
    ),
    (
        "frameCfg 0 2 32 0 100 1 0",
        "frameCfg 0 2 32",
        "9: frameCfg has 3 numbers: should be 6, 7 or 8: frameCfg",
    ),
    ("frameCfg 0 2 32 0 100 1 0", "", "frameCfg is missing; a line that would do: frameCfg 0 0"),
    ("frameCfg 0 2 32 0 100 1 0", "advFrameCfg 2 0 0 1 0", "board.cfg: subFrameCfg is missing"),
    (
        "clutterRemoval 1",
        "bpmCfg -1 1 0 2",
        "chirp0Idx chirp1Idx = 0 2: should be two chirps of the",
    ),
    ("clutterRemoval 1", "bpmCfg -1 1 0 3", "13: bpmCfg chirp1Idx = 3: should be a chirp of the"),
    ("channelCfg 15 7 0", "channelCfg 0 7 0", "2: channelCfg rxChannelEn = 0: should be 1 to 15"),
    ("channelCfg 15 7 0", "channelCfg 15 7 1", "cascading = 1: should be 0"),
    ("channelCfg 15 7 0", "channelCfg 15 3 0", "7: chirpCfg txEnable = 4: should be of transmit"),
    (
        "cfarCfg 0 2 8 4 3 0 1130",
        "cfarCfg 0 2 8",
        "10: cfarCfg has 3 numbers: should be 7, 8, 9, 12, 13 or 14: cfarCfg proc",
    ),
    (
        "cfarCfg 0 2 8 4 3 0 1130",
        "cfarCfg 0 7 8 4 3 0 1130",
        "averageMode = 7: should be 0, 1",
    ),
    (
        "cfarCfg 0 2 8 4 3 0 1130",
        "cfarCfg 0 2 90 4 3 0 1130",
        "winLen = 90: should be less: 94 cells",
    ),
    ("clutterRemoval 1", "clutterRemoval on", "clutterRemoval enabled = on: should be a number"),
    (
        "clutterRemoval 1",
        "clutterRemoval 1e999",
        "enabled = 1e999: should be a number, decimal or 0x",
    ),
    (
        "clutterRemoval 1",
        "compRangeBiasAndRxChanPhase 0 1 0 1 0",
        "should be 12 pairs of Re and Im",
    ),
    ("clutterRemoval 1", "ddmPhaseShiftAntOrder 0 1", "13: ddmPhaseShiftAntOrder: DDMA is not"),
    ("clutterRemoval 1", "dfeDataOutputMode 2", "13: dfeDataOutputMode modeType = 2: should be 1"),
    (
        "profileCfg 0 77 17",
        "profileCfg 0 77 -17",
        "5: profileCfg idleTime = -17: should be a number",
    ),
    (
        "1 80 2499",
        "1 84 2499",
        "5: profileCfg numAdcSamples = 84: should be at most 82: at 2.499e+06",
    ),
    ("7 40 0 0 100", "7 1e308 0 0 100", "rampEndTime = 1e308: should be a number from 0.001 to"),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG)
def test_what_cannot_be_is_refused_in_a_line(old: str, new: str, message: str) -> None:
    with pytest.raises(CaptureError, match=r"^board\.cfg") as caught:
        parse_ti_cfg(CFG.replace(old, new), "board.cfg")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_equal_profiles_are_one() -> None:
    (profile,) = (line for line in CFG.splitlines() if line.startswith("profileCfg"))
    twice = CFG.replace(profile, f"{profile}\n{profile.replace('profileCfg 0', 'profileCfg 1')}")
    twice = twice.replace("chirpCfg 1 1 0", "chirpCfg 1 1 1")
    assert parse_ti_cfg(twice) == parse_ti_cfg(CFG)
    with pytest.raises(CaptureError, match="chirpCfg profileId = 1: should be 0: a frame"):
        parse_ti_cfg(twice.replace("profileCfg 1 77 17", "profileCfg 1 77.1 17"))


def with_second_profile(numbers: str) -> str:
    """A file whose second and third chirps have another profile, of other first numbers."""
    (profile,) = (line for line in CFG.splitlines() if line.startswith("profileCfg"))
    other = profile.replace("profileCfg 0 77 17 7 40 0", f"profileCfg 1 {numbers}")
    text = CFG.replace(profile, f"{profile}\n{other}")
    return text.replace("chirpCfg 1 1 0", "chirpCfg 1 1 1").replace(
        "chirpCfg 2 2 0", "chirpCfg 2 2 1"
    )


@pytest.mark.parametrize(
    ("numbers", "starts_us", "loop_us"),
    [
        ("77 500 7 40 0", (0, 540, 1080), 57 + 2 * 540),  # pauses before the later chirps
        ("77 17 7 60 0", (0, 57, 134), 57 + 2 * 77),  # and behind the ramps
        ("77 37 7 20 0", (), None),  # which ends before the samples do
    ],
)
def test_profiles_may_differ_in_the_time_that_they_take(
    numbers: str, starts_us: tuple[float, ...], loop_us: float | None
) -> None:
    if loop_us is None:
        with pytest.raises(CaptureError, match="6: profileCfg numAdcSamples = 80: should be at m"):
            parse_ti_cfg(with_second_profile(numbers), "board.cfg")
        return
    header = parse_ti_cfg(with_second_profile(numbers))
    assert header.timing.chirp_starts_s == pytest.approx([1e-6 * start for start in starts_us])
    assert header.timing.loop_s == pytest.approx(loop_us * 1e-6)
    assert (header.timing.order, header.timing.loops) == (MARS.order, MARS.loops)
    assert header.timing.burst_s is not None


def test_each_transmitter_has_the_power_of_its_own_profile() -> None:
    header = parse_ti_cfg(with_second_profile("77 17 7 40 394758"))
    assert header.timing.backoff_db == (0, 6, 6, 0)
    assert header.timing.chirp_starts_s == ()
    both = with_second_profile("77 17 7 40 394758").replace("0 0 0 0 2\n", "0 0 0 0 1\n")
    with pytest.raises(CaptureError, match="should have the txOutPower of the other chirps"):
        parse_ti_cfg(both.replace("0 0 0 0 4\n", "0 0 0 0 1\n"))


@pytest.mark.parametrize(
    "line",
    [
        "chirpCfg 3 3 0 0 0 0 0 0",  # no transmitter
        "chirpCfg 3 9 0 0.5 1 2 3 7",  # changed in every way, of all transmitters
        "chirpCfg 3 3 9 0 0 0 0 1",  # of a profile that is not there
        "profileCfg 3 0 0 0 0 0 0 0 0 0 0 0 0 0",
        "chirpCfg 3 3 3 0 0 0 0 1\nprofileCfg 3 77 7 7 9 0 0 -10 1 999 1 0 0 30",
    ],
)
def test_chirps_and_profiles_that_no_frame_sends_do_not_matter(line: str) -> None:
    assert parse_ti_cfg(f"{CFG}{line}\n") == parse_ti_cfg(CFG)
    with pytest.raises(CaptureError, match="chirpCfg txEnable = 0: should be a mask of trans"):
        parse_ti_cfg(f"{CFG}chirpCfg 1 1 0 0 0 0 0 0\n")


def test_masks_that_repeat_are_further_loops() -> None:
    """As mmwdemo_rfparser.c counts them: C numLoops/n_TX chirps, n_TX slots apart."""
    alone = CFG.replace("0 0 0 0 4\n", "0 0 0 0 1\n").replace("2 2 0 0 0 0 0 2", "2 2 0 0 0 0 0 1")
    board = parse_ti_cfg(alone)
    assert (board.timing.order, board.timing.loops, board.timing.period_s) == (
        (0,),
        96,
        pytest.approx(0.1),
    )
    assert board.timing.slot_s == pytest.approx(57e-6)
    in_turn = CFG.replace("frameCfg 0 2 32", "chirpCfg 3 3 0 0 0 0 0 4\nframeCfg 0 3 32")
    in_turn = in_turn.replace("2 2 0 0 0 0 0 2", "2 2 0 0 0 0 0 1")
    board = parse_ti_cfg(in_turn)
    assert (board.timing.order, board.timing.loops) == ((0, 2), 64)


PAIR = """
channelCfg 15 7 0
adcCfg 2 1
bpmCfg -1 1 0 2
profileCfg 0 60.75 30 25 59.1 0 0 54.71 1 96 2950 2 1 36
chirpCfg 0 0 0 0 0 0 0 5
chirpCfg 1 1 0 0 0 0 0 2
chirpCfg 2 2 0 0 0 0 0 5
frameCfg 0 2 48 0 55 1 0
"""


def test_two_transmitters_may_send_together() -> None:
    """The lower of them takes the place of the chirp that has their sum."""
    header = parse_ti_cfg(PAIR)
    assert (header.timing.masks, header.timing.order, header.timing.bpm) == (
        (5, 2, 5),
        (0, 1, 2),
        (0, 2),
    )
    assert (header.timing.loops, header.not_simulated) == (48, ())
    turned = parse_ti_cfg(PAIR.replace("bpmCfg -1 1 0 2", "bpmCfg -1 1 2 0"))
    assert (turned.timing.order, turned.timing.bpm) == ((2, 1, 0), (2, 0))
    two = PAIR.replace("chirpCfg 1 1 0 0 0 0 0 2\n", "").replace("chirpCfg 2 2", "chirpCfg 1 1")
    two = two.replace("bpmCfg -1 1 0 2", "bpmCfg -1 1 0 1").replace("frameCfg 0 2", "frameCfg 0 1")
    alone = parse_ti_cfg(two)
    assert (alone.timing.order, alone.timing.bpm, alone.timing.loops) == ((0, 2), (0, 1), 48)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("bpmCfg -1 1 0 2", "bpmCfg -1 0 0 2", "6: chirpCfg txEnable = 5: should be one transmit"),
        ("2 2 0 0 0 0 0 5", "2 2 0 0 0 0 0 3", "chirp0Idx chirp1Idx = 0 2: should be two chirps"),
        ("1 1 0 0 0 0 0 2", "1 1 0 0 0 0 0 1", "= 0 2: should be the two chirps of a loop, or two"),
        (
            "chirpCfg 2 2 0 0 0 0 0 5\nframeCfg 0 2",
            "chirpCfg 2 2 0 0 0 0 0 5\nchirpCfg 3 3 0 0 0 0 0 2\nframeCfg 0 3",
            "= 0 2: should be the two chirps of a loop, or two of three, the other of which has",
        ),
    ],
)
def test_other_mixtures_of_bpm_are_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(CaptureError) as caught:
        parse_ti_cfg(PAIR.replace(old, new), "board.cfg")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("masks", "pair", "order"),
    [
        ((3, 3, 4), (0, 1), (0, 1, 2)),
        ((4, 3, 3), (1, 2), (2, 0, 1)),
        ((3, 4, 3), (2, 0), (1, 2, 0)),
        ((6, 6, 1), (1, 0), (2, 1, 0)),
    ],
)
def test_two_transmitters_may_send_together_anywhere_in_the_loop(
    masks: tuple[int, ...], pair: tuple[int, int], order: tuple[int, ...]
) -> None:
    text = PAIR.replace("bpmCfg -1 1 0 2", f"bpmCfg -1 1 {pair[0]} {pair[1]}")
    for place, mask in enumerate(masks):
        text = text.replace(
            f"chirpCfg {place} {place} 0 0 0 0 0 {(5, 2, 5)[place]}",
            f"chirpCfg {place} {place} 0 0 0 0 0 {mask}",
        )
    header = parse_ti_cfg(text)
    assert (header.timing.masks, header.timing.bpm, header.timing.order, header.timing.loops) == (
        masks,
        pair,
        order,
        48,
    )


OBSTACLES = CFG.replace("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg 1 4 12 4 2 8 2 350 30 2 0 5 20")


@pytest.mark.parametrize("more", [" 0.5", "\ndbscanCfg 4 4 13 20 3 256"])
def test_detection_of_obstacles_is_said_not_to_be_simulated(more: str) -> None:
    header = parse_ti_cfg(OBSTACLES.replace("2 0 5 20", f"2 0 5 20{more}"))
    count = 13 + more.count(".")
    assert (header.family, header.not_simulated) == (Family.OBSTACLES, ("cfarCfg",))
    assert (header.firmware, header.unknown) == (None, ())
    assert header.why_no_chain == (f"cfarCfg of {count} numbers is not simulated",)


def test_detection_of_occupants_is_said_not_to_be_simulated() -> None:
    """Of a file with near windows of its own, of which the elements are read all the same."""
    text = ISK_CFG.replace("2 2 8 12 4 8 4.00 8.00 0.40 1 1\n", "2 2 8 8 4 6 4 1 8 6 0.4 1 15\n")
    header = parse_ti_cfg(text)
    assert (header.firmware, header.not_simulated) == (None, ("dynamicRACfarCfg",))
    assert header.why_no_chain == ("dynamicRACfarCfg of 16 numbers is not simulated",)
    assert header.elements == parse_ti_cfg(ISK_CFG).elements


def test_a_window_that_does_not_fit_is_refused_with_its_arithmetic() -> None:
    text = ISK_CFG.replace("-1 4 4 2 2 8 12 4 8", "-1 40 40 2 2 20 12 5 8")
    with pytest.raises(CaptureError, match=r"2 \(20 \+ 5\) bins.* 128 - 40 - 40 = 48 bins$"):
        parse_ti_cfg(text)


def test_of_windows_that_are_mirrored_beside_the_map_another_chain_finds_the_points() -> None:
    """As files that come with the boards have them."""
    header = parse_ti_cfg(ISK_CFG.replace("-1 4 4 2 2 8 12 4 8", "-1 2 78 2 2 4 12 4 8"))
    assert (header.firmware, header.people) == (None, None)
    (reason,) = header.why_no_chain
    assert reason.startswith("dynamicRACfarCfg leaves out so many of 128 range bins")
    assert reason.endswith("128 - 78 - 4 (window) - 4 (guard) = 42, less than 78")
    at_most = parse_ti_cfg(ISK_CFG.replace("-1 4 4 2 2 8 12 4 8", "-1 2 60 2 2 4 12 4 8"))
    assert (at_most.firmware, at_most.why_no_chain) == ("people_tracking", ())


def test_frame_of_the_mcu_plus_sdk_repeats_the_number_of_samples() -> None:
    newer = CFG.replace("frameCfg 0 2 32 0 100 1 0", "frameCfg 0 2 32 0 80 100 1 0")
    header = parse_ti_cfg(newer)
    assert replace(header, family=Family.SDK_1) == parse_ti_cfg(CFG)


def test_lines_of_other_subframes_do_not_count() -> None:
    lines = "clutterRemoval 1 0\ncfarCfg 1 0 0 8 4 4 1 15.0 1\n"
    assert parse_ti_cfg(CFG + lines).detection == parse_ti_cfg(CFG).detection


OLDER = [name for name, device in DEVICES.items() if device.families != (Family.L_SDK,)]
XWRL = """channelCfg 7 3 0
chirpComnCfg 15 5 0 128 1 34 3
chirpTimingCfg 6 26 1 47.95 60
frameCfg 2 0 600 64 200 0
"""


@pytest.mark.parametrize("device", [*OLDER, None])
@pytest.mark.parametrize("argument", ["rxChannelEn", "txChannelEn"])
def test_antennas_that_the_device_lacks_are_refused(device: str | None, argument: str) -> None:
    """Both the mask's name and the device's stand in the message; all that it has may be on."""
    array = DEVICES[device].array if device else None
    receivers, transmitters = (len(array.rx), len(array.tx)) if array else (4, 4)
    masks = {"rxChannelEn": 2**receivers - 1, "txChannelEn": 2**transmitters - 1}
    one = CFG.replace("chirpCfg 1 1 0 0 0 0 0 4\n", "").replace("chirpCfg 2 2 0 0 0 0 0 2\n", "")
    one = one.replace("frameCfg 0 2", "frameCfg 0 0")

    def with_masks() -> str:
        numbers = f"{masks['rxChannelEn']} {masks['txChannelEn']} 0"
        return one.replace("channelCfg 15 7 0", f"channelCfg {numbers}")

    assert parse_ti_cfg(with_masks(), device=device).timing.receivers == tuple(range(receivers))
    masks[argument] = masks[argument] * 2 + 1
    noun = "receivers" if argument == "rxChannelEn" else "transmitters"
    message = f"channelCfg {argument} = {masks[argument]}: should be at most"
    with pytest.raises(CaptureError, match=f"{message} .*{device or 'boards'} ha.* {noun}"):
        parse_ti_cfg(with_masks(), device=device)


@pytest.mark.parametrize(
    ("masks", "message"),
    [
        ("15 3 0", "rxChCtrlBitMask = 15: should be at most 7: the IWRL6432BOOST has 3"),
        ("7 7 0", "txChCtrlBitMask = 7: should be at most 3: the IWRL6432BOOST has 2"),
    ],
)
def test_antennas_that_an_xwrl_board_lacks_are_refused(masks: str, message: str) -> None:
    text = XWRL.replace("7 3 0", masks, 1)
    with pytest.raises(CaptureError, match=message):
        parse_ti_cfg(text, device="IWRL6432BOOST")
