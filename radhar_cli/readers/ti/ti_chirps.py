"""Chirps and frames as the files of TI radars state them, and the timing that follows.

A chirp takes idle time + ramp end time. Transmitters that take turns have PRF = 1/(n T_c) each. The
ADC starts later than the ramp: carrier = start frequency + slope times that. Masks of transmitters
that repeat within a loop are further loops, as the firmware counts them (`mmwdemo_rfparser.c`).
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any

from radhar_cli.errors import CaptureError
from radhar_cli.radar.frame_timing import FrameTiming, Sampling, transmitters_of

ROUNDING = 1 + 1e-6  # of times that a file states in decimals
MOST_ANTENNAS = 4  # receivers, or transmitters, of a device
MAX_CHIRPS = 512  # of a frame


@dataclass(frozen=True)
class ChirpProfile:
    """Ramp of a chirp and the samples that are taken in it, in TI's units.

    Attributes:
        start_ghz: Frequency at which the ramp starts.
        idle_us: Time before the ramp.
        adc_start_us: Time from the start of the ramp to the first sample.
        ramp_end_us: Time from the start of the ramp to its end.
        slope_mhz_per_us: Slope of the ramp.
        samples: Number of samples.
        rate_ksps: Sampling rate.
        backoff_db: By how much the power of each transmitter is lower; () for none.
        place: Line and argument of the number of samples, which messages name.
    """

    start_ghz: float
    idle_us: float
    adc_start_us: float
    ramp_end_us: float
    slope_mhz_per_us: float
    samples: int
    rate_ksps: float
    backoff_db: tuple[float, ...] = ()
    place: str = field(default="", compare=False)

    @property
    def sweep(self) -> tuple[float, ...]:
        """Numbers of the profile that decide a sampled sweep, at any time and strength."""
        ramp = self.start_ghz, self.slope_mhz_per_us, self.adc_start_us
        return (*ramp, self.samples, self.rate_ksps)

    @property
    def adc_rate_hz(self) -> float:
        """Sampling rate, Hz."""
        return self.rate_ksps * 1e3

    @property
    def slot_s(self) -> float:
        """Time from the start of a chirp to that of the next, s."""
        return (self.idle_us + self.ramp_end_us) * 1e-6

    def require_samples_within_ramp(self) -> None:
        """Raise CaptureError if the ramp ends before the last sample."""
        sampled_us = self.ramp_end_us - self.adc_start_us
        if self.samples / self.adc_rate_hz > sampled_us * 1e-6 * ROUNDING:
            ended_us = self.adc_start_us + self.samples / self.adc_rate_hz * 1e6
            fitting = max(int(sampled_us * self.adc_rate_hz / 1e6), 0)
            raise CaptureError(
                f"{self.place} = {self.samples}: should be at most {fitting}: at "
                f"{self.adc_rate_hz:g} Hz they end at {ended_us:.6g} us, after the ramp "
                f"({self.ramp_end_us:g} us)"
            )

    def timing(self, **of_frames: Any) -> FrameTiming:
        """Make the timing of chirps of this profile, of the other numbers that it has."""
        start_hz, slope_hz = self.start_ghz * 1e9, self.slope_mhz_per_us * 1e12
        of_chirps: dict[str, Any] = {
            "start_hz": start_hz,
            "carrier_hz": start_hz + slope_hz * self.adc_start_us * 1e-6,
            "slope_hz": slope_hz,
            "samples": self.samples,
            "adc_rate_hz": self.adc_rate_hz,
            "slot_s": self.slot_s,
            "backoff_db": self.backoff_db,
        }
        return FrameTiming(**(of_chirps | of_frames))


@dataclass(frozen=True)
class ChirpRange:
    """Chirps `first` to `last`, which are alike.

    Attributes:
        first: Index of the first.
        last: Index of the last.
        profile: Number of their profile.
        mask: Transmitters, bit n for transmitter n.
        place: Line or key that messages name.
    """

    first: int
    last: int
    profile: int
    mask: int
    place: str


@dataclass(frozen=True)
class StatedFrame:
    """The chirps of a frame by their indices, and the time between frames.

    Attributes:
        first: Index of the first chirp of a loop.
        last: Index of the last.
        loops: Number of loops of a frame.
        frames: Number of frames of a recording; 0 is as many as there is time for.
        period_ms: Time from frame to frame.
        place: Line or key that messages name.
        chirps_name: Arguments of the chirps, which messages name.
        period_name: Argument of the time between frames.
    """

    first: int
    last: int
    loops: int
    frames: int
    period_ms: float
    place: str
    chirps_name: str = "chirpStartIdx chirpEndIdx"
    period_name: str = "framePeriodicity"


@dataclass(frozen=True)
class ChirpPair:
    """Two chirps in which the same two transmitters send, the second one turned in the later.

    Attributes:
        first: Index of the chirp that has their sum (chirp0Idx).
        second: Index of the chirp that has their difference (chirp1Idx).
        place: Line or key that messages name.
    """

    first: int
    second: int
    place: str


def make_timing(
    profiles: Mapping[int, ChirpProfile],
    chirps: Sequence[ChirpRange],
    frame: StatedFrame,
    receiver_mask: int,
    sampling: Sampling,
    adc_bits: int,
    pair: ChirpPair | None = None,
) -> FrameTiming:
    """Make the timing of what a file states.

    Args:
        profiles: {number: profile}.
        chirps: Chirps; of those with the same index the last holds.
        frame: Chirps of a frame and time between frames.
        receiver_mask: Receivers that are on, bit n for receiver n.
        sampling: Kind of the samples.
        adc_bits: Number of bits of a sample.
        pair: Chirps in which two transmitters send together; None for none.

    Raises:
        CaptureError: The statements do not fit together; names the first and what would be right.
    """
    loop = _chirps_of_loop(chirps, frame)
    of_chirps = _profiles_of(loop, profiles)
    for profile in of_chirps:
        profile.require_samples_within_ramp()
    slots_s = [profile.slot_s for profile in of_chirps]
    busy_s = frame.loops * sum(slots_s)
    if busy_s > frame.period_ms * 1e-3 * ROUNDING:
        lengths = " and ".join(f"{slot_s * 1e6:g}" for slot_s in dict.fromkeys(slots_s))
        raise CaptureError(
            f"{frame.place} {frame.period_name} = {frame.period_ms:g}: should be at least "
            f"{busy_s * 1e3:.6g} ms, {frame.loops} loops of {len(loop)} chirps of {lengths} us"
        )
    masks = [chirp.mask for chirp in loop]
    bpm = None if pair is None else _places_of(pair, loop, frame)
    roles = [bpm.index(place) if bpm and place in bpm else None for place in range(len(masks))]
    times = [(profile.idle_us, profile.ramp_end_us) for profile in of_chirps]
    turns = count_turns(list(zip(masks, roles, times, strict=True)))
    is_even = len(set(times)) == 1
    return of_chirps[0].timing(
        backoff_db=_backoff_of(loop, of_chirps),
        masks=tuple(masks[:turns]),
        loops=frame.loops * len(masks) // turns,
        frames=frame.frames,
        period_s=frame.period_ms * 1e-3,
        receivers=tuple(n for n in range(4) if receiver_mask >> n & 1),
        sampling=sampling,
        adc_bits=adc_bits,
        bpm=bpm,
        chirp_starts_s=() if is_even else _ramp_starts_of(of_chirps[:turns]),
        burst_s=None if is_even else sum(slots_s[:turns]),
    )


def count_turns(masks: Sequence[Hashable]) -> int:
    """Count the chirps after which a sequence of transmitters repeats."""
    count = len(masks)
    return next(
        n
        for n in range(1, count + 1)
        if count % n == 0 and all(masks[k] == masks[k % n] for k in range(count))
    )


def _chirps_of_loop(chirps: Sequence[ChirpRange], frame: StatedFrame) -> list[ChirpRange]:
    """Find the chirps of a loop, in order."""
    by_index = {
        index: chirp
        for chirp in chirps
        for index in range(chirp.first, min(chirp.last, MAX_CHIRPS - 1) + 1)
    }
    indices = range(frame.first, min(frame.last, MAX_CHIRPS) + 1)
    loop = [by_index[index] for index in indices if index in by_index]
    if not loop or len(loop) < len(indices):
        raise CaptureError(
            f"{frame.place} {frame.chirps_name} = {frame.first} {frame.last}: should be "
            f"chirps that are all defined (chirpCfg), at most {MAX_CHIRPS}"
        )
    return loop


def _places_of(pair: ChirpPair, loop: Sequence[ChirpRange], frame: StatedFrame) -> tuple[int, int]:
    """Find the places in the loop of the chirps in which two transmitters send together."""
    first, second = pair.first - frame.first, pair.second - frame.first
    for name, place in (("chirp0Idx", first), ("chirp1Idx", second)):
        if not 0 <= place < len(loop):
            raise CaptureError(
                f"{pair.place} {name} = {place + frame.first}: should be a chirp of the frame, "
                f"{frame.first} to {frame.last}"
            )
    masks = loop[first].mask, loop[second].mask
    if first == second or masks[0] != masks[1] or masks[0].bit_count() != 2:
        raise CaptureError(
            f"{pair.place} chirp0Idx chirp1Idx = {pair.first} {pair.second}: should be two chirps "
            f"of the same two transmitters (chirpCfg txEnable = {masks[0]} and {masks[1]})"
        )
    return first, second


def _profiles_of(
    loop: Sequence[ChirpRange], profiles: Mapping[int, ChirpProfile]
) -> list[ChirpProfile]:
    """Return the profile of each chirp of a loop, whose sampled sweeps are equal."""
    for chirp in loop:
        if chirp.profile not in profiles:
            known = ", ".join(map(str, sorted(profiles)))
            raise CaptureError(
                f"{chirp.place} profileId = {chirp.profile}: should be one that is defined "
                f"(profileCfg): {known}"
            )
    of_chirps = [profiles[chirp.profile] for chirp in loop]
    for chirp, profile in zip(loop, of_chirps, strict=True):
        if profile.sweep != of_chirps[0].sweep:
            raise CaptureError(
                f"{chirp.place} profileId = {chirp.profile}: should be {loop[0].profile}: a frame "
                "has chirps of one profile, or of profiles that differ in idleTime, rampEndTime "
                "and txOutPower alone; subFrameCfg has one each"
            )
    return of_chirps


def _ramp_starts_of(profiles: Sequence[ChirpProfile]) -> tuple[float, ...]:
    """Times (s) from the first ramp of a loop to each of its ramps."""
    ends = accumulate(profile.slot_s for profile in profiles)
    starts = [end - profile.ramp_end_us * 1e-6 for end, profile in zip(ends, profiles, strict=True)]
    return tuple(start - starts[0] for start in starts)


def _backoff_of(loop: Sequence[ChirpRange], profiles: Sequence[ChirpProfile]) -> tuple[float, ...]:
    """Return by how much the power of each transmitter is lower in the chirps that it sends."""
    if len({profile.backoff_db for profile in profiles}) == 1:
        return profiles[0].backoff_db
    lower_db = dict[int, float]()
    for chirp, profile in zip(loop, profiles, strict=True):
        for transmitter in transmitters_of(chirp.mask):
            decibels = profile.backoff_db[transmitter] if profile.backoff_db else 0.0
            if lower_db.setdefault(transmitter, decibels) != decibels:
                raise CaptureError(
                    f"{chirp.place} profileId = {chirp.profile}: should have the txOutPower of the "
                    f"other chirps of its transmitter, {lower_db[transmitter]:g} dB"
                )
    return tuple(lower_db.get(transmitter, 0.0) for transmitter in range(MOST_ANTENNAS))
