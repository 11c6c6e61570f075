"""Every processing function on the inputs that break arithmetic, and in single precision.

Zero, constant, impulse, denormal (1e-310), huge (1e150): finite results, no warning, and the same
as for an input of size 1 but for the scale. Spectra are those of a signal scaled to 1, so that
their squares are finite; elsewhere squares beyond 1e154 are infinite, with a warning of NumPy.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from helpers.signals import signal

from radhar_cli.config.data_set import Config
from radhar_cli.config.processing import SavgolConfig
from radhar_cli.errors import RadharError
from radhar_cli.processing import fsst, image
from radhar_cli.processing.canceller import FIRST_DIFFERENCE
from radhar_cli.processing.denoising import savgol
from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.look import RangeSum
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.processing.stft import Stft
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.table import products

Function = Callable[[np.ndarray], np.ndarray]

SAMPLES, PULSES = 16, 120
WAVEFORM = Waveform(24e9, 2e8, 40e-6, SAMPLES / 40e-6, 1000, PULSES / 1000)
FRAMES = Frames(24, 5)
TRACK = 2e-8 + 1e-11 * np.arange(PULSES)


def transformed(
    x: np.ndarray, window: np.ndarray, bins: int | None = None
) -> tuple[np.ndarray, int]:
    """X [frames, N] with a window, in units of 2^exponent, and that exponent."""
    stft = Stft(signal(x), FRAMES, bins, single=x.dtype == np.complex64)
    (block,) = stft.blocks
    return stft.transform(x, block, window), stft.exponent


def spectrum(x: np.ndarray, bins: int | None = None) -> np.ndarray:
    """X [frames, N] in the scale of x."""
    return rescaled(*transformed(x, FRAMES.window, bins))


def rescaled(v: np.ndarray, exponent: int) -> np.ndarray:
    return (np.ldexp(v.real, exponent) + 1j * np.ldexp(v.imag, exponent)).astype(v.dtype)


def squeezed(x: np.ndarray, threshold: float = 1e-3) -> np.ndarray:
    """T [frames, L] in the scale of x."""
    (v, exponent), (slope, _) = (transformed(x, g) for g in (FRAMES.window, FRAMES.window_slope))
    least = threshold * float(np.abs(v).max())
    return rescaled(fsst.synchrosqueeze(v, slope, least), exponent)


def range_power(bins: np.ndarray) -> np.ndarray:
    """|S|^2 as the range-time map has it."""
    rtm = products(Config())["rtm"].make(signal(bins))
    return rtm.power


def levels(power: np.ndarray, size: tuple[int, int], dynamic_range_db: float) -> np.ndarray:
    return image.levels(image.reduced_map(power, size).cells, dynamic_range_db)


# Linear functions of a slow-time signal [M] or a beat matrix [N_ADC, M].
LINEAR: dict[str, Function] = {
    "canceller": FIRST_DIFFERENCE,
    "range_compression": lambda s: range_compression(s, WAVEFORM),
    "coherent sum": lambda s: RangeSum(WAVEFORM)(s),
    "compensate": lambda x: compensate(x, TRACK, 24e9),
    "savgol": lambda x: savgol(x, 5, 11),
    "spectrum": spectrum,
    "padded spectrum": lambda x: spectrum(x, 64),
}
MATRIX = ("range_compression", "coherent sum")


def shape_of(name: str) -> tuple[int, ...]:
    return (SAMPLES, PULSES) if name in MATRIX else (PULSES,)


def inputs(shape: tuple[int, ...]) -> dict[str, np.ndarray]:
    """Signals of size 1."""
    rng = np.random.default_rng(3)
    noise = rng.standard_normal((*shape, 2)).view(complex)[..., 0]
    impulse = np.zeros(shape, complex)
    impulse[tuple(size // 2 for size in shape)] = 1 - 2j
    m = np.arange(shape[-1])
    tone = np.broadcast_to(np.exp(0.7j * m), shape).copy()
    return {"constant": np.full(shape, 1 + 1j), "impulse": impulse, "noise": noise, "tone": tone}


KINDS = tuple(inputs((4, 4)))
DENORMAL = 5e-324


@pytest.mark.parametrize("name", [*LINEAR, "synchrosqueeze"])
def test_zeros_stay_zeros(name: str) -> None:
    function = LINEAR.get(name, squeezed)
    assert not function(np.zeros(shape_of(name), complex)).any()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scale", [1e150, 1e290, 1e-150, 1e-290])
@pytest.mark.parametrize("name", LINEAR)
def test_linear_functions_scale(name: str, scale: float, kind: str) -> None:
    x = inputs(shape_of(name))[kind]
    right, found = LINEAR[name](x), LINEAR[name](x * scale)
    assert np.isfinite(found).all()
    error = np.abs(found / scale - right).max()
    assert error <= 1e-13 * max(np.abs(right).max(), np.abs(x).max())


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LINEAR)
def test_linear_functions_of_denormals(name: str, kind: str) -> None:
    """1e-310 has 13 digits left; every sum loses one last place a term."""
    x = inputs(shape_of(name))[kind]
    right, found = LINEAR[name](x), LINEAR[name](x * 1e-310)
    assert np.isfinite(found).all()
    # In pieces: 1e310 is no double.
    error = np.abs(found * 1e155 * 1e155 - right).max()
    terms = 4 * SAMPLES * FRAMES.length
    assert error <= terms * DENORMAL * 1e155 * 1e155 + 1e-13 * np.abs(right).max()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scale", [1e150, 1e290, 1e-150, 1e-290])
def test_synchrosqueezing_scales(scale: float, kind: str) -> None:
    x = inputs((PULSES,))[kind]
    right, found = squeezed(x), squeezed(x * scale)
    assert np.isfinite(found).all()
    assert np.abs(found / scale - right).max() <= 1e-12 * np.abs(right).max()


@pytest.mark.parametrize("kind", KINDS)
def test_synchrosqueezing_of_denormals_keeps_the_sum(kind: str) -> None:
    x = inputs((PULSES,))[kind] * 1e-310
    found = squeezed(x, 0.0)
    assert np.isfinite(found).all()
    middle = FRAMES.length // 2
    kept = x[middle :: FRAMES.hop][: len(found)] * FRAMES.length * FRAMES.window[middle]
    error = np.abs(found.sum(axis=1) - kept).max()
    assert error <= 4 * FRAMES.length**2 * DENORMAL


def coefficients(kind: str) -> np.ndarray:
    return inputs((20, 24))[kind]


@pytest.mark.parametrize("kind", KINDS)
def test_range_power(kind: str) -> None:
    """Up to 1e150 the power scales; 1e-310 squares to zero, and so does anything below 1e-162."""
    z = inputs((20, 24))[kind]
    right = range_power(z)
    for scale in (1e150, 1e-150):
        found = range_power(z * scale)
        assert np.isfinite(found).all()
        assert found / scale / scale == pytest.approx(right, rel=1e-12)
    assert not range_power(z * 1e-310).any()


def test_squares_beyond_a_double_overflow_with_a_warning() -> None:
    """|S| from 1.4e154 on: NumPy warns of the overflow and the map is infinite."""
    with np.errstate(over="warn"), pytest.warns(RuntimeWarning, match="overflow"):
        power = range_power(np.full((20, 24), 1e155 + 0j))
    assert np.isinf(power).all()
    with pytest.raises(RadharError, match="should be finite; its largest value is inf"):
        entropy_bits(power)
    with pytest.raises(RadharError, match="should be finite; its largest value is inf"):
        levels(power, (8, 8), 50.0)


@pytest.mark.parametrize("function", [entropy_bits, lambda p: levels(p, (8, 8), 50.0)])
def test_maps_with_a_nan_are_refused(function: Callable[[np.ndarray], Any]) -> None:
    power = np.ones((9, 9))
    power[4, 4] = np.nan
    with pytest.raises(RadharError, match="its largest value is nan"):
        function(power)


MAPS = {
    "constant": np.ones((30, 40)),
    "impulse": np.pad([[1.0]], ((10, 19), (12, 27))),
    "gradient": np.outer(np.logspace(-20, 0, 30), np.linspace(0.5, 1, 40)),
}


@pytest.mark.parametrize("kind", MAPS)
@pytest.mark.parametrize("scale", [5e-324, 1e-310, 1e-300, 1e150, 1e300, 1.7e308])
def test_entropy_and_levels_do_not_see_the_scale(scale: float, kind: str) -> None:
    power = MAPS[kind]
    found = power * scale
    if scale < 1e-309 and kind == "gradient":  # its small pixels round away
        assert np.isfinite(entropy_bits(found))
        assert levels(found, (16, 20), 50.0).max() == 255
        return
    assert entropy_bits(found) == pytest.approx(entropy_bits(power), abs=1e-9)
    grey = levels(found, (16, 20), 50.0)
    assert np.array_equal(grey, levels(power, (16, 20), 50.0))
    assert grey.max() == 255


@pytest.mark.parametrize("dynamic_range", [5e-324, 1e-12, 300.0])
@pytest.mark.parametrize("kind", MAPS)
def test_levels_at_the_ends_of_the_dynamic_range(kind: str, dynamic_range: float) -> None:
    grey = levels(MAPS[kind], (16, 20), dynamic_range)
    assert grey.max() == 255
    assert grey.shape == (16, 20)


# A float has 24 bits: 6e-8 a number, and a few of them a sum.
SINGLE = 1e-6


@pytest.mark.parametrize("name", [*LINEAR, "synchrosqueeze"])
def test_complex64(name: str) -> None:
    function = LINEAR.get(name, squeezed)
    z = inputs(shape_of(name))["tone" if name == "synchrosqueeze" else "noise"]
    single = z.astype(np.complex64)
    right = function(single.astype(complex))
    found = function(single)
    error = np.linalg.norm(found - right) / np.linalg.norm(right)
    print(f"{name}, complex64 against complex128: {error:.1e}")
    assert np.isfinite(found).all()
    assert error < SINGLE


def test_range_power_of_complex64() -> None:
    single = inputs((20, 24))["noise"].astype(np.complex64)
    found, right = range_power(single), range_power(single.astype(complex))
    assert np.abs(found / right - 1).max() < SINGLE


def test_maps_of_float32() -> None:
    power = MAPS["gradient"].astype(np.float32)
    off = entropy_bits(power) - entropy_bits(power.astype(float))
    print(f"entropy_bits, float32 against float64: {off:+.1e} bits")
    assert abs(off) < 1e-5
    grey = [levels(p, (16, 20), 50.0).astype(int) for p in (power, power.astype(float))]
    print(f"levels, float32 against float64: {np.abs(grey[0] - grey[1]).max()} levels")
    assert np.abs(grey[0] - grey[1]).max() <= 1


@pytest.mark.parametrize("frame", [31, 301, 3001])
@pytest.mark.parametrize("order", [0, 1, 2, 5, 13, 30])
def test_savitzky_golay_of_any_order_and_frame(order: int, frame: int) -> None:
    """Polynomials of its order pass, ends included."""
    SavgolConfig(order=order, frame=frame)
    t = np.linspace(-1, 1, frame + 50)
    x = np.polynomial.Legendre.basis(order)(t) + 1j * t ** min(order, 1)
    error = np.abs(savgol(x, order, frame) - x).max()
    print(f"Savitzky-Golay, order {order}, frame {frame}: {error:.0e}")
    assert error < 1e-12
