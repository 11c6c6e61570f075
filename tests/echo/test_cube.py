"""The beat matrix and the blocks in which the cube engine computes it."""

from dataclasses import asdict

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.config.data_set import Config
from radhar_cli.echo import exact
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.processing.canceller import Fir
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene

# fc tau is about 1e4 cycles at most: float64 places the phase to some 1e-11 of a turn.
ROUNDING = 1e-11

RADARS = {
    "default": ref.Radar(duration=0.02),
    "odd": ref.Radar(5.8e9, 4e8, 50.5e-6, 2e6, 400, 0.1),
    "prime": ref.Radar(24e9, 1e9, 97e-6, 1e6, 1000, 0.05),
    "two samples": ref.Radar(24e9, 1e9, 2e-6, 1e6, 1000, 0.05),
    "zero-padded": ref.Radar(10e9, 1e9, prf=1000, duration=0.05, fft_length=1024),
    "start": ref.Radar(duration=0.02, centred=False),
    "video phase": ref.Radar(duration=0.02, residual_video_phase=True),
}
radars = pytest.mark.parametrize("radar", RADARS.values(), ids=RADARS)


def crowd(t: np.ndarray) -> np.ndarray:
    """Five points between 0.3 m and 30 m, some of them moving."""
    still = np.array([0.3, 2.0, 7.1, 12.0, 30.0])[:, None]
    return still + np.array([0.0, 1.0, -4.0, 0.0, 6.0])[:, None] * t + 0.02 * np.sin(40 * t)


@radars
def test_beat_matrix_is_a_sum_of_exponentials(radar):
    paths = ref.Points(crowd)(radar.times)
    right = ref.beat_matrix(paths.delay, paths.amplitude, radar)
    found = beat_matrix(paths.delay, paths.amplitude, Waveform(**asdict(radar)))
    assert found.shape == (radar.n_adc, radar.times.size)
    assert np.abs(found - right).max() < ROUNDING * np.abs(right).max()


def test_one_path_of_one_pulse_has_negative_frequency_and_its_own_amplitude():
    """exp(-j 2 pi (fc tau + K tau n/fs)) with 10 whole beats in the chirp."""
    waveform = Waveform(**asdict(RADARS["default"]))
    tau = 10 / waveform.bandwidth
    beat = beat_matrix(np.array([[tau]]), np.array([[0.25]]), waveform)[:, 0]
    spectrum = np.fft.fft(beat) / beat.size
    assert np.argmax(np.abs(spectrum)) == beat.size - 10
    assert spectrum[-10] == pytest.approx(0.25 * np.exp(-2j * np.pi * waveform.fc * tau), rel=1e-9)


def test_unit_phasor_turns_backwards():
    cycles = np.array([0.0, 0.25, 0.5, -0.25, 1e6 + 0.125])
    right = [1, -1j, -1, 1j, np.exp(-0.25j * np.pi)]
    assert unit_phasor(cycles) == pytest.approx(np.array(right), abs=1e-9)


@pytest.mark.parametrize("activity", [2, 8, 12])
@pytest.mark.parametrize(("carrier", "wall"), [(77e9, None), (2e9, {})], ids=["free space", "wall"])
def test_slow_time_signal_of_a_person_is_the_reference(activity, carrier, wall):
    """The whole cube path of a plan, from paths to the sum over bins."""
    radar = ref.Radar(carrier, 1e9, adc_rate=1e6, prf=300, duration=0.5)
    config = Config.model_validate(
        {
            "duration_s": radar.duration,
            "radar": {"carrier_hz": carrier, "bandwidth_hz": 1e9, "adc_rate_hz": 1e6, "prf_hz": 300}
            | {"chirp_s": radar.chirp},
            "motion": {"model": "paper"},
            "timing": {"walk_stop_s": 0.2},
            "wall": wall,
            "snr_db": None,
            "engine": {"kind": "cube"},
        }
    )
    recording = record(draw_scene(config, ACTIVITIES[activity - 1], 0), ["signal", "paths"])
    paths = recording["paths"](radar.times)
    right = ref.mti(ref.slow_time(paths.delay, paths.amplitude, radar))
    # MTI leaves a hundredth of the amplitude or more, and rounding stays what it was.
    assert ref.error_db(recording["signal"].x[0, 0], right) < -170


