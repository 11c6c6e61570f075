"""What the bodies of people should be like."""

import numpy as np

from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.skeleton import JOINTS, links

LEGS = [JOINTS.index(f"{side}_{part}") for side in ("right", "left") for part in ("knee", "ankle")]
TRUNK = [JOINTS.index(name) for name in ("head", "hip")]


def links_of(person: Physique) -> np.ndarray:
    """Links [13, 3] of a person: a child's legs are shorter and the trunk is longer."""
    link = links(person.stature)
    link[LEGS] *= person.leg / np.linalg.norm(link[LEGS[0]])
    link[TRUNK] *= person.trunk / np.linalg.norm(link[TRUNK[1]])
    return link
