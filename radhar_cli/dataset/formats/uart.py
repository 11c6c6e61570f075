"""Frames as TI's demos send them over the data port: a magic word, a header, messages (TLVs)."""

import struct
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.people_tracking.compressed_points import (
    TLV,
    Polar,
    encode_points,
    pack_points,
)
from radhar_cli.readers.points.point_messages import DETECTED_POINTS, Q_POINT, SIDE_INFO
from radhar_cli.readers.points.uart_packets import ALIGNED, MAGIC

VERSION, PLATFORM = 0x03060000, 0xA6843
HEADER = 40  # bytes, with the magic word
TENTHS = 10  # of a decibel, in which SNR and noise are sent
LEAST = 1e-9  # amplitude whose decibels are finite
OLD_VERSION, OLD_PLATFORM, OLD_HEADER = 0x01020000, 0xA1443, 36  # of SDK 1
Q_FORMAT = 10  # binary places of the coordinates of SDK 1, m
COUNTED_POINTS, COUNTING_HEADER, COUNTING_PLATFORM = 6, 52, 0xA1642  # of people counting
TYPE_AND_LENGTH = 8  # bytes before a message


def encode_message(kind: int, message: bytes, counted: int = 0) -> bytes:
    """Write a message (TLV) with its type and length.

    Args:
        kind: Type of the message.
        counted: Bytes of type and length that the length counts, too; 0 but of people counting.
    """
    return struct.pack("<2I", kind, len(message) + counted) + message


def encode_frame(number: int, count: int, messages: Mapping[int, bytes]) -> bytes:
    """Write a frame.

    Args:
        number: Number of the frame.
        count: Number of its points.
        messages: {type: message}.
    """
    body = b"".join(encode_message(kind, message) for kind, message in messages.items())
    padding = -(HEADER + len(body)) % ALIGNED
    length = HEADER + len(body) + padding
    fields = VERSION, length, PLATFORM, number, 0, count, len(messages), 0
    return MAGIC + struct.pack("<8I", *fields) + body + bytes(padding)


def encode_old_frame(number: int, points: NDArray[np.void]) -> bytes:
    """Write a frame of the demos of SDK 1: a shorter header, and points of whole numbers.

    Args:
        number: Number of the frame.
        points: Points [n] of Q_POINT.
    """
    head = struct.pack("<2H", len(points), Q_FORMAT) if len(points) else b""
    message = head + points.tobytes()
    tlv = encode_message(DETECTED_POINTS, message) if len(points) else b""
    padding = -(OLD_HEADER + len(tlv)) % ALIGNED
    length = OLD_HEADER + len(tlv) + padding
    fields = OLD_VERSION, length, OLD_PLATFORM, number, 0, len(points), int(len(points) > 0)
    return MAGIC + struct.pack("<7I", *fields) + tlv + bytes(padding)


def old_demo_frames(frames: Iterator[Float]) -> Iterator[bytes]:
    """Write frames of points [n, 8] as the out-of-box demos of SDK 1 send them.

    Places are in steps of 2^-10 m; those beyond 32 m are cut there.
    """
    limits = np.iinfo(np.int16)
    for number, points in enumerate(frames):
        packed = np.zeros(len(points), Q_POINT)
        places = np.round(_places_of(points) * 2.0**Q_FORMAT)
        packed["place"] = np.clip(places, limits.min, limits.max)
        packed["range"], packed["doppler"] = np.round(points[:, 6]), -np.round(points[:, 7])
        packed["peak"] = np.clip(np.round(points[:, 4]), 0, np.iinfo(np.uint16).max)
        yield encode_old_frame(number, packed)


def _places_of(points: Float) -> Float:
    """Places [n, (right, ahead, up)] in TI's axes of points [n, 8] in radhar's, m."""
    x, y, z = points[:, :3].T
    return np.column_stack([-y, x, z])


def counting_frames(frames: Iterator[Float]) -> Iterator[bytes]:
    """Write frames of points [n, 8] as people counting sends them.

    A point is range, azimuth to the right, Doppler away, and SNR as a ratio of powers.
    """
    for number, points in enumerate(frames):
        polar = Polar.of_cloud(points)
        numbers = [polar.range, polar.azimuth, polar.doppler, polar.snr]
        message = np.column_stack(numbers).astype("<f4").tobytes()
        tlv = encode_message(COUNTED_POINTS, message, TYPE_AND_LENGTH) if message else b""
        length = COUNTING_HEADER + len(tlv)
        fields = OLD_VERSION, COUNTING_PLATFORM, 0, length, number, 0, 0, 0, 0, 0
        yield MAGIC + struct.pack("<10I2H", *fields, int(bool(message)), 0) + tlv


def people_frames(frames: Iterator[Float]) -> Iterator[bytes]:
    """Write frames of points [n, 8] as people tracking sends them."""
    for number, points in enumerate(frames):
        packed = pack_points(Polar.of_cloud(points))
        messages = {TLV: encode_points(packed)} if len(points) else {}
        yield encode_frame(number, len(points), messages)


def demo_frames(frames: Iterator[Float]) -> Iterator[bytes]:
    """Write frames of points [n, 8] as the out-of-box demo of SDK 3 sends them.

    Noise is the level of a point less its SNR, both in tenths of a decibel.
    """
    limits = np.iinfo(np.int16)
    for number, points in enumerate(frames):
        places = np.column_stack([_places_of(points), -points[:, 3]]).astype("<f4")
        snr = np.round(points[:, 5] * TENTHS)
        level = np.round(20 * TENTHS * np.log10(np.maximum(points[:, 4], LEAST)))
        side = np.clip(np.column_stack([snr, level - snr]), limits.min, limits.max).astype("<i2")
        messages = {DETECTED_POINTS: places.tobytes(), SIDE_INFO: side.tobytes()}
        yield encode_frame(number, len(points), messages if len(points) else {})
