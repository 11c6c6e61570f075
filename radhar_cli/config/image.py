"""`image:` how a power map becomes levels and colours."""

from typing import Annotated, Any

from pydantic import Field, field_validator

from radhar_cli.config.section import Section

Pixels = Annotated[int, Field(ge=2, le=8192, strict=True)]


class ImageConfig(Section):
    """Size (height, width; one number means square), dynamic range and colour map."""

    size_px: tuple[Pixels, Pixels] = (256, 256)
    dynamic_range_db: Annotated[float, Field(gt=0, le=300)] = 50.0
    colour_map: str = "viridis"

    @field_validator("size_px", mode="before")
    @classmethod
    def _square(cls, value: Any) -> Any:
        return (value, value) if isinstance(value, int) else value
