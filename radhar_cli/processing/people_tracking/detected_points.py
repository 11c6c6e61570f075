"""Points of a frame as the firmware finds them: range, two angles, speed, and SNR."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Bool, Float, Index


class DetectedPoints(NamedTuple):
    """Points of a frame, in the order in which the firmware sends them.

    Attributes:
        bin: Range bin [n].
        azimuth: Azimuth, positive to the right [n], rad.
        elevation: Elevation, positive upwards [n], rad.
        doppler: Doppler bin, receding positive [n].
        snr: Power over the noise of the map [n].
        power: Power of the map [n].
    """

    bin: Index
    azimuth: Float
    elevation: Float
    doppler: Index
    snr: Float
    power: Float

    def where(self, chosen: Bool | Index | slice) -> "DetectedPoints":
        """Points of a mask, of indices or of a slice."""
        return DetectedPoints(
            self.bin[chosen],
            self.azimuth[chosen],
            self.elevation[chosen],
            self.doppler[chosen],
            self.snr[chosen],
            self.power[chosen],
        )

    @classmethod
    def joined(cls, parts: Sequence["DetectedPoints"]) -> "DetectedPoints":
        """Points of all parts, one after the other."""
        return cls(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
