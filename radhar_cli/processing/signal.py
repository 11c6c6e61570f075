"""A slow-time signal, simulated or recorded."""

from dataclasses import dataclass, replace

from radhar_cli.arrays import Complex, Float


@dataclass(frozen=True)
class Signal:
    """One complex sample a pulse.

    Attributes:
        x: [M].
        t0: time of x[0], s.
        prf: pulses per second, Hz.
        f0: frequency at which the Doppler is read, Hz.
    """

    x: Complex
    t0: float
    prf: float
    f0: float

    def times(self, samples: Float) -> Float:
        """Times (s) of sample numbers, which need not be whole."""
        return self.t0 + samples / self.prf

    def with_samples(self, x: Complex, later: float = 0.0) -> "Signal":
        """The same with other samples, `later` pulse intervals after these."""
        return replace(self, x=x, t0=self.t0 + later / self.prf)
