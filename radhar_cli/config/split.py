"""`split:` which samples train, which validate, which test."""

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from radhar_cli.config.section import Section

Share = Annotated[float, Field(ge=0, le=1, strict=True)]


class SplitConfig(Section):
    """Shares of the three parts, of the samples of each class or of the persons."""

    by: Literal["sample", "subject"] = "sample"
    train: Share = 0.8
    validation: Share = 0.2
    test: Share = 0.0
    subjects: Annotated[int, Field(ge=1, strict=True)] | None = None

    @model_validator(mode="after")
    def _whole(self) -> "SplitConfig":
        total = self.train + self.validation + self.test
        if abs(total - 1) > 1e-9:
            raise PydanticCustomError(
                "shares",
                "should have train + validation + test = 1 (they add up to {total})",
                {"total": f"{total:g}"},
            )
        if (self.by == "subject") != (self.subjects is not None):
            raise PydanticCustomError(
                "subjects", "should have 'subjects: n' with 'by: subject', and only with it"
            )
        return self
