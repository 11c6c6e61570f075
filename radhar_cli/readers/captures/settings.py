"""Settings that are needed to read a capture, from its header or from the command line."""

from math import prod
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

Count: TypeAlias = Annotated[int, Field(ge=1, le=2**24, strict=True)]
Above: TypeAlias = Annotated[float, Field(gt=0, le=1e15, strict=True)]
Text: TypeAlias = Annotated[str, Field(max_length=1000)]
# {what an axis of a capture is called, one of it, in lower case, with _ for spaces: its name}
AXIS_WORDS = {
    **{name: name for name in ("receiver", "transmitter", "sample", "frame", "pulse")},
    **dict.fromkeys(("range", "range_bin", "bin", "adc", "adc_sample", "fast_time"), "sample"),
    **dict.fromkeys(("chirp", "sweep", "slow_time", "loop"), "pulse"),
    **dict.fromkeys(("rx", "channel", "antenna"), "receiver"),
    "tx": "transmitter",
}


def axis_of_word(word: object) -> object:
    """Name of the axis that a word of other software means, such as chirps; others as they are."""
    if not isinstance(word, str):
        return word
    plain = word.strip().lower().replace(" ", "_").replace("-", "_").removesuffix("s")
    return AXIS_WORDS.get(plain, word)


AxisName: TypeAlias = Literal["receiver", "transmitter", "sample", "frame", "pulse", "iq"]
AxisWord: TypeAlias = Annotated[AxisName, BeforeValidator(axis_of_word)]
NUMBER_TYPE = r"^[<>]?(u?int(8|16|32|64)|float(16|32|64)|complex(64|128))$"
FARTHEST_M = 1000  # first sample of range profiles
MAX_RANGE_STEP_M = 3.0  # of range profiles; a coarser one is of cm
NO_TIMES = "none"  # for `times`: those of the file are not used


def _refusal(right: str) -> PydanticCustomError:
    """Error of a value, by what would be right."""
    return PydanticCustomError("wrong", "{right}", {"right": right})


def _require_metres(value: float) -> float:
    if value > FARTHEST_M:
        raise _refusal(f"should be at most {FARTHEST_M}, a number in m")
    return value


def _require_steps(value: float) -> float:
    if value > MAX_RANGE_STEP_M:
        raise _refusal(f"should be at most {MAX_RANGE_STEP_M:g}, a number in m: 5 cm is 0.05")
    return value


def _require_each_once(value: tuple[AxisName, ...]) -> tuple[AxisName, ...]:
    if len(set(value)) < len(value) or "pulse" not in value:
        raise _refusal("should name each axis once, including pulse")
    return value


class CaptureSettings(BaseModel):
    """The header of a capture; None is unknown, and requested where it is needed."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True, defer_build=True
    )

    # at the first sample of a chirp; of slow time, the frequency of its Doppler
    carrier_hz: Annotated[float, Field(ge=1e6, le=1e13, strict=True)] | None = None
    # swept while the samples are taken
    bandwidth_hz: Annotated[float, Field(ge=1e3, le=1e12, strict=True)] | None = None
    adc_rate_hz: Above | None = None  # samples per second within a chirp
    # pulses per second of one transmitter: 1/(transmitters times chirp interval)
    prf_hz: Annotated[float, Field(ge=1e-3, le=1e7, strict=True)] | None = None
    samples: Annotated[int, Field(ge=2, le=2**24, strict=True)] | None = None  # of a chirp
    receivers: Annotated[int, Field(ge=1, le=64, strict=True)] | None = None
    transmitters: Annotated[int, Field(ge=1, le=512, strict=True)] = 1  # they take turns
    frame_pulses: Count | None = None  # of one transmitter; None where slow time has no frames
    frame_s: Above | None = None  # from the start of a frame to that of the next
    frame_delay_s: Annotated[float, Field(ge=0, le=1e6)] = 0.0  # from there to its first pulse
    # of frames of several subframes: number of the one that is read; None is all
    subframe: Annotated[int, Field(ge=0, le=3, strict=True)] | None = None
    # of an acconeer recording of several subsweeps: number of the one that is read
    subsweep: Annotated[int, Field(ge=0, le=63, strict=True)] | None = None
    # words from frame to frame of TI's stream where there are others than these pulses, and words
    # of a frame before the first of them
    frame_words: Annotated[int, Field(ge=1, le=2**40, strict=True)] | None = None
    skipped_words: Annotated[int, Field(ge=0, le=2**40, strict=True)] = 0
    # of TI's LVDS stream; see dca1000.py
    lanes: Literal[2, 4] | None = None
    interleaved: Annotated[bool, Field(strict=True)] | None = None
    receiver_lanes: tuple[Annotated[int, Field(ge=0, le=3, strict=True)], ...] | None = None
    iq: Literal["iq", "qi"] = "iq"  # which part comes first
    complex: Annotated[bool, Field(strict=True)] = True  # whether samples have two parts
    adc_bits: Literal[12, 14, 16] = 16
    # of whole numbers, two's complement or offset binary; detected if None
    coding: Literal["signed", "offset"] | None = None
    # half of the spectrum with the targets: negative is radhar's exp(-j 2 pi K tau t), positive
    # TI's; detected if None
    beat: Literal["negative", "positive"] | None = None
    # what samples are, where they do not look like it; slow_time follows from axes without sample
    holds: Literal["beat", "profiles"] | None = None
    # of range profiles: range of the first sample and step to the next, m
    first_range_m: Annotated[float, Field(ge=0), AfterValidator(_require_metres)] | None = None
    range_step_m: Annotated[float, Field(gt=0), AfterValidator(_require_steps)] | None = None
    # of a file of numbers without a mark: their type, as NumPy names it, and bytes before them
    dtype: Annotated[str | None, Field(pattern=NUMBER_TYPE)] = None
    skipped_bytes: Annotated[int, Field(ge=0, le=2**40, strict=True)] = 0
    # names of the samples (or of I, where Q is another array: imaginary), and of the pulses' times
    # (s), within the file; times=none leaves those of the file out
    dataset: Text | None = None
    imaginary: Text | None = None
    times: Text | None = None
    # of an array, outermost first, in the order of the program that wrote it
    axes: Annotated[tuple[AxisWord, ...], AfterValidator(_require_each_once)] | None = None
    # keys of a config's section `radar` that samples do not tell: array, position_m and so on
    radar: dict[str, Any] | None = None
    label: Text | None = None  # of the whole recording, as the person
    person: Text | None = None

    @property
    def are_profiles(self) -> bool:
        """Whether samples of a pulse are said to lie over range."""
        return self.holds == "profiles" or (
            self.holds is None and (self.first_range_m, self.range_step_m) != (None, None)
        )

    @property
    def words_of_a_pulse(self) -> int:
        """Number of 16-bit words for one pulse of every transmitter in TI's stream."""
        sizes = self.transmitters, self.stored_receivers, self.samples or 1, 1 + self.complex
        return prod(sizes)

    @property
    def words_of_a_frame(self) -> int:
        """Number of 16-bit words of a frame in TI's stream; of a pulse where there are none."""
        return self.frame_words or self.words_of_a_pulse * (self.frame_pulses or 1)

    @property
    def stored_receivers(self) -> int:
        """Number of receivers in TI's stream: four with four interleaved lanes, used or not."""
        return 4 if self.interleaved and self.lanes == 4 else self.receivers or 1
