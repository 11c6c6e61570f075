"""Joint sets of pose estimation and of depth cameras: their joints in their own order and names.

The table of them is joint_sets.txt; a new set is a block there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from radhar_cli.files.numbered_words import expand_words
from radhar_cli.motion.recorded.plain_names import canonical_name


@dataclass(frozen=True)
class JointSet:
    """Joints of a pose, as a network or a camera gives them.

    Attributes:
        title: Name of the set in messages and tables.
        names: Names of the joints in the set's own order; "Hip|Pelvis" is called either.
        sources: {joint of ours: the joints whose mean it is} where names alone would mislead.
        is_by_axis: Whether its maker's columns are all x, then all y, then all z.
        up: Axis that points up by its maker's document; None where it depends on the set-up.
    """

    title: str
    names: tuple[str, ...]
    sources: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    is_by_axis: bool = False
    up: str | None = None

    @property
    def spellings(self) -> tuple[frozenset[str], ...]:
        """Names that each joint may have, in canonical form."""
        return tuple(frozenset(map(canonical_name, name.split("|"))) for name in self.names)


def _read_sets(text: str) -> Mapping[str, JointSet]:
    """Read the table of sets, whose form its first lines describe: {key: set}."""
    sets = dict[str, JointSet]()
    for block in text.split("\n\n")[1:]:
        head, *lines = block.splitlines()
        key, _, title = head.removeprefix("[").partition("] ")
        names = [line for line in lines if " = " not in line and line != BY_AXIS]
        sources = dict(line.split(" = ") for line in lines if " = " in line)
        up = sources.pop("up", None)
        sets[key] = JointSet(
            title,
            tuple(expand_words(" ".join(names))),
            {ours: tuple(theirs.split()) for ours, theirs in sources.items()},
            BY_AXIS in lines,
            up,
        )
    return MappingProxyType(sets)


BY_AXIS = "columns by axis"
# {key that a config or --joints names: the set}; order tells which comes first in messages.
JOINT_SETS = _read_sets(Path(__file__).with_name("joint_sets.txt").read_text(encoding="utf-8"))


def find_joint_set(names: Sequence[str]) -> tuple[JointSet, dict[int, int]] | None:
    """Find the set that a file's joints are named by: all of the set are there, or none else.

    Args:
        names: Names of the joints of the file.

    Returns:
        The largest such set, and {number of a joint of the set: number in the file}; None where
        names are of no set.
    """
    numbers = {canonical_name(name): n for n, name in reversed([*enumerate(names)])}
    fitting = []
    for joint_set in JOINT_SETS.values():
        matches = _match_names(joint_set, numbers)
        if len(matches) == len(joint_set.names) or len(matches) == len(names):
            fitting.append((joint_set, matches))
    return max(fitting, key=lambda pair: len(pair[1]), default=None)


def _match_names(joint_set: JointSet, numbers: Mapping[str, int]) -> dict[int, int]:
    """Joints of a set that a file has: {number in the set: number in the file}.

    Args:
        numbers: {canonical name: number} of the file's joints.
    """
    matches, used = dict[int, int](), set[int]()
    for place, name in enumerate(joint_set.names):
        for spelling in map(canonical_name, name.split("|")):
            number = numbers.get(spelling)
            if number is not None and number not in used:
                matches[place] = number
                used.add(number)
                break
    return matches


def sets_of_size(count: int) -> dict[str, JointSet]:
    """Joint sets of so many joints."""
    return {key: s for key, s in JOINT_SETS.items() if len(s.names) == count}
