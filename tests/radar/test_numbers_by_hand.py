"""Axes of real profiles against numbers that were computed by hand."""

from pathlib import Path
from typing import NamedTuple

import pytest

from radhar_cli.config.radar import BoardRadar
from radhar_cli.errors import CaptureError
from radhar_cli.readers.ti.ti_cfg import parse_ti_cfg
from radhar_cli.scene.radar import board_of

FILES = Path(__file__).with_name("cfg")
TURNS = "".join(f"chirpCfg {n} {n} 0 0 0 0 0 {1 << n}\n" for n in range(3))
HEAD = "channelCfg 15 7 0\nadcCfg 2 1\n"
ISK = (
    f"{HEAD}{TURNS}profileCfg 0 60.75 30 25 59.1 0 0 54.71 1 96 2950 2 1 36\n"
    "frameCfg 0 2 96 0 55 1 0\n"
)
ODS = (
    f"{HEAD}{TURNS}profileCfg 0 61.2 60 17 50 0 0 55.27 1 64 2000 0 0 30\n"
    "frameCfg 0 2 224 0 120 1 0\n"
)
REAL = """
channelCfg 15 1 0
adcCfg 2 0
profileCfg 0 77 220 6 132 0 0 4 0 3072 25000 0 0 30
chirpCfg 0 0 0 0 0 0 0 1
frameCfg 0 0 128 0 3072 500 1 0
"""
LOW_POWER = """
channelCfg 7 3 0
chirpComnCfg 15 5 0 128 1 34 3
chirpTimingCfg 6 26 1 47.95 60
frameCfg 2 0 600 64 200 0
"""


class Numbers(NamedTuple):
    """What a line of the table says of a board."""

    f_adc_ghz: float
    f_c_ghz: float
    band_mhz: float
    step_mm: float
    bins: int
    farthest_m: float
    turns: int
    loop_us: float
    loops: int
    n_doppler: int
    speed_step: float
    highest_speed: float
    busy_ms: float
    virtual: int


def text_of(name: str) -> str:
    return (FILES / f"{name}.cfg").read_text()


FIRST, SECOND = (62.11775, 62.998674, 1780.393), (77.399948, 79.151720, 3519.542)
# {case: (.cfg, device, f_adc, f_c, B, step, bins, R_max, n_TX, loop, L, N_D, speed step, v_max,
# busy, virtual elements)}
BY_HAND = {
    "pair": (
        *(text_of("people_isk_bpm"), "IWR6843ISK", *FIRST, 63.1446, 128, 8.0825),
        *(3, 267.3, 48, 64, 0.139085, 4.45072, 12.830, 12),
    ),
    "ISK": (
        *(ISK, "IWR6843ISK", *FIRST, 63.1446, 128, 8.0825),
        *(3, 267.3, 96, 128, 0.069543, 4.45072, 25.661, 12),
    ),
    "ODS": (
        *(ODS, "IWR6843ISK-ODS", 62.13959, 63.010092, 1768.640, 84.7523, 64, 5.4241),
        *(3, 330, 224, 256, 0.028160, 3.60443, 73.920, 12),
    ),
    "1642": (
        *(text_of("iwr1642_pc"), "IWR1642BOOST", 77.42, 78.944, 3072, 48.7943, 128, 6.2457),
        *(2, 184, 128, 128, 0.080620, 5.15969, 23.552, 8),
    ),
    "2944": (
        *(REAL, "AWR2944EVM", 77.024, 77.269680, 491.520, 228.7235, 2048, 468.4257),
        *(1, 352, 128, 128, 0.043056, 2.75555, 45.056, 4),
    ),
    "two profiles": (
        *(text_of("two_profiles"), "IWR1443BOOST", *SECOND, 36.6005, 256, 9.3697),
        *(2, 88, 60, 64, 0.336254, 10.76013, 5.280, 8),
    ),
    "chirp range": (
        *(text_of("chirp_range"), "IWR1443BOOST", 77.3, 79.070833, 3555.556, 42.1583, 256, 10.7925),
        *(1, 46, 192, 256, 0.160982, 20.60566, 8.832, 4),
    ),
    "level": (
        *(text_of("level_1tx1rx"), "IWR1443BOOST", 77.12824, 79.002376, 3751.936, 39.9517),
        *(1024, 40.9105, 1, 219.8, 1, 1, 8.632, 4.31611, 0.220, 1),
    ),
    "advframe, subframe 0": (
        *(text_of("advframe"), "IWR1443BOOST", 77.49, 79.203381, 3440.200, 43.5720, 256, 11.1544),
        *(1, 64.14, 64, 64, 0.461039, 14.75326, 4.105, 4),
    ),
    "advframe, subframe 1": (
        *(text_of("advframe"), "IWR1443BOOST", 77.21, 77.944306, 1474.371, 101.6679, 256, 26.0270),
        *(1, 71.14, 64, 64, 0.422389, 13.51644, 4.553, 4),
    ),
    "6432": (
        *(LOW_POWER, "IWRL6432BOOST", 60.187005, 60.643729, 920.640, 162.8174, 64, 10.4203),
        *(2, 600, 64, 64, 0.064369, 2.05979, 38.4, 6),
    ),
}


