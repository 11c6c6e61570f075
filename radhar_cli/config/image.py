"""`image:` how a power map becomes levels and colours."""

from typing import Annotated, Any

from pydantic import Field, field_validator
from pydantic_core import PydanticCustomError

from radhar_cli.config.section import Section
from radhar_cli.errors import did_you_mean

DEFAULT_COLOUR_MAP = "viridis"
Pixels = Annotated[int, Field(ge=2, le=8192, strict=True)]


class ImageConfig(Section):
    """Size (height, width; one number means square), dynamic range and colour map."""

    size_px: tuple[Pixels, Pixels] = (256, 256)
    dynamic_range_db: Annotated[float, Field(gt=0, le=300, strict=True)] = 50.0
    colour_map: str = DEFAULT_COLOUR_MAP

    @field_validator("size_px", mode="before")
    @classmethod
    def _square(cls, value: Any) -> Any:
        return (value, value) if isinstance(value, int) else value

    @field_validator("colour_map")
    @classmethod
    def _known(cls, value: str) -> str:
        if value != DEFAULT_COLOUR_MAP:  # Matplotlib is slow to import
            from matplotlib import colormaps

            if value not in colormaps:
                some = "viridis, gray, turbo, jet are some"
                hint = did_you_mean(value, colormaps, some)
                raise PydanticCustomError(
                    "colour", "should be a Matplotlib colour map; {hint}", {"hint": hint}
                )
        return value
