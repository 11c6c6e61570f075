"""`processing:` from the beat signal to the maps (../docs/model.md, section Processing)."""

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from radhar_cli.config.section import Flag, Section

# Powers of the sample number up to this are still told apart: the fit errs by 1e-5 at most.
MOST_CONDITION = 1e11


class SavgolConfig(Section):
    """The Savitzky-Golay filter of the denoised maps."""

    order: Annotated[int, Field(ge=0, le=30, strict=True)] = 5
    frame: Annotated[int, Field(ge=1, strict=True)] = 11

    @model_validator(mode="after")
    def _fits(self) -> "SavgolConfig":
        if self.frame % 2 == 0 or self.frame <= self.order:
            raise PydanticCustomError(
                "frame", "should have a frame that is odd and above the order"
            )
        if (self.frame // 2) ** self.order > MOST_CONDITION:
            raise PydanticCustomError(
                "frame",
                "should have (frame // 2)^order at most 1e11, beyond which rounding spoils the fit",
            )
        return self


class ProcessingConfig(Section):
    """MTI, range compression, windows and thresholds."""

    mti: Flag = True
    range_fft_length: Annotated[int, Field(ge=2, multiple_of=2, strict=True)] | None = None
    range_reference: Literal["centre", "start"] = "centre"
    window_fraction: Annotated[float, Field(gt=0, lt=1, strict=True)] = 0.1
    overlap_fraction: Annotated[float, Field(ge=0, lt=1, strict=True)] = 0.9
    stft_fft_length: Annotated[int, Field(ge=8, strict=True)] | None = None
    savgol: SavgolConfig = SavgolConfig()
    fsst_hop_pulses: Annotated[int, Field(ge=1, le=2**24, strict=True)] | None = None
    fsst_threshold: Annotated[float, Field(ge=0, lt=1, strict=True)] = 1e-3
