"""Content of a recording's samples: beat signals of chirps, range profiles, or slow time."""

from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar, Self, TypeAlias

from radhar_cli.config.radar import class_of_radar
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.frame_timing import FrameTiming
from radhar_cli.radar.impulse import Impulse, impulse

TOLERANCE = 1e-6  # relative difference of frequencies and times that are the same


@dataclass(frozen=True)
class WholeBand(Waveform):
    """Waveform of which all range bins are kept, as complex samples tell both halves apart."""

    @property
    def n_bins(self) -> int:
        """Number of range bins."""
        return self.n_fft

    @property
    def half_band_range(self) -> float:
        """Range of the end of the band, m."""
        return self.range_step * self.n_bins


@dataclass(frozen=True)
class Beat:
    """Beat signals: N samples of every chirp."""

    dataset: ClassVar[str] = "beat"
    noun: ClassVar[str] = "samples of chirps"
    axes: ClassVar[tuple[str, ...]] = ("receiver", "fast time", "pulse")

    carrier_hz: float  # frequency at the first sample of a chirp that is kept
    bandwidth_hz: float  # B, swept while the samples are taken
    adc_rate_hz: float  # fs
    samples: int  # N, of a chirp
    prf_hz: float  # pulses per second of one receiver, within a segment
    is_whole: bool = False  # whether echoes lie in both halves of the band of complex samples

    @classmethod
    def of_frames(cls, timing: FrameTiming) -> Self:
        """Samples of the chirps of one transmitter of a radar with frames."""
        rates = timing.adc_rate_hz, timing.samples, timing.prf_hz
        return cls(timing.carrier_hz, timing.bandwidth_hz, *rates)

    @classmethod
    def of_waveform(cls, w: Waveform, is_whole: bool = False) -> Self:
        """Samples of the chirps of a waveform, N = N_ADC."""
        bandwidth = w.slope * w.n_adc / w.adc_rate
        return cls(w.fc, bandwidth, w.adc_rate, w.n_adc, w.prf, is_whole)

    def waveform(
        self, duration: float, fft_length: int | None = None, centred: bool = True
    ) -> Waveform:
        """Waveform of the chirps.

        Args:
            duration: Duration of the recording, s.
            fft_length: Length of the transform over a chirp; None is the number of samples.
            centred: Whether ranges refer to the middle of the chirp.
        """
        kind = WholeBand if self.is_whole else Waveform
        return kind(
            fc=self.carrier_hz,
            bandwidth=self.bandwidth_hz,
            chirp=self.samples / self.adc_rate_hz,
            adc_rate=self.adc_rate_hz,
            prf=self.prf_hz,
            duration=duration,
            fft_length=fft_length,
            centred=centred,
        )

    def range_bins(self, pulses: Complex, w: Waveform) -> Complex:
        """Range bins [K, M] of pulses [N, M], referred to the chirp's start unless w is centred."""
        return range_compression(pulses, w)


@dataclass(frozen=True)
class RangeProfiles:
    """Range profiles: N samples of every pulse over range, real or complex."""

    dataset: ClassVar[str] = "profiles"
    axes: ClassVar[tuple[str, ...]] = ("receiver", "range", "pulse")

    carrier_hz: float  # frequency of their Doppler, the middle of the band
    bandwidth_hz: float  # of the pulse
    samples: int  # N, of a profile
    prf_hz: float  # pulses per second of one receiver, within a segment
    first_range_m: float  # range of the first sample
    range_step_m: float  # from one sample to the next
    is_iq: bool = False  # whether samples are complex, which their type tells

    @property
    def are_waves(self) -> bool:
        """Whether steps are fine enough for real samples of the pulse as it comes."""
        w = self.waveform(1.0)
        return w.range_step <= replace(w, is_iq=False).coarsest_step * (1 + TOLERANCE)

    @property
    def noun(self) -> str:
        """Words for the samples, in messages."""
        return "complex range profiles" if self.is_iq else "real range profiles"

    def waveform(
        self, duration: float, fft_length: int | None = None, centred: bool = True
    ) -> Impulse:
        """Waveform of the pulses, of a duration, s; the other arguments are those of chirps."""
        del fft_length, centred
        last_m = self.first_range_m + self.samples * self.range_step_m
        lowest_hz = self.carrier_hz - self.bandwidth_hz / 2
        pulses = lowest_hz, self.bandwidth_hz, self.prf_hz, duration
        return impulse(*pulses, (self.first_range_m, last_m), self.samples, self.is_iq)

    def range_bins(self, pulses: Complex, w: Waveform) -> Complex:
        """Range bins [K, M] of pulses [N, M]: profiles are their own bins."""
        del w
        return pulses


