"""The interface of what happens to an echo between the antenna and the processing."""

from collections.abc import Iterator, Sequence

from radhar_cli.arrays import Complex, Index
from radhar_cli.errors import RadharError
from radhar_cli.processing.canceller import Fir


class Impairment:
    """Base of impairments; each form of the echo has a method of its own.

    `beat` is the whole echo, all that `engine.kind: cube` and raw echoes need. The others are what
    becomes of the impairment in the form that `engine.kind: direct` makes for a map; without the
    method that map is refused there, as it would be shown without the impairment.
    """

    def beat(self, blocks: Iterator[Complex]) -> Iterator[Complex]:
        """Of a beat matrix in blocks [N_ADC, some pulses], in the order of time."""
        raise self._without("beat", "the beat matrix")

    def slow_time(self, y: Complex) -> Complex:
        """Of the slow-time signal [M] before the canceller, which it leaves as it is."""
        raise self._without("slow_time", "Doppler-time maps")

    def range_bins(self, bins: Complex, pulses: Index, canceller: Fir) -> Complex:
        """Of range bins [N_FFT/2, len(pulses)] after the canceller.

        Args:
            bins: referred to the chirp's start (`range_bins`).
            pulses: first pulse of each, as the canceller's output counts them.
            canceller: what was applied.
        """
        raise self._without("range_bins", "the range-time map")

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
        raise self._without("range_signals", "a gate, or a range-time map after its canceller,")

    def _without(self, method: str, needed_by: str) -> RadharError:
        cure = "" if method == "beat" else ", or engine.kind: cube, which needs beat alone"
        return RadharError(
            f"{type(self).__name__}: has no method {method}, which {needed_by} needs; should "
            f"have it{cure}"
        )
