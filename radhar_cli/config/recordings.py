"""Recordings that a data set of measured data is cut from."""

from functools import cached_property
from math import floor
from pathlib import PurePosixPath
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from radhar_cli.schema.number import value_error
from radhar_cli.schema.section import Flag, Section

MAX_WINDOWS = 1_000_000


SLUG = r"[a-z][a-z0-9_]{0,62}"
SplitName: TypeAlias = Literal["train", "validation", "test"]


class RecordedPart(Section):
    """Part of a recording in which one person does one thing.

    The file is named from the manifest's folder, or below.
    """

    file: Annotated[str, Field(max_length=500)]
    """Path of the recording, from the manifest's folder on."""
    label: Annotated[str, Field(pattern=f"^{SLUG}$")]
    """Class of the person's activity."""
    person: Annotated[str, Field(max_length=100)] | None = None
    """Name or number of the person, where it is known."""
    start_s: Annotated[float, Field(ge=0, le=1e7, strict=True)]
    """Beginning of the part."""
    stop_s: Annotated[float, Field(ge=0, le=1e7, strict=True)]
    """End of the part."""
    split: SplitName | None = None
    """Part of the split, where the manifest says it."""

    @model_serializer(mode="wrap")
    def _without_unknown_split(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return _without(serialise(self), {"split": None})

    @field_validator("file")
    @classmethod
    def _require_path_below(cls, value: str) -> str:
        place = PurePosixPath(value)
        if place.is_absolute() or ".." in place.parts or "\\" in value or not place.name:
            raise value_error("should be a path below the manifest's folder")
        return value


class RecordingsConfig(Section):
    """A data set of measured data: windows of recordings instead of scenes."""

    window_s: Annotated[float, Field(gt=0, le=1e6, strict=True)] = 4.0
    """Duration of a sample."""
    hop_s: Annotated[float, Field(gt=0, le=1e6, strict=True)] = 4.0
    """Time from the start of a sample to the start of the next."""
    receiver: Annotated[int, Field(ge=0, le=2**16, strict=True)] | None = None
    """Number of the receiver that maps are made of; null is the sum of all receivers' powers."""
    parts: Annotated[tuple[RecordedPart, ...], Field(max_length=10_000)] = ()
    """Parts of recordings, filled in from the manifest, in its order."""
    sha256: dict[str, str] = {}
    """SHA-256 of each file, filled in; the data set's bytes depend on it."""
    frame_s: Annotated[float, Field(ge=1e-5, le=1e6)] | None = None
    """Time from frame to frame of recordings of points, filled in; null of others."""
    rows: tuple[float, float] | None = None
    """Lowest and highest edge of images that exist already, Hz (m of a range-time map)."""
    packed: Flag = False
    """Whether the columns of masks are bits."""
    joints: Flag = False
    """Whether recordings of points have joints beside them, filled in."""
    source: Annotated[str, Field(max_length=500)] | None = None
    """Origin of the recordings, for the data card."""

    @model_serializer(mode="wrap")
    def _without_defaults(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return _without(serialise(self), {"joints": False, "source": None})

    @model_validator(mode="after")
    def _require_few_windows(self) -> "RecordingsConfig":
        if (total := sum(map(self.count, self.parts))) > MAX_WINDOWS:
            raise value_error(f"should have at most {MAX_WINDOWS} windows; hop_s makes {total}")
        return self

    def count(self, part: RecordedPart) -> int:
        """Count the windows of a part."""
        room = part.stop_s - part.start_s - self.window_s
        return floor(room / self.hop_s + 1e-9) + 1 if room >= -1e-9 else 0

    def starts(self, part: RecordedPart) -> list[float]:
        """List the times at which the windows of a part begin, s."""
        return [part.start_s + n * self.hop_s for n in range(self.count(part))]

    @cached_property
    def counts(self) -> dict[str, int]:
        """{label: windows}, of those that have any."""
        counts: dict[str, int] = {}
        for part in self.parts:
            counts[part.label] = counts.get(part.label, 0) + self.count(part)
        return {label: count for label, count in counts.items() if count}

    @property
    def has_split(self) -> bool:
        """Whether the manifest says how the recordings are split."""
        return bool(self.parts) and self.parts[0].split is not None

    @property
    def persons(self) -> tuple[str, ...]:
        """Names of all persons, in alphabetical order."""
        return tuple(sorted({part.person for part in self.parts if part.person is not None}))


def _without(document: dict[str, Any], defaults: dict[str, Any]) -> dict[str, Any]:
    """Leave keys out of plain values where they say nothing: most data sets do not have them."""
    return {k: v for k, v in document.items() if k not in defaults or v != defaults[k]}
