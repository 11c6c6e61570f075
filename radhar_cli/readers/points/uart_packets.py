"""Packets of TI's demos in a dump of their data port: magic word, header, messages (TLVs).

Bytes may be missing anywhere: whatever is no whole packet is left out, up to the next magic word.
Headers as TI's demos have them (mmw_output.h of SDK 1 to 5; area scanner; people counting labs).
"""

import struct
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from radhar_cli.errors import CaptureError

MAGIC = bytes((2, 1, 4, 3, 6, 5, 8, 7))
ALIGNED = 32  # bytes of which a frame is a multiple
MAX_PACKET = 2**20  # bytes; heat maps of 256 bins by 256 take a quarter of it
MAX_MESSAGES = 64  # of a packet
BLOCK = 2**16  # bytes that are read at once
PROBED = 200  # packets by which the header is recognised
TYPE_AND_LENGTH = struct.Struct("<2I")
_WORD, _HALF = struct.Struct("<I"), struct.Struct("<H")


@dataclass(frozen=True)
class HeaderLayout:
    """Places of a header's fields, bytes from the start of the magic word.

    Attributes:
        name: Software that has it, in words.
        size: Length of the header.
        length: Place of the length of the packet.
        number: Place of the number of the frame.
        subframe: Place of the number of the subframe; None where there is none.
        points: Place of the number of points; None where there is none.
        messages: Place of the number of messages, and its format.
        counts_itself: Whether the length of a message may count its type and length.
    """

    name: str
    size: int
    length: int
    number: int
    subframe: int | None
    points: int | None
    messages: tuple[int, struct.Struct]
    counts_itself: bool = False

    @property
    def is_people_counting(self) -> bool:
        """Whether its messages have the numbers of the people counting labs."""
        return self.counts_itself


LAYOUTS = (
    HeaderLayout("SDK 2 and later", 40, 12, 20, 36, 28, (32, _WORD)),
    HeaderLayout("SDK 1 and 2", 36, 12, 20, None, 28, (32, _WORD)),
    HeaderLayout("area scanner", 44, 12, 20, 36, 28, (32, _WORD)),
    HeaderLayout("3D people counting", 48, 12, 20, 24, None, (44, _HALF), True),
    HeaderLayout("people counting", 52, 20, 24, 28, None, (48, _HALF), True),
)


@dataclass(frozen=True)
class Framing:
    """Law by which packets of a dump are cut into messages."""

    layout: HeaderLayout
    length_counts_itself: bool  # of a message: whether it counts type and length

    def read(self, packet: bytes) -> "Packet | None":
        """Cut a packet, from its magic word to its end, into messages; None if they do not fit."""
        layout = self.layout
        if len(packet) < layout.size:
            return None
        place, form = layout.messages
        (count,) = form.unpack_from(packet, place)
        if count > MAX_MESSAGES:
            return None
        messages, offset = list[tuple[int, bytes]](), layout.size
        for _ in range(count):
            if offset + TYPE_AND_LENGTH.size > len(packet):
                return None
            kind, length = TYPE_AND_LENGTH.unpack_from(packet, offset)
            length -= TYPE_AND_LENGTH.size * self.length_counts_itself
            offset += TYPE_AND_LENGTH.size
            if not 0 < kind < 2**16 or length < 0 or offset + length > len(packet):
                return None
            messages.append((kind, packet[offset : offset + length]))
            offset += length
        if len(packet) - offset >= ALIGNED:
            return None
        words = [
            None if where is None else _WORD.unpack_from(packet, where)[0]
            for where in (layout.number, layout.subframe, layout.points)
        ]
        return Packet(words[0] or 0, words[1] or 0, words[2], dict(messages), len(packet) - offset)


@dataclass(frozen=True)
class Packet:
    """A packet: the messages of a frame, or of a subframe of it."""

    number: int  # of the frame, as the board counts
    subframe: int
    points: int | None  # number of points, as its header says
    messages: Mapping[int, bytes]  # {type: message}
    padding: int  # bytes after the last message


@dataclass
class DumpDamage:
    """Bytes of a dump that were left out."""

    skipped: int = 0  # bytes outside of whole packets
    damaged: int = 0  # packets that do not fit themselves
    truncated: bool = False  # the last packet ends early

    def findings(self) -> list[str]:
        """Words for the bytes that were left out."""
        sentences = []
        if self.damaged:
            sentences.append(
                f"{self.damaged} packets are damaged (lengths that do not fit) and left out"
            )
        if self.truncated:
            sentences.append("the last packet is cut off and left out")
        if self.skipped:
            sentences.append(f"{self.skipped} bytes lie outside of whole packets and are left out")
        return sentences


