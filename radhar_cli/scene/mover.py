"""A person of a scene as the movements see them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.motion.activities.activity import first_states
from radhar_cli.motion.movements.catalogue import name_of
from radhar_cli.motion.movements.kind import S
from radhar_cli.scene.scene import Person

IN_BED = "in_bed"


@dataclass(frozen=True)
class SceneMover:
    """The `Mover` of a person of a scene.

    Attributes:
        person: Person of the scene.
        duration: Duration of the movement, s; infinity goes on.
        place: Place of the movement in its sequence.
    """

    person: Person
    duration: float
    place: int = 0

    @property
    def seconds(self) -> float:
        return self.person.seconds

    @property
    def stature(self) -> float:
        return self.person.subject.height_m

    @cached_property
    def is_in_bed(self) -> bool:
        """Whether it is as the config has it, unless the sequence needs a bed, or none."""
        section = self.person.config.classes.get(self.person.activity.slug)
        if isinstance(section, SequenceConfig):
            firsts = first_states([step.name for step in section.steps()])
            if len(firsts) == 1:
                return firsts == (IN_BED,)
        return bool(self.person.motion.lying.bed > 0.5)

    def numbers(self, section: type[S]) -> S:
        """Numbers of a section of `motion`."""
        numbers: S = getattr(self.person.motion, name_of(section))
        return numbers

    def stream(self, name: str) -> np.random.Generator:
        """Random stream of a name, for what this person does in this scene."""
        return self.person.stream(name)
