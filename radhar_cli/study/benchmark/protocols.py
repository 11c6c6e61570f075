"""Protocols: who is trained on and tested, by which network, and what tuned the simulation.

docs/guide/benchmark_simulators.md shows the same table; a test compares them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from radhar_cli.capture.recipes.mars import MOVEMENTS
from radhar_cli.errors import ConfigError, did_you_mean

AUTHORS, PERSONS = "authors", "persons"


@dataclass(frozen=True)
class Protocol:
    """One row of the table of protocols: a measured set, a simulation and a network.

    Attributes:
        recipe: recipe of `radhar prepare`.
        simulation: preset of the simulated data set.
        tuned_on: measured data that settings of the simulation were chosen on, in words.
        split: `authors`, or `persons`: these are dealt into parts, each tested once.
        training: keys of the training config.
        map: map of both data sets.
        part: folder of the download that is used alone; "" is all of it.
        preparing: KEY=VALUE of the measured data set.
        simulating: KEY=VALUE of the simulated data set.
        names: {class of either data set: class of the protocol, or None to leave it out}.
        size_px: height and width that images are brought to; None for sequences.
        folds: largest number of parts of the persons.
    """

    recipe: str
    simulation: str
    tuned_on: str
    split: str
    training: Mapping[str, Any]
    map: str = "points"
    part: str = ""
    preparing: tuple[str, ...] = ()
    simulating: tuple[str, ...] = ()
    names: Mapping[str, str | None] = field(default_factory=dict)
    size_px: tuple[int, int] | None = None
    folds: int = 5

    @property
    def find_joints(self) -> bool:
        """Whether joints are found, not classes."""
        return self.training.get("target") == "skeleton"

    @property
    def data(self) -> str:
        """Name of the measured data set."""
        return f"{self.recipe}_{self.part}".strip("_").lower()


_MARS = "no measured cloud: the paper says board and place, and the names say the movements"
# Exercises of UniMM-HAR beside those of MARS, and the movements that simulate them.
_EXERCISES = {
    **{"walk": "walking", "jump": "jumping", "jumping_jack": "jumping_jacks", "box": "punching"},
    "picking_up": "grabbing",
}
_UNIMMHAR: dict[str, Any] = {
    "recipe": "unimmhar",
    "simulation": "measured/mars_1443",
    "tuned_on": "no measured cloud: board and place are those of MARS's paper, which not all of "
    "the set's recordings share, and the names say the movements",
    "split": AUTHORS,
    "training": {"model": "cloudnet", "frames": 20},
    "simulating": (
        *(f"classes.{name}={{sequence: [{motion}]}}" for name, motion in _EXERCISES.items()),
        f"activities=[{','.join((*MOVEMENTS, *_EXERCISES))}]",
    ),
}
PROTOCOLS = {
    "glasgow": Protocol(
        recipe="glasgow",
        simulation="measured/glasgow_5p8GHz",
        tuned_on="masks of the same set: places, headings, speeds and noise were chosen by looking "
        "at all of its persons",
        split=PERSONS,
        training={"model": "smallnet", "input": "gray", "batch_size": 64, "average_last": 0.5},
        map="stft",
        simulating=(
            "activities=[walking,sitting_down,standing_up,grabbing,walking_to_falling,falling]",
        ),
        names={"grabbing": "picking_up", "walking_to_falling": "falling", "drinking": None},
        size_px=(64, 64),
    ),
    "radhar": Protocol(
        recipe="radhar",
        simulation="measured/radhar_1443",
        tuned_on="the first half of one recording a class of the Test folder",
        split=AUTHORS,
        training={"model": "cloudnet", "frames": 60},
        simulating=("duration_s=2",),
    ),
    "unimmhar_csub": Protocol(**_UNIMMHAR, part="CSub"),
    "unimmhar_cset": Protocol(**_UNIMMHAR, part="CSet"),
    "mars": Protocol(
        recipe="mars",
        simulation="measured/mars_1443",
        tuned_on=_MARS,
        split=PERSONS,
        training={"model": "cloudnet", "frames": 20, "target": "skeleton"},
        folds=4,
    ),
}


def choose_protocols(names: Sequence[str]) -> dict[str, Protocol]:
    """Protocols of some names; all where none is given.

    Raises:
        ConfigError: there is no such protocol.
    """
    for name in names:
        if name not in PROTOCOLS:
            hint = did_you_mean(name, PROTOCOLS, f"there are {', '.join(PROTOCOLS)}")
            raise ConfigError(f"--protocols {name}: there is no such protocol; {hint}")
    return {name: PROTOCOLS[name] for name in names or PROTOCOLS}
