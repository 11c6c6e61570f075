"""Clouds of people tracking in the formats of others: as the board would have sent them."""

import csv
import struct

import numpy as np
from helpers.boards import CLOUDS
from helpers.command_line import radhar
from helpers.scatterers import ISK_CFG

from radhar_cli.dataset.formats.uart import HEADER
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.processing.people_tracking.compressed_points import POINT, UNITS, unpack_points


def test_exports_have_what_the_board_would_have_sent(tmp_path) -> None:
    (tmp_path / "board.cfg").write_text(ISK_CFG.replace("frameCfg 0 2 96", "frameCfg 0 2 24"))
    config = CLOUDS.replace("IWR1443BOOST", "IWR6843ISK").replace("cloud: {chain: board}\n", "")
    config = config.replace("samples_per_class: 5", "samples_per_class: 2")
    config = config.replace(
        "split: {train: 0.6, validation: 0.4}", "split: {train: 1, validation: 0}"
    )
    (tmp_path / "config.yaml").write_text(config.replace("duration_s: 0.5", "duration_s: 0.2"))
    made = radhar("generate", tmp_path / "config.yaml", "-o", tmp_path / "set", "--jobs", "1", "-q")
    assert made.returncode == 0, made.stderr
    made = radhar("convert", tmp_path / "set", "-o", tmp_path / "ti", "--to", "ti", "-q")
    assert made.returncode == 0, made.stderr
    with open_dataset(tmp_path / "set") as data:
        total = sum(len(data.products["points"][row]) for row in range(len(data)))
    paths = sorted((tmp_path / "ti" / "train").rglob("*.csv"))
    lines = [line for path in paths for line in csv.DictReader(path.read_text().splitlines())]
    table = {key: np.array([float(line[key]) for line in lines]) for key in lines[0]}
    assert len(lines) == total > 10
    messages = []
    for path in paths:
        stream, start = path.with_suffix(".bin").read_bytes(), 0
        while start < len(stream):
            length, count = (struct.unpack_from("<8I", stream, start + 8)[n] for n in (1, 5))
            first = start + HEADER + 8
            if count:
                assert np.allclose(struct.unpack_from("<5f", stream, first), UNITS)
                messages.append(np.frombuffer(stream, POINT, count, first + 20))
            start += length
    sent = unpack_points(np.concatenate(messages))
    for name, column in zip("xyz", sent.places.T, strict=True):
        np.testing.assert_allclose(table[name], column, atol=2e-5)
    np.testing.assert_allclose(table["doppler"], sent.doppler, atol=1e-5)
    np.testing.assert_allclose(table["snr"], sent.snr, rtol=1e-5)
    assert not table["noise"].any()
