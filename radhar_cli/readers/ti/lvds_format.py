"""Order of the words in a raw capture over LVDS (dca1000.py)."""

from collections.abc import Sequence
from dataclasses import dataclass

from radhar_cli.readers.ti.ti_commands import CfgLine


@dataclass(frozen=True)
class LvdsFormat:
    """Order of the words in a raw capture.

    Attributes:
        lanes: Number of lanes, 2 or 4.
        is_interleaved: Whether the receivers alternate from sample to sample.
        is_q_first: Whether the quadrature part of a sample comes first.
    """

    lanes: int
    is_interleaved: bool
    is_q_first: bool


def read_lvds_format(lines: Sequence[CfgLine], subframe: int) -> LvdsFormat:
    """Read the order of words of a subframe; a demo without adcbufCfg has two lanes.

    Args:
        lines: Lines of a .cfg.
        subframe: Number of the subframe, 0 of a frame without.

    Raises:
        CaptureError: A line cannot be read, or sends headers that are not read.
    """
    is_swapped, is_interleaved = False, False
    for line in lines:
        if line.name == "lvdsStreamCfg":
            header = line.numbers["enableHeader"]
            if header:
                raise line.refusal("enableHeader", header, "0: streams with headers are not read")
        if line.name == "adcbufCfg" and line.holds_for(subframe):
            numbers = line.numbers
            is_swapped = numbers["SampleSwap"] == 1
            is_interleaved = numbers["ChanInterleave"] == 0
    return LvdsFormat(4 if is_interleaved else 2, is_interleaved, is_swapped)


def sends_samples(lines: Sequence[CfgLine], subframe: int) -> bool:
    """Whether the stream has the samples of a subframe: not where dataFmt of its last line is 0.

    Args:
        lines: Lines of a .cfg.
        subframe: Number of the subframe.

    Raises:
        CaptureError: A line lvdsStreamCfg cannot be read.
    """
    formats = [
        line.numbers["dataFmt"]
        for line in lines
        if line.name == "lvdsStreamCfg" and line.holds_for(subframe)
    ]
    return formats[-1:] != [0]
