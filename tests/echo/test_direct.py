"""The closed-form engine on paths that no person makes: against the naive reference."""

from dataclasses import asdict

import numpy as np
import pytest
from helpers import reference as ref
from hypothesis import example, given, settings
from hypothesis import strategies as st

from radhar_cli.echo import direct, knots
from radhar_cli.echo.accuracy import PROBES
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.interpolation import AFTER, BEFORE
from radhar_cli.processing.canceller import NO_CANCELLER
from radhar_cli.radar.fmcw import Waveform

pytestmark = pytest.mark.usefixtures("either_sum")

DEFAULT, TIGHT = -60.0, -110.0  # tolerances, dB

few = settings(max_examples=40, deadline=None, derandomize=True, database=None)
references = pytest.mark.parametrize("centred", [True, False], ids=["centre", "start"])


@st.composite
def radars(draw) -> ref.Radar:
    """0.2 s of any carrier, bandwidth, PRF and number of samples, even or odd."""
    return ref.Radar(
        fc=draw(st.sampled_from([2e9, 24e9, 77e9])),
        bandwidth=draw(st.sampled_from([1e8, 1e9, 4e9])),
        adc_rate=1e6,
        chirp=draw(st.sampled_from([20, 31, 40, 64])) * 1e-6,
        prf=draw(st.sampled_from([300, 1000, 5000])),
        duration=0.2,
        residual_video_phase=draw(st.booleans()),
        fft_length=draw(st.sampled_from([None, 64, 100])),
    )


# Where G turns most between two knots: a wide band, many samples, a fast radar.
WIDE = ref.Radar(2e9, 4e9, 64e-6, 1e6, 5000, 0.2)


def with_reference(radar: ref.Radar, centred: bool) -> ref.Radar:
    return ref.Radar(**asdict(radar) | {"centred": centred})


def half_band(radar: ref.Radar) -> float:
    return ref.C * radar.n_adc / (4 * radar.bandwidth)


def after_mti(
    source: ref.Points, radar: ref.Radar, tolerance: float = DEFAULT, double: bool = False
) -> np.ndarray:
    return np.diff(DirectEcho(source, Waveform(**asdict(radar)), tolerance, double).slow_time()[0])


def right_answer(source: ref.Points, radar: ref.Radar) -> np.ndarray:
    paths = source(radar.times)
    return ref.mti(ref.slow_time(paths.delay, paths.amplitude, radar))


def check(source: ref.Points, radar: ref.Radar) -> None:
    right = right_answer(source, radar)
    for tolerance in (DEFAULT, TIGHT):
        assert ref.error_db(after_mti(source, radar, tolerance), right) < tolerance


@references
@given(radar=radars(), place=st.floats(0.3, 0.7), speed=st.floats(-5, 5))
@example(radar=WIDE, place=0.45, speed=1.28)
@few
def test_constant_velocity(centred, radar, place, speed):
    speed = np.copysign(max(abs(speed), 0.1), speed)
    travel = np.clip(speed * 0.2, -0.25 * half_band(radar), 0.25 * half_band(radar)) / 0.2
    source = ref.Points(lambda t: (place * half_band(radar) + travel * t)[None])
    check(source, with_reference(radar, centred))


@references
@given(
    radar=radars(), place=st.floats(0.4, 0.6), gait=st.floats(0.3, 3), phase=st.floats(0, 2 * np.pi)
)
@few
def test_pendulum(centred, radar, place, gait, phase):
    """An ankle: never faster than 5 m/s, half a metre at most."""
    swing = min(0.3 * half_band(radar), 5 / (2 * np.pi * gait), 0.5)

    def ranges(t):
        return (place * half_band(radar) + swing * np.sin(2 * np.pi * gait * t + phase))[None]

    check(ref.Points(ranges, highest_frequency=gait), with_reference(radar, centred))


@references
@given(radar=radars(), speed=st.floats(0.5, 5), nearest=st.floats(-0.05, 0.25))
@example(radar=WIDE, speed=1.92, nearest=0.2)
@few
def test_passage_at_five_centimetres(centred, radar, speed, nearest):
    """The nearest that the model allows: 40 dB of amplitude within a few pulses."""
    source = ref.Points(lambda t: np.hypot(0.05, speed * (t - nearest))[None])
    check(source, with_reference(radar, centred))


@given(radar=radars(), seed=st.integers(0, 1000))
@few
def test_several_points_some_beyond_the_half_band(radar, seed):
    """What lies beyond folds back as leakage; it is part of the sum in both."""
    rng = np.random.default_rng(seed)
    place = np.array([0.5, 1.3, *rng.uniform(0.2, 2.5, 3)])[:, None] * half_band(radar)
    speed = np.array([0.8, *rng.uniform(-4, 4, 4)])[:, None]
    check(ref.Points(lambda t: np.hypot(0.05, place + speed * t)), radar)


