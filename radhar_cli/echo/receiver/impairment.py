"""Interface of impairments, which act on an echo between the antenna and the processing."""

from radhar_cli.errors import RadharError
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processing.look import Look


class Impairment:
    """Base of impairments: all that one needs is `apply`."""

    # whether it adds to the echo something that does not depend on it. Only then does it hold for
    # echoes from which what stands still was left out, and for sums over samples; others need raw
    # samples of the whole echo, which the direct engine does not make: it refuses them.
    additive: bool = True

    def apply(self, x: Complex, look: Look) -> Complex:
        """Impair an echo.

        A recording may come in consecutive blocks: `look.state_of(self, start)` holds what is kept
        from one to the next.

        Args:
            x: The echo [K, M] as `look` shows it, which may be overwritten; raw samples unless the
                impairment is additive.

        Returns:
            The impaired echo [K, M].
        """
        raise RadharError(f"{type(self).__name__}: has no method apply; should have it")
