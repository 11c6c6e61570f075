"""Config of the files of a sample, and of the splits."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from radhar_cli.schema.number import Share, value_error
from radhar_cli.schema.section import Flag, Section

Level = Annotated[int, Field(ge=0, le=9, strict=True)]


Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,62}$")]


class OutputConfig(Section):
    """Files and arrays written of every sample, and their compression: 0 none, 1 fast, 9 small."""

    png: Flag = True
    """Whether a tree of images is written beside dataset.h5."""
    column_labels: Flag = False
    """Whether the movement at the time of each column of a map is stored."""
    png_level: Level = 1
    """Compression of PNGs, 0 to 9."""
    hdf5_level: Level = 1
    """Compression of dataset.h5, 0 to 9."""
    power: Literal["float16"] | None = None
    """Powers behind the images: float16 stores the decibels of every map, not clipped."""
    slow_time: Flag = False
    """Whether the complex slow-time signal is stored."""
    products: tuple[Name, ...] = ()
    """Further products that are stored as arrays, a user's own too (`radhar_cli.extensions`)."""
    license: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.+-]{0,60}$")] | None = None
    """Licence in the data card, as the Hugging Face Hub calls it: cc-by-4.0, mit."""


class SplitConfig(Section):
    """Shares of the three parts, of the samples of each class or of the persons."""

    by: Literal["sample", "subject"] = "sample"
    """Whether samples of each class are split, or persons."""
    train: Share = 0.8
    """Share to train on."""
    validation: Share = 0.2
    """Share to choose the best epoch by."""
    test: Share = 0.0
    """Share that training never sees."""
    subjects: Annotated[int, Field(ge=1, strict=True)] | None = None
    """Number of persons, who each perform every activity, with `by: subject`."""

    @model_validator(mode="after")
    def _require_whole_split(self) -> "SplitConfig":
        total = self.train + self.validation + self.test
        if abs(total - 1) > 1e-9:
            raise value_error(
                f"should have train + validation + test = 1 (they add up to {total:g})"
            )
        if (self.by == "subject") != (self.subjects is not None):
            raise value_error("should have 'subjects: n' with 'by: subject', and only with it")
        return self
