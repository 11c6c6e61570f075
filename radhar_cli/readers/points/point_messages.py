"""Points and targets of the messages (TLVs) of TI's demos.

Types and structures: mmw_output.h and mmwdemo_adaptive... of TI's SDKs; TLV lists of the people
counting labs, the 3D people tracking demo and the xWRL6432's demos, as TI's visualizer reads them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.people_tracking.compressed_points import (
    POINT,
    UNITS,
    Polar,
    unpack_points,
)
from radhar_cli.processing.people_tracking.compressed_points import TLV as COMPRESSED
from radhar_cli.readers.points.point_frames import (
    PointFrame,
    RadarSteps,
    TiPoints,
    amplitude_of,
    are_measurements,
    decibels_of,
    make_targets,
    no_targets,
)
from radhar_cli.readers.points.uart_packets import Packet

COUNTED, COUNTED_TARGETS, COUNTED_INDEX = 6, 7, 8  # people counting labs
EXTENDED, EXTENDED_TARGETS, EXTENDED_INDEX = 301, 308, 309  # xWRL
SPHERICAL, TARGETS, INDEX = 1000, 1010, 1011  # people tracking

DETECTED_POINTS, SIDE_INFO = 1, 7  # messages of the out-of-box demo of SDK 3
Q_POINT = np.dtype([("range", "<u2"), ("doppler", "<i2"), ("peak", "<u2"), ("place", "<i2", (3,))])
DESCRIPTOR = np.dtype([("count", "<u2"), ("q", "<u2")])
SIDE = np.dtype([("snr", "<i2"), ("noise", "<i2")])
TENTH_DB = 0.1
UNITS_BYTES = 4 * len(UNITS)  # floats before compressed points
EXTENDED_UNITS = np.dtype(
    [("place", "<f4"), ("doppler", "<f4"), ("snr", "<f4"), ("noise", "<f4"), ("count", "<u2", (2,))]
)
EXTENDED_POINT = np.dtype(
    [("place", "<i2", (3,)), ("doppler", "<i2"), ("snr", "<u1"), ("noise", "<u1")]
)
_THREE = ("<f4", (3,))
TARGET_3D = np.dtype(
    [
        ("track", "<u4"),
        ("place", *_THREE),
        ("velocity", *_THREE),
        ("acceleration", *_THREE),
        ("covariance", "<f4", (16,)),
        ("gain", "<f4"),
        ("confidence", "<f4"),
    ]
)
TARGET_2D = np.dtype(
    [("track", "<u4")]
    + [(name, "<f4", (2,)) for name in ("place", "velocity", "acceleration")]
    + [("covariance", "<f4", (9,)), ("gain", "<f4")]
)
# Of the first 3D labs: two dimensions, then the third of place, velocity and acceleration.
TARGET_SHORT = np.dtype(
    [("track", "<u4")]
    + [(name, "<f4", (2,)) for name in ("place", "velocity", "acceleration")]
    + [("third", *_THREE)]
)


class MessageError(Exception):
    """A message whose length or numbers fit nothing that is known; says what."""


@dataclass(frozen=True)
class MessageReader:
    """Reads frames of packets, of one header.

    Attributes:
        is_people_counting: Whether messages have the numbers of the people counting labs.
        steps: Steps of the board, as far as they are known.
    """

    is_people_counting: bool
    steps: RadarSteps

    def frame(self, packet: Packet) -> PointFrame:
        """Points and targets of a packet; tracks of points are those that it names itself.

        Raises:
            MessageError: a message does not fit its type.
            CaptureError: points have bins of Doppler, and the step of a bin is unknown.
        """
        messages = packet.messages
        if self.is_people_counting:
            points, targets = _read_people_counting(messages)
        else:
            points, targets = self._read_points(messages, packet.points), _targets(messages)
        rows = points.rows(self.steps)
        if not are_measurements(rows) or not are_measurements(targets[:, 1:]):
            raise MessageError("holds infinite or huge numbers")
        return PointFrame(packet.number, rows, points.tracks(), targets)

    def index_of(self, packet: Packet) -> Float | None:
        """Track of each point of the frame before, as a packet says; None if it does not."""
        kinds = (COUNTED_INDEX,) if self.is_people_counting else (INDEX, EXTENDED_INDEX)
        for kind in kinds:
            if kind in packet.messages:
                return np.frombuffer(packet.messages[kind], "<u1").astype(float)
        return None

    def _read_points(self, messages: Mapping[int, bytes], count: int | None) -> TiPoints:
        """Points of the out-of-box demos, of xWRL boards and of people tracking."""
        if COMPRESSED in messages:
            return _unpack_compressed(messages[COMPRESSED])
        if EXTENDED in messages:
            return _unpack_extended(messages[EXTENDED])
        if SPHERICAL in messages:
            message = messages[SPHERICAL]
            if len(message) % 16 or (len(message) // 16 != count and _has_units(message)):
                return _unpack_compressed(message)
            return _with_side_info(_unpack_spherical(message), messages.get(SIDE_INFO))
        if DETECTED_POINTS not in messages:
            return TiPoints.empty()
        message = messages[DETECTED_POINTS]
        if is_q_format(message, count):
            return self._q_format(message)
        if len(message) % 16:
            raise MessageError(f"TLV 1 has {len(message)} bytes; should be 16 a point")
        values = np.frombuffer(message, "<f4").reshape(-1, 4).astype(float)
        unknown = np.full(len(values), np.nan)
        points = TiPoints(values[:, :3], values[:, 3], unknown, unknown)
        return _with_side_info(points, messages.get(SIDE_INFO))

    def _q_format(self, message: bytes) -> TiPoints:
        """Points of SDK 1 and 2: bins, a peak and places in 2^-q m."""
        descriptor = np.frombuffer(message, DESCRIPTOR, 1)[0]
        values = np.frombuffer(message, Q_POINT, int(descriptor["count"]), DESCRIPTOR.itemsize)
        if self.steps.speed_mps is None:
            raise CaptureError("points have bins of Doppler, and nothing says how fast one is")
        bins = np.column_stack([values["range"], values["doppler"]]).astype(float)
        return TiPoints(
            values["place"] * 2.0 ** -int(descriptor["q"]),
            bins[:, 1] * self.steps.speed_mps,
            values["peak"].astype(float),
            np.full(len(values), np.nan),
            bins,
        )


def is_q_format(message: bytes, count: int | None) -> bool:
    """Whether TLV 1 is that of SDK 1 and 2, by its descriptor and length.

    Args:
        message: the message.
        count: number of points by the header; None where it is unknown.
    """
    if len(message) < DESCRIPTOR.itemsize:
        return False
    descriptor = np.frombuffer(message, DESCRIPTOR, 1)[0]
    points, q = int(descriptor["count"]), int(descriptor["q"])
    fits = len(message) == DESCRIPTOR.itemsize + points * Q_POINT.itemsize and q <= 16
    return fits and (len(message) % 16 != 0 or count in (None, points))


def _with_side_info(points: TiPoints, message: bytes | None) -> TiPoints:
    """Points with SNR and noise of TLV 7, in tenths of dB; the amplitude is that of their sum."""
    if message is None:
        return points
    side = np.frombuffer(message[: len(message) // SIDE.itemsize * SIDE.itemsize], SIDE)
    if len(message) % SIDE.itemsize or len(side) != len(points.doppler):
        raise MessageError(
            f"TLV 7 has {len(message)} bytes; should be {SIDE.itemsize} for each of "
            f"{len(points.doppler)} points"
        )
    snr, noise = side["snr"] * TENTH_DB, side["noise"] * TENTH_DB
    return replace(points, snr_db=snr, intensity=amplitude_of(snr + noise))


def _of_polar(polar: Polar) -> TiPoints:
    """Points of ranges and angles, whose SNR is a ratio of powers."""
    snr = np.maximum(polar.snr, 0)
    return TiPoints(polar.places, polar.doppler, snr, decibels_of(snr))


def _has_units(message: bytes) -> bool:
    """Whether a message begins with five units of compressed points."""
    if len(message) < UNITS_BYTES or (len(message) - UNITS_BYTES) % POINT.itemsize:
        return False
    units = np.frombuffer(message, "<f4", len(UNITS))
    return bool(np.isfinite(units).all() and (units > 0).all() and (units < 1).all())


def _unpack_compressed(message: bytes) -> TiPoints:
    """Points of TLV 1020 (6 of the labs): five units, then whole numbers of them."""
    if not _has_units(message):
        raise MessageError(
            f"compressed points have {len(message)} bytes; should be five units between 0 and 1, "
            f"then {POINT.itemsize} bytes a point"
        )
    units = np.frombuffer(message, "<f4", len(UNITS)).astype(float)
    packed = np.frombuffer(message, POINT, offset=UNITS_BYTES)
    return _of_polar(unpack_points(packed, units.tolist()))


def _unpack_spherical(message: bytes) -> TiPoints:
    """Points of TLV 1000: range, azimuth, elevation and Doppler as floats."""
    r, azimuth, elevation, doppler = np.frombuffer(message, "<f4").reshape(-1, 4).astype(float).T
    unknown = np.full(len(r), np.nan)
    return TiPoints(
        Polar(r, azimuth, elevation, doppler, unknown).places, doppler, unknown, unknown
    )


def _unpack_extended(message: bytes) -> TiPoints:
    """Points of TLV 301 of xWRL boards: units, two counts, then places and Doppler."""
    size = len(message) - EXTENDED_UNITS.itemsize
    if size < 0 or size % EXTENDED_POINT.itemsize:
        raise MessageError(f"TLV 301 has {len(message)} bytes; should be 20 and 10 a point")
    units = np.frombuffer(message, EXTENDED_UNITS, 1)[0]
    values = np.frombuffer(message, EXTENDED_POINT, offset=EXTENDED_UNITS.itemsize)
    snr = values["snr"] * float(units["snr"])
    noise = values["noise"] * float(units["noise"])
    places = values["place"] * float(units["place"])
    doppler = values["doppler"] * float(units["doppler"])
    return TiPoints(places, doppler, amplitude_of(snr + noise), snr)


def _read_people_counting(messages: Mapping[int, bytes]) -> tuple[TiPoints, Float]:
    """Points and targets of the people counting labs."""
    message, points, is_flat = messages.get(COUNTED, b""), TiPoints.empty(), False
    if _has_units(message):
        points = _unpack_compressed(message)
    elif message and len(message) % 20 == 0 and not _is_flat(message, messages):
        points = _of_floats(message, columns=5)
    elif len(message) % 16 == 0:
        is_flat = bool(message)
        points = _of_floats(message, columns=4)
    else:
        raise MessageError(f"TLV 6 has {len(message)} bytes; should be 16 or 20 a point")
    return points, _read_counted_targets(messages.get(COUNTED_TARGETS, b""), is_flat)


def _is_flat(message: bytes, messages: Mapping[int, bytes]) -> bool:
    """Whether points of a length that fits 16 and 20 bytes have 16: as targets are flat."""
    targets = len(messages.get(COUNTED_TARGETS, b""))
    return len(message) % 16 == 0 and targets > 0 and targets % TARGET_2D.itemsize == 0


def _of_floats(message: bytes, columns: int) -> TiPoints:
    """Points of range, azimuth, (elevation,) Doppler and SNR as floats."""
    values = np.frombuffer(message, "<f4").reshape(-1, columns).astype(float).T
    r, azimuth, *elevation, doppler, snr = values
    return _of_polar(Polar(r, azimuth, (elevation or [np.zeros_like(r)])[0], doppler, snr))


def _read_counted_targets(message: bytes, is_flat: bool) -> Float:
    """Targets of the people counting labs, of two or three dimensions."""
    forms = (TARGET_2D,) if is_flat else (TARGET_3D, TARGET_SHORT, TARGET_2D)
    for form in forms:
        if len(message) % form.itemsize == 0:
            return _targets_of(np.frombuffer(message, form))
    raise MessageError(f"a list of targets has {len(message)} bytes; should be 68, 112 or 40 each")


def _targets(messages: Mapping[int, bytes]) -> Float:
    """Targets of people tracking and of xWRL boards [t, 11]."""
    for kind in (TARGETS, EXTENDED_TARGETS):
        if kind in messages:
            message = messages[kind]
            if len(message) % TARGET_3D.itemsize:
                raise MessageError(f"TLV {kind} has {len(message)} bytes; should be 112 a target")
            return _targets_of(np.frombuffer(message, TARGET_3D))
    return no_targets()


def _targets_of(values: np.ndarray) -> Float:
    """Targets [t, 11] of structures of TI."""
    names = values.dtype.names or ()
    vectors = []
    for number, name in enumerate(("place", "velocity", "acceleration")):
        vector = values[name].astype(float)
        if vector.shape[1] == 2:
            third = values["third"][:, number] if "third" in names else np.zeros(len(values))
            vector = np.column_stack([vector, third])
        vectors.append(vector)
    confidence = values["confidence"] if "confidence" in names else np.full(len(values), np.nan)
    place, velocity, acceleration = vectors
    return make_targets(values["track"].astype(float), place, velocity, acceleration, confidence)
