"""A MIMO board whose transmitters take turns: its elements, the times of its chirps, its pose.

Elements lie in the plane across boresight, (left, up) in half wavelengths as seen looking out of
the radar. A virtual element is the sum of a transmitter and a receiver; v = n_RX k + r, k the place
of the chirp in the loop. Positions of the devices: TI's board user guides and the antenna
geometries of its people tracking demos.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.frame_timing import FrameTiming
from radhar_cli.radar.propagation import Aim, Antennas, boresight_axes, roll_matrix
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.radar.room import Point
from radhar_cli.radar.ti_family import Family

Places: TypeAlias = tuple[tuple[float, float], ...]  # (left, up) in half wavelengths
NOISE_FIGURE_DB = 30.0  # of boards that are not known better


@dataclass(frozen=True)
class Array:
    """Antenna elements of a device.

    Attributes:
        tx: Places of the transmitters.
        rx: Places of the receivers.
        rx_sign: +1, or -1 for a receiver that is fed the other way round.
        half_power_deg: Half-power half-widths (azimuth, elevation) of an element, one way.
        tx_sign: As `rx_sign`, of the transmitters; () for +1 of all.
        unit_m: Unit of the places, m; None for half a wavelength at the middle of the band.
    """

    tx: Places
    rx: Places
    rx_sign: tuple[float, ...]
    half_power_deg: tuple[float, float]
    tx_sign: tuple[float, ...] = ()
    unit_m: float | None = None


@dataclass(frozen=True)
class Device:
    """A board as it is sold, with the firmware of its out-of-box demo.

    Attributes:
        array: Antenna elements.
        families: Software that is made for it.
        heeds_limits: Whether the firmware leaves out points beyond the limits of aoaFovCfg and
            cfarFovCfg, which the demo of xWR14xx does not know.
        noise_figure_db: Noise figure with which simulated people have as many points a frame as
            measured ones, for 12 dBm and antennas of 9 dBi; it stands for what the radar equation
            leaves out, too (docs/results/noise.md).
    """

    array: Array
    families: tuple[Family, ...]
    heeds_limits: bool = True
    noise_figure_db: float = NOISE_FIGURE_DB


_ROW: Places = ((0, 0), (1, 0), (2, 0), (3, 0))
_SAME = (1.0, 1.0, 1.0, 1.0)
_BOOST = Array(((0, 0), (2, 1), (4, 0)), _ROW, _SAME, (28.0, 14.0))
_FIRST = Family.SDK_1, Family.SDK_2
_TRACKING = Family.SDK_3, Family.PEOPLE_3D
_1443 = Device(_BOOST, _FIRST, heeds_limits=False, noise_figure_db=15.0)
_1843 = Device(_BOOST, (*_TRACKING, Family.OBSTACLES))
# Front ends without a processor: captures of theirs come with a .cfg of any of these demos.
_FRONT_END = Device(_BOOST, (*_FIRST, Family.SDK_3))
_1642 = Device(
    Array(((0, 0), (4, 0)), _ROW, _SAME, (28.0, 14.0)),
    # SDK 3: e2e.ti.com 1439888, the demo of SDK 3.6 on it
    (*_FIRST, Family.SDK_3, Family.PEOPLE, Family.OBSTACLES),
)
_ISK = Array(((0, -1), (2, 0), (4, -1)), _ROW, _SAME, (60.0, 15.0))
_ODS = Array(
    ((0, 0), (2, 0), (2, -2)),
    ((0, 0), (0, -1), (1, -1), (1, 0)),
    (1.0, -1.0, -1.0, 1.0),
    (60.0, 60.0),
)
_2944 = Array(
    ((0, 0), (2, 1.6), (4, 0), (8, 0)), _ROW, _SAME, (28.0, 14.0)
)  # probable: rows 0.8 wavelength apart
_6432 = Array(
    ((0, 0), (1, 0)),
    ((0, 0), (1, 1), (2, 0)),
    (1.0, -1.0, 1.0),
    (60.0, 30.0),  # a guess
    tx_sign=(1.0, -1.0),
    unit_m=2.418e-3,
)
_6844 = Array(
    ((2, 2), (0, 2), (0, 0), (2, 0)),
    ((0, 1), (0, 0), (1, 0), (1, 1)),
    _SAME,
    (60.0, 60.0),
    tx_sign=(-1.0, 1.0, -1.0, 1.0),
    unit_m=2.54e-3,
)
_AOP = Array(
    ((0, 0), (2, -2), (0, -2)),
    ((1, -1), (1, 0), (0, -1), (0, 0)),
    (1.0, -1.0, 1.0, -1.0),
    (60.0, 60.0),
)
DEVICES: Mapping[str, Device] = MappingProxyType(
    {
        **dict.fromkeys(("IWR1443BOOST", "AWR1443BOOST"), _1443),
        **dict.fromkeys(("IWR1642BOOST", "AWR1642BOOST"), _1642),
        **dict.fromkeys(("IWR1843BOOST", "AWR1843BOOST"), _1843),
        **dict.fromkeys(("AWR1243BOOST", "AWR2243BOOST"), _FRONT_END),
        "IWR6843ISK": Device(_ISK, (*_TRACKING, Family.PEOPLE)),
        "IWR6843ISK-ODS": Device(_ODS, _TRACKING),
        "IWR6843AOP": Device(_AOP, _TRACKING),
        "AWR2944EVM": Device(_2944, (Family.MCU_PLUS,)),
        "IWRL6432BOOST": Device(_6432, (Family.L_SDK,)),
        "IWRL6844EVM": Device(_6844, (Family.L_SDK,)),
    }
)
_PREFIXES = "iwr", "awr", "xwr"  # industrial, automotive and either: of the same antennas


def plain_name(name: str) -> str:
    """Name of a board or its profile in plain form.

    Capitals, spaces, hyphens, underscores, BOOST, EVM, MOD and AWR or xWR for IWR do not matter.
    """
    plain = re.sub("boost|evm|mod$|[-_ ]", "", name.lower()).replace("iskods", "ods")
    return f"i{plain[1:]}" if plain.startswith(_PREFIXES) else plain


# The last of equal keys counts: IWR before AWR.
_PLAIN_DEVICES = {plain_name(name): name for name in reversed(tuple(DEVICES))}


def device_name(name: str) -> str | None:
    """Name in DEVICES of a board by a spelling of it; None of a board that is not there."""
    return name if name in DEVICES else _PLAIN_DEVICES.get(plain_name(name))


MAX_SIDELOBE = 0.3  # highest sidelobe, over the main lobe, of a row that tells targets apart
EVEN = (1000.0, 1000.0)  # half-power half-widths (degree) of an array by hand: no pattern


def longest_rows(places: Sequence[Sequence[float]] | Float, axis: int) -> list[list[int]]:
    """Longest rows of elements along an axis.

    Args:
        places: (left, up) of the elements [V, 2].
        axis: 0 for rows to the left, 1 for columns upwards.

    Returns:
        Numbers of the elements of each row that has the most of them, in the order of the axis; of
        elements at the same place the first counts.
    """
    rows: dict[float, dict[float, int]] = {}
    for v, place in enumerate(np.round(places, 6).tolist()):
        rows.setdefault(place[1 - axis], {}).setdefault(place[axis], v)
    row_length = max(map(len, rows.values()))
    return [
        [row[place] for place in sorted(row)] for row in rows.values() if len(row) == row_length
    ]


def axis_after_roll(axis: int, roll: float) -> int:
    """Axis of a board, 0 to its left or 1 upwards, that is nearest to one before the roll.

    Args:
        axis: the axis before the roll, likewise.
        roll: angle about boresight by which the left side goes up, rad.
    """
    return (axis + round(roll / (pi / 2))) % 2


def sidelobe(row: Sequence[float] | Float) -> float:
    """Power of the highest sidelobe over the main lobe of a row of elements that looks ahead.

    Args:
        row: Places of the elements [n], half wavelengths.

    Returns:
        1 where a grating lobe is as high as the main lobe, 0 without sidelobes.
    """
    sines = np.linspace(0, 1, 501)
    pattern = np.abs(np.exp(1j * np.pi * np.outer(sines, row)).mean(axis=1)) ** 2
    rises = np.flatnonzero(np.diff(pattern) > 0)  # behind the main lobe
    return float(pattern[rises[0] :].max()) if rises.size else 0.0


@dataclass(frozen=True, kw_only=True)
class Board(FrameTiming):
    """A radar that sends frames: their timing, its array, and its pose in the scene.

    Attributes:
        array: Elements of the device.
        position: Position of the array's origin, m.
        yaw: Angle of boresight from the x axis to the left, rad.
        tilt: Angle of boresight below the horizontal, rad.
        roll: Angle about boresight by which the left side goes up, rad.
        half_power_deg: Half-power half-widths in place of the array's; None for the array's.
        half_wavelength: Unit of the elements' places, m; None is c/(2 f_c).
        gain: Linear gain of each antenna.
        ends: Positions of the one transmitter and the one receiver in the scene, m, in place of the
            array's elements; None for these.
    """

    array: Array
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    tilt: float = 0.0
    roll: float = 0.0
    half_power_deg: tuple[float, float] | None = None
    half_wavelength: float | None = None
    gain: float = 1.0
    ends: tuple[Point, Point] | None = None

    @cached_property
    def aim(self) -> Aim:
        """Position, axes and beam of the antennas."""
        axes = boresight_axes(self.yaw, self.tilt, self.roll)
        return Aim(self.position, axes, self.half_power_deg or self.array.half_power_deg)

    @cached_property
    def upright(self) -> Aim:
        """Position and axes (ahead, left, up) before the roll: those of points and skeletons."""
        return self.aim._replace(axes=boresight_axes(self.yaw, self.tilt))

    def without_roll(self, p: Float) -> Float:
        """Coordinates [..., (ahead, left, up)] before the roll, of those after it."""
        if self.roll == 0:
            return p
        turned: Float = p.copy()
        turned[..., 1:] = p[..., 1:] @ roll_matrix(self.roll).astype(p.dtype)
        return turned

    @property
    def unit(self) -> float:
        """Length of the unit of the elements' places, half a wavelength, m."""
        unit = self.half_wavelength or self.array.unit_m
        return unit or SPEED_OF_LIGHT / (2 * self.centre_hz)

    def element(self, place: tuple[float, float]) -> tuple[float, float, float]:
        """Position (m) in the scene of an element at a place (left, up) in half wavelengths."""
        x, y, z = self.position + self.unit * (np.array(place) @ np.array(self.aim.axes[1:]))
        return float(x), float(y), float(z)

    def antennas(self, k: int, r: int) -> Antennas:
        """Antennas of a channel: the transmitter at place k of the loop, and receiver r."""
        tx, rx = self.array.tx[self.order[k]], self.array.rx[r]
        gain = self.gain  # sqrt(G_t G_r), in which less transmitted power counts as less G_t
        if self.backoff_db:
            gain *= 10 ** (-self.backoff_db[self.order[k]] / 20)
        places = self.ends or (self.element(tx), self.element(rx))
        return Antennas(*places, gain, 0.0, self.aim)

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """Pairs (place in the loop, receiver) of the virtual elements [V]."""
        return [(k, r) for k in range(len(self.masks)) for r in self.receivers]

    @cached_property
    def places(self) -> Float:
        """Places (left, up) of the virtual elements [V, 2], half wavelengths at f_c."""
        tx, rx = np.array(self.array.tx, float), np.array(self.array.rx, float)
        sums = np.array([tx[self.order[k]] + rx[r] for k, r in self.pairs])
        return sums * (self.unit * 2 * self.centre_hz / SPEED_OF_LIGHT)

    def rows_along(self, axis: int) -> tuple[list[list[int]], Float]:
        """Longest rows of virtual elements that tell angles apart, and their places.

        Of a board that is rolled the rows are those of its columns where these are nearer to the
        axis.

        Args:
            axis: 0 for angles to the left, 1 upwards, both before the roll.

        Returns:
            Numbers of the elements of each row, and places of all elements along the axis [V],
            half wavelengths at f_c.
        """
        if self.roll == 0:
            return longest_rows(self.places, axis), self.places[:, axis]
        rows = longest_rows(self.places, axis_after_roll(axis, self.roll))
        return rows, (self.places @ roll_matrix(self.roll))[:, axis]

    @cached_property
    def delays(self) -> Float:
        """Times (s) from the first chirp of a loop to each of its chirps [place in the loop]."""
        if self.chirp_starts_s:
            return np.array(self.chirp_starts_s)
        delays: Float = np.arange(len(self.masks)) * self.slot_s
        return delays

    @cached_property
    def turns(self) -> Float:
        """Delay of the virtual elements [V] within a loop, in loops.

        Of two transmitters that send together both have that of the block of their sum.
        """
        places = list(range(len(self.masks)))
        if self.bpm is not None:
            places[self.bpm[1]] = self.bpm[0]
        turns: Float = self.delays[[places[k] for k, _ in self.pairs]] / self.loop_s
        return turns

    @cached_property
    def sums(self) -> Index:
        """Channels [receiver] of the chirp that has the sum of two transmitters."""
        return self._channels_at(0)

    @cached_property
    def differences(self) -> Index:
        """Channels [receiver] of the chirp that has the difference of two transmitters."""
        return self._channels_at(1)

    def _channels_at(self, chirp: int) -> Index:
        """Channels of one of the two chirps of `bpm`; none without it."""
        place = None if self.bpm is None else self.bpm[chirp]
        return np.array([v for v, (k, _) in enumerate(self.pairs) if k == place], np.intp)

    @cached_property
    def signs(self) -> Float:
        """Signs of the feeds of the chirps [V].

        Where two transmitters send together it is that of the receiver alone.
        """
        return np.array([self._sign_of(k) * self.array.rx_sign[r] for k, r in self.pairs])

    def _sign_of(self, k: int) -> float:
        """Sign of the transmitter at place k of the loop, 1 where another sends with it."""
        is_alone = self.bpm is None or k not in self.bpm
        return self._tx_sign(self.order[k]) if is_alone else 1.0

    def _tx_sign(self, transmitter: int) -> float:
        return self.array.tx_sign[transmitter] if self.array.tx_sign else 1.0

    @property
    def signs_of_two(self) -> tuple[float, float]:
        """Signs of the feeds of the two transmitters that send together; 1 where none do."""
        lower, higher = self.bpm or (0, 0)
        has_two = self.bpm is not None
        signs = self._tx_sign(self.order[lower]), self._tx_sign(self.order[higher])
        return signs if has_two else (1.0, 1.0)

    def chirp_times(self, frames: slice = slice(None)) -> Float:
        """Times (s) at which chirps begin [frame, loop, place in the loop].

        Positions of the scene are frozen at these times.
        """
        begin = np.arange(self.frames)[frames, None, None] * self.period_s + self.delay_s
        loop, k = np.arange(self.loops)[:, None], np.arange(len(self.masks))
        if self.burst_s is not None:
            times: Float = begin + loop * self.burst_s + self.delays
            return times
        return begin + (loop * len(self.masks) + k) * self.slot_s

    @property
    def middles(self) -> Float:
        """Times (s) of the middles of the frames' chirps [frame]."""
        begins = np.arange(self.frames) * self.period_s + self.delay_s
        return begins + self.loops * self.loop_s / 2

    @property
    def pulses(self) -> PulseTimes:
        """Times of the chirps of one transmitter, with a stretch for each frame."""
        frame = np.arange(self.frames)
        if not self.frames_apart:
            return PulseTimes.even(self.frames * self.loops, self.prf_hz)
        begins = frame * self.period_s + self.delay_s
        return PulseTimes(begins, frame * self.loops, self.frames * self.loops, self.prf_hz)

    @property
    def path_waveform(self) -> Waveform:
        """Waveform at the centre frequency, without gaps, for which paths are computed."""
        return Waveform(
            fc=self.centre_hz,
            bandwidth=self.bandwidth_hz,
            chirp=self.chirp_s,
            adc_rate=self.adc_rate_hz,
            prf=self.prf_hz,
            duration=self.frames * self.period_s,
        )

    @cached_property
    def waveform(self) -> Waveform:
        """Waveform of one transmitter, whose `times` counts the chirps of all, frame by frame."""
        return BoardWaveform(
            fc=self.carrier_hz,
            bandwidth=self.bandwidth_hz,
            chirp=self.chirp_s,
            adc_rate=self.adc_rate_hz,
            prf=self.prf_hz,
            duration=self.frames * self.period_s,
            fft_length=self.n_fft,
            board=self,
        )


