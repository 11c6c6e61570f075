"""Functions of the table of products, called alone: with values, without a config or a scene."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from radhar_cli.config.engine import EngineConfig
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.paths import Paths
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.errors import SceneError
from radhar_cli.processing.canceller import FIRST_DIFFERENCE, NO_CANCELLER, MeanRemoval
from radhar_cli.processing.cfar_mask import CellAveraging
from radhar_cli.processing.doppler_power import compute_fsst_power, compute_stft_power
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.look import Look, RangeSum
from radhar_cli.processing.scale import CfarMask, DecibelScale
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.products.exact import compute_beat_signals, compute_gate_bins
from radhar_cli.scene.products.fallback import Fallback, fall_back
from radhar_cli.scene.products.gated import (
    find_needed_bins,
    make_fixed_gate,
    make_gate_around_torso,
)
from radhar_cli.scene.products.images import ImageForm, draw_doppler_image, draw_map
from radhar_cli.scene.products.maps import make_range_time_map
from radhar_cli.scene.products.signal import (
    compensate_torso,
    keep_in_phase,
    receive_echo,
    smooth_signal,
)
from radhar_cli.scene.products.signal_power import power_at_pulses

F0, PRF, PULSES = 10e9, 500.0, 400
WAVEFORM = Waveform(fc=F0, bandwidth=1e9, chirp=40e-6, adc_rate=2e6, prf=PRF, duration=0.4)


class Still:
    """Two paths that do not move, of amplitudes 3 and 4."""

    breakpoints = ()
    highest_frequency = 1.0
    smooth = True

    def __call__(self, t: np.ndarray) -> Paths:
        ones = np.ones((2, t.size))
        return Paths(ones * [[2e-8], [3e-8]], ones * [[3.0], [4.0]])


def tone(doppler_hz: float, rows: int = 1) -> Signal:
    """A signal of one Doppler frequency; several rows are range bins 0.15 m apart."""
    x = np.exp(2j * np.pi * doppler_hz * np.arange(PULSES) / PRF) * np.ones((1, rows, 1))
    ranges = None if rows == 1 else 0.15 * np.arange(rows)
    return Signal(x, PulseTimes.even(PULSES, PRF, 0.0), F0, ranges, range_step=0.15)


def test_blocks_of_a_power_start_anew_at_each_call() -> None:
    power = compute_stft_power(tone(50.0), Frames(64, 16))
    first, again = (np.concatenate(list(power.blocks())) for _ in range(2))
    assert_array_equal(first, again)
    assert power.frames == len(first)


@pytest.mark.parametrize("single", [False, True])
def test_a_tone_is_at_its_frequency_within_the_limits_of_speed(single: bool) -> None:
    limits = (0.0, 2.0)
    power = compute_stft_power(tone(50.0), Frames(64, 16), limits_mps=limits, single=single)
    shown = power.as_map()
    speeds = shown.rows.values * SPEED_OF_LIGHT / (2 * F0)
    assert speeds.min() >= limits[0] - 1e-9
    assert speeds.max() <= limits[1] + 1e-9
    step = shown.rows.values[1] - shown.rows.values[0]
    assert abs(shown.rows.values[shown.power.argmax(axis=0)] - 50.0).max() <= step / 2 + 1e-9


def test_synchrosqueezing_keeps_the_power_of_a_tone_in_fewer_bins() -> None:
    frames = Frames(64, 16)
    stft = compute_stft_power(tone(50.0), frames).as_map().power
    fsst = compute_fsst_power(tone(50.0), frames, threshold=1e-3).as_map().power
    assert (fsst > 1e-3 * fsst.max()).sum() < (stft > 1e-3 * stft.max()).sum()


def test_magnitudes_of_equal_rows_add_up_in_amplitude() -> None:
    frames, gate = Frames(64, 16), make_fixed_gate(0.15 * np.arange(4), (0.0, 0.45))
    bins = tone(50.0, rows=4)
    powers = compute_stft_power(bins, frames, gate).as_map().power
    magnitudes = compute_stft_power(bins, frames, gate, sums_magnitudes=True).as_map().power
    assert_allclose(magnitudes, 4 * powers, rtol=1e-9, atol=1e-9 * magnitudes.max())


def test_an_image_is_brightest_at_the_tone() -> None:
    power = compute_stft_power(tone(100.0), Frames(64, 16))
    image = draw_doppler_image(power, DecibelScale(50.0), ImageForm((64, 32)))
    assert image.levels.shape == (64, 32)
    assert image.levels.max() == 255
    row = int(image.levels.sum(axis=1, dtype=int).argmax())
    _, _, low, high = image.extent
    assert high - (row + 0.5) * (high - low) / 64 == pytest.approx(100.0, abs=PRF / 64)
    assert image.decibels is None


@pytest.mark.parametrize("decibel", [False, True])
def test_a_mask_stores_the_decibels_of_the_power_itself(decibel: bool) -> None:
    """The block-by-block image has to be resized twice where the mask is of decibels."""
    power = compute_stft_power(tone(100.0), Frames(64, 16))
    form = ImageForm((32, 32), has_decibels=True)
    mask = CfarMask(CellAveraging((1, 1), (4, 4), 1e-2, decibel))
    masked = draw_doppler_image(power, mask, form)
    grey = draw_doppler_image(power, DecibelScale(50.0), form)
    assert set(np.unique(masked.levels)) <= {0, 255}
    assert_array_equal(masked.decibels, grey.decibels)
    assert masked.largest_db == grey.largest_db


def test_a_map_in_memory_and_one_in_blocks_have_one_image() -> None:
    power = compute_stft_power(tone(100.0), Frames(64, 16))
    form = ImageForm((32, 32), has_decibels=True)
    in_blocks = draw_doppler_image(power, DecibelScale(50.0), form)
    in_memory = draw_map(power.as_map(), DecibelScale(50.0), form)
    assert_array_equal(in_blocks.levels, in_memory.levels)
    assert in_blocks.entropy == pytest.approx(in_memory.entropy)


def test_a_range_time_map_has_gain_and_sign_where_asked() -> None:
    profiles = tone(0.0, rows=3)
    assert_allclose(make_range_time_map(profiles).power, 1.0)
    gained = make_range_time_map(profiles, gain_power=2.0, has_sign=True)
    assert_allclose(gained.power[:, 0], [0.0, 0.5**4, 1.0])
    assert gained.real is not None
    assert_allclose(gained.real[:, 0], [0.0, 0.25, 1.0])


def test_compensation_takes_out_the_doppler_of_the_torso() -> None:
    speed = 50.0 * SPEED_OF_LIGHT / (2 * F0)  # approaching
    track = 2e-8 - 2 * speed / SPEED_OF_LIGHT * np.arange(PULSES) / PRF
    left = compensate_torso(tone(50.0), track).x[0, 0]
    assert_allclose(left, left[0], atol=1e-6)


def test_smoothing_keeps_polynomials_of_its_order() -> None:
    signal = tone(0.0)
    parabola = signal.with_samples(signal.x * np.arange(PULSES) ** 2)
    smooth = smooth_signal(parabola, order=2, frame=11)
    assert_allclose(smooth.x, parabola.x, atol=1e-6 * abs(parabola.x).max())


def test_in_phase_samples_have_both_signs_of_doppler() -> None:
    power = compute_stft_power(keep_in_phase(tone(50.0)), Frames(64, 16)).as_map()
    mean = power.power.mean(axis=1)
    at = {sign: int(abs(power.rows.values - sign * 50.0).argmin()) for sign in (-1, 1)}
    assert mean[at[-1]] == pytest.approx(mean[at[1]], rel=0.05)


class Doubling(Impairment):
    """An impairment that adds the echo once more."""

    def apply(self, x: np.ndarray, look: Look) -> np.ndarray:
        return 2 * x


class Clipping(Doubling):
    """An impairment that does not add."""

    additive = False


def test_a_receiver_acts_before_the_canceller() -> None:
    look = Look.of_all("slow_time", RangeSum(WAVEFORM))
    x = np.arange(look.count, dtype=complex)[None]
    received = receive_echo(x, look, (Doubling(),), FIRST_DIFFERENCE)
    assert_allclose(received.x[0, 0], 2.0)
    assert received.pulses == look.count - 1


def test_an_impairment_that_does_not_add_is_refused() -> None:
    look = Look.of_all("slow_time", RangeSum(WAVEFORM))
    with pytest.raises(SceneError, match="Clipping: is not additive"):
        receive_echo(np.zeros((1, look.count), complex), look, (Clipping(),))


def test_one_pass_makes_the_profiles_of_a_canceller_with_taps_alone() -> None:
    with_taps = compute_beat_signals(Still(), WAVEFORM, NO_CANCELLER, (), width=16)
    assert with_taps.profiles is not None
    assert with_taps.profiles.pulses == 16
    of_recording = compute_beat_signals(Still(), WAVEFORM, MeanRemoval(), (), width=16)
    assert of_recording.profiles is None
    assert not of_recording.signal.x.any()


def test_bins_of_a_gate_are_those_of_the_axis() -> None:
    gate = make_fixed_gate(WAVEFORM.range_axis(), (1.0, 5.0))
    bins = compute_gate_bins(gate, Still(), WAVEFORM, NO_CANCELLER, ())
    assert bins.ranges is not None
    assert_allclose(bins.ranges[[0, -1]], [1.0, 5.0], atol=WAVEFORM.range_step / 2)
    strongest = bins.ranges[abs(bins.x[0, :, 0]).argmax()]
    assert strongest == pytest.approx(3e-8 * SPEED_OF_LIGHT / 2, abs=WAVEFORM.range_step)


def test_a_gate_follows_the_torso() -> None:
    ranges, frames = 0.1 * np.arange(100), Frames(20, 20)
    track = np.repeat([2.0, 4.0], 100) * 2 / SPEED_OF_LIGHT
    gate = make_gate_around_torso(ranges, frames, NO_CANCELLER, track, half_width_m=0.5)
    assert gate.count == 11
    assert_array_equal(gate.first, np.repeat([15, 35], 5))
    needed = find_needed_bins(gate, frames, replace(WAVEFORM, duration=0.4), NO_CANCELLER, 0)
    assert needed is not None
    assert needed.first[0] == 15
    assert find_needed_bins(gate, frames, WAVEFORM, MeanRemoval(), 0) is None


def test_a_kind_of_echo_has_one_power() -> None:
    """P_s of amplitudes 3 and 4 is 25; of real pulses half of it."""
    assert power_at_pulses(Still(), WAVEFORM) == pytest.approx(25.0)
    pulses = Impulse(7e9, 1.5e9, 1e-6, 2e6, PRF, 0.1, profile=(0.5, 6.0), samples=800)
    assert power_at_pulses(Still(), pulses) == pytest.approx(12.5)


def test_a_tolerance_falls_back_or_refuses() -> None:
    error = AccuracyError(-250.0)
    sloppy, strict = EngineConfig(fallback="cube"), EngineConfig(tolerance_db=-300)
    assert fall_back(sloppy, "walking/0", error) == Fallback(str(error))
    with pytest.raises(
        SceneError, match=r"sample walking/0: engine\.tolerance_db = -300: should be"
    ):
        fall_back(strict, "walking/0", error)
