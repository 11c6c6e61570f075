"""What every section of a config shares: frozen, strict, unknown keys refused."""

from typing import Annotated, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

Flag: TypeAlias = Annotated[bool, Field(strict=True)]


class Section(BaseModel):
    """Base of all config models."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, validate_default=True, allow_inf_nan=False
    )
