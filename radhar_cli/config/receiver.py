"""Config of the receiver: noise and other impairments of the echo."""

from typing import Annotated, Generic, Literal

from pydantic import Field

from radhar_cli.config.acting import BOARD
from radhar_cli.schema.annotations import ABOVE_ZERO, NeedsAnyKey, NeedsKey
from radhar_cli.schema.number import DECIBEL, NOT_NEGATIVE, POSITIVE, within
from radhar_cli.schema.section import Flag, N, Section, default_draw


class ToneConfig(Section, Generic[N]):
    """Interference at a fixed Doppler.

    on_s, off_s: mean times for which it is on and off; always on where off_s is 0.
    """

    doppler_hz: Annotated[N, within(-1e7, 1e7, "Hz")]
    """Doppler frequency of the tone."""
    level_db: Annotated[N, DECIBEL] = default_draw(-10.0)
    """Level of the tone, relative to the white noise of a raw sample."""
    on_s: Annotated[N, POSITIVE, within(1e-3, 1e7, "s")] = default_draw(1.0)
    """Mean time for which the tone is on."""
    off_s: Annotated[N, NOT_NEGATIVE, within(0, 1e7, "s")] = default_draw(0.0)
    """Mean time for which the tone is off; 0 is always on."""
    both_sides: Flag = False
    """Whether the tone stands as strong at the opposite Doppler, at the same times: amplitude
    modulation, real samples. At 0 Hz the two are one tone of 6 dB more."""


class ReceiverConfig(Section, Generic[N]):
    """Noise that grows towards zero Doppler, and interference tones, beside the white noise."""

    noise_corner_hz: Annotated[
        N, NOT_NEGATIVE, within(0, 1e7, "Hz"), NeedsKey("receiver.noise_corner_hz", ABOVE_ZERO)
    ] = default_draw(0.0)
    """Doppler at which noise that grows towards zero equals the white noise; 0 is no such noise."""
    noise_slope_db: Annotated[
        N,
        NOT_NEGATIVE,
        within(1, 20, "dB per decade"),
        NeedsKey("receiver.noise_corner_hz", ABOVE_ZERO),
    ] = default_draw(10.0)
    """Slope of the noise that grows towards zero Doppler, dB per decade."""
    tones: Annotated[tuple[ToneConfig[N], ...], Field(max_length=16)] = ()
    """Interference tones: up to 16 of {doppler_hz, level_db, on_s, off_s, both_sides}."""
    noise_figure_db: Annotated[
        Annotated[N, NOT_NEGATIVE, within(0, 100, "dB")] | None, NeedsKey("snr_db", None)
    ] = None
    """F of thermal noise, k T0 fs F in a raw sample, where snr_db is null; null is no noise. Left
    out, it is 15 dB of an xWR1443 and 30 dB of other boards; given, it makes snr_db null unless
    that is given, too."""
    channel_gain_db: Annotated[N, NOT_NEGATIVE, within(0, 20, "dB"), BOARD] = default_draw(0.0)
    """Standard deviation of the virtual channels' gains."""
    channel_phase_deg: Annotated[N, NOT_NEGATIVE, within(0, 180, "degree"), BOARD] = default_draw(
        0.0
    )
    """Standard deviation of the virtual channels' phases."""
    channel_errors: Annotated[
        Literal["data_set", "sample"],
        BOARD,
        NeedsAnyKey(
            NeedsKey("receiver.channel_gain_db", ABOVE_ZERO),
            NeedsKey("receiver.channel_phase_deg", ABOVE_ZERO),
        ),
    ] = "data_set"
    """Draws of the channels' gains and phases: one for the data set, or one for each sample."""