@dataclass(frozen=True)
class SlowTime:
    """Slow time: one sample of every pulse, which has no range."""

    dataset: ClassVar[str] = "slow_time"
    noun: ClassVar[str] = "slow time"
    axes: ClassVar[tuple[str, ...]] = ("receiver", "pulse")
    samples: ClassVar[int] = 1

    carrier_hz: float  # frequency of the Doppler
    prf_hz: float  # pulses per second of one receiver, within a segment


Ranging: TypeAlias = Beat | RangeProfiles
Content: TypeAlias = Ranging | SlowTime


def numbers_of(content: Content) -> dict[str, Any]:
    """Numbers of the radar behind a content, by the names that they have in a recording's file."""
    numbers = {name: value for name, value in asdict(content).items() if name != "is_iq"}
    return numbers | {"whole_band": True} if numbers.pop("is_whole", False) else numbers


def describe_difference(
    content: Content, expected: Content, tolerance: float = TOLERANCE
) -> str | None:
    """Describe the first difference of a content from another of the same radar; None without one.

    The text is such as "prf_hz = 200: should be 256".

    Args:
        expected: content that it should have.
        tolerance: relative difference of numbers that are taken for the same.
    """
    if content.noun != expected.noun:
        return f"holds {content.noun}: should hold {expected.noun}"
    numbers, expected_numbers = numbers_of(content), numbers_of(expected)
    # The number of samples comes first, as the bandwidth follows from it.
    for name in sorted(numbers | expected_numbers, key=lambda name: name != "samples"):
        value, number = numbers.get(name, False), expected_numbers.get(name, False)
        if abs(value - number) > tolerance * abs(number):
            return f"{name} = {value:.10g}: should be {number:.10g}"
    return None


def describe_other_chirps(
    content: Content, expected: Content, tolerance: float = TOLERANCE
) -> str | None:
    """Describe a difference of contents, in whichever half of the band echoes lie; or return None.

    Args:
        expected: content that it should have.
        tolerance: relative difference of numbers that are taken for the same.
    """
    if isinstance(content, Beat) and isinstance(expected, Beat):
        expected = replace(expected, is_whole=content.is_whole)
    return describe_difference(content, expected, tolerance)


def radar_section(radar: dict[str, Any], content: Content) -> dict[str, Any]:
    """Replace keys of a config's section `radar` by those of the radar that was recorded.

    What the resulting kind of radar has no key for is left out, such as the chirps of a board.

    Args:
        radar: section `radar` of a config, plain values.
        content: content of a recording of the radar.

    Returns:
        The section, plain values.
    """
    section = radar | _radar_keys(content, radar.get("waveform", "fmcw"))
    if isinstance(content, SlowTime):  # no board has a single sample a pulse, nor has a chirp
        gone = {"cfg"} if radar.get("waveform") == "cw" else {"cfg", "frame"}
        section = {key: value for key, value in section.items() if key not in gone}
    kind = class_of_radar(section)
    assert kind is not None  # a config was read, or content tells the kind
    return {key: value for key, value in section.items() if key in kind.model_fields}


def _radar_keys(content: Content, waveform: str) -> dict[str, Any]:
    """Keys of `radar:` that a recording determines, with their values.

    Args:
        waveform: `waveform:` of the config, which samples of chirps leave as it is, fmcw or sfcw.
    """
    numbers = {"carrier_hz": content.carrier_hz, "prf_hz": content.prf_hz}
    match content:
        case SlowTime():
            return numbers | {"waveform": "cw"}
        case RangeProfiles():
            w = content.waveform(1.0)
            return {
                "waveform": "impulse",
                "output": "iq" if content.is_iq or not content.are_waves else "rf",
                "carrier_hz": w.fc,
                "prf_hz": w.prf,
                "bandwidth_hz": w.bandwidth,
                "profile_m": [content.first_range_m, w.half_band_range],
                "profile_samples": content.samples,
            }
        case Beat():
            steps = {"steps": content.samples, "dwell_s": 1 / content.adc_rate_hz}
            return numbers | {
                **({"waveform": "sfcw", **steps} if waveform == "sfcw" else {"waveform": "fmcw"}),
                "bandwidth_hz": content.bandwidth_hz,
                "adc_rate_hz": content.adc_rate_hz,
                "chirp_s": content.samples / content.adc_rate_hz,
            }