@dataclass(frozen=True)
class BoardWaveform(Waveform):
    """Chirps of a board: every range bin is kept, and pulses are the chirps of all transmitters."""

    board: Board | None = None

    @cached_property
    def n_pulses(self) -> int:
        """Number of chirps of the recording, of all transmitters."""
        assert self.board is not None
        return self.board.frames * self.board.loops * len(self.board.masks)

    @cached_property
    def n_adc(self) -> int:
        """Number N of samples of a chirp."""
        assert self.board is not None
        return self.board.samples

    @property
    def n_bins(self) -> int:
        """Number of range bins that are kept; of complex 1x samples all."""
        assert self.board is not None
        return self.board.n_bins

    @property
    def sample_rate(self) -> float:
        """Samples per second that noise is white up to, Hz: of one sample a chirp all chirps.

        A mean of chirps takes less of it.
        """
        assert self.board is not None
        if self.n_adc == 1:
            return 1 / self.board.slot_s
        return self.adc_rate / self.board.averaged

    @property
    def bin_gain(self) -> float:
        """Factor of range bins, 2 of real samples."""
        return 2.0 if self.board is not None and self.board.is_real else 1.0

    @property
    def half_band_range(self) -> float:
        """Range at which ranges begin again, or the half band ends: c fs/(2 K) or half of it, m."""
        return self.range_step * self.n_bins

    def times(self, pulses: Float) -> Float:
        """Times (s) at which chirps begin, by their numbers [...].

        Chirps are counted through frames, loops and transmitters.
        """
        assert self.board is not None
        frame, chirp = np.divmod(pulses, self.board.loops * len(self.board.masks))
        begin = frame * self.board.period_s + self.board.delay_s
        if self.board.burst_s is not None:
            loop, k = np.divmod(chirp, len(self.board.masks))
            return begin + loop * self.board.burst_s + self.board.delays[k.astype(np.intp)]
        return begin + chirp * self.board.slot_s
