"""Measure how people of the human model move, beside what was measured of people.

    python scripts/measure_movements.py

writes docs/reference/movement_figures.md: angles, speeds and accelerations of every movement, and
bounds with their sources. A test (tests/scripts/test_measure_movements.py) holds the bounds. People
are 1.75 m tall and drawn as those of a data set are, DRAWS of each movement.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.config import Config
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.motion.segments import unit
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import draw_scene

PAGE = Path(__file__).resolve().parents[1] / "docs/reference/movement_figures.md"
STATURE = 1.75
DRAWS = 1, 2, 3
LASTING, LONGEST = 4.0, 8.0  # durations of what goes on and on, and of what is looked at, s
STEP = 2e-3  # between instants, s
G = 9.81
SIDES = "right", "left"

# What comes before a movement, and numbers of `motion` that are not drawn, by name of the row.
WAYS: dict[str, tuple[list[str], dict[str, Any]]] = {
    **{name: ([], {}) for name in MOVEMENTS if name != NOBODY},
    "crawling": (["getting_on_fours"], {"crawling": {"speed_mps": 0.5}}),
    "walking": ([], {"walking": {"speed_mps": 1.2}}),
    "turning_over by a half": ([], {"lying": {"roll_deg": 0, "turn_deg": 180, "bed": 0}}),
    "lying on a side": ([], {"lying": {"roll_deg": 90, "bed": 0}}),
    **{
        f"{name} after a fall {way}": (["falling"], {"falling": {"direction": way}})
        for name in ("getting_up", "trying_to_get_up", "turning_over")
        for way in ("forward", "backward", "sideways")
    },
    **{
        f"{name} {way}": ([], {"falling": {"direction": way}})
        for name in ("falling", "falling_on_hands", "falling_off_seat", "falling_on_rising")
        for way in ("forward", "backward", "sideways")
    },
}


@dataclass(frozen=True)
class Recording:
    """Joints [3, 13, M] and hip joints [3, 2, M] (m) of one movement, STEP s apart."""

    joints: Float
    hips: Float

    def joint(self, name: str) -> Float:
        """Positions [3, M] of a joint, m."""
        return self.joints[:, JOINTS.index(name)]

    @cached_property
    def speeds(self) -> Float:
        """Speeds of the joints [13, M - 1], m/s."""
        speeds: Float = np.linalg.norm(np.diff(self.joints, axis=2), axis=0) / STEP
        return speeds

    @property
    def accelerations(self) -> Float:
        """Accelerations of the joints [13, M - 2], in units of G."""
        changes: Float = np.linalg.norm(np.diff(self.joints, n=2, axis=2), axis=0)
        return changes / STEP**2 / G

    @property
    def trunk(self) -> Float:
        """Direction from the hip to the middle of the shoulders [3, M]."""
        neck = (self.joint("right_shoulder") + self.joint("left_shoulder")) / 2
        return unit(neck - self.joint("hip"))

    def knee(self, side: str) -> Float:
        """Flexion of a knee [M], degrees; 0 is straight, below 0 bent the wrong way."""
        thigh, shank = self._leg(side)
        left = unit(self.hips[:, 1] - self.hips[:, 0])
        ahead = np.cross(shank, thigh, axis=0) * left
        return _angle(thigh, shank) * np.sign(-ahead.sum(axis=0) + 1e-3)

    def hip(self, side: str) -> Float:
        """Angle of a thigh to the trunk [M], degrees; 0 is in line."""
        return _angle(self._leg(side)[0], -self.trunk)

    def elbow(self, side: str) -> Float:
        """Flexion of an elbow [M], degrees; 0 is straight."""
        shoulder, elbow, hand = (self.joint(f"{side}_{p}") for p in ("shoulder", "elbow", "hand"))
        return _angle(unit(elbow - shoulder), unit(hand - elbow))

    def _leg(self, side: str) -> tuple[Float, Float]:
        """Directions of thigh and shank [3, M]."""
        hip, knee = self.hips[:, SIDES.index(side)], self.joint(f"{side}_knee")
        return unit(knee - hip), unit(self.joint(f"{side}_ankle") - knee)

    @property
    def shanks_apart(self) -> Float:
        """Distance of the axes of both shanks [M], cm."""
        ends = [(self.joint(f"{s}_knee"), self.joint(f"{s}_ankle")) for s in SIDES]
        shares = np.linspace(0, 1, 25)[:, None, None]
        right, left = (start + shares * (end - start) for start, end in ends)
        apart = [np.linalg.norm(right - point, axis=1).min(axis=0) for point in left]
        distance: Float = 100 * np.min(apart, axis=0)
        return distance


def _angle(one: Float, other: Float) -> Float:
    """Angles [M] between unit vectors [3, M], degrees."""
    angle: Float = np.degrees(np.arccos(np.clip((one * other).sum(axis=0), -1.0, 1.0)))
    return angle


@cache
def recordings(way: str) -> tuple[Recording, ...]:
    """Recordings of a row of WAYS, one for each of DRAWS."""
    before, motion = WAYS[way]
    return tuple(_recording([*before, way.split()[0]], motion, draw) for draw in DRAWS)


def _recording(names: list[str], motion: dict[str, Any], draw: int) -> Recording:
    """Last of some movements that follow each other."""
    durations = [LASTING if MOVEMENTS[name].seconds is None else None for name in names]
    config = Config.model_validate(
        {
            "duration_s": 12.0,
            "activities": ["own"],
            "classes": {"own": {"sequence": names, "durations_s": durations}},
            "motion": motion,
            "subject": {"height_m": STATURE},
        }
    )
    person = draw_scene(config, config.chosen_activities[0], draw).people[0]
    moving = motion_of(person)
    assert isinstance(moving, HumanMotion)
    part = moving.parts[-1][0]
    t = np.arange(part.begin, min(part.end, part.begin + LONGEST), STEP)
    return Recording(moving.positions(t), moving.hip_joints(t))


# Quantities of a recording, by what the tables call them.
Quantity = Callable[[Recording], float]


def _speed(joint: str) -> Quantity:
    """Quantity: the largest speed of a joint, of either side."""
    rows = [n for n, name in enumerate(JOINTS) if name.endswith(joint)]
    return lambda recording: float(recording.speeds[rows].max())


def _down(joint: str) -> Quantity:
    """Quantity: the largest speed downwards of a joint."""
    return lambda recording: float(-np.diff(recording.joint(joint)[2]).min() / STEP)


def _both(angle: Callable[[Recording, str], Float]) -> Quantity:
    """Quantity: the largest of an angle of the right or left side."""
    return lambda recording: float(max(angle(recording, side).max() for side in SIDES))


def _over(joint: str, seconds: float) -> Quantity:
    """Quantity: the largest speed of a joint within the first seconds."""
    rows = [n for n, name in enumerate(JOINTS) if name.endswith(joint)]
    return lambda recording: float(recording.speeds[rows, : round(seconds / STEP)].max())


def _planted_elbow(recording: Recording) -> float:
    """Speed of an elbow whose hand is on the floor and does not move, at most, m/s."""
    return max(
        float(elbow[hand < 0.01].max())
        for elbow, hand in (
            (recording.speeds[JOINTS.index(f"{s}_elbow")], recording.speeds[JOINTS.index(hand)])
            for s in SIDES
            for hand in [f"{s}_hand"]
        )
    )


QUANTITIES: dict[str, Quantity] = {
    "knee, degrees": _both(Recording.knee),
    "hip, degrees": _both(Recording.hip),
    "elbow, degrees": _both(Recording.elbow),
    "trunk from upright, degrees": lambda r: float(
        np.degrees(np.arccos(r.trunk[2].clip(-1, 1))).max()
    ),
    "fastest joint, m/s": lambda r: float(r.speeds.max()),
    "acceleration, g": lambda r: float(r.accelerations.max()),
    "shanks apart, cm": lambda r: float(r.shanks_apart.min()),
    "knee at first, degrees": lambda r: float(max(r.knee(side)[0] for side in SIDES)),
    "knee bent back, degrees": lambda r: float(-min(r.knee(side).min() for side in SIDES)),
    **{f"{joint}, m/s": _speed(joint) for joint in ("hand", "elbow", "knee", "ankle", "head")},
    **{f"{joint} down, m/s": _down(joint) for joint in ("hip", "head")},
    "any joint in the first 0.6 s, m/s": _over("", 0.6),
    "elbow of a planted hand, m/s": _planted_elbow,
    "duration, s": lambda r: r.joints.shape[2] * STEP,
}
OF_ALL = tuple(QUANTITIES)[:7]


class Bound(NamedTuple):
    """Between what a quantity of a way to move should lie, and who says so."""

    way: str
    quantity: str
    least: float
    most: float
    source: str


ESTIMATE = "estimate"
ROM = "adults bend knees by 140 (on the heels 155 to 165), elbows by 145 to 150 (from memory)"
CHOI = "Choi et al. 2015, 25 real falls: mean and two deviations"
# Gaits are those of walking.
GAITS = "walking", "limping", "walking_with_stick", "walking_with_walker", "carrying"
RUNNING = "running", "jogging_in_place"
# What is faster than an everyday movement, or stops harder: most of m/s and of g.
FAST = {
    "punching": (
        7.0,
        10.0,
        "lay people 2.8 to 5.2, competitors 7.5 to 9.3 (Piorkowski et al. 2011)",
    ),
    "kicking": (14.0, 30.0, "8 of a motion capture clip, athletes 8 to 14 (from memory)"),
    **dict.fromkeys(GAITS, (5.5, 10.0, "ankle 2.9 to 3.2 times the walking speed (CMU)")),
    **dict.fromkeys(RUNNING, (12.0, 40.0, ESTIMATE)),
    "tripping": (7.0, 12.0, ESTIMATE),
    "stumbling": (5.0, 13.0, ESTIMATE),
    "jumping": (3.5, 12.0, "0.36 s in the air are 1.8 m/s of the trunk at take-off"),
    "jumping_jacks": (6.5, 10.0, ESTIMATE),
    **{
        way: (6.0, 12.0, "Choi et al. 2015: head 2.9 +- 0.9, hand 2.9 +- 1.6, two deviations")
        for way in WAYS
        if way.startswith("falling")
    },
}
STILL = "stationary", "sitting", "kneeling", "lying", "lying on a side"
CLOSE = dict.fromkeys(RUNNING, 4.0)  # least distance of the shanks of who runs, cm


def bounds() -> Iterator[Bound]:
    """All bounds: of each way to move, then of those that were measured."""
    for way in WAYS:
        fastest, hardest, source = FAST.get(way, (2.6, 5.0, ESTIMATE))
        if way in STILL:
            fastest, hardest = 1.0, 1.0
        yield Bound(way, "knee bent back, degrees", -360, 1, "a knee bends one way")
        yield Bound(way, "knee, degrees", 0, 165, ROM)
        yield Bound(way, "elbow, degrees", 0, 155, ROM)
        yield Bound(way, "fastest joint, m/s", 0, fastest, source)
        yield Bound(way, "acceleration, g", 0, hardest, ESTIMATE)
        yield Bound(
            way, "shanks apart, cm", CLOSE.get(way, 7.0), 300, "a shank is 8 to 10 cm thick"
        )
    yield from MEASURED


SWING = "60 to 65 measured (Perry, Gait Analysis, from memory), and 7 to both sides"
MEASURED = (
    Bound("walking", "ankle, m/s", 3.3, 4.8, "CMU: 2.9 to 3.2 times 1.2 m/s, a stride's jitter"),
    *(Bound(way, "knee, degrees", 53, 72, SWING) for way in GAITS),
    Bound("stationary", "knee at first, degrees", -1, 8, "0 to 5 of who stands (from memory)"),
    Bound("punching", "hand, m/s", 2.2, 7.0, "lay people 2.8 to 5.2 (CMU, DeepMimic)"),
    Bound("kicking", "ankle, m/s", 5.0, 14.0, "8.1 (DeepMimic), athletes 8 to 14 (from memory)"),
    Bound("standing_up", "trunk from upright, degrees", 30, 55, "30 to 50 (from memory)"),
    Bound(
        "standing_up", "duration, s", 1.4, 2.3, "1.7 to 2.3 (Arch Phys Med Rehabil 74 (1993) 1095)"
    ),
    Bound("sitting_down", "head, m/s", 0.6, 1.6, ESTIMATE),
    Bound("falling forward", "hip down, m/s", 0.9, 3.4, CHOI),
    Bound("falling forward", "head down, m/s", 1.2, 4.7, CHOI),
    Bound("falling backward", "hip down, m/s", 0.9, 3.4, CHOI),
    Bound("falling backward", "head down, m/s", 1.2, 4.7, CHOI),
    Bound("falling sideways", "hip down, m/s", 0.9, 3.4, CHOI),
    Bound("falling sideways", "head down, m/s", 1.2, 4.7, CHOI),
    *(
        Bound(f"{name} after a fall {way}", "any joint in the first 0.6 s, m/s", 0, most, ESTIMATE)
        for name, way, most in (
            ("getting_up", "forward", 1.1),
            ("getting_up", "sideways", 1.7),
            ("getting_up", "backward", 2.0),
            ("trying_to_get_up", "forward", 1.1),
            ("trying_to_get_up", "sideways", 1.2),
            ("trying_to_get_up", "backward", 1.2),
        )
    ),
    Bound(
        "getting_up",
        "duration, s",
        2.4,
        5.5,
        "young 3 to 4, of 50 to 90 years 4.1 +- 1.1 (Bohannon)",
    ),
    Bound("crawling", "knee, m/s", 1.0, 1.4, "2 to 2.8 times the body's 0.5: " + ESTIMATE),
    Bound("crawling", "elbow, m/s", 0.5, 2.0, ESTIMATE),
    Bound(
        "crawling",
        "elbow of a planted hand, m/s",
        0.1,
        0.35,
        "half the body's speed: a straight arm",
    ),
    Bound("lying_down", "hand, m/s", 0.3, 1.9, "1.5, a duration 15 % shorter: " + ESTIMATE),
    Bound("getting_up_from_bed", "hand, m/s", 0.3, 1.9, "likewise"),
    *(
        Bound(way, "hand, m/s", 0.3, 1.8, "1.5, a duration 15 % shorter: " + ESTIMATE)
        for way in WAYS
        if way.startswith("turning_over")
    ),
    Bound(
        "drinking_seated",
        "hand, m/s",
        0.3,
        1.0,
        "0.6 +- 0.1 reaching for a glass (Alt Murphy, from memory)",
    ),
    Bound("waving", "hand, m/s", 0.8, 3.0, ESTIMATE),
)


def values(bound: Bound) -> tuple[float, float]:
    """Least and largest of a bound's quantity in DRAWS."""
    found = [QUANTITIES[bound.quantity](recording) for recording in recordings(bound.way)]
    return min(found), max(found)