RADAR = ref.Radar(adc_rate=1e6, duration=0.5)


def mean_power(source: ref.Points) -> float:
    return float(np.mean(np.sum(source(RADAR.times).amplitude ** 2, axis=0)))


WALK = 2.0, 1.5  # m, m/s


def walk(t: np.ndarray) -> np.ndarray:
    return (WALK[0] + WALK[1] * t)[None]


class TestStaticPaths:
    """MTI removes what does not move; the engine does not even compute it."""

    def with_static(self, strength: float) -> ref.Points:
        def ranges(t):
            return np.concatenate([np.full((1, t.size), 3.0), walk(t)])

        return ref.Points(ranges, strength=np.array([strength, 1.0]))

    def test_static_paths_change_no_bit(self):
        alone = after_mti(ref.Points(walk), RADAR)
        assert np.array_equal(after_mti(self.with_static(1e6), RADAR), alone)

    def test_without_mti_static_paths_count(self):
        source = self.with_static(5.0)
        paths = source(RADAR.times)
        y = DirectEcho(
            source, Waveform(**asdict(RADAR)), TIGHT, canceller=NO_CANCELLER
        ).slow_time()[0]
        assert ref.error_db(y, ref.slow_time(paths.delay, paths.amplitude, RADAR)) < TIGHT

    @pytest.mark.parametrize("tolerance", [DEFAULT, TIGHT, -400.0])
    def test_a_motionless_scene_is_exactly_nothing(self, tolerance):
        still = ref.Points(lambda t: np.full((4, t.size), [[1.0], [2.0], [3.0], [4.5]]))
        assert not DirectEcho(still, Waveform(**asdict(RADAR)), tolerance).slow_time()[0].any()

    def test_a_path_that_only_changes_its_amplitude_moves(self):
        """A scatterer whose ray enters the wall at constant delay, say."""

        class Fading(ref.Points):
            def __call__(self, t):
                paths = super().__call__(t)
                return paths._replace(amplitude=paths.amplitude * (1 + 0.5 * np.sin(20 * t)))

        source = Fading(lambda t: np.full((1, t.size), 2.0), highest_frequency=3.2)
        check(source, RADAR)

    def test_a_path_that_moves_only_between_knots_moves(self):
        """A jerk around one kink, seen by the exact pulses alone."""

        def ranges(t):
            return (2 + 1e-3 * np.maximum(0, 1 - np.abs(t - 0.3021) / 1e-3))[None]

        check(ref.Points(ranges, breakpoints=(0.3011, 0.3021, 0.3031)), RADAR)


class TestPrecision:
    def test_single_is_used_where_it_suffices(self):
        source = ref.Points(walk)
        single = after_mti(source, RADAR)
        double = after_mti(source, RADAR, double=True)
        assert not np.array_equal(single, double)
        assert ref.error_db(single, double) < DEFAULT

    @pytest.mark.parametrize("speed", [1e-6, 1e-5, 1e-4])
    def test_a_very_slow_motion_falls_back_to_double(self, speed):
        """MTI leaves 1e-6 to 1e-4 of the signal: less than, or little above, float32's rounding."""
        source = ref.Points(lambda t: (2 + speed * t)[None])
        y, accuracy = DirectEcho(source, Waveform(**asdict(RADAR)), DEFAULT).slow_time()
        assert not accuracy.single
        assert ref.error_db(np.diff(y), right_answer(source, RADAR)) < DEFAULT

    @pytest.mark.parametrize("speed", np.geomspace(1e-6, 1, 13))
    def test_every_speed_keeps_the_tolerance_in_single_or_double(self, speed):
        source = ref.Points(lambda t: (2 + speed * t)[None])
        assert ref.error_db(after_mti(source, RADAR), right_answer(source, RADAR)) < DEFAULT