class TestMotionInChirp:
    """Delays and amplitudes at t_m + n/fs instead of t_m."""

    def beat(self, ranges, radar, moving=True, strength=1.0):
        source = ref.Points(ranges, strength)
        return np.hstack(
            [*exact.beat_blocks(source, Waveform(**asdict(radar)), motion_in_chirp=moving)]
        )

    @staticmethod
    def closed_form(ranges, radar):
        """exp(-j 2 pi (fc tau(t) + K tau(t) t_n)) A(t) at every sample of every chirp."""
        n = np.arange(radar.n_adc) / radar.adc_rate
        r = ranges((radar.times[None, :] + n[:, None]).ravel())
        tau = (2 * r / ref.C).reshape(len(r), radar.n_adc, -1)
        cycles = radar.fc * tau + radar.slope * tau * n[:, None]
        if radar.residual_video_phase:
            cycles -= radar.slope * tau**2 / 2
        return (ref.turn(-cycles) / r.reshape(tau.shape) ** 2).sum(axis=0)

    @radars
    def test_a_motionless_scene_is_as_in_stop_and_hop(self, radar):
        def still(t):
            return np.array([0.3, 2.0, 7.1])[:, None] + 0 * t

        moving, frozen = (self.beat(still, radar, moving) for moving in (True, False))
        assert np.abs(moving - frozen).max() < ROUNDING * np.abs(frozen).max()
        assert not ref.mti(moving).any()

    @radars
    @pytest.mark.parametrize("speed", [-6.0, 1.5, 40.0])
    def test_a_constant_velocity_is_the_closed_form(self, radar, speed):
        def receding(t):
            return 5.0 + speed * t[None, :]

        found, right = self.beat(receding, radar), self.closed_form(receding, radar)
        assert np.abs(found - right).max() < 1e-9 * np.abs(right).max()

    @radars
    def test_a_crowd_is_the_closed_form(self, radar):
        found, right = self.beat(crowd, radar), self.closed_form(crowd, radar)
        assert np.abs(found - right).max() < 1e-9 * np.abs(right).max()

    @pytest.mark.parametrize("chirp", [1e-3, 2e-3])
    def test_the_polynomial_errs_by_its_bound(self, chirp):
        """A far too fast swing, so that there is an error: |tau^(5)| L^5/61440 at most."""
        radar = ref.Radar(77e9, 1e9, chirp, 1e6, 100, 0.05)
        swing, omega = 0.02, 2 * np.pi * 100

        def fast(t):
            return 3.0 + swing * np.sin(omega * t[None, :])

        found, right = self.beat(fast, radar), self.closed_form(fast, radar)
        error = np.abs(np.angle(found * right.conj())).max() / (2 * np.pi)
        fifth = 2 * swing * omega**5 / ref.C
        length = (radar.n_adc - 1) / radar.adc_rate
        bound = (radar.fc + radar.bandwidth) * fifth * length**5 / 61440
        assert 0.5 * bound < error < 1.01 * bound

    @pytest.mark.parametrize("speed", [-20.0, 20.0])
    def test_range_and_doppler_couple(self, speed):
        """The beat is K tau + f0 dtau/dt at mid-chirp: the peak moves by (f0 2 v/c)/K of delay."""
        radar = ref.Radar(prf=1000, duration=0.004)

        def receding(t):
            return 3.0 + speed * t[None, :]

        def beat_frequency(moving):
            spectrum = np.abs(np.fft.ifft(self.beat(receding, radar, moving)[:, 0], 2**19))
            return np.argmax(spectrum[: 2**18]) * radar.adc_rate / 2**19

        tau_mid = 2 * (3.0 + speed * radar.chirp / 2) / ref.C
        moved = beat_frequency(True) - radar.slope * tau_mid
        coupling = radar.f0 * 2 * speed / ref.C
        bin_width = radar.adc_rate / 2**19  # 0.2 % of the coupling
        assert moved == pytest.approx(coupling, abs=2 * bin_width)
        assert beat_frequency(False) == pytest.approx(radar.slope * 2 * 3.0 / ref.C, abs=bin_width)

    def test_the_plan_uses_it(self):
        """Both for the slow-time signal and for the range-time map of a person."""
        base = {
            "duration_s": 0.4,
            "radar": {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 300},
            "snr_db": None,
            "image": {"size_px": 16},
        }
        frozen, moving = (
            record(draw_scene(config, ACTIVITIES[7], 0), ["signal", "rtm"])
            for config in (
                Config.model_validate(base | {"engine": {"kind": "cube", "motion_in_chirp": on}})
                for on in (False, True)
            )
        )
        assert -80 < ref.error_db(moving["signal"].x, frozen["signal"].x) < -20
        assert -80 < ref.error_db(moving["rtm"].power, frozen["rtm"].power) < -20

    def test_block_length_is_bounded_and_does_not_matter(self, monkeypatch):
        radar = RADARS["odd"]
        whole = self.beat(crowd, radar)
        monkeypatch.setattr(exact, "BLOCK_SAMPLES", 7 * radar.n_adc)
        source = ref.Points(crowd)
        list(exact.beat_blocks(source, Waveform(**asdict(radar)), motion_in_chirp=True))
        assert [t.size for t in source.asked] == [5 * m for m in (7, 7, 7, 7, 7, 5)]
        assert np.abs(self.beat(crowd, radar) - whole).max() < ROUNDING * np.abs(whole).max()


