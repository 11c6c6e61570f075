"""A MIMO board whose transmitters take turns: its elements, the times of its chirps, its pose.

Elements lie in the plane across boresight, (left, up) in half wavelengths as seen looking out of
the radar. A virtual element is the sum of a transmitter and a receiver; v = n_RX k + r, k the place
of the chirp in the loop. Positions of the devices: TI's board user guides and the antenna
geometries of its people tracking demos.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.light import SPEED_OF_LIGHT
from radhar_cli.radar.propagation import Aim, Antennas, boresight_axes
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.radar.waveform import Waveform

Places: TypeAlias = tuple[tuple[float, float], ...]  # (left, up) in half wavelengths


@dataclass(frozen=True)
class Array:
    """Antenna elements of a device."""

    # tx, rx: places of the elements
    tx: Places
    rx: Places
    rx_sign: tuple[float, ...]  # +1, or -1 of a receiver that is fed the other way round
    # half-power half-widths (azimuth, elevation) of an element, one way
    half_power_deg: tuple[float, float]


_ROW: Places = ((0, 0), (1, 0), (2, 0), (3, 0))
_SAME = (1.0, 1.0, 1.0, 1.0)
_BOOST = Array(((0, 0), (2, 1), (4, 0)), _ROW, _SAME, (28.0, 14.0))
DEVICES: Mapping[str, Array] = MappingProxyType(
    {
        **dict.fromkeys(("IWR1443BOOST", "AWR1443BOOST", "IWR1843BOOST", "AWR1843BOOST"), _BOOST),
        "IWR6843ISK": Array(((0, -1), (2, 0), (4, -1)), _ROW, _SAME, (60.0, 15.0)),
        "IWR6843ISK-ODS": Array(
            ((0, 0), (2, 0), (2, -2)),
            ((0, 0), (0, -1), (1, -1), (1, 0)),
            (1.0, -1.0, -1.0, 1.0),
            (60.0, 60.0),
        ),
        "IWR6843AOP": Array(
            ((0, 0), (2, -2), (0, -2)),
            ((1, -1), (1, 0), (0, -1), (0, 0)),
            (1.0, -1.0, 1.0, -1.0),
            (60.0, 60.0),
        ),
    }
)
MAX_SIDELOBE = 0.3  # of a row that tells targets apart, over its main lobe
EVEN = (1000.0, 1000.0)  # half-power half-widths (degree) of an array by hand: no pattern


def longest_rows(places: Sequence[Sequence[float]] | Float, axis: int) -> list[list[int]]:
    """Elements along an axis, ordered: of each of the rows that have the most of them.

    Of elements at the same place the first counts.
    """
    rows: dict[float, dict[float, int]] = {}
    for v, place in enumerate(np.round(places, 6).tolist()):
        rows.setdefault(place[1 - axis], {}).setdefault(place[axis], v)
    most = max(map(len, rows.values()))
    return [[row[at] for at in sorted(row)] for row in rows.values() if len(row) == most]


def sidelobe(row: Sequence[float] | Float) -> float:
    """Power of the highest sidelobe over the main lobe of a row of elements that looks ahead.

    Args:
        row: places of the elements [n], half wavelengths.

    Returns:
        1 where a grating lobe is as high as the main lobe, 0 without sidelobes.
    """
    sines = np.linspace(0, 1, 501)
    pattern = np.abs(np.exp(1j * np.pi * np.outer(sines, row)).mean(axis=1)) ** 2
    rises = np.flatnonzero(np.diff(pattern) > 0)  # behind the main lobe
    return float(pattern[rises[0] :].max()) if rises.size else 0.0


@dataclass(frozen=True)
class Board:
    """A board as its chirp profile, its frames and its place in the scene have it."""

    array: Array  # its elements
    start: float  # frequency at which a ramp starts, Hz
    fc: float  # frequency at the first sample that is kept, Hz
    slope: float  # K, Hz/s
    adc_rate: float  # fs, Hz
    samples: int  # of a chirp
    slot: float  # from chirp to chirp, s
    order: tuple[int, ...]  # numbers of the transmitters, in their order within a loop
    receivers: tuple[int, ...]  # numbers of those that are on
    # loops, frames: of a frame; of the recording
    loops: int
    frames: int
    period: float  # from frame to frame, s
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of the array's origin, m
    # yaw, tilt: of boresight from the x axis, rad; to the left, and down
    yaw: float = 0.0
    tilt: float = 0.0
    half_power_deg: tuple[float, float] | None = None  # as `Array`
    half_wavelength: float | None = None  # unit of the elements' places, m; None is c/(2 f_c)
    gain: float = 1.0  # linear, of each antenna

    @property
    def centre(self) -> float:
        """f_c = f_adc + K (N - 1)/(2 fs), the frequency of Doppler and angles, Hz."""
        return self.fc + self.slope * (self.samples - 1) / (2 * self.adc_rate)

    @property
    def loop(self) -> float:
        """From a chirp to the next of the same transmitter, s."""
        return self.slot * len(self.order)

    @property
    def channels(self) -> int:
        """Virtual elements."""
        return len(self.order) * len(self.receivers)

    @property
    def n_fft(self) -> int:
        """Range bins: the next power of two; complex samples have all of them."""
        return 1 << (self.samples - 1).bit_length()

    @property
    def n_doppler(self) -> int:
        """Doppler bins: the next power of two."""
        return 1 << (self.loops - 1).bit_length()

    @property
    def range_step(self) -> float:
        """c fs/(2 K N_FFT), m."""
        return SPEED_OF_LIGHT * self.adc_rate / (2 * self.slope * self.n_fft)

    def doppler_step(self, carrier: float | None = None) -> float:
        """c/(2 f loop N_D), m/s, at the centre frequency or another one (Hz)."""
        return SPEED_OF_LIGHT / (2 * (carrier or self.centre) * self.loop * self.n_doppler)

    @cached_property
    def aim(self) -> Aim:
        """Rows of its axes: ahead, left, up."""
        axes = boresight_axes(self.yaw, self.tilt)
        return Aim(self.position, axes, self.half_power_deg or self.array.half_power_deg)

    @property
    def unit(self) -> float:
        """Half a wavelength, m."""
        return self.half_wavelength or SPEED_OF_LIGHT / (2 * self.centre)

    def element(self, place: tuple[float, float]) -> tuple[float, float, float]:
        """Position of an element in the scene, m."""
        x, y, z = self.position + self.unit * (np.array(place) @ np.array(self.aim.axes[1:]))
        return float(x), float(y), float(z)

    def antennas(self, k: int, r: int) -> Antennas:
        """Transmitter at place k of the loop, and receiver r."""
        tx, rx = self.array.tx[self.order[k]], self.array.rx[r]
        return Antennas(self.element(tx), self.element(rx), self.gain, 0.0, self.aim)

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """(place in the loop, receiver) of the virtual elements [V]."""
        return [(k, r) for k in range(len(self.order)) for r in self.receivers]

    @cached_property
    def places(self) -> Float:
        """(left, up) of the virtual elements [V, 2], half wavelengths at f_c."""
        tx, rx = np.array(self.array.tx, float), np.array(self.array.rx, float)
        at = np.array([tx[self.order[k]] + rx[r] for k, r in self.pairs])
        return at * (self.unit * 2 * self.centre / SPEED_OF_LIGHT)

    @cached_property
    def turns(self) -> Float:
        """Place in the loop over their number [V]: how late a virtual element is, in loops."""
        return np.array([k for k, _ in self.pairs]) / len(self.order)

    @cached_property
    def signs(self) -> Float:
        """Signs of the virtual elements' feeds [V]."""
        return np.array([self.array.rx_sign[r] for _, r in self.pairs])

    def chirp_times(self, frames: slice = slice(None)) -> Float:
        """When chirps begin [frame, loop, place in the loop], s; positions are frozen there."""
        f = np.arange(self.frames)[frames, None, None]
        loop, k = np.arange(self.loops)[:, None], np.arange(len(self.order))
        return f * self.period + (loop * len(self.order) + k) * self.slot

    @property
    def middles(self) -> Float:
        """Middles of the frames' chirps [frame], s."""
        return np.arange(self.frames) * self.period + self.loops * self.loop / 2

    @property
    def pulses(self) -> PulseTimes:
        """Times of the chirps of one transmitter, a stretch a frame."""
        f = np.arange(self.frames)
        if abs(self.period - self.loops * self.loop) < 1e-9 * self.period:
            return PulseTimes.even(self.frames * self.loops, 1 / self.loop)
        return PulseTimes(f * self.period, f * self.loops, self.frames * self.loops, 1 / self.loop)

    @property
    def seen_as(self) -> Waveform:
        """A waveform of the centre frequency, as paths are computed for, without gaps."""
        chirp, band = self.samples / self.adc_rate, self.slope * self.samples / self.adc_rate
        timing = self.adc_rate, 1 / self.loop, self.frames * self.period
        return Waveform(self.centre, band, chirp, *timing)

    @cached_property
    def waveform(self) -> Waveform:
        """The chirps of one transmitter; `times` counts those of all, frame by frame."""
        return BoardWaveform(
            fc=self.fc,
            bandwidth=self.slope * self.samples / self.adc_rate,
            chirp=self.samples / self.adc_rate,
            adc_rate=self.adc_rate,
            prf=1 / self.loop,
            duration=self.frames * self.period,
            fft_length=self.n_fft,
            board=self,
        )


@dataclass(frozen=True)
class BoardWaveform(Waveform):
    """Chirps of a board: every range bin is kept, and pulses are the chirps of all transmitters."""

    board: Board | None = None

    @cached_property
    def n_pulses(self) -> int:
        """Chirps of the recording."""
        assert self.board is not None
        return self.board.frames * self.board.loops * len(self.board.order)

    @cached_property
    def n_adc(self) -> int:
        """N."""
        assert self.board is not None
        return self.board.samples

    @property
    def n_bins(self) -> int:
        """All: complex samples have no half band."""
        return self.n_fft

    @property
    def half_band_range(self) -> float:
        """Range c fs/(2 K) at which ranges begin again, m."""
        return self.range_step * self.n_fft

    def times(self, pulses: Float) -> Float:
        """When chirps of these numbers begin, counted through frames, loops and transmitters."""
        assert self.board is not None
        frame, chirp = np.divmod(pulses, self.board.loops * len(self.board.order))
        return frame * self.board.period + chirp * self.board.slot
