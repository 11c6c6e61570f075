"""Frames as TI's demos send them over the data port: a magic word, a header, messages (TLVs)."""

import struct
from collections.abc import Iterator, Mapping

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.people_tracking.compressed_points import (
    TLV,
    Polar,
    encode_points,
    pack_points,
)

MAGIC = bytes((2, 1, 4, 3, 6, 5, 8, 7))
VERSION, PLATFORM = 0x03060000, 0xA6843
HEADER = 40  # bytes, with the magic word
ALIGNED = 32  # bytes of which a frame is a multiple
DETECTED_POINTS, SIDE_INFO = 1, 7  # messages of the out-of-box demo of SDK 3
TENTH_DB = 10


def encode_frame(number: int, count: int, messages: Mapping[int, bytes]) -> bytes:
    """Write a frame.

    Args:
        number: Number of the frame.
        count: Number of its points.
        messages: {type: message}.
    """
    body = b"".join(
        struct.pack("<2I", kind, len(message)) + message for kind, message in messages.items()
    )
    padding = -(HEADER + len(body)) % ALIGNED
    length = HEADER + len(body) + padding
    fields = VERSION, length, PLATFORM, number, 0, count, len(messages), 0
    return MAGIC + struct.pack("<8I", *fields) + body + bytes(padding)


def people_frames(frames: Iterator[Float]) -> Iterator[bytes]:
    """Write frames of points [n, 8] as people tracking sends them."""
    for number, points in enumerate(frames):
        packed = pack_points(Polar.of_cloud(points))
        messages = {TLV: encode_points(packed)} if len(points) else {}
        yield encode_frame(number, len(points), messages)


def demo_frames(frames: Iterator[Float]) -> Iterator[bytes]:
    """Write frames of points [n, 8] as the out-of-box demo of SDK 3 sends them.

    The column of the noise is 0.
    """
    for number, points in enumerate(frames):
        x, y, z, doppler = points[:, :4].T
        places = np.column_stack([-y, x, z, -doppler]).astype("<f4")
        snr = np.round(points[:, 5] * TENTH_DB)
        side = np.column_stack([snr, np.zeros_like(snr)]).astype("<i2")
        messages = {DETECTED_POINTS: places.tobytes(), SIDE_INFO: side.tobytes()}
        yield encode_frame(number, len(points), messages if len(points) else {})