class TestBlocks:
    """The matrix is made block by block; results do not depend on the blocks."""

    @pytest.fixture
    def waveform(self):
        return Waveform(**asdict(RADARS["odd"]))

    @pytest.mark.parametrize("pulses", [1, 2, 3, 7, 39, 40, 1000])
    def test_length_does_not_matter(self, monkeypatch, waveform, pulses):
        def joined():
            return np.hstack([*exact.beat_blocks(ref.Points(crowd), waveform)])

        whole = joined()
        assert whole.shape == (waveform.n_adc, waveform.n_pulses)
        monkeypatch.setattr(exact, "BLOCK_SAMPLES", pulses * waveform.n_adc)
        assert np.array_equal(joined(), whole)

    def test_a_block_holds_no_more_than_its_length(self, monkeypatch, waveform):
        """What bounds the memory of a long recording."""
        monkeypatch.setattr(exact, "BLOCK_SAMPLES", 7 * waveform.n_adc)
        source = ref.Points(crowd)
        list(exact.beat_blocks(source, waveform))
        assert [t.size for t in source.asked] == [7, 7, 7, 7, 7, 5]

    @pytest.mark.parametrize("taps", [(1,), (-1, 1), (1, -2, 1)])
    def test_products_do_not_depend_on_it(self, monkeypatch, taps):
        """Noise and canceller reach across the blocks."""
        config = Config.model_validate(
            {
                "duration_s": 0.5,
                "radar": {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 300},
                "image": {"size_px": 37},
                "motion": {"model": "paper"},
                "engine": {"kind": "cube"},
            }
        )
        scene, asked = draw_scene(config, ACTIVITIES[1], 0), ["rtm", "signal"]
        whole = record(scene, asked, canceller=Fir(taps))
        assert whole["signal"].x.shape == (1, 1, 151 - len(taps))
        assert whole["rtm"].power.shape == (200, 37)
        for pulses in (2, 10, 149):
            monkeypatch.setattr(exact, "BLOCK_SAMPLES", pulses * 400)
            parts = record(scene, asked, canceller=Fir(taps))
            for found, right in (
                (parts["signal"].x, whole["signal"].x),
                (parts["rtm"].power, whole["rtm"].power),
            ):
                assert np.abs(found - right).max() < 1e-14 * np.abs(right).max()

    def test_signal_power_is_the_mean_over_the_pulses(self, monkeypatch, waveform):
        source = ref.Points(crowd)
        right = np.mean(np.sum(source(RADARS["odd"].times).amplitude ** 2, axis=0))
        assert exact.signal_power(source, waveform) == pytest.approx(right, rel=1e-13)
        monkeypatch.setattr(exact, "BLOCK_SAMPLES", 7)
        assert exact.signal_power(source, waveform) == pytest.approx(right, rel=1e-13)