class TestBreakpoints:
    """S12 stops a walk at an instant: acceleration jumps there, or everything does (blend 0)."""

    at = 0.31071

    def braked(self, breakpoints):
        def ranges(t):
            return walk(t) - 6 * np.maximum(t - self.at, 0) ** 2

        return ref.Points(ranges, breakpoints=breakpoints)

    def jumping(self, at, breakpoints):
        return ref.Points(lambda t: walk(t) + np.where(t >= at, 0.05, 0), breakpoints=breakpoints)

    def test_acceleration_jump(self):
        source = self.braked((self.at,))
        error = after_mti(source, RADAR, TIGHT) - right_answer(source, RADAR)
        near = np.abs(np.arange(error.size) / RADAR.prf - self.at) < 0.002
        assert np.abs(error[near]).max() <= 2 * np.abs(error[~near]).max()
        check(source, RADAR)

    def test_an_undeclared_breakpoint_is_interpolated_across(self):
        """A broken contract costs accuracy at that place alone."""
        source = self.braked(())
        assert ref.error_db(after_mti(source, RADAR), right_answer(source, RADAR)) < DEFAULT

    @pytest.mark.parametrize("at", [0.0, 0.0002, 0.1, 0.30001, 0.3999, 0.4, 0.4996, 0.4999])
    def test_jump(self, at):
        """At pulses, at knots, between them, and at both ends of the recording."""
        check(self.jumping(at, (at,)), RADAR)

    @pytest.mark.parametrize(
        "breakpoints", [(-1.0,), (-1e-3,), (0.5,), (0.501,), (7.0,), (-0.1, 0.6)]
    )
    def test_breakpoints_beyond_the_recording_are_harmless(self, breakpoints):
        """Those just beyond still reach the first and last segments."""
        for at in breakpoints:
            check(self.jumping(at, breakpoints), RADAR)


class TestKnots:
    """How often the kinematics are evaluated: no more often than the motion needs."""

    def asked(self, source: ref.Points, radar: ref.Radar, tolerance: float = DEFAULT) -> int:
        """Times that the source was asked for, without those of the check."""
        echo = DirectEcho(source, Waveform(**asdict(radar)), tolerance)
        echo.signal_power()
        return sum(t.size for t in source.asked)

    def swinging(self, gait: float) -> ref.Points:
        """A limb, with its overtones."""
        return ref.Points(
            lambda t: (2 + 0.3 * np.sin(3 * np.sin(2 * np.pi * gait * t)))[None],
            highest_frequency=gait,
        )

    def test_a_high_prf_needs_few_knots(self):
        assert self.asked(self.swinging(0.5), RADAR) < 0.1 * RADAR.times.size

    def test_a_tighter_tolerance_needs_more_knots(self):
        asked = [self.asked(self.swinging(1.0), RADAR, db) for db in (-80, -100, -120)]
        assert asked == sorted(set(asked))

    def test_a_looser_tolerance_than_the_default_has_its_knots(self):
        asked = {self.asked(self.swinging(1.0), RADAR, db) for db in (-20, -60, -80)}
        assert len(asked) == 1

    def test_a_low_prf_evaluates_each_pulse_once(self):
        source, radar = ref.Points(walk), ref.Radar(2e9, 1e9, adc_rate=1e6, prf=128, duration=0.5)
        assert self.asked(source, radar) == 64
        moments = np.concatenate(source.asked)
        assert moments == pytest.approx(radar.times, abs=0)

    def test_rough_paths_are_taken_at_every_pulse(self):
        source = ref.Points(walk, smooth=False)
        assert self.asked(source, RADAR) == RADAR.times.size

    def test_fast_motion_needs_more_knots(self):
        """Eight times the frequency, a few times the knots."""
        slow, fast = (self.asked(self.swinging(gait), RADAR) for gait in (0.25, 2.0))
        assert 2 * slow < fast < RADAR.times.size

    def test_power_takes_the_knots_of_the_signal(self):
        source = ref.Points(walk)
        echo = DirectEcho(source, Waveform(**asdict(RADAR)), DEFAULT)
        echo.slow_time()
        once = len(source.asked)
        echo.signal_power()
        assert len(source.asked) == once

    @pytest.mark.parametrize("pulses", [2, 3, 7, 8, 21])
    def test_recordings_of_few_pulses(self, pulses):
        radar = ref.Radar(adc_rate=1e6, prf=1000, duration=pulses / 1000)
        check(ref.Points(lambda t: walk(t) - 3 * t), radar)


@pytest.mark.parametrize(
    ("ranges", "accuracy"),
    [
        (walk, 1e-9),
        (lambda t: np.hypot(0.05, 4 * (t - 0.2))[None], 1e-4),
        (lambda t: np.where(t < 0.11007, 2.0, 1.99)[None], 1e-12),
    ],
    ids=["walk", "passage at 5 cm", "jump"],
)
def test_signal_power_is_the_mean_over_the_pulses(ranges, accuracy):
    """Interpolated as the paths are: 1e-4 is 0.0004 dB of SNR; exact where they jump."""
    source = ref.Points(ranges, breakpoints=(0.11007,))
    echo = DirectEcho(source, Waveform(**asdict(RADAR)), DEFAULT)
    assert echo.signal_power() == pytest.approx(mean_power(source), rel=accuracy)


