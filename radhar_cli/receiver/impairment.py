"""The interface of what happens to an echo between the antenna and the processing."""

from collections.abc import Iterator, Sequence

from radhar_cli.arrays import Complex, Index
from radhar_cli.processing.canceller import Fir


class Impairment:
    """Base of impairments, which changes nothing; each form of the echo has a method of its own."""

    def beat(self, blocks: Iterator[Complex]) -> Iterator[Complex]:
        """Of a beat matrix in blocks [N_ADC, some pulses], in the order of time."""
        return blocks

    def slow_time(self, y: Complex) -> Complex:
        """Of the slow-time signal [M] before the canceller, which it leaves as it is."""
        return y

    def range_bins(self, bins: Complex, pulses: Index, canceller: Fir) -> Complex:
        """Of range bins [N_FFT/2, len(pulses)] after the canceller.

        Args:
            bins: referred to the chirp's start (`range_bins`).
            pulses: first pulse of each, as the canceller's output counts them.
            canceller: what was applied.
        """
        del pulses, canceller
        return bins

    def range_signals(
        self, x: Complex, bins: slice, spans: Sequence[slice] | None = None
    ) -> Complex:
        """Of range bins [K, M] of all pulses before the canceller, referred to mid-chirp.

        Args:
            x: the bins.
            bins: which of the N_FFT/2 these are.
            spans: pulses of each bin that count; what the others become does not matter. None is
                all.
        """
        del bins, spans
        return x
