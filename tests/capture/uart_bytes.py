"""Bytes of TI's demos, written field by field as their structures are documented."""

import struct

import numpy as np

MAGIC = bytes((2, 1, 4, 3, 6, 5, 8, 7))
UNITS = (0.01, 0.01, 0.00028, 0.00025, 0.04)


def tlvs(messages, counts_itself=False):
    return b"".join(
        struct.pack("<2I", kind, len(body) + 8 * counts_itself) + body for kind, body in messages
    )


def demo_packet(number, messages, points=0, size=40, padded=True, subframe=0):
    """A packet with the header of SDK 1 (36), 2 and later (40), or the area scanner (44)."""
    body = tlvs(messages)
    length = size + len(body)
    padding = -length % 32 if padded else 0
    fields = [0x01020304, length + padding, 0xA1443, number, 77, points, len(messages)]
    fields += [subframe, 0][: (size - 36) // 4]
    return MAGIC + struct.pack(f"<{len(fields)}I", *fields) + body + bytes(padding)


def counting_packet(number, messages, size=48, counts_itself=True):
    """A packet of the people counting labs, whose header has 48 (3D) or 52 bytes."""
    body = tlvs(messages, counts_itself)
    length = size + len(body)
    before = [3, length, 0xA6843, number] if size == 48 else [3, 0xA1642, 99, length, number]
    rest = [0, 1, 2, 3, 4]  # subframe, margins, times
    return (
        MAGIC
        + struct.pack("<9I" if size == 48 else "<10I", *before, *rest)
        + struct.pack("<2H", len(messages), 0xBEEF)
        + body
    )


def q_points(points, q=9):
    """TLV 1 of SDK 1 and 2, of (range bin, Doppler bin, peak, x, y, z) with places in m."""
    rows = [
        struct.pack("<HhH3h", r, d, p, *(round(value * 2**q) for value in place))
        for r, d, p, *place in points
    ]
    return struct.pack("<2H", len(points), q) + b"".join(rows)


def floats(rows):
    return np.asarray(rows, "<f4").tobytes()


def side_info(rows):
    return np.round(np.asarray(rows) * 10).astype("<i2").tobytes()


def compressed(points, units=UNITS):
    """TLV 1020 of (elevation, azimuth, Doppler, range, SNR)."""
    rows = [
        struct.pack("<2bh2H", *(round(v / u) for v, u in zip(row, units, strict=True)))
        for row in points
    ]
    return struct.pack("<5f", *units) + b"".join(rows)


def target(track, place, velocity=(0, 0, 0), acceleration=(0, 0, 0), confidence=0.9):
    """A target of 112 bytes, of TLVs 1010 and 308."""
    numbers = (*place, *velocity, *acceleration, *([0.5] * 16), 3.0, confidence)
    return struct.pack("<I27f", track, *numbers)


def flat_target(track, place, velocity=(0, 0), acceleration=(0, 0)):
    """A target of 68 bytes, of the people counting labs in two dimensions."""
    return struct.pack("<I16f", track, *place, *velocity, *acceleration, *([0.1] * 10))
