"""Kinds of maps of a slow-time signal: the transform, and what is done to the signal before it."""

from dataclasses import dataclass
from enum import StrEnum
from itertools import product


class Transform(StrEnum):
    """Transform that makes a map."""

    RTM = "rtm"  # power of the range profiles over time
    STFT = "stft"  # short-time Fourier transform
    FSST = "fsst"  # Fourier synchrosqueezed transform


@dataclass(frozen=True)
class Treatment:
    """Treatment of a signal before its Doppler-time maps are made.

    Attributes:
        compensated: whether the bulk Doppler of the torso is taken out.
        denoised: whether a Savitzky-Golay filter smooths it, after the compensation.
    """

    compensated: bool = False
    denoised: bool = False

    def __str__(self) -> str:
        return "_".join(self._words) or "raw"

    @property
    def suffix(self) -> str:
        """Suffix to the name of a signal or map, such as _compensated_denoised."""
        return "".join(f"_{word}" for word in self._words)

    @property
    def _words(self) -> tuple[str, ...]:
        return (*["compensated"] * self.compensated, *["denoised"] * self.denoised)


UNTREATED = Treatment()
TREATMENTS = tuple(Treatment(*flags) for flags in product((False, True), repeat=2))


@dataclass(frozen=True)
class MapKind:
    """Kind of a map: a transform, and the treatment of the slow-time signal before it.

    `str(kind)` is the name that `maps:` has, such as stft_compensated_denoised.

    Attributes:
        transform: transform that makes the map.
        treatment: treatment of the signal that it shows; an rtm shows untreated range profiles.
    """

    transform: Transform
    treatment: Treatment = UNTREATED

    @classmethod
    def parse(cls, name: str) -> "MapKind":
        """Read a name of `maps:`, such as stft_compensated_denoised.

        Raises:
            ValueError: no signal has a map of that name.
        """
        kind = MAP_KINDS.get(name)
        if kind is None:
            raise ValueError(f"{name!r} should be one of {', '.join(MAP_KINDS)}")
        return kind

    def __str__(self) -> str:
        return self.transform + self.treatment.suffix

    @property
    def is_doppler_time(self) -> bool:
        """Whether the map shows Doppler over time, rather than range."""
        return self.transform is not Transform.RTM


RTM = MapKind(Transform.RTM)
DOPPLER_TIME_KINDS = tuple(
    MapKind(transform, treatment)
    for transform in (Transform.STFT, Transform.FSST)
    for treatment in TREATMENTS
)
# {name: kind} of every map of a signal, in the order of data sets.
MAP_KINDS = {str(kind): kind for kind in (RTM, *DOPPLER_TIME_KINDS)}

MIN_CADENCE_WINDOWS = 8  # of a recording, for its cadences
# {name: Doppler-time map that it shows the cadences of} of every cadence-velocity diagram.
CADENCE_KINDS = {f"{kind}_cadence": kind for kind in DOPPLER_TIME_KINDS}


def kind_of(name: str) -> MapKind | None:
    """Kind of the map of a signal that a name shows, itself or its cadences; None of others."""
    return MAP_KINDS.get(name) or CADENCE_KINDS.get(name)


def treatment_of(name: str) -> Treatment:
    """Treatment of the signal that a map of a name shows; none of a map of a user's own."""
    kind = kind_of(name)
    return UNTREATED if kind is None else kind.treatment
