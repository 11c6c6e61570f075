"""`output:` what is written beside dataset.h5."""

from typing import Annotated

from pydantic import Field

from radhar_cli.config.section import Flag, Section

Level = Annotated[int, Field(ge=0, le=9, strict=True)]


class OutputConfig(Section):
    """PNG tree or not, and the compression levels (0 none, 1 fast, 9 small)."""

    png: Flag = True
    png_level: Level = 1
    hdf5_level: Level = 1
