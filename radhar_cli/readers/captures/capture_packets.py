"""Packets of a DCA1000 as they came: with their headers in a file, or in a capture of the network.

A packet of the card has its number (32 bits, from 1) and the place of its first byte in the stream
(48 bits), then up to 1456 bytes, little endian (TI, "DCA1000EVM Data Capture Card User's Guide",
raw mode, UDP port 4098). mmWave Studio's files have the length (32 bits) between number and place.
Networks are captured as pcap or pcapng, of Ethernet.
"""

import struct
from collections.abc import Iterator, Sequence
from itertools import islice, pairwise
from pathlib import Path
from typing import BinaryIO, NamedTuple

from radhar_cli.errors import CaptureError

LONGEST = 2**11  # bytes of a packet
PORT = 4098
HEADERS_SEEN = 4  # packets in a row by which a file of packets is recognised
_STUDIO = struct.Struct("<IIIH")  # number, length, place
_UDP = struct.Struct("<IIH")  # number, place
PCAPS = {
    b"\xd4\xc3\xb2\xa1": "<",
    b"\xa1\xb2\xc3\xd4": ">",
    b"\x4d\x3c\xb2\xa1": "<",
    b"\xa1\xb2\x3c\x4d": ">",
}
PCAPNG = b"\x0a\x0d\x0d\x0a"
_ETHERNET, _IPV4, _VLAN, _UDP_PROTOCOL = 1, 0x0800, 0x8100, 17


class CardPacket(NamedTuple):
    """Samples of a packet.

    Attributes:
        number: Number of the packet.
        place: Place of its first byte in the stream.
        data: Bytes of samples.
    """

    number: int
    place: int
    data: bytes


def is_network_capture(head: bytes) -> bool:
    """Whether a file that begins so holds packets of a network."""
    return head[:4] in PCAPS or head[:4] == PCAPNG


def unpack_packets(
    files: Sequence[Path], scratch: Path, frame_bytes: int, notes: list[str]
) -> Path | None:
    """Write the stream of the packets of a capture, lost ones as zeros; add a note.

    Args:
        files: Files of the capture.
        scratch: Folder for the stream.
        frame_bytes: Bytes of a frame: frames before the first packet are left out.
        notes: Findings.

    Returns:
        File of the stream; None of a capture that has no packets but samples.

    Raises:
        CaptureError: There is no packet of a card in it, or most are lost.
    """
    if is_network_capture(_head_of(files[0])):
        packets = _network_packets(files)
    elif _are_studio_packets(files[0]):
        packets = _studio_packets(files)
    else:
        return None
    out = scratch / "stream.bin"
    begin, received, end, count, late = -1, 0, 0, 0, 0
    with out.open("wb") as stream:
        for packet in packets:
            if begin < 0:
                begin = packet.place // frame_bytes * frame_bytes
            place = packet.place - begin
            if place < 0:
                late += 1
                continue
            received, count = received + len(packet.data), count + 1
            end = max(end, place + len(packet.data))
            if end - received > max(received, frame_bytes):
                raise CaptureError(
                    f"{files[0]}: packet {packet.number} has its bytes at {packet.place}, after "
                    f"{received} that came: most packets are lost, or it is damaged"
                )
            stream.seek(place)
            stream.write(packet.data)
    if not count:
        raise CaptureError(
            f"{files[0]}: holds no packet of a DCA1000: UDP over IPv4 and Ethernet to port {PORT}"
        )
    lost = f"{end - received} of {end} bytes were lost and are zeros" * (end > received)
    notes.append(f"{count} packets of a DCA1000{'; ' * bool(lost)}{lost or ', none lost'}")
    if late:
        notes.append(f"{late} packets before the first are left out")
    return out


def _head_of(path: Path) -> bytes:
    """First bytes of a file."""
    with path.open("rb") as file:
        return file.read(4)


