"""The model of docs/physics/model.md as naively as it reads: what the tests compare with.

Nothing here comes from radhar_cli but the type of paths. Loops where the package has matrices, one
exponential a scatterer where it has products and tables; meant for small sizes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import floor, log2

import numpy as np

from radhar_cli.echo.paths import Paths

C = 299_792_458.0


@dataclass(frozen=True)
class Radar:
    """The numbers of a waveform; the fields are those of `Waveform`."""

    fc: float = 77e9
    bandwidth: float = 4e9
    chirp: float = 40e-6
    adc_rate: float = 10e6
    prf: float = 5000.0
    duration: float = 1.0
    fft_length: int | None = None
    centred: bool = True
    residual_video_phase: bool = False

    @property
    def slope(self) -> float:
        return self.bandwidth / self.chirp

    @property
    def n_adc(self) -> int:
        return round(self.adc_rate * self.chirp)

    @property
    def n_fft(self) -> int:
        return self.fft_length or 2 * ((self.n_adc + 1) // 2)

    @property
    def n0(self) -> float:
        return self.n_adc / 2 if self.centred else 0.0

    @property
    def f0(self) -> float:
        return self.fc + self.slope * self.n0 / self.adc_rate

    @property
    def times(self) -> np.ndarray:
        return np.arange(round(self.duration * self.prf)) / self.prf


@dataclass
class Points:
    """A source of paths without a body: points seen by a radar at the origin.

    Attributes:
        ranges: times [M] -> distances [I, M], m.
        strength: amplitude at 1 m, one or one a point.
        breakpoints, highest_frequency, smooth: as in `PathSource`.
        asked: the times of every call, in order.
    """

    ranges: Callable[[np.ndarray], np.ndarray]
    strength: float | np.ndarray = 1.0
    breakpoints: tuple[float, ...] = ()
    highest_frequency: float = 0.0
    smooth: bool = True

    def __post_init__(self) -> None:
        self.asked: list[np.ndarray] = []

    def __call__(self, t: np.ndarray) -> Paths:
        self.asked.append(t)
        r = self.ranges(t)
        a = np.broadcast_to(np.atleast_1d(self.strength)[:, None] / r**2, r.shape).copy()
        return Paths(2 * r / C, a)


def turn(cycles: np.ndarray) -> np.ndarray:
    """exp(j 2 pi cycles), whole turns removed first."""
    return np.exp(2j * np.pi * np.mod(cycles, 1))


def beat_matrix(delay: np.ndarray, amplitude: np.ndarray, radar: Radar) -> np.ndarray:
    """s_b[n, m] = sum_i A_i exp(-j 2 pi (fc tau_i + K tau_i n/fs)) [+ j pi K tau_i^2]."""
    n = np.arange(radar.n_adc)[:, None]
    s = np.zeros((radar.n_adc, delay.shape[1]), dtype=complex)
    for tau, a in zip(delay, amplitude, strict=True):
        path = a * turn(-radar.fc * tau) * turn(-radar.slope * tau * n / radar.adc_rate)
        if radar.residual_video_phase:
            path = path * turn(radar.slope * tau**2 / 2)
        s += path
    return s


def mti(s: np.ndarray) -> np.ndarray:
    """s[:, m + 1] - s[:, m], pulse by pulse."""
    return np.stack([s[..., m + 1] - s[..., m] for m in range(s.shape[-1] - 1)], axis=-1)


def range_bins(s: np.ndarray, radar: Radar) -> np.ndarray:
    """S[k, m] = sum_n s[n, m] exp(+j 2 pi k (n - n0)/N_FFT) for k < N_FFT/2."""
    n = np.arange(radar.n_adc) - radar.n0
    return np.stack([turn(k * n / radar.n_fft) @ s for k in range(radar.n_fft // 2)])


def slow_time(delay: np.ndarray, amplitude: np.ndarray, radar: Radar) -> np.ndarray:
    """y[m] before MTI: the beat matrix, its range bins, their sum."""
    return range_bins(beat_matrix(delay, amplitude, radar), radar).sum(axis=0)


def sample_weights(radar: Radar) -> np.ndarray:
    """D[n] = sum over the kept bins of exp(+j 2 pi k (n - n0)/N_FFT), term by term."""
    n = np.arange(radar.n_adc) - radar.n0
    return sum(turn(k * n / radar.n_fft) for k in range(radar.n_fft // 2))


def half_band_sum(u: np.ndarray, radar: Radar) -> np.ndarray:
    """G(u) = sum_n D[n] exp(-j 2 pi (n - n0) u), term by term."""
    terms = zip(np.arange(radar.n_adc) - radar.n0, sample_weights(radar), strict=True)
    return sum(d * turn(-n * u) for n, d in terms)


def frame_starts(samples: int, length: int, hop: int) -> range:
    """First samples of the floor((M - L)/hop) + 1 whole frames."""
    return range(0, (floor((samples - length) / hop) + 1) * hop, hop)


def stft(x: np.ndarray, length: int, hop: int, fft_length: int | None = None) -> np.ndarray:
    """|X|^2 [frequency, frame], the lowest frequency first and zero Doppler at N//2."""
    size = fft_length or length
    g = [(1 - np.cos(2 * np.pi * (n + 0.5) / length)) / 2 for n in range(length)]
    columns = []
    for start in frame_starts(x.size, length, hop):
        column = [
            sum(x[start + n] * g[n] * np.exp(-2j * np.pi * k * n / size) for n in range(length))
            for k in range(-(size // 2), size - size // 2)
        ]
        columns.append(np.abs(column) ** 2)
    return np.array(columns).T


def fsst(x: np.ndarray, length: int, hop: int, threshold: float) -> np.ndarray:
    """T [bin k = 0 .. L - 1, frame]: every V[k] added to the bin of its instantaneous frequency."""
    middle = length // 2
    starts = frame_starts(x.size, length, hop)
    v = np.zeros((length, len(starts)), dtype=complex)
    slope = np.zeros_like(v)
    for column, start in enumerate(starts):
        for k in range(length):
            for n in range(length):
                g = (1 - np.cos(2 * np.pi * (n + 0.5) / length)) / 2
                g_slope = np.pi / length * np.sin(2 * np.pi * (n + 0.5) / length)
                kernel = x[start + n] * np.exp(-2j * np.pi * k * (n - middle) / length)
                v[k, column] += g * kernel
                slope[k, column] += g_slope * kernel
    squeezed = np.zeros_like(v)
    least = threshold * np.abs(v).max()
    for column in range(len(starts)):
        for k in range(length):
            value = v[k, column]
            if value != 0 and abs(value) >= least:
                shift = (-slope[k, column] / value).imag * length / (2 * np.pi)
                squeezed[(k + floor(shift + 0.5)) % length, column] += value
    return squeezed


def entropy_bits(power: np.ndarray) -> float:
    """H = -sum p log2 p, pixel by pixel."""
    total = power.sum()
    shares = [pixel / total for pixel in power.ravel() if pixel > 0]
    return -sum(p * log2(p) for p in shares)


def error_db(found: np.ndarray, right: np.ndarray) -> float:
    """Root-mean-square error relative to `right`, dB; minus infinity where they are the same."""
    relative = np.linalg.norm(found - right) / np.linalg.norm(right)
    return float(20 * np.log10(relative)) if relative else float("-inf")