@dataclass
class Dump:
    """Packets of a dump in one or more files, which are read as one stream."""

    paths: Sequence[Path]
    framing: Framing
    damage: DumpDamage = field(default_factory=DumpDamage)

    def packets(self) -> Iterator[Packet]:
        """Yield the packets that are whole; `damage` counts what is not."""
        self.damage = DumpDamage()
        for raw in cut_packets(_bytes_of(self.paths), self.framing.layout.length, self.damage):
            packet = self.framing.read(raw)
            if packet is None:
                self.damage.damaged += 1
            else:
                yield packet


def is_dump(head: bytes) -> bool:
    """Whether the first bytes of a file hold the magic word."""
    return MAGIC in head


def open_dump(paths: Sequence[Path]) -> Dump:
    """Open a dump, and recognise its headers by what makes most packets fit.

    Args:
        paths: its files, in order.

    Raises:
        CaptureError: no packet fits any header that is known.
    """
    best: tuple[tuple[int, ...], Framing] | None = None
    for order, layout in enumerate(LAYOUTS):
        raw = [*islice(cut_packets(_bytes_of(paths), layout.length, DumpDamage()), PROBED)]
        for counts_itself in sorted({False, layout.counts_itself}):
            framing = Framing(layout, counts_itself)
            packets = [packet for packet in map(framing.read, raw) if packet is not None]
            speaking = [packet for packet in packets if packet.messages]
            known = Counter(
                is_known(kind, layout) for packet in speaking for kind in packet.messages
            )
            exact = sum(packet.padding == 0 for packet in speaking)
            score = len(speaking), known[True] - known[False], len(packets), exact, -order
            if packets and (best is None or score > best[0]):
                best = score, framing
    if best is None:
        names = "; ".join(f"{layout.size} bytes, {layout.name}" for layout in LAYOUTS)
        raise CaptureError(
            f"{paths[0]}: has the magic word of TI's demos, but no packet whose lengths fit; "
            f"headers that are known: {names}"
        )
    return Dump(paths, best[1])


def is_known(kind: int, layout: HeaderLayout) -> bool:
    """Whether a type of message is one that demos with this header send."""
    if layout.is_people_counting:
        return 6 <= kind <= 14
    return 1 <= kind <= 11 or 300 <= kind <= 330 or 1000 <= kind <= 1100


def cut_packets(blocks: Iterable[bytes], length_at: int, damage: DumpDamage) -> Iterator[bytes]:
    """Cut a stream of bytes into packets, each from a magic word over the length that it states.

    Args:
        blocks: stream, block by block.
        length_at: place of the length of a packet, from its magic word on.
        damage: counts what is left out: bytes between packets, and packets with the magic word of
            another within, or of a length beyond MAX_PACKET.
    """
    buffer = bytearray()
    for block in blocks:
        buffer += block
        yield from _whole_packets(buffer, length_at, damage)
    damage.truncated |= buffer.startswith(MAGIC)
    damage.skipped += len(buffer)


def _whole_packets(buffer: bytearray, length_at: int, damage: DumpDamage) -> Iterator[bytes]:
    """Take whole packets from the front of a buffer, until what is left may still become one."""
    while True:
        start = buffer.find(MAGIC)
        if start < 0:  # its end may be the start of a magic word
            start = max(0, len(buffer) - (len(MAGIC) - 1))
        damage.skipped += start
        del buffer[:start]
        if not buffer.startswith(MAGIC) or len(buffer) < length_at + _WORD.size:
            return
        (length,) = _WORD.unpack_from(buffer, length_at)
        skipped = _damaged_bytes(buffer, length, length_at + _WORD.size)
        if skipped:
            damage.damaged += 1
            damage.skipped += skipped
            del buffer[:skipped]
        elif len(buffer) >= length:
            yield bytes(buffer[:length])
            del buffer[:length]
        else:
            return


def _damaged_bytes(buffer: bytearray, length: int, header: int) -> int:
    """Count the bytes to leave out of a packet at the front of a buffer; 0 if it may be whole.

    A packet is damaged if its length is less than its header or beyond MAX_PACKET, or if another
    packet begins within it.
    """
    if not header <= length <= MAX_PACKET:
        return len(MAGIC)
    return max(0, buffer.find(MAGIC, len(MAGIC), min(length, len(buffer))))


def _bytes_of(paths: Sequence[Path]) -> Iterator[bytes]:
    """Yield the bytes of files, one after the other, in blocks."""
    for path in paths:
        with path.open("rb") as file:
            while block := file.read(BLOCK):
                yield block