def page() -> str:
    """docs/reference/movement_figures.md."""
    lines = [*INTRODUCTION, "", "## Every movement", ""]
    lines += [f"| movement | {' | '.join(OF_ALL)} |", f"| --- |{' ---: |' * len(OF_ALL)}"]
    for way in WAYS:
        found = (QUANTITIES[name] for name in OF_ALL)
        cells = (
            _span([quantity(recording) for recording in recordings(way)]) for quantity in found
        )
        lines.append(f"| {way} | {' | '.join(cells)} |")
    lines += ["", "## Beside what was measured", ""]
    lines += [
        "| movement | quantity | ours | bounds | source |",
        "| --- | --- | ---: | ---: | --- |",
    ]
    for bound in MEASURED:
        span, limits = _span(values(bound)), f"{bound.least:g} to {bound.most:g}"
        lines.append(f"| {bound.way} | {bound.quantity} | {span} | {limits} | {bound.source} |")
    lines += ["", "## Bounds of all movements", ""]
    lines += ["| movements | m/s | g | source of the speed |", "| --- | ---: | ---: | --- |"]
    for way, (fastest, hardest, source) in FAST.items():
        lines.append(f"| {way} | {fastest:g} | {hardest:g} | {source} |")
    return "\n".join([*lines, *ENDING]) + "\n"


