"""The person: lengths in proportion to stature, and the pose in which people stand at rest."""

from dataclasses import dataclass
from functools import cached_property
from math import acos, exp, log, radians, sqrt

from radhar_cli.motion.skeleton import (
    ANKLE_HEIGHT,
    GROWN_UP,
    JOINTS,
    SHORTER_LEGS,
    childlike,
    leg_length,
    links,
)


@dataclass(frozen=True)
class Physique:
    """A body with the paper's links; heights and widths are fractions of the stature.

    Ankle height: Winter, Biomechanics and Motor Control, after Drillis and Contini. Hip width: CMU
    motion capture, subject 02. Children have shorter legs and a longer trunk, as
    `radhar_cli.motion.skeleton` has them.
    """

    stature: float  # m
    ankle_height: float = ANKLE_HEIGHT  # height of the ankle above the floor
    # distance of a hip joint beside the hip point; at rest the feet are below the hip joints
    hip_width: float = 0.052
    ball: float = 0.10  # distance of the ball of the foot ahead of the ankle
    # Length of a standing leg, and the longest that a leg gets, over thigh and shank together:
    # people stand with knees bent by 5 degrees.
    standing: float = 0.9992
    straightest: float = 0.9998
    # k of the soft minimum that sets the pelvis's height at rest, over the stature
    softness: float = 4000.0
    elbow: float = radians(8)  # flexion at rest, rad
    weight: float | None = None  # kg; 26 kg/m^2 times the stature squared where it is not given

    def __post_init__(self) -> None:
        if not self.stature > 0:
            raise ValueError(f"a person's stature is above 0 m, not {self.stature:g} m")

    @cached_property
    def _links(self) -> dict[str, list[float]]:
        return dict(zip(JOINTS, links(self.stature).tolist(), strict=True))

    @property
    def childlike(self) -> float:
        """Share of the way from a grown-up's proportions to those of a child of 1.0 m."""
        return childlike(self.stature)

    @property
    def smallness(self) -> float:
        """Stature over that of the smallest grown-up, 1 of grown-ups."""
        return min(self.stature / GROWN_UP, 1.0)

    @cached_property
    def quickness(self) -> float:
        """Times and speeds of a child over those of the smallest grown-up: sqrt of `smallness`."""
        return sqrt(self.smallness)

    @cached_property
    def _longer_trunk(self) -> float:
        """Factor of the trunk that keeps the stature where legs are shorter."""
        legs, trunk = 2 * self._links["right_knee"][2], self._links["hip"][2]
        lost = SHORTER_LEGS * self.childlike * legs
        return 1 + lost / (trunk - self._links["head"][2])

    @cached_property
    def leg(self) -> float:
        """Length of the thigh, and of the shank, m."""
        return leg_length(self.stature) / 2

    @cached_property
    def arm(self) -> float:
        """Length of the upper arm, and of the forearm, m."""
        return -self._links["right_elbow"][2]

    @cached_property
    def trunk(self) -> float:
        """Distance from hip to torso, m."""
        return -self._links["hip"][2] * self._longer_trunk

    @cached_property
    def neck(self) -> float:
        """Distance from torso to head, m."""
        return self._links["head"][2] * self._longer_trunk

    @cached_property
    def shoulder(self) -> float:
        """Distance of a shoulder beside the torso, and above it, m."""
        return self._links["left_shoulder"][1]

    @property
    def ankle(self) -> float:
        """Height of an ankle whose foot is on the floor, m."""
        return self.ankle_height * self.stature

    @property
    def hip(self) -> float:
        """Distance of a hip joint beside the hip point, m."""
        return self.hip_width * self.stature

    @property
    def toes(self) -> float:
        """Distance of the ball of the foot ahead of the ankle, m."""
        return self.ball * self.stature

    @property
    def reach(self) -> float:
        """Longest distance from hip joint to ankle that a leg gets, m."""
        return self.straightest * 2 * self.leg

    @property
    def sharpness(self) -> float:
        """K of the soft minimum that sets the pelvis's height at rest, 1/m."""
        return self.softness / self.stature

    @cached_property
    def tallest(self) -> float:
        """Height of the hip above standing legs, m."""
        return self.ankle + self.standing * 2 * self.leg

    @cached_property
    def rest_height(self) -> float:
        """Height of the hip at rest, m.

        It is the soft minimum of `tallest` and of both legs at full reach.
        """
        k, stretched = self.sharpness, self.ankle + self.reach
        return stretched - log(2 + exp(k * (stretched - self.tallest))) / k

    @cached_property
    def rest_lean(self) -> float:
        """Angle of shank and thigh from the vertical at rest, rad."""
        return acos((self.rest_height - self.ankle) / (2 * self.leg))


def froude_scale(stature: float, reference: float = 1.7) -> float:
    """Speed of a person over that of one of a `reference` stature at the same Froude number.

    v^2/(g l) is alike where people of legs l move alike (Alexander, Physiol. Rev. 69 (1989) 1199):
    children of 4 and 7 years walk at 0.9 to 1.0 and 1.1 m/s (Sutherland et al., J. Bone Joint Surg.
    62-A (1980) 336).
    """
    return sqrt(Physique(stature).leg / Physique(reference).leg)