def _are_studio_packets(path: Path) -> bool:
    """Whether a file begins with packets whose numbers and places count up."""
    with path.open("rb") as file:
        first = [*islice(_packets_of(file), HEADERS_SEEN)]
    return len(first) == HEADERS_SEEN and all(
        before.number < after.number <= before.number + LONGEST
        and after.place - before.place >= (after.number - before.number) * len(before.data)
        for before, after in pairwise(first)
    )


def _packets_of(file: BinaryIO) -> Iterator[CardPacket]:
    """Yield packets of a file of mmWave Studio up to where there are no more."""
    while len(head := file.read(_STUDIO.size)) == _STUDIO.size:
        number, length, low, high = _STUDIO.unpack(head)
        if not 0 < length <= LONGEST:
            return
        data = file.read(length)
        if len(data) < length:
            return
        yield CardPacket(number, low + (high << 32), data)


def _studio_packets(files: Sequence[Path]) -> Iterator[CardPacket]:
    """Yield packets of files of mmWave Studio, the last of which may be cut off.

    Raises:
        CaptureError: What follows a packet is none.
    """
    for path in files:
        with path.open("rb") as file:
            yield from _packets_of(file)
            place = file.tell()
            if len(file.read(LONGEST)) == LONGEST:
                raise CaptureError(f"{path}: has no packet before byte {place}; damaged?")


def _network_packets(files: Sequence[Path]) -> Iterator[CardPacket]:
    """Yield packets of a card out of captures of a network."""
    for path in files:
        with path.open("rb") as file:
            head = file.read(4)
            frames = _pcapng_frames(file) if head == PCAPNG else _pcap_frames(path, file, head)
            for frame in frames:
                data = _udp_data(frame)
                if len(data) > _UDP.size:
                    number, low, high = _UDP.unpack_from(data)
                    yield CardPacket(number, low + (high << 32), data[_UDP.size :])


def _pcap_frames(path: Path, file: BinaryIO, magic: bytes) -> Iterator[bytes]:
    """Yield the frames of a pcap file after its magic number.

    Raises:
        CaptureError: They are not of Ethernet.
    """
    order = PCAPS[magic]
    header = file.read(20)
    link = struct.unpack(f"{order}I", header[16:])[0] if len(header) == 20 else -1
    if link != _ETHERNET:
        raise CaptureError(f"{path}: is of link type {link}; should be {_ETHERNET}, of Ethernet")
    while len(record := file.read(16)) == 16:
        length = struct.unpack(f"{order}I", record[8:12])[0]
        if length > 2**18:
            return
        yield file.read(length)


def _pcapng_frames(file: BinaryIO) -> Iterator[bytes]:
    """Yield the frames of a pcapng file, taken for Ethernet, from its first block on."""
    file.seek(8)
    order = "<" if file.read(4) == b"\x4d\x3c\x2b\x1a" else ">"
    file.seek(0)
    while len(head := file.read(8)) == 8:
        kind, length = struct.unpack(f"{order}II", head)
        if not 12 <= length <= 2**20:
            return
        body = file.read(length - 8)
        if kind == 6 and len(body) >= 20:  # enhanced packet
            yield body[20 : 20 + struct.unpack(f"{order}I", body[12:16])[0]]


def _udp_data(frame: bytes) -> bytes:
    """Data that an Ethernet frame brings to the port of a card; none of others."""
    kind = 12
    while frame[kind : kind + 2] == _VLAN.to_bytes(2):
        kind += 4
    begin = kind + 2
    if frame[kind:begin] != _IPV4.to_bytes(2) or len(frame) < begin + 28:
        return b""
    udp = begin + 4 * (frame[begin] & 15)
    if frame[begin + 9] != _UDP_PROTOCOL or frame[udp + 2 : udp + 4] != PORT.to_bytes(2):
        return b""
    return frame[udp + 8 : udp + int.from_bytes(frame[udp + 4 : udp + 6])]
