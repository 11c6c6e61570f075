"""Raw samples of TI's capture card DCA1000, as it writes them after its own reordering.

Words of 16 bits, little endian (TI application report SWRA581, "Mmwave Radar Device ADC Raw Data
Capture", sections on DCA1000, and rawDataReader.m of mmWave Studio):

    2 lanes (xWR16xx, 18xx, 68xx): I I Q Q, two samples; 4 lanes (xWR12xx, 14xx, 22xx): I I I I
    Q Q Q Q. Real samples stand one after the other.
    Channels not interleaved: all samples of the first receiver, then of the next. Interleaved: a
    sample of every receiver, then the next; with 4 lanes always of four, zeros where one is off.
    Then the next chirp, of the next transmitter where they take turns. Of frames of several
    subframes all chirps of the first, then those of the next (`subframes.py`).

The card splits a capture into files of 1 GiB anywhere. Lost packets are zeros; of other software
they are left out (`lost_packets.py`), or it keeps the packets as they came (`capture_packets.py`).
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import refuse_outside, regular_size
from radhar_cli.readers.captures.capture_packets import is_network_capture, unpack_packets
from radhar_cli.readers.captures.lost_packets import (
    PACKET_WORDS,
    FilledWords,
    WordStream,
    fill_losses,
    missing_packets,
)
from radhar_cli.readers.captures.point_tables import refuse_file_of_points
from radhar_cli.readers.captures.settings import CaptureSettings
from radhar_cli.readers.captures.source import (
    CaptureFiles,
    CaptureFormat,
    MissingKeysError,
    Parts,
    Source,
)

WORD = np.dtype("<u2")
PROBED_WORDS = 2**20
SHORTEST_CHIRP = 32  # words
REPEATS = 0.6  # least correlation of a repetition
ALIKE = 0.7  # least share of the best correlation at the length that the header gives
MOST_JOINED, FEWEST_JOINED = 8, 16  # chirps that are taken for one, and samples of each
JUMP = 2.0  # square of a jump between chirps, over the largest step within them
WAYS_OUT = (
    "record again, or import the packets as they came (.pcap, or _Raw_0.bin with their headers)"
)
_NUMBERED = re.compile(r"(.*_)(\d+)(\.bin)", re.IGNORECASE)


class Words:
    """Files of 16-bit words as one stream, cut anywhere.

    Raises:
        CaptureError: a file is missing, empty or cannot be read.
    """

    def __init__(self, files: Sequence[Path]) -> None:
        self.files, self._ends = files, [0]
        for path in files:
            try:
                size = regular_size(path)
            except OSError as error:
                raise CaptureError(f"{path}: {error.strerror}") from None
            if size == 0:
                raise CaptureError(f"{path}: holds 0 bytes; should hold samples of 16 bits")
            self._ends.append(self._ends[-1] + size)

    @property
    def bytes(self) -> int:
        """Number of bytes."""
        return self._ends[-1]

    @property
    def count(self) -> int:
        """Number of words."""
        return self.bytes // WORD.itemsize

    def __getitem__(self, key: slice) -> NDArray[np.uint16]:
        """Read words from key.start to key.stop - 1."""
        start, stop = key.start * WORD.itemsize, key.stop * WORD.itemsize
        blocks = [
            np.fromfile(path, np.uint8, min(stop, high) - first, offset=first - low)
            for path, (low, high) in zip(self.files, pairwise(self._ends), strict=True)
            if (first := max(start, low)) < min(stop, high)
        ]
        data = np.concatenate(blocks)
        if data.size < stop - start:
            raise CaptureError(f"{self.files[0]}: became shorter while it was read")
        return data.view(WORD)


@dataclass(frozen=True)
class FrameLayout:
    """Places of pulses in a stream of words, in which every frame may have further words.

    Attributes:
        unit: Words of a pulse of every transmitter.
        pulses: Number of pulses of a frame.
        frame_words: Words from frame to frame.
        skipped_words: Words of a frame before the first pulse.
    """

    unit: int
    pulses: int
    frame_words: int
    skipped_words: int = 0

    def slices(self, first: int, stop: int) -> Iterator[slice]:
        """Yield the words of pulses first .. stop - 1, a slice for each frame."""
        for frame in range(first // self.pulses, (stop - 1) // self.pulses + 1):
            begin = frame * self.frame_words + self.skipped_words
            low = max(first - frame * self.pulses, 0)
            high = min(stop - frame * self.pulses, self.pulses)
            yield slice(begin + low * self.unit, begin + high * self.unit)

    def read(self, words: WordStream, first: int, stop: int) -> NDArray[np.uint16]:
        """Read the words of pulses first .. stop - 1."""
        return np.concatenate([words[place] for place in self.slices(first, stop)])


def whole_capture(paths: Sequence[Path]) -> tuple[Path, ...]:
    """List all files of a capture: `..._Raw_0.bin` is followed by `..._Raw_1.bin` and so on.

    Raises:
        CaptureError: one in between is missing.
    """
    numbered = _NUMBERED.fullmatch(paths[0].name)
    if len(paths) > 1 or numbered is None or int(numbered[2]) != 0:
        return tuple(paths)
    stem, _, suffix = numbered.groups()
    numbers = {
        int(match[2]): other
        for other in paths[0].parent.iterdir()
        if (match := _NUMBERED.fullmatch(other.name)) and (match[1], match[3]) == (stem, suffix)
    }
    for n in range(1, max(numbers) + 1):
        if n not in numbers:
            raise CaptureError(
                f"{paths[0].parent / f'{stem}{n}{suffix}'}: is missing; the capture continues in "
                f"{numbers[max(numbers)].name}"
            )
        refuse_outside(numbers[n], paths[0].parent)
    return (paths[0], *(numbers[n] for n in range(1, max(numbers) + 1)))


def open_dca1000(capture: CaptureFiles) -> Source:
    """Open a capture of the card.

    Raises:
        CaptureError: the header lacks samples or receivers, or the samples do not fit it.
    """
    settings, header = capture.settings, capture.header
    files = whole_capture(capture.paths)
    refuse_file_of_points(files[0])
    missing = [key for key in ("samples", "receivers") if getattr(settings, key) is None]
    if missing:
        verb = "are" if len(missing) > 1 else "is"
        raise MissingKeysError(
            f"{header}: {' and '.join(missing)} {verb} missing; give them by --radar FILE or "
            f"--set {missing[0]}=N ({capture.paths[0].name} is taken for samples of a DCA1000, as "
            "it has no packet of a TI demo's data port; plain numbers need --set dtype=int16 and "
            "axes)",
            dict.fromkeys(missing, "N"),
        )
    interleaved, lanes = bool(settings.interleaved), settings.lanes
    stream = {"lanes": lanes or (4 if interleaved else 2), "interleaved": interleaved}
    settings = settings.model_copy(update=stream)
    notes = list[str]()
    packets = unpack_packets(files, capture.scratch, 2 * settings.words_of_a_frame, notes)
    stored = Words([packets] if packets else files)
    words = _fill_lost_packets(stored, files[0], settings, notes) if packets is None else stored
    layout, pulses = _layout_of(words, files[0], settings, header, notes)
    _check_length(words, files[0], layout, pulses, settings, header)
    if note := _note_of_joined_chirps(words, layout, pulses, settings):
        notes.append(note)
    if len(files) > 1:
        notes.insert(0, f"{len(files)} files: {files[0].name} to {files[-1].name}")

    def read(first: int, stop: int) -> Parts:
        return decode(layout.read(words, first, stop), settings)

    return Source(
        files,
        settings.transmitters * (settings.receivers or 1),
        settings.samples,
        pulses,
        np.dtype(np.int16),
        1 + settings.complex,
        read,
        is_part=settings.frame_words is not None,
        notes=tuple(notes),
        usual_beat="positive",
    )


FORMAT = CaptureFormat(
    ".bin of a DCA1000 (with --radar)",
    lambda path, head: path.suffix.lower() == ".bin",
    open_dca1000,
    is_split=True,
    has_subframes=True,
)
NETWORK = CaptureFormat(
    ".pcap of its network",
    lambda path, head: is_network_capture(head),
    open_dca1000,
    is_split=True,
    has_subframes=True,
)


def decode(words: NDArray[np.uint16], s: CaptureSettings) -> Parts:
    """Decode the words of whole pulses to samples int16 [virtual receiver, sample, pulse, part]."""
    parts, lanes = 1 + s.complex, s.lanes or 2
    assert s.samples is not None
    assert s.receivers is not None
    samples = words.view("<i2")
    if s.complex:
        samples = samples.reshape(-1, 2, lanes).swapaxes(1, 2)
    order = (s.samples, s.stored_receivers) if s.interleaved else (s.stored_receivers, s.samples)
    samples = samples.reshape(-1, s.transmitters, *order, parts)
    # [pulse, transmitter, receiver, sample, part]
    samples = samples.swapaxes(2, 3) if s.interleaved else samples
    if s.stored_receivers != s.receivers:
        chosen = s.receiver_lanes or tuple(range(s.receivers))
        samples = samples[:, :, list(chosen)]
    samples = samples.transpose(1, 2, 3, 0, 4)
    return samples.reshape(-1, s.samples, samples.shape[3], parts)


def _fill_lost_packets(
    words: Words, path: Path, s: CaptureSettings, notes: list[str]
) -> Words | FilledWords:
    """Put zeros where a stream that is no whole number of frames lacks packets; add a note.

    Raises:
        CaptureError: packets may be missing at the beginning, so that no pulse can be assigned.
    """
    frame, period = s.words_of_a_frame * WORD.itemsize, s.frame_words or s.words_of_a_pulse
    if words.bytes % frame == 0:
        return words
    unit = "frames" if s.frame_pulses or s.frame_words else "pulses"
    size = f"{words.bytes} bytes are no whole number of {unit} of {frame} bytes"
    missing = missing_packets(words.bytes, frame)
    filled = fill_losses(words, period, missing)
    lost = sum(loss.packets for loss in filled.losses) if filled else 0
    packets = f"packets of {PACKET_WORDS * WORD.itemsize} bytes"
    if missing is not None and lost != missing:
        raise CaptureError(
            f"{path}: {size}: by this {missing} {packets} are missing, and static echoes show "
            f"where {lost} of them are; others may be missing at the beginning, after which "
            f"receivers and transmitters would be exchanged; {WAYS_OUT}"
            f"{'' if lost else _way_of_cut_end(words.bytes, frame)}"
        )
    if filled is None:
        notes.append(
            f"{size}: nothing static shows whether bytes are missing within, after which "
            "transmitters and ranges would be exchanged"
        )
        return words
    if filled.stop < period:
        raise CaptureError(
            f"{path}: {size}: bytes are missing near the beginning, or where static echoes do not "
            f"show it, after which receivers and transmitters would be exchanged; {WAYS_OUT}"
            f"{_way_of_cut_end(words.bytes, frame)}"
        )
    if lost:
        gaps = [loss for loss in filled.losses if loss.packets]
        places = ", ".join(str(loss.begin * WORD.itemsize) for loss in gaps[:5])
        notes.append(
            f"{size}: {lost} {packets} are missing, by the static echoes at byte {places}"
            f"{', ...' * (len(gaps) > 5)}; zeros stand there"
        )
    if filled.stop < words.count:
        stop = filled.stop * WORD.itemsize
        notes.append(
            f"{size}: after byte {stop} bytes are missing within, as static echoes move, and "
            f"pulses after that cannot be assigned: the last {words.bytes - stop} bytes are left "
            "out"
        )
    return filled


def _way_of_cut_end(size: int, frame: int) -> str:
    """Words for what to do with a capture of which the end alone is missing."""
    kept_bytes = size // frame * frame
    return f"; if only its end was cut off, cut it to {kept_bytes} bytes" if kept_bytes else ""


def _layout_of(
    words: WordStream, path: Path, s: CaptureSettings, header: str, notes: list[str]
) -> tuple[FrameLayout, int]:
    """Find where the pulses of a stream lie, and how many are whole; add a note on what is not.

    Of frames of several subframes those are left out that are not whole.

    Raises:
        CaptureError: there is none, or frames have too few words for their pulses.
    """
    unit = s.words_of_a_pulse
    period, noun = s.frame_words or unit, "pulse"
    if s.frame_words is not None:
        noun = "frame" if s.subframe is None else "frame of all subframes"
        busy = s.skipped_words + (s.frame_pulses or 1) * unit
        if s.frame_pulses is None or busy > s.frame_words:
            raise CaptureError(
                f"{header}: frame_words = {s.frame_words}: should be at least {busy}, of "
                f"frame_pulses = {s.frame_pulses or 1} after skipped_words = {s.skipped_words}"
            )
    count, incomplete_words = divmod(words.count, period)
    if count == 0:
        raise CaptureError(
            f"{path}: holds {words.bytes} bytes; a {noun} by {header} takes {period * 2}"
        )
    if incomplete_words:
        notes.append(f"the last {incomplete_words * 2} bytes (an incomplete {noun}) are left out")
    if s.frame_words is None:
        return FrameLayout(unit, count, count * unit), count
    pulses = s.frame_pulses or 1
    return FrameLayout(unit, pulses, period, s.skipped_words), count * pulses


def _check_length(
    words: WordStream, path: Path, layout: FrameLayout, pulses: int, s: CaptureSettings, header: str
) -> None:
    """Refuse a header whose chirps are not those of the file.

    Static echoes are the same in every chirp: words repeat after the length of a chirp.
    """
    assert s.samples is not None
    pulse_words = layout.unit
    if 2 * pulse_words > PROBED_WORDS:
        return
    probed = min(PROBED_WORDS // pulse_words, pulses)
    start = (pulses - probed) // 2
    correlation = autocorrelation(layout.read(words, start, start + probed))
    if pulse_words >= correlation.size:
        return
    best = float(correlation.max())
    if best < REPEATS or correlation[pulse_words] >= ALIKE * best:
        return
    if s.frame_words is not None:
        place = "the pulses of frames" if s.subframe is None else f"subframe {s.subframe}"
        raise CaptureError(
            f"{header}: {place}: samples = {s.samples}, receivers = {s.receivers}, transmitters = "
            f"{s.transmitters}, frame_pulses = {s.frame_pulses}: {path} does not repeat "
            f"from chirp to chirp there, in frames of {layout.frame_words * 2} bytes"
        )
    # One receiver's chirp may repeat, a chirp of all, or a cycle of the transmitters.
    lag = int(np.flatnonzero(correlation >= 0.95 * best)[0])
    per_sample = (1 + s.complex, (1 + s.complex) * s.stored_receivers, pulse_words // s.samples)
    fitting = {lag // words_each for words_each in per_sample if lag % words_each == 0}
    nearest = min(fitting or {0}, key=lambda n: abs(np.log(max(n, 1e-3) / (s.samples or 1))))
    fits = f"samples: {nearest}" if fitting else f"chirps of {lag} words"
    raise CaptureError(
        f"{header}: samples = {s.samples}, receivers = {s.receivers}, transmitters = "
        f"{s.transmitters}: {path} does not repeat after a pulse of {pulse_words} words; "
        f"{fits} would fit"
    )


def _note_of_joined_chirps(
    words: WordStream, layout: FrameLayout, pulses: int, s: CaptureSettings
) -> str | None:
    """Words for samples that are too many by a factor: static echoes jump within every chirp."""
    assert s.samples is not None
    probed = min(max(PROBED_WORDS // layout.unit, 1), pulses)
    start = (pulses - probed) // 2
    values = decode(layout.read(words, start, start + probed), s).astype(float).mean(axis=2)
    steps = np.sum(np.diff(values, axis=1) ** 2, axis=(0, 2))
    for factor in range(2, MOST_JOINED + 1):
        if s.samples % factor or s.samples // factor < FEWEST_JOINED:
            continue
        is_seam = np.zeros(steps.size, bool)
        is_seam[s.samples // factor - 1 :: s.samples // factor] = True
        if steps[is_seam].min() > JUMP * np.max(steps[~is_seam], initial=0):
            return (
                f"every chirp of {s.samples} samples jumps at each {s.samples // factor}th: "
                f"samples = {s.samples // factor} may be right"
            )
    return None


def autocorrelation(words: NDArray[np.uint16]) -> NDArray[np.float64]:
    """Normalised autocorrelation of words, as signed numbers, over the lag in words [lag].

    It is set to 0 below the lag SHORTEST_CHIRP, and empty for a constant or short signal.
    """
    x = words.view("<i2").astype(float)
    x -= x.mean()
    length = 2 ** ceil(np.log2(max(2 * x.size, 2)))
    spectrum = np.abs(np.fft.rfft(x, length)) ** 2
    lags = floor(x.size / 2)
    correlation = np.fft.irfft(spectrum, length)[:lags]
    if lags <= SHORTEST_CHIRP or correlation[0] <= 0:
        return np.zeros(0)
    normalised = correlation / correlation[0] * x.size / (x.size - np.arange(lags))
    normalised[:SHORTEST_CHIRP] = 0
    return np.asarray(normalised)
