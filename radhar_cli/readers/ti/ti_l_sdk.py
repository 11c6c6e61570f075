"""Chirps and frames of the .cfg of an xWRL board (MMWAVE-L-SDK): real samples, bursts, means.

The ADC divides 100 MHz, on the 6844 200 MHz. A sample may be the mean of chirps in a row. Where a
frame has several bursts, a loop is a burst; otherwise the chirps of the one burst are its loops.
"""

from collections.abc import Sequence

from radhar_cli.errors import CaptureError
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.frame_timing import FrameTiming, Sampling
from radhar_cli.readers.ti.ti_chirps import ROUNDING, ChirpProfile
from radhar_cli.readers.ti.ti_commands import CfgLine, describe_missing

IWRL6844 = "IWRL6844EVM"  # whose masks have two bits an antenna
_CLOCK_KSPS = {IWRL6844: 200e3}
_EXAMPLES = {
    "channelCfg": "channelCfg 7 3 0",
    "chirpComnCfg": "chirpComnCfg 15 5 0 128 1 34 3",
    "chirpTimingCfg": "chirpTimingCfg 6 26 1 47.95 60",
    "frameCfg": "frameCfg 2 0 600 64 200 0",
}
_TOGETHER = 4  # chirpTxMimoPatSel of two transmitters that send together


def read_l_sdk(lines: Sequence[CfgLine], where: str, device: str | None) -> FrameTiming:
    """Read all that lines say of chirps, frames and samples.

    Args:
        lines: Lines of a .cfg, of equal ones the last holds.
        where: File that messages name.
        device: Board that they run on; None for the likely one.

    Raises:
        CaptureError: A line is missing, cannot be read, or asks for what is not simulated.
    """
    last = {line.name: line for line in lines}
    for name, example in _EXAMPLES.items():
        if name not in last:
            raise CaptureError(f"{where}: {describe_missing(name, example)}")
    channels, frame = last["channelCfg"].numbers, last["frameCfg"]
    device = device or likely_l_device(int(channels["rxChCtrlBitMask"]))
    receivers = _antennas(last["channelCfg"], "rxChCtrlBitMask", device)
    transmitters = _antennas(last["channelCfg"], "txChCtrlBitMask", device)
    profile = _read_profile(last, device)
    profile.require_samples_within_ramp()
    masks, bpm = tuple(1 << n for n in transmitters), None
    pattern = last["chirpComnCfg"].numbers["chirpTxMimoPatSel"]
    if pattern == _TOGETHER:
        if len(masks) != 2:
            right = f"0 or 1: {len(masks)} transmitters are on (channelCfg), 4 is of two"
            raise last["chirpComnCfg"].refusal("chirpTxMimoPatSel", pattern, right)
        masks, bpm = (sum(masks),) * 2, (0, 1)
    averaged = max(1, int(frame.numbers["numOfChirpsAccum"]))
    slot_s = profile.slot_s * averaged
    loops, loop_s = _read_loops(frame, len(masks), slot_s * len(masks))
    follow = abs(loop_s - slot_s * len(masks)) <= 1e-9 * loop_s
    return profile.timing(
        slot_s=slot_s,
        masks=masks,
        loops=loops,
        frames=int(frame.numbers["numOfFrames"]),
        period_s=frame.numbers["framePeriodicity"] * 1e-3,
        receivers=receivers,
        sampling=Sampling.REAL,
        burst_s=None if follow else loop_s,
        bpm=bpm,
        averaged=averaged,
    )


def likely_l_device(receiver_mask: int) -> str:
    """Name the xWRL board that a mask of receivers is for."""
    return IWRL6844 if receiver_mask > 7 else "IWRL6432BOOST"


def _antennas(line: CfgLine, argument: str, device: str) -> tuple[int, ...]:
    """Numbers of the antennas that are on, from 0 on."""
    mask = int(line.numbers[argument])
    width = 2 if device == IWRL6844 else 1
    array = DEVICES[device].array
    count = len(array.rx if argument == "rxChCtrlBitMask" else array.tx)
    if mask >= 1 << count * width:
        right = f"at most {(1 << count * width) - 1}: the {device} has {count} of these antennas"
        raise line.refusal(argument, mask, right)
    antennas = tuple(n for n in range(count) if mask >> n * width & (1 << width) - 1)
    if not antennas:
        raise line.refusal(argument, mask, "a mask of antennas of which one is on")
    return antennas


def _read_profile(last: dict[str, CfgLine], device: str) -> ChirpProfile:
    """Read the ramp and the samples of a chirp."""
    common, times = last["chirpComnCfg"], last["chirpTimingCfg"].numbers
    rate_ksps = _CLOCK_KSPS.get(device, 100e3) / common.numbers["digOutputSampRate"]
    backoff_db = 0.0
    if "factoryCalibCfg" in last:
        backoff_db = last["factoryCalibCfg"].numbers["txBackoff"]
    return ChirpProfile(
        start_ghz=times["chirpRfFreqStart"],
        idle_us=times["chirpIdleTime"],
        adc_start_us=times["chirpAdcSkipSamples"] / rate_ksps * 1e3,
        ramp_end_us=common.numbers["chirpRampEndTime"],
        slope_mhz_per_us=times["chirpRfFreqSlope"],
        samples=int(common.numbers["numOfAdcSamples"]),
        rate_ksps=rate_ksps,
        backoff_db=(backoff_db,) * 4 if backoff_db else (),
        place=f"{common.place} numOfAdcSamples",
    )


def _read_loops(frame: CfgLine, turns: int, turns_s: float) -> tuple[int, float]:
    """Read the number of loops of a frame, and the time from loop to loop (s).

    Args:
        frame: Line frameCfg.
        turns: Number of chirps, or means of chirps, after which the transmitters repeat.
        turns_s: Time that they take, s.
    """
    numbers = frame.numbers
    chirps, bursts = int(numbers["numOfChirpsInBurst"]), int(numbers["numOfBurstsInFrame"])
    period_ms = numbers["framePeriodicity"]
    if bursts > 1:
        if chirps != turns:
            right = f"{turns}, one of each transmitter, where a frame has several bursts"
            raise frame.refusal("numOfChirpsInBurst", chirps, right)
        loops, loop_s = bursts, numbers["burstPeriodicity"] * 1e-6
        if turns_s > loop_s * ROUNDING:
            right = f"at least the {turns_s * 1e6:.6g} us of its chirps"
            raise frame.refusal("burstPeriodicity", numbers["burstPeriodicity"], right)
    else:
        if chirps % turns:
            right = f"a multiple of {turns}, the chirps after which transmitters repeat"
            raise frame.refusal("numOfChirpsInBurst", chirps, right)
        loops, loop_s = chirps // turns, turns_s
    if loops * loop_s > period_ms * 1e-3 * ROUNDING:
        right = f"at least {loops * loop_s * 1e3:.6g} ms, {loops} loops of {loop_s * 1e6:.6g} us"
        raise frame.refusal("framePeriodicity", period_ms, right)
    return loops, loop_s
