"""Headers of the subframes of a capture, and where their pulses lie in TI's stream.

Chirps stand in the stream in the order in which they are sent: of every frame those of the first
subframe, loop by loop, then those of the next, each with samples and receivers of its own.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from radhar_cli.capture.config_header import read_yaml_settings
from radhar_cli.capture.fitted_radar import require_known_keys
from radhar_cli.capture.ti_header import read_ti_settings
from radhar_cli.config.reading import validated, with_overrides
from radhar_cli.errors import CaptureError
from radhar_cli.readers.captures.settings import CaptureSettings

TI_HEADERS = (".json", ".cfg", ".lua")


def read_subframes(header: Path | None, overrides: Sequence[str]) -> dict[int, CaptureSettings]:
    """Read the settings of each subframe of a capture from its header and from overrides.

    Args:
        header: TI's JSON, .lua or .cfg, YAML with radhar's keys, or a config; None for overrides
            alone.
        overrides: KEY=VALUE of each, which hold for every subframe; subframe=N chooses one.

    Returns:
        {number: settings} of the subframes in the stream, or of the chosen one; 0 of a capture
        without subframes.

    Raises:
        RadharError: the header or an override cannot be used.
    """
    documents: dict[int, dict[str, Any]] = {0: {}}
    if header is not None:
        ti = header.suffix.lower() in TI_HEADERS
        documents = read_ti_settings(header) if ti else read_yaml_settings(header)
    where = str(header) if header else "--set"
    subframes = {
        number: validated(CaptureSettings, with_overrides(document, overrides), where, {})
        for number, document in documents.items()
    }
    for settings in subframes.values():
        require_known_keys(settings.radar or {}, where)
    chosen = next(iter(subframes.values())).subframe
    if chosen is not None and chosen not in subframes:
        numbers = " or ".join(map(str, subframes))
        raise CaptureError(
            f"{where}: subframe = {chosen}: should be {numbers}, of the subframes of the stream"
        )
    if len(subframes) > 1:
        subframes = _place_in_stream(subframes, where)
    return subframes if chosen is None else {chosen: subframes[chosen]}


def recording_of_subframe(out: Path, number: int) -> Path:
    """Path of the recording of a subframe: `walk.h5`, then `walk_sf1.h5`."""
    return out.with_stem(f"{out.stem}_sf{number}") if number else out


def _place_in_stream(
    subframes: Mapping[int, CaptureSettings], where: str
) -> dict[int, CaptureSettings]:
    """Set where the pulses of each subframe lie within the words of a frame.

    Raises:
        CaptureError: a number that this needs was taken from the header.
    """
    for key in ("samples", "receivers", "frame_pulses"):
        if any(getattr(s, key) is None for s in subframes.values()):
            raise CaptureError(f"{where}: {key} is missing; frames of subframes need it")
    words = {n: (s.frame_pulses or 0) * s.words_of_a_pulse for n, s in subframes.items()}
    placed, begin = dict[int, CaptureSettings](), 0
    for number, settings in subframes.items():
        place = {
            "subframe": number,
            "frame_words": sum(words.values()),
            "skipped_words": begin,
        }
        placed[number] = settings.model_copy(update=place)
        begin += words[number]
    return placed
