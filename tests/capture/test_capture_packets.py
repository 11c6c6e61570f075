"""Packets of the DCA1000 with their headers are the stream that they carry."""

import struct
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from capture.dca1000_file import Radar, write_studio
from capture.test_lost_packets import made_echo, words
from helpers.command_line import radhar

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording

RADAR = Radar()
SIZE = 1456
Packets = Sequence[tuple[int, bytes]]  # places and bytes


def packets_of(data: bytes, *lost: int) -> Packets:
    whole = [(at, data[at : at + SIZE]) for at in range(0, len(data), SIZE)]
    return [packet for number, packet in enumerate(whole) if number not in lost]


def studio(packets: Packets) -> bytes:
    return b"".join(
        struct.pack("<IIQ", at // SIZE + 1, len(data), at)[:14] + data for at, data in packets
    )


def ethernet(packets: Packets, port: int = 4098, tag: bytes = b"") -> list[bytes]:
    frames = []
    for at, data in packets:
        payload = struct.pack("<IQ", at // SIZE + 1, at)[:10] + data
        udp = struct.pack(">HHHH", 4096, port, len(payload) + 8, 0) + payload
        ip = struct.pack(">BBHHHBBHII", 0x45, 0, len(udp) + 20, 0, 0, 64, 17, 0, 1, 2) + udp
        frames.append(bytes(12) + tag + b"\x08\x00" + ip)
    return frames


def pcap(packets: Packets, order: str = "<", link: int = 1, **more: object) -> bytes:
    out = struct.pack(f"{order}IHHIIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, link)
    others = ethernet([(0, b"configuration")], port=4096)  # of the same card
    for frame in [*others, *ethernet(packets, **more)]:
        out += struct.pack(f"{order}IIII", 0, 0, len(frame), len(frame)) + frame
    return out


def big_pcap(packets: Packets) -> bytes:
    return pcap(packets, ">")


def tagged_pcap(packets: Packets) -> bytes:
    return pcap(packets, tag=b"\x81\x00\x00\x05")


def pcapng(packets: Packets) -> bytes:
    def block(kind: int, body: bytes) -> bytes:
        body += bytes(-len(body) % 4)
        size = struct.pack("<I", len(body) + 12)
        return struct.pack("<I", kind) + size + body + size

    out = block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1))
    out += block(1, struct.pack("<HHI", 1, 0, 0))
    for frame in ethernet(packets):
        out += block(6, struct.pack("<IIIII", 0, 0, 0, len(frame), len(frame)) + frame)
    return out


FORMS = {"_Raw_0.bin": studio, ".pcap": pcap, ".cap": big_pcap, ".dump": tagged_pcap,
         ".pcapng": pcapng}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_packets_are_read_and_lost_ones_are_zeros(tmp_path: Path, form: str) -> None:
    write: Callable[[Packets], bytes] = FORMS[form]
    echo = made_echo()
    stream = words(echo, 2)
    packets = [*packets_of(stream.tobytes(), 40, 41, 150)]
    packets[10], packets[11] = packets[11], packets[10]  # networks exchange packets
    (tmp_path / f"adc{form}").write_bytes(write(packets))
    header = write_studio(tmp_path / "radar.mmwave.json", RADAR)
    read = read_settings(header, ["beat=positive"])
    import_capture([tmp_path / f"adc{form}"], tmp_path / "out.h5", read, str(header))
    with Recording(tmp_path / "out.h5") as recording:
        lost = np.asarray(recording.flags & 1, bool)
        found = recording.beat(0, recording.info.pulses) / 8000
        told = " ".join(recording.info.source.findings)
    assert np.abs(found - echo)[..., ~lost].max() < 2 / 8000
    assert 0 < lost.sum() <= 9
    assert f"{3 * SIZE} of {stream.nbytes} bytes were lost" in told


def test_a_recording_that_began_within_the_stream_begins_with_its_frame(tmp_path: Path) -> None:
    echo = made_echo()
    stream = words(echo, 2).tobytes()
    frame = len(stream) // 4
    late = 40 * frame
    packets = [(at + late, data) for at, data in packets_of(stream)[2:]]
    (tmp_path / "adc_Raw_0.bin").write_bytes(studio(packets))
    header = write_studio(tmp_path / "radar.mmwave.json", RADAR)
    read = read_settings(header, ["beat=positive"])
    import_capture([tmp_path / "adc_Raw_0.bin"], tmp_path / "out.h5", read, str(header))
    with Recording(tmp_path / "out.h5") as recording:
        lost = np.asarray(recording.flags & 1, bool)
        found = recording.beat(0, recording.info.pulses) / 8000
    assert np.flatnonzero(lost).tolist() == [*range(-(-2 * SIZE // 1024))]
    assert np.abs(found - echo)[..., ~lost].max() < 2 / 8000


DAMAGED = {
    "no packet of a card": (pcap([]), "holds no packet of a DCA1000"),
    "another link": (pcap(packets_of(bytes(9000)), link=105), "is of link type 105"),
    "a place beyond all": (
        studio([*packets_of(bytes(9000)), (2**41, b"x" * SIZE)]),
        "most packets are lost, or it is damaged",
    ),
    "samples after packets": (
        studio(packets_of(bytes(9000))) + b"\xff" * 5000,
        "has no packet before byte",
    ),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_damaged_packets_are_refused_in_a_line(tmp_path: Path, damage: str) -> None:
    data, words_of_refusal = DAMAGED[damage]
    capture = tmp_path / ("adc.pcap" if data[:1] == b"\xd4" else "adc_Raw_0.bin")
    capture.write_bytes(data)
    header = write_studio(tmp_path / "radar.mmwave.json", RADAR)
    done = radhar("import", capture, "--radar", header, "-o", tmp_path / "out.h5")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert words_of_refusal in done.stderr
    assert not (tmp_path / "out.h5").exists()
