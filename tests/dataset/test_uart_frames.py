"""Frames of simulated points, as boards send them, are read as `radhar import` reads a board's."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from radhar_cli.dataset.formats.uart import counting_frames, demo_frames, old_demo_frames
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.points.point_frames import RadarSteps
from radhar_cli.readers.points.point_messages import MessageReader
from radhar_cli.readers.points.uart_packets import open_dump

RANGE_M, SPEED_MPS = 0.05, 0.1
COUNTS = (3, 0, 64, 1)  # points of a frame


def draw_frames() -> list[Float]:
    """Points [n, 8] of frames, with whole bins and an SNR of tenths of a decibel."""
    draw = np.random.default_rng(3)
    frames = []
    for count in COUNTS:
        places = draw.uniform([0.5, -2, -1], [6, 2, 1], (count, 3))
        places = np.round(places * 1024) / 1024
        bins = draw.integers([0, -30], [120, 30], (count, 2))
        level = draw.integers(100, 60000, count)
        snr_db = draw.integers(110, 400, count) / 10
        doppler = bins[:, 1] * SPEED_MPS
        frames.append(np.column_stack([places, doppler, level, snr_db, bins]))
    return frames


def read_back(path: Path, encode: Callable[[Iterator[Float]], Iterator[bytes]]) -> list[Float]:
    """Points of a dump of the data port to which frames were written."""
    path.write_bytes(b"".join(encode(iter(draw_frames()))))
    dump = open_dump([path])
    reader = MessageReader(dump.framing.layout.is_people_counting, RadarSteps(RANGE_M, SPEED_MPS))
    frames = [reader.frame(packet) for packet in dump.packets()]
    assert [frame.number for frame in frames] == [*range(len(COUNTS))]
    return [frame.points for frame in frames]


def test_points_of_sdk_1_come_back_with_bins_and_levels(tmp_path: Path) -> None:
    for sent, read in zip(
        draw_frames(), read_back(tmp_path / "a.bin", old_demo_frames), strict=True
    ):
        columns = [0, 1, 2, 3, 4, 6, 7]
        np.testing.assert_allclose(read[:, columns], sent[:, columns], atol=1e-9)


def test_points_of_sdk_3_come_back_with_their_snr_and_level(tmp_path: Path) -> None:
    for sent, read in zip(draw_frames(), read_back(tmp_path / "a.bin", demo_frames), strict=True):
        np.testing.assert_allclose(read[:, :4], sent[:, :4], atol=1e-5)
        np.testing.assert_allclose(read[:, 5], sent[:, 5], atol=1e-9)
        np.testing.assert_allclose(read[:, 4], sent[:, 4], rtol=0.006)  # 0.05 dB


def test_points_of_people_counting_come_back_in_polar_coordinates(tmp_path: Path) -> None:
    frames = read_back(tmp_path / "a.bin", counting_frames)
    for sent, read in zip(draw_frames(), frames, strict=True):
        r = np.linalg.norm(sent[:, :3], axis=1)
        azimuth = np.arctan2(sent[:, 1], sent[:, 0])
        np.testing.assert_allclose(read[:, 0], r * np.cos(azimuth), atol=1e-5)
        np.testing.assert_allclose(read[:, 1], r * np.sin(azimuth), atol=1e-5)
        np.testing.assert_allclose(read[:, 2], 0)  # of one row of elements
        np.testing.assert_allclose(read[:, 3], sent[:, 3], atol=1e-6)
        np.testing.assert_allclose(read[:, 5], sent[:, 5], atol=1e-5)


@pytest.mark.parametrize("places", [[[40.0, -50.0, 1.0]]])
def test_what_whole_numbers_do_not_hold_is_cut(places: list[list[float]]) -> None:
    points = np.zeros((1, 8))
    points[:, :3], points[:, 4] = places, 1e6
    (frame,) = old_demo_frames(iter([points]))
    assert len(frame) % 32 == 0
    assert frame[36 + 8 + 4 :][:12] == np.array([0, 0, 65535, 32767, 32767, 1024], "<u2").tobytes()
