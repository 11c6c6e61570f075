"""Points as the people tracking firmware sends them: whole numbers of five units (TLV 1020).

Five floats, the units of elevation, azimuth (rad), speed (m/s), range (m) and SNR, then for each
point int8 elevation, int8 azimuth, int16 Doppler, uint16 range, uint16 SNR, little endian. What
does not fit saturates; the firmware's SNR would wrap above 4095.875.
"""

import struct
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from radhar_cli.numerics.arrays import Float

TLV = 1020
ELEVATION_RAD, AZIMUTH_RAD, SPEED_MPS, RANGE_M, SNR = UNITS = 0.01, 0.01, 0.00028, 0.00025, 0.04
SNR_FINEST = 8  # of 1, in the list from which the message is made
POINT = np.dtype(
    [
        ("elevation", "<i1"),
        ("azimuth", "<i1"),
        ("doppler", "<i2"),
        ("range", "<u2"),
        ("snr", "<u2"),
    ]
)
Packed: TypeAlias = NDArray[Any]  # of POINT


class Polar(NamedTuple):
    """Points by range and angles, of TI's signs.

    Attributes:
        range: Range [n], m.
        azimuth: Azimuth, positive to the right [n], rad.
        elevation: Elevation [n], rad.
        doppler: Speed, receding positive [n], m/s.
        snr: Power over the noise [n].
    """

    range: Float
    azimuth: Float
    elevation: Float
    doppler: Float
    snr: Float

    @classmethod
    def of_cloud(cls, points: Float) -> "Polar":
        """Points of the rows [n, 8] of a cloud of radhar."""
        x, y, z, doppler = points[:, :4].astype(float).T
        r = np.sqrt(x * x + y * y + z * z)
        elevation = np.arcsin(np.clip(z / np.where(r > 0, r, 1), -1, 1))
        snr = 10 ** (points[:, 5].astype(float) / 10)
        return cls(r, np.arctan2(-y, x), elevation, -doppler, snr)

    @property
    def places(self) -> Float:
        """Places [n, 3] (right, ahead, up), m."""
        level = self.range * np.cos(self.elevation)
        right, ahead = level * np.sin(self.azimuth), level * np.cos(self.azimuth)
        return np.column_stack([right, ahead, self.range * np.sin(self.elevation)])


def pack_points(points: Polar) -> Packed:
    """Round points to the units of the message, half away from zero."""
    snr = np.minimum(np.floor(points.snr * SNR_FINEST), np.iinfo(np.int16).max) / SNR_FINEST
    values = {
        "elevation": points.elevation / ELEVATION_RAD,
        "azimuth": points.azimuth / AZIMUTH_RAD,
        "doppler": points.doppler / SPEED_MPS,
        "range": points.range / RANGE_M,
        "snr": snr / SNR,
    }
    packed = np.zeros(points.range.size, POINT)
    for name, value in values.items():
        limits = np.iinfo(POINT[name])
        rounded = np.copysign(np.floor(np.abs(value) + 0.5), value)
        packed[name] = np.clip(rounded, limits.min, limits.max)
    return packed


def unpack_points(packed: Packed, units: Sequence[float] = UNITS) -> Polar:
    """Points that a receiver of the message has.

    Args:
        packed: Whole numbers [n] of the message.
        units: Units of elevation, azimuth (rad), speed (m/s), range (m) and SNR, in this order.
    """
    elevation_rad, azimuth_rad, speed_mps, range_m, snr = units
    return Polar(
        range=packed["range"] * range_m,
        azimuth=packed["azimuth"] * azimuth_rad,
        elevation=packed["elevation"] * elevation_rad,
        doppler=packed["doppler"] * speed_mps,
        snr=packed["snr"] * snr,
    )


def encode_points(packed: Packed) -> bytes:
    """Write the message of the points of a frame, without its type and length."""
    return struct.pack("<5f", *UNITS) + packed.tobytes()
