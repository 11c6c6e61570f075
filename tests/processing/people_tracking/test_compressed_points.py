"""Points in the units of TLV 1020."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.dataset.formats.uart import HEADER, MAGIC, people_frames
from radhar_cli.processing.people_tracking.chain import as_rows
from radhar_cli.processing.people_tracking.compressed_points import (
    POINT,
    UNITS,
    Polar,
    encode_points,
    pack_points,
    unpack_points,
)
from radhar_cli.processing.people_tracking.detected_points import DetectedPoints


def polar(azimuth: float = 0.3, doppler: float = -0.5, snr: float = 20.0) -> Polar:
    r, elevation = 2.5, -0.1
    return Polar(*(np.array([value]) for value in (r, azimuth, elevation, doppler, snr)))


@given(
    st.floats(-1.25, 1.25),
    st.floats(-5, 5),
    st.floats(1, 2500),
)
def test_points_come_back_within_half_a_unit(azimuth: float, doppler: float, snr: float) -> None:
    points = polar(azimuth, doppler, snr)
    back = unpack_points(pack_points(points))
    for (name, value), unit in zip(
        points._asdict().items(), (0.00025, 0.01, 0.01, 0.00028, 0.04), strict=True
    ):
        coarser = 0.125 if name == "snr" else 0.0
        assert getattr(back, name) == pytest.approx(value, abs=unit / 2 * 1.000001 + coarser)


def test_rounding_is_half_away_from_zero_and_saturates() -> None:
    assert pack_points(polar(azimuth=0.025))["azimuth"] == 3
    assert pack_points(polar(azimuth=-0.025))["azimuth"] == -3
    assert pack_points(polar(azimuth=1.5))["azimuth"] == 127
    assert pack_points(polar(snr=1e9))["snr"] == 65535
    assert pack_points(polar(snr=3.99))["snr"] == 97  # 3.875, the eighth below


def test_a_message_has_its_units_and_eight_bytes_a_point() -> None:
    packed = pack_points(polar())
    message = encode_points(packed)
    assert struct.unpack("<5f", message[:20]) == pytest.approx(UNITS)
    assert struct.unpack("<2bh2H", message[20:]) == (-10, 30, -1786, 10000, 500)
    assert POINT.itemsize == 8


def test_a_cloud_of_radhar_becomes_the_points_that_it_is_of() -> None:
    index = np.array([20, 33])
    detected = DetectedPoints(
        index, np.array([0.2, -0.6]), np.array([0.1, -0.2]), index * 0 + 3, index + 0.5, index + 1.0
    )
    points = Polar.of_cloud(as_rows(detected, 0.06, 0.07).astype(np.float32))
    np.testing.assert_allclose(points.range, index * 0.06, atol=1e-5)
    np.testing.assert_allclose(points.azimuth, detected.azimuth, atol=1e-6)
    np.testing.assert_allclose(points.elevation, detected.elevation, atol=1e-6)
    np.testing.assert_allclose(points.doppler, 0.21, atol=1e-6)
    np.testing.assert_allclose(points.snr, detected.snr, rtol=1e-5)


def test_frames_follow_each_other_as_on_the_data_port() -> None:
    row = as_rows(
        DetectedPoints(*(np.array([value]) for value in (20, 0.2, 0.1, 3, 15.0, 2.0))), 0.06, 0.07
    )
    stream = b"".join(people_frames(iter([row, row[:0], np.vstack([row, row])])))
    start, counts = 0, []
    while start < len(stream):
        assert stream[start : start + 8] == MAGIC
        _, length, _, number, _, count, messages, _ = struct.unpack_from("<8I", stream, start + 8)
        assert length % 32 == 0
        assert number == len(counts)
        if messages:
            kind, size = struct.unpack_from("<2I", stream, start + HEADER)
            assert (kind, size) == (1020, 20 + 8 * count)
        counts.append(count)
        start += length
    assert (start, counts) == (len(stream), [1, 0, 2])
