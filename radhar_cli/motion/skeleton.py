"""The body: joints, parents, links and RCS (paper, table "Structure and Properties ...")."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Float

REFERENCE_HEIGHT = 1.8
REFERENCE_WEIGHT = 84.24
BODY_MASS_INDEX = 26.0
CHILDREN = (1.1, 1.35, 1.5), (15.5, 17.0, BODY_MASS_INDEX)  # statures, m, and kg/m^2
# Proportions of people who stand on the floor, of the human model and of motion files. Who is
# smaller than GROWN_UP counts as a child, with shorter legs and a longer trunk: sitting height is
# 56 % of the stature at SMALL_CHILD, 52 % of grown-ups' (Snyder et al., Anthropometry of Infants,
# Children, and Youths, UM-HSRI-77-17, 1977); linear between them.
SMALL_CHILD, GROWN_UP = 1.0, 1.5  # statures, m
SHORTER_LEGS = 0.08  # loss of leg length of a child of 1.0 m beside a grown-up, over that
ANKLE_HEIGHT = 0.039  # of the ankle above the floor, over the stature (Winter)


class Joint(NamedTuple):
    """One scatterer, and its link (m) from the parent and RCS (m^2) in the reference person."""

    name: str
    parent: str | None
    link: tuple[float, float, float]
    rcs: float


SKELETON: tuple[Joint, ...] = (
    Joint("torso", None, (0, 0, 0), 1.0),
    Joint("head", "torso", (0, 0, 0.3), 0.5),
    Joint("right_shoulder", "torso", (0, -0.2, 0.2), 0.1),
    Joint("right_elbow", "right_shoulder", (0, 0, -0.3), 0.3),
    Joint("right_hand", "right_elbow", (0, 0, -0.3), 0.2),
    Joint("left_shoulder", "torso", (0, 0.2, 0.2), 0.1),
    Joint("left_elbow", "left_shoulder", (0, 0, -0.3), 0.3),
    Joint("left_hand", "left_elbow", (0, 0, -0.3), 0.2),
    Joint("hip", "torso", (0, 0, -0.3), 0.1),
    Joint("right_knee", "hip", (0, 0, -0.45), 0.4),
    Joint("right_ankle", "right_knee", (0, 0, -0.45), 0.3),
    Joint("left_knee", "hip", (0, 0, -0.45), 0.4),
    Joint("left_ankle", "left_knee", (0, 0, -0.45), 0.3),
)
JOINTS: tuple[str, ...] = tuple(joint.name for joint in SKELETON)
TORSO = JOINTS.index("torso")
PARENTS: tuple[int | None, ...] = tuple(
    None if joint.parent is None else JOINTS.index(joint.parent) for joint in SKELETON
)


def default_weight(height: float) -> float:
    """Weight (kg) of a person of this height (m) when none is given: 26 kg/m^2 of grown-ups.

    A person below 1.5 m counts as a child, of 15.5 kg/m^2 at 1.1 m and 17 at 1.35 m, medians
    of the WHO's growth reference (de Onis et al., Bull. World Health Organ. 85 (2007) 660).
    """
    return float(np.interp(height, *CHILDREN)) * height**2


def links(height: float) -> Float:
    """Link vectors [13, 3] in m, scaled with the stature (m)."""
    return np.array([joint.link for joint in SKELETON], dtype=float) * (height / REFERENCE_HEIGHT)


def cross_sections(height: float, weight: float) -> Float:
    """RCS [13] in m^2, scaled with sqrt(height * weight) (paper, note under the table)."""
    scale = sqrt(height * weight / (REFERENCE_HEIGHT * REFERENCE_WEIGHT))
    return np.array([joint.rcs for joint in SKELETON]) * scale


def standing_height(height: float) -> float:
    """Height (m) of the torso above the ground when the ankles are at z = 0."""
    return (0.30 + 0.45 + 0.45) * (height / REFERENCE_HEIGHT)


def thigh_length(height: float) -> float:
    """Length (m) of the link from hip to knee."""
    return 0.45 * (height / REFERENCE_HEIGHT)


def childlike(stature: float) -> float:
    """Share of the way from a grown-up's proportions to those of a child of 1.0 m."""
    return min(max((GROWN_UP - stature) / (GROWN_UP - SMALL_CHILD), 0.0), 1.0)


def leg_length(stature: float) -> float:
    """Length (m) of thigh and shank together of people who stand on the floor."""
    return 2 * thigh_length(stature) * (1 - SHORTER_LEGS * childlike(stature))


def stature_of_leg(length: float) -> float:
    """Stature (m) of people whose `leg_length` (m) is given."""
    if length >= leg_length(GROWN_UP):
        return length / (2 * thigh_length(1.0))
    if length <= leg_length(SMALL_CHILD):
        return SMALL_CHILD * length / leg_length(SMALL_CHILD)
    # Between them the length is linear + square * stature, times the stature.
    square = 2 * thigh_length(1.0) * SHORTER_LEGS / (GROWN_UP - SMALL_CHILD)
    linear = 2 * thigh_length(1.0) - GROWN_UP * square
    return (sqrt(linear**2 + 4 * square * length) - linear) / (2 * square)