@pytest.mark.parametrize("case", BY_HAND)
def test_axes_are_those_computed_by_hand(case: str) -> None:
    cfg, device, *line = BY_HAND[case]
    numbers = Numbers(*map(float, line))
    subframe = int(case.endswith("subframe 1"))
    radar = BoardRadar[float].model_validate({"cfg": cfg, "device": device, "subframe": subframe})
    board = board_of(radar, 1.0)
    speed_step = board.doppler_step_mps()
    highest = speed_step * board.n_doppler / 2
    values = Numbers(
        *(
            board.carrier_hz / 1e9,
            board.centre_hz / 1e9,
            board.slope_hz * board.samples / board.adc_rate_hz / 1e6,
        ),
        *(board.range_step_m * 1e3, board.n_bins, radar.timing.farthest_m, len(board.order)),
        *(board.loop_s * 1e6, board.loops, board.n_doppler, speed_step, highest),
        *(board.loops * board.loop_s * 1e3, board.channels),
    )
    assert values == pytest.approx(numbers, rel=6e-5, abs=6e-4)
    assert board.waveform.n_bins == numbers.bins
    assert board.waveform.half_band_range == pytest.approx(numbers.farthest_m, rel=1e-4)


def test_subframes_follow_each_other() -> None:
    headers = [parse_ti_cfg(text_of("advframe"), subframe=number) for number in (0, 1)]
    assert [header.timing.delay_s for header in headers] == [0.0, pytest.approx(0.05)]
    assert [header.timing.period_s for header in headers] == [pytest.approx(0.1)] * 2
    assert [header.timing.order for header in headers] == [(0,), (2,)]


DDMA = """
channelCfg 15 15 0
adcCfg 2 0
profileCfg 0 77 10 6 26.7 0 0 32 0 384 30000 0 0 30
chirpCfg 0 0 0 0 0 0 0 15
frameCfg 0 0 768 0 384 50 1 0
"""


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", "board.cfg:5: chirpCfg txEnable = 15: should be one transmitter a chirp (the TDM"),
        ("ddmPhaseShiftAntOrder 0 1 2 3\n", "board.cfg:7: ddmPhaseShiftAntOrder: DDMA is not"),
    ],
)
def test_transmitters_that_all_send_at_once_are_refused(line: str, words: str) -> None:
    with pytest.raises(CaptureError) as caught:
        parse_ti_cfg(DDMA + line, "board.cfg")
    assert words in str(caught.value)
    assert "DDMA is not simulated" in str(caught.value)
    assert "should be one transmitter a chirp (the TDM demo's profile)" in str(caught.value)


def test_the_likely_board_of_low_power_has_as_many_receivers() -> None:
    """The ADC of the 6844 runs twice as fast, and two bits of a mask are an antenna."""
    assert parse_ti_cfg(LOW_POWER).timing.adc_rate_hz == pytest.approx(100e6 / 15)
    wide = LOW_POWER.replace("channelCfg 7 3", "channelCfg 153 255").replace(
        "frameCfg 2", "frameCfg 4"
    )
    header = parse_ti_cfg(wide)
    assert (header.timing.order, header.timing.receivers) == ((0, 1, 2, 3), (0, 1, 2, 3))
    assert header.timing.adc_rate_hz == pytest.approx(200e6 / 15)
    assert parse_ti_cfg(wide, device="IWRL6844EVM") == header


def test_bursts_and_means_of_low_power() -> None:
    burst = parse_ti_cfg(LOW_POWER.replace("frameCfg 2 0 600 64", "frameCfg 2 4 600 64")).timing
    assert (burst.averaged, burst.slot_s, burst.loop_s) == (4, pytest.approx(160e-6), 600e-6)
    single = parse_ti_cfg(LOW_POWER.replace("frameCfg 2 0 600 64", "frameCfg 64 0 600 1")).timing
    assert (single.loops, single.loop_s, single.burst_s) == (32, pytest.approx(80e-6), None)
    together = parse_ti_cfg(LOW_POWER.replace("128 1 34", "128 4 34")).timing
    assert (together.masks, together.bpm, together.order) == ((3, 3), (0, 1), (0, 1))
    less = parse_ti_cfg(f"{LOW_POWER}factoryCalibCfg 1 0 40 6 0x1ff000\n")
    assert less.timing.backoff_db == (6, 6, 6, 6)


WRONG_OF_LOW_POWER = [
    (
        "128 1 34",
        "256 1 34",
        "3: chirpComnCfg numOfAdcSamples = 256: should be at most 200: at 6.66",
    ),
    ("128 1 34", "128 2 34", "3: chirpComnCfg chirpTxMimoPatSel = 2: should be 0, 1 or 4 (0, 1:"),
    (
        "frameCfg 2 0",
        "frameCfg 4 0",
        "5: frameCfg numOfChirpsInBurst = 4: should be 2, one of each",
    ),
    (
        "frameCfg 2 0 600 64",
        "frameCfg 3 0 600 1",
        "numOfChirpsInBurst = 3: should be a multiple of 2",
    ),
    (
        "frameCfg 2 0 600 64 200",
        "frameCfg 2 0 600 64 30",
        "= 30: should be at least 38.4 ms, 64 lo",
    ),
    (
        "frameCfg 2 0 600",
        "frameCfg 2 9 600",
        "burstPeriodicity = 600: should be at least the 720 us",
    ),
    (
        "frameCfg 2 0 600 64 200 0",
        "",
        "board.cfg: frameCfg is missing; a line that would do: frameCfg",
    ),
    (
        "channelCfg 7 3 0",
        "channelCfg 7 3",
        "2: channelCfg has 2 numbers: should be 3: channelCfg rx",
    ),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG_OF_LOW_POWER)
def test_what_low_power_boards_cannot_do_is_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(CaptureError) as caught:
        parse_ti_cfg(LOW_POWER.replace(old, new), "board.cfg")
    assert message in str(caught.value)
