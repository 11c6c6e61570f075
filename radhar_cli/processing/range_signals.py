"""Slow-time signals of range bins, simulated or recorded."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from radhar_cli.arrays import Complex, Float
from radhar_cli.processing.canceller import Canceller


@dataclass(frozen=True)
class RangeSignals:
    """One complex sample a pulse in each of some consecutive range bins.

    Attributes:
        x: [K, M].
        ranges: of the bins [K], m.
        t0: time of x[:, 0], s.
        prf: pulses per second, Hz.
        f0: frequency at which the Doppler of a bin is read, Hz: that of mid-chirp.
        first: number of the first bin, as a `Gate` counts them.
    """

    x: Complex
    ranges: Float
    t0: float
    prf: float
    f0: float
    first: int = 0

    def times(self, samples: Float) -> Float:
        """Times (s) of sample numbers, which need not be whole."""
        return self.t0 + samples / self.prf

    def with_samples(self, x: Complex, later: float = 0.0) -> "RangeSignals":
        """The same with other samples, `later` pulse intervals after these."""
        return replace(self, x=x, t0=self.t0 + later / self.prf)

    def cancelled(
        self, canceller: Canceller, spans: Sequence[slice] | None = None
    ) -> "RangeSignals":
        """The same after a canceller, of these pulses of each bin alone; the others become 0."""
        if spans is None:
            return self.with_samples(canceller(self.x), canceller.delay)
        x = np.zeros((len(self.x), self.x.shape[1] - canceller.lost), self.x.dtype)
        for row, span in enumerate(spans):
            if span.stop - span.start > canceller.lost:
                x[row, span.start : span.stop - canceller.lost] = canceller(self.x[row, span])
        return self.with_samples(x, canceller.delay)