@pytest.mark.parametrize("size", [1, 37, 1000])
def test_block_lengths_do_not_matter(monkeypatch, size):
    """They bound the memory. Single precision may round differently, a double at 1e-15."""
    source = ref.Points(lambda t: walk(t) - 6 * np.maximum(t - 0.2, 0) ** 2, breakpoints=(0.2,))
    rough = ref.Points(walk, smooth=False)
    whole = [after_mti(s, RADAR, -150.0) for s in (source, rough)]
    for values in ("BLOCK", "PHASORS", "CHUNK"):
        monkeypatch.setattr(direct, values, size)
    parts = [after_mti(s, RADAR, -150.0) for s in (source, rough)]
    for part, right in zip(parts, whole, strict=True):
        assert ref.error_db(part, right) < -200


@pytest.mark.parametrize("step", [3, 4, 19, 40])
def test_an_envelope_in_single_precision_is_a_cubic(step):
    """Through four points of every segment; shifted stencils included."""
    at = np.arange(12.0)[:, None] - direct.BEFORE
    cubic = lambda x: 1 + 0.2 * x - 0.03 * x**2 + 1j * 0.004 * x**3  # noqa: E731
    knots = np.hstack([cubic(at), 0 * at + 1]).astype(np.complex64)
    found = direct._interpolated_sum(0.25 + 0 * knots.real, knots, np.array([0, 1, -1]), step, True)
    right = -1j * (cubic(np.arange(3 * step) / step) + 1)
    assert np.abs(found - right).max() < 2e-5


class TestFaces:
    """A limb that crosses the face of a wall jumps in amplitude: one pulse has most of x."""

    def jumping(self, at: int, before: float, after: float) -> ref.Points:
        class Jumping(ref.Points):
            def __call__(self, t):
                paths = super().__call__(t)
                loss = np.where(t >= at / RADAR.prf, after, before)
                return paths._replace(amplitude=paths.amplitude * loss)

        return Jumping(lambda t: (2 + 0.05 * t)[None], smooth=False)

    @pytest.mark.parametrize("tolerance", [-40.0, -84.0])
    @pytest.mark.parametrize("at", [1, 2, 309, 618, 1250, 1545, 2498, 2499])
    def test_a_jump_at_any_pulse(self, at, tolerance):
        source = self.jumping(at, 0.4, 1.0)
        found = after_mti(source, RADAR, tolerance)
        assert ref.error_db(found, right_answer(source, RADAR)) < tolerance

    @pytest.mark.parametrize("at", [1, 1250, 2497, 2499])
    def test_a_step_out_of_an_opaque_wall(self, at):
        """A hundred decades at once: nothing overflows, and the little before is not missed."""
        source = self.jumping(at, 1e-101, 1.0)
        found = after_mti(source, RADAR)
        assert ref.error_db(found, right_answer(source, RADAR)) < DEFAULT


@pytest.mark.parametrize("tolerance", [DEFAULT, TIGHT])
@pytest.mark.parametrize("smooth", [True, False])
def test_a_moment_of_motion_in_a_long_recording_is_not_overlooked(monkeypatch, smooth, tolerance):
    """Wherever the recording is cut into chunks."""
    monkeypatch.setattr(knots, "CHUNK_KNOTS", 100)

    def ranges(t):
        return (2 + 0.1 * np.clip((t - 0.37) / 0.01, 0, 1) ** 2)[None]

    source = ref.Points(ranges, breakpoints=(0.37, 0.38), smooth=smooth)
    right = right_answer(source, RADAR)
    assert ref.error_db(after_mti(source, RADAR, tolerance), right) < tolerance


@pytest.mark.parametrize("tolerance", [DEFAULT, TIGHT])
@pytest.mark.parametrize("size", [7, 60])
def test_a_long_recording_is_made_in_chunks(monkeypatch, size, tolerance):
    """The same promise, with the knots used a few at a time."""
    source = ref.Points(lambda t: walk(t) - 6 * np.maximum(t - 0.2, 0) ** 2, breakpoints=(0.2,))
    rough = ref.Points(walk, smooth=False)
    monkeypatch.setattr(knots, "CHUNK_KNOTS", size)
    for each in (source, rough):
        right = right_answer(each, RADAR)
        each.asked.clear()
        assert ref.error_db(after_mti(each, RADAR, tolerance), right) < tolerance
        longest = max(t.size for t in each.asked)
        assert longest <= max(size + BEFORE + AFTER + RADAR.times.size / 40, 2 * PROBES)
        power = DirectEcho(each, Waveform(**asdict(RADAR)), tolerance).signal_power()
        assert power == pytest.approx(mean_power(each), rel=1e-6)
