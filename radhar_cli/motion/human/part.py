"""Parts that activities are made of, each from one state of rest to the next."""

from math import cos, sin
from typing import NamedTuple, Protocol

from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import Pose
from radhar_cli.numerics.arrays import Float

STANDING, SEATED, LYING = "standing", "seated", "lying"
KNEELING, ON_FOURS = "kneeling", "on hands and knees"


class Phase(NamedTuple):
    """Name of what is under way from `start` (s) on."""

    start: float
    name: str


class Place(NamedTuple):
    """Place of a part's end, seen from its beginning: m ahead, m to the left, rad to the left."""

    ahead: float = 0.0
    left: float = 0.0
    turn: float = 0.0


HERE = Place()


def place_after(place: Place, end: Place) -> Place:
    """Place in the room where a part ends that begins at `place`; `end` is seen from there."""
    c, s = cos(place.turn), sin(place.turn)
    return Place(
        place.ahead + c * end.ahead - s * end.left,
        place.left + s * end.ahead + c * end.left,
        place.turn + end.turn,
    )


def origin_seen_from(place: Place) -> Place:
    """Inverse of a place: where the point that it is relative to lies, seen from the place."""
    c, s = cos(place.turn), sin(place.turn)
    x, y = -place.ahead, -place.left
    return Place(c * x + s * y, c * y - s * x, -place.turn)


def kind_of_rest(state: str) -> str:
    """Kind of a state of rest, without how somebody lies: "lying prone" is lying."""
    return state.partition(" ")[0]


class Part(Protocol):
    """A movement that begins and ends at rest; before and after it the body holds its pose.

    Times are those of the recording. Poses are local: x ahead and y to the left of the floor point
    between the ankles of the stance in which the part begins.

    Attributes:
        before: State of rest in which it begins, such as standing, seated or lying.
        after: State of rest in which it ends.
        begin: Time at which the body leaves its first state, s.
        end: Time at which the body has come to rest, s; infinity for what goes on.
        place: Place of its end.
        phases: Names of what is under way, and from when on.
        breakpoints: Instants (s) at which a position is not smooth.
    """

    @property
    def before(self) -> str: ...
    @property
    def after(self) -> str: ...
    @property
    def begin(self) -> float: ...
    @property
    def end(self) -> float: ...
    @property
    def place(self) -> Place: ...
    @property
    def phases(self) -> tuple[Phase, ...]: ...
    @property
    def breakpoints(self) -> tuple[float, ...]: ...

    def pose(self, t: Float, idle: IdleState) -> Pose:
        """Pose of the body at times t [M] (s), its own movements `idle` [M] included."""
        ...


class Movement(Protocol):
    """A dataclass of how a person makes one movement, such as `sitting.SitDown`.

    One that is faster than others has `fastest_hz`, the frequency that it counts as.
    """

    def part(self, person: Physique, begin: float, horizon: float) -> Part:
        """Place the movement of a person in time.

        Args:
            person: Body that moves.
            begin: Beginning of the movement, s.
            horizon: Until when a movement that goes on is worked out, s.
        """
        ...
