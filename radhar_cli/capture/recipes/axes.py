"""Directions of the columns of a table, which the user gives where no publisher states them."""

from typing import Literal, TypeAlias

import numpy as np
from pydantic import field_validator

from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.number import value_error
from radhar_cli.schema.section import Section

Way: TypeAlias = Literal["ahead", "behind", "left", "right", "up", "down"]
Axes: TypeAlias = tuple[Way, Way, Way]
# {way: (one of radhar's axes, sign)}
WAYS: dict[Way, tuple[int, int]] = {
    "ahead": (0, 1),
    "behind": (0, -1),
    "left": (1, 1),
    "right": (1, -1),
    "up": (2, 1),
    "down": (2, -1),
}
OF_TI: Axes = ("right", "ahead", "up")
OF_ROS: Axes = ("ahead", "left", "up")
EXAMPLE = "--set axes=[right,ahead,up] --set doppler=receding, as TI's demos send them"


class AxesSettings(Section):
    """Directions of x, y and z, and of motion with positive Doppler."""

    axes: Axes | None = None
    """Ways of x, y and z: three of ahead, behind, left, right, up, down."""
    doppler: Literal["receding", "approaching"] | None = None
    """Motion whose Doppler is positive."""

    @field_validator("axes")
    @classmethod
    def _require_three_axes(cls, value: Axes | None) -> Axes | None:
        if value is not None and len({WAYS[way][0] for way in value}) < 3:
            raise value_error("should have one of ahead or behind, left or right, up or down")
        return value

    def require(self, subject: str) -> None:
        """Require that both are given.

        Raises:
            CaptureError: one is missing; says how to give it.
        """
        if self.axes is None or self.doppler is None:
            raise CaptureError(
                f"{subject} does not say which way x, y and z point, or whose Doppler is positive: "
                f"axes and doppler are missing ({EXAMPLE})"
            )

    def receding(self, doppler: Float) -> Float:
        """Speeds [n] away from the radar, of a column of Doppler, m/s."""
        return doppler if self.doppler == "receding" else -doppler


def to_radhar_axes(places: Float, axes: Axes) -> Float:
    """Turn places [n, 3] of other axes to radhar's: ahead, left, up."""
    out = np.empty_like(places)
    for column, direction in enumerate(axes):
        axis, sign = WAYS[direction]
        out[:, axis] = sign * places[:, column]
    return out
