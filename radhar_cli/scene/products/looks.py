"""Looks at the echo of one channel: at its range profiles, and the taps that act before them."""

from dataclasses import replace

from radhar_cli.processing.canceller import Canceller, Fir, MeanRemoval
from radhar_cli.processing.look import Look, RangeBins
from radhar_cli.processing.signal import shown_pulses
from radhar_cli.radar.fmcw import Waveform


def look_at_profiles(waveform: Waveform, canceller: Canceller, width: int) -> Look:
    """Look at the range bins that a range-time map shows.

    After a `Fir` these are the pulses of the map's columns; before another canceller all pulses,
    on which its output depends. Of the pulses that are not shown, the mean depends on the sum.
    """
    if not isinstance(canceller, Fir):
        spans = [slice(0, waveform.n_pulses)] * waveform.n_bins
        look = Look.of_all("range_signals", RangeBins(waveform), spans=spans)
        by_sum = isinstance(canceller, MeanRemoval)
        return replace(look, columns=shown_pulses(look.count, width)) if by_sum else look
    pulses = shown_pulses(waveform.n_pulses - canceller.lost, width)
    from_start = replace(waveform, centred=False)  # of which the power is the same, for less work
    return Look("range_profiles", RangeBins(from_start), pulses, canceller.taps)


def taps_before_range(canceller: Canceller) -> tuple[float, ...]:
    """Taps of a canceller that acts before W; (1,) for one that acts on the whole recording."""
    return canceller.taps if isinstance(canceller, Fir) else (1.0,)
