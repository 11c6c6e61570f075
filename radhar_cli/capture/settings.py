"""Settings needed to read a capture, from its header or given by hand."""

from math import prod
from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from radhar_cli.config.number import must
from radhar_cli.config.schema import Section

Count: TypeAlias = Annotated[int, Field(ge=1, le=2**24, strict=True)]
Above: TypeAlias = Annotated[float, Field(gt=0, le=1e15, strict=True)]
Text: TypeAlias = Annotated[str, Field(max_length=1000)]
AxisName: TypeAlias = Literal["receiver", "transmitter", "sample", "frame", "pulse", "iq"]
USUAL_AXES: dict[int, tuple[AxisName, ...]] = {
    1: ("pulse",),
    2: ("sample", "pulse"),
    3: ("receiver", "sample", "pulse"),
    4: ("frame", "pulse", "receiver", "sample"),
}


class CaptureSettings(Section):
    """The header of a capture; None is unknown, and requested where it is needed.

    Attributes:
        carrier_hz: at the first sample of a chirp; of slow time, the frequency of its Doppler.
        bandwidth_hz: swept while the samples are taken.
        adc_rate_hz: samples per second within a chirp.
        prf_hz: pulses per second of one transmitter: 1/(transmitters times chirp interval).
        samples: of a chirp, N_ADC.
        receivers, transmitters: antennas; transmitters take turns (TDM-MIMO).
        frame_pulses: pulses of one transmitter in a frame; None where slow time has no frames.
        frame_s: from the start of a frame to that of the next.
        lanes, interleaved, receiver_lanes: of TI's LVDS stream; see dca1000.py.
        iq: which part comes first.
        complex: whether samples have two parts.
        adc_bits: of a sample.
        coding: of whole numbers, two's complement or offset binary; detected if None.
        beat: half of the spectrum with the targets: `negative` is radhar's exp(-j 2 pi K tau t),
            `positive` TI's; detected if None.
        dataset, times: names of the samples, and of the pulses' times (s), within the file.
        axes: of an array, outermost first, in the order of the program that wrote it.
        label, person: of the whole recording.
    """

    carrier_hz: Above | None = None
    bandwidth_hz: Above | None = None
    adc_rate_hz: Above | None = None
    prf_hz: Above | None = None
    samples: Annotated[int, Field(ge=2, le=2**24, strict=True)] | None = None
    receivers: Annotated[int, Field(ge=1, le=64, strict=True)] | None = None
    transmitters: Annotated[int, Field(ge=1, le=512, strict=True)] = 1
    frame_pulses: Count | None = None
    frame_s: Above | None = None
    lanes: Literal[2, 4] | None = None
    interleaved: Annotated[bool, Field(strict=True)] | None = None
    receiver_lanes: tuple[Annotated[int, Field(ge=0, le=3, strict=True)], ...] | None = None
    iq: Literal["iq", "qi"] = "iq"
    complex: Annotated[bool, Field(strict=True)] = True
    adc_bits: Literal[12, 14, 16] = 16
    coding: Literal["signed", "offset"] | None = None
    beat: Literal["negative", "positive"] | None = None
    dataset: Text | None = None
    times: Text | None = None
    axes: Annotated[
        tuple[AxisName, ...] | None,
        must(
            lambda value: len(set(value)) == len(value) and "pulse" in value,
            "should name each axis once, including pulse",
        ),
    ] = None
    label: Text | None = None
    person: Text | None = None

    @property
    def words_of_a_pulse(self) -> int:
        """Words of 16 bits for one pulse of every transmitter in TI's stream."""
        sizes = self.transmitters, self.stored_receivers, self.samples or 1, 1 + self.complex
        return prod(sizes)

    @property
    def stored_receivers(self) -> int:
        """Receivers in TI's stream: with four interleaved lanes all of them, used or not."""
        return 4 if self.interleaved and self.lanes == 4 else self.receivers or 1