def _span(found: tuple[float, ...] | list[float]) -> str:
    """Least and largest of some numbers, in two digits, or one where they are the same."""
    least, most = (
        f"{number:.2g}" if abs(number) < 10 else f"{number:.0f}"
        for number in (min(found), max(found))
    )
    return least if least == most else f"{least} to {most}"


INTRODUCTION = (
    "# Figures of movements",
    "",
    "After this page you know which angles, speeds and accelerations people of the human model",
    "have, and what they are held against. `python scripts/measure_movements.py` writes it, and",
    "`tests/scripts/test_measure_movements.py` holds the bounds. People are 1.75 m tall and drawn",
    f"{len(DRAWS)} times as those of a data set; numbers are the largest of a movement (distances:",
    "the least), from the least to the largest of the draws. Knees and elbows are at 0 where",
    "straight, hips where thigh and trunk are in line (the spine, which does not bend",
    "here, is part of them). An estimate has no published figure behind it; what is from memory",
    "was not read again.",
)
ENDING = (
    "| all others | 2.6 | 5 | estimate |",
    "",
    "Knees bend one way, by at most 165 degrees, elbows by at most 155 (adults bend knees by 140,",
    "on the heels 155 to 165, elbows by 145 to 150: from memory), and axes of shanks are at least",
    "7 cm apart (of who runs, 4 cm).",
)


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
