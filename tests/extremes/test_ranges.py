"""Accuracy of the signal over the full range of every parameter.

The cube is compared with the naive formulas in extended precision (free space), the direct engine
with the cube. docs/reference/limits.md quotes what these tests print.
"""

from typing import Any

import numpy as np
import pytest
from helpers import reference as ref
from helpers.extreme_scenes import (
    SCENE,
    config_of,
    exact_signal,
    free_space_paths,
    radar_of,
    record,
    relative,
    signal,
)

from radhar_cli.config import MAP_NAMES, Config
from radhar_cli.config.reading import validated
from radhar_cli.echo.exact import beat_blocks
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.skeleton import JOINTS, PARENTS, SKELETON
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.checks.warnings import scene_warnings
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.scene import draw_scene, nominal_scene

DIRECT_DB = -60.0  # the promise of docs/physics/engines.md
# Rounding of a phase of C cycles is about C 2^-52 turns; over the PRF it is compared with the
# little that the MTI leaves. 1e-9 is -180 dB, far below anything a map shows.
CUBE_ERROR = 1e-9
EDGE_ERROR = 2e-6  # the same where the phase has 1e12 cycles or the PRF is 10 MHz

WALK = {"range_m": 2.0, "angle_deg": 20.0}
AT_5_CM = {"tx_m": [1.9499, 0, 1.2], "rx_m": [1.9499, 0, 1.2]}


def slow(prf: float, pulses: int) -> dict[str, Any]:
    """A scene at another PRF, with its 20 samples a chirp."""
    chirp = min(40e-6, 0.9 / prf)
    radar = {"prf_hz": prf, "chirp_s": chirp, "adc_rate_hz": 20 / chirp}
    return {"radar": radar, "duration_s": pulses / prf}


RIGHT: dict[str, dict[str, Any]] = {
    **{f"carrier {f:g} Hz": {"radar": {"carrier_hz": f}} for f in (1e6, 0.5e9, 24e9, 300e9)},
    **{f"bandwidth {b:g} Hz": {"radar": {"bandwidth_hz": b}} for b in (1e3, 1e6, 1e10, 1e12)},
    "range 5 cm": {"radar": AT_5_CM, "motion": {"range_m": 2.0, "angle_deg": 0.0}},
    "range 500 m at 300 GHz, 1e6 cycles": {
        "radar": {"carrier_hz": 300e9},
        "motion": WALK | {"range_m": 500.0},
    },
    "PRF 1 mHz": slow(1e-3, 200),
    "PRF 20 Hz": slow(20, 200),
    "PRF 1 MHz": slow(1e6, 200),
    **{f"gain {g} dBi": {"radar": {"antenna_gain_dbi": g}} for g in (-150, -120, 120, 150)},
    **{f"stature {h} m": {"subject": {"height_m": h}} for h in (0.1, 0.3, 3.0, 10.0)},
    **{f"weight {w:g} kg": {"subject": {"weight_kg": w}} for w in (1e-3, 1e6)},
    **{
        f"gait {g:g} Hz": {"radar": {"prf_hz": 5000}, "motion": WALK | {"paper": {"gait_hz": g}}}
        for g in (0, 1e-9, 50, 1000)
    },
    **{
        f"speed {s:g} m/s": {
            "radar": {"prf_hz": 5000},
            "motion": WALK | {"walking": {"speed_mps": s}},
        }
        for s in (0, 1e4)
    },
}
EDGES: dict[str, dict[str, Any]] = {
    "carrier 1e13 Hz": {"radar": {"carrier_hz": 1e13}},
    "range 1e6 m at 300 GHz": {"radar": {"carrier_hz": 300e9}, "motion": WALK | {"range_m": 1e6}},
    "PRF 10 MHz": slow(1e7, 200),
}
CASES = [(name, case, CUBE_ERROR) for name, case in RIGHT.items()]
CASES += [(name, case, EDGE_ERROR) for name, case in EDGES.items()]


@pytest.mark.parametrize(("name", "case", "error"), CASES, ids=[name for name, _, _ in CASES])
def test_signal(name: str, case: dict[str, Any], error: float) -> None:
    config = config_of("cube", **case)
    found, right = signal(config), exact_signal(config)
    direct = ref.error_db(signal(config_of("direct", **case)), found)
    print(f"{name}: cube {relative(found, right):.1e}, direct {direct:.0f} dB")
    assert np.abs(right).max() > 0
    assert relative(found, right) < error
    assert direct < DIRECT_DB


def test_a_gait_of_0_stands_still() -> None:
    """Punching without a rhythm is a posture: nothing is left after the MTI."""
    motion = WALK | {"paper": {"gait_hz": 0}}
    for engine in ("cube", "direct"):
        assert not signal(config_of(engine, motion=motion), "punching").any()


@pytest.mark.parametrize("engine", ["cube", "direct"])
@pytest.mark.parametrize("gain", [-150, -120, 120, 150])
def test_gains_are_linear(engine: str, gain: float) -> None:
    """G on both antennas: the amplitude is proportional to G, the image does not see it."""
    products = ("signal", "image:stft", "image:fsst")
    at_0 = record(config_of(engine, {"antenna_gain_dbi": 0}), *products)
    here = record(config_of(engine, {"antenna_gain_dbi": gain}), *products)
    error = relative(here["signal"].x[0, 0] / 10 ** (gain / 10), at_0["signal"].x[0, 0])
    print(f"gain {gain} dBi, {engine}: off a straight line by {error:.1e}")
    assert error < {"direct": 10 ** (DIRECT_DB / 20), "cube": 1e-12}[engine]
    for name in products[1:]:
        assert np.abs(here[name].levels.astype(int) - at_0[name].levels).max() <= 1


def test_rcs_from_1e_12_to_1e12() -> None:
    """Points of any RCS add up: the strong one does not spoil its own phase, nor the weak the sum.

    The weak point is 240 dB of power below the strong one, 1e-12 of its amplitude: it is there to
    the rounding of the sum.
    """
    waveform = Waveform(24e9, 1e9, 40e-6, 5e5, 1000, 0.2)

    def beat(*rcs: float) -> np.ndarray:
        ranges = np.array([2.0, 3.1])[: len(rcs), None]
        source = ref.Points(lambda t: ranges + 0.3 * t, np.sqrt(np.array(rcs)))
        return np.hstack([*beat_blocks(source, waveform)])

    unit = beat(1.0)
    for rcs in (1e-12, 1e12):
        assert relative(beat(rcs) / np.sqrt(rcs), unit) < 1e-14
    both = beat(1e12, 1e-12)
    weak = beat(0.0, 1e-12)
    found = both - beat(1e12, 0.0)
    error = relative(found, weak)
    print(f"RCS 1e-12 beside 1e12 m^2: the weak echo errs by {error:.0e} of itself")
    assert error < 1e-2


@pytest.mark.parametrize("height", [0.1, 0.3, 3.0, 10.0])
def test_persons_scale(height: float) -> None:
    """Every link keeps its length, h/1.8 of the reference person's, at every time."""
    config = config_of(subject={"height_m": height})
    motion = motion_of(nominal_scene(config, ACTIVITIES[7]).people[0])
    p = motion.positions(np.linspace(0, 2, 50))
    for joint, parent in enumerate(PARENTS):
        if parent is not None:
            right = np.linalg.norm(SKELETON[joint].link) * height / 1.8
            length = np.linalg.norm(p[:, joint] - p[:, parent], axis=0)
            assert length == pytest.approx(right, rel=1e-12, abs=1e-14), JOINTS[joint]


class TestSnr:
    """sigma^2 = P_s/10^(SNR/10) per raw sample, and that is what is measured."""

    PULSES = 4000

    def config(self, engine: str, snr_db: float | None) -> Config:
        return config_of(
            engine,
            {"prf_hz": 20000, "adc_rate_hz": 2e5},
            snr_db=snr_db,
            processing={"clutter": "none"},
        )

    @pytest.mark.parametrize("engine", ["cube", "direct"])
    @pytest.mark.parametrize("snr_db", [-300, -60, -10, 30, 90, 120])
    def test_measured(self, engine: str, snr_db: float) -> None:
        noisy, clean = self.config(engine, snr_db), self.config(engine, None)
        power = np.mean(np.sum(free_space_paths(clean)[1] ** 2, axis=0))
        variance = float(power) / 10 ** (snr_db / 10)
        gain = np.sum(np.abs(ref.sample_weights(radar_of(clean))) ** 2)
        recording = record(noisy, "noise", "signal")
        noise = recording["signal"].x[0, 0] - signal(clean)
        measured = np.mean(np.abs(noise) ** 2) / gain
        off_db = 10 * np.log10(measured / variance)
        print(f"SNR {snr_db} dB, {engine}: measured noise off by {off_db:+.2f} dB")
        assert recording["noise"].sigma ** 2 == pytest.approx(variance, rel=1e-6)
        assert noise.size == self.PULSES
        # 5 standard deviations of the mean of 4000 exponentials
        assert measured == pytest.approx(variance, rel=5 / np.sqrt(self.PULSES))

    @pytest.mark.parametrize("engine", ["cube", "direct"])
    def test_noise_below_the_rounding_of_a_double(self, engine: str) -> None:
        """At 300 dB the noise is 1e-15 of the signal: defined, drawn, and at rounding's size."""
        recording = record(self.config(engine, 300), "noise", "signal")
        assert recording["noise"].sigma > 0
        clean = signal(self.config(engine, None))
        assert relative(recording["signal"].x[0, 0], clean) < 1e-13

    @pytest.mark.parametrize("engine", ["cube", "direct"])
    def test_snr_null_adds_no_noise(self, engine: str) -> None:
        """Another seed changes nothing where there is no noise, and something where there is."""
        for snr_db, same in ((None, True), (120, False)):
            config = self.config(engine, snr_db)
            other = config.model_copy(update={"seed": 2})
            assert np.array_equal(signal(config), signal(other)) == same


class TestFewPulses:
    """One frame, one pulse more than a window, a filter as long as the signal."""

    PULSES = 100

    def config(self, engine: str, fraction: float, **processing: Any) -> Config:
        return config_of(
            engine,
            duration_s=0.1,
            processing={
                "window_s": 0.1 * fraction,
                "savgol": {"order": 3, "frame": 99},
                **processing,
            },
            maps=list(MAP_NAMES),
        )

    @pytest.mark.parametrize("engine", ["cube", "direct"])
    def test_one_frame(self, engine: str) -> None:
        """M is one pulse more than the window: with MTI exactly one frame is left."""
        config = self.config(engine, 0.99)
        names = [n for n in MAP_NAMES if n != "rtm"]
        images = [f"image:{name}" for name in MAP_NAMES]
        found = record(config, "signal", *MAP_NAMES, *images)
        x = found["signal"].x[0, 0]
        assert x.size == 99
        assert all(found[name].power.shape == (99, 1) for name in names)
        right = ref.stft(x, 99, 1)
        assert found["stft"].power == pytest.approx(right, rel=1e-5, abs=1e-6 * right.max())
        squeezed = np.fft.fftshift(np.abs(ref.fsst(x, 99, 1, 1e-3)) ** 2, axes=0)
        assert found["fsst"].power == pytest.approx(squeezed, rel=1e-5, abs=1e-6 * squeezed.max())
        for name in MAP_NAMES:
            assert found[f"image:{name}"].levels.max() >= 102  # that of the noise floor
            assert 0 < found[f"image:{name}"].entropy <= np.log2(found[name].power.size)

    @pytest.mark.parametrize("engine", ["cube", "direct"])
    def test_a_filter_as_long_as_the_signal_is_one_cubic(self, engine: str) -> None:
        config = self.config(engine, 0.5)
        found = record(config, "signal", "signal_denoised")
        x, t = found["signal"].x[0, 0], np.linspace(-1, 1, 99)
        for part in (np.real, np.imag):
            fit = np.polynomial.Polynomial.fit(t, part(x), 3)(t)
            assert part(found["signal_denoised"].x[0, 0]) == pytest.approx(
                fit, rel=1e-9, abs=1e-10 * np.abs(x).max()
            )

    def test_a_window_longer_than_the_signal_is_refused(self) -> None:
        """A window of all 100 pulses, of which the MTI leaves 99."""
        short = {"duration_s": 0.02, "processing": {"window_s": 0.02}}
        document = SCENE | {"radar": {"prf_hz": 5000}} | short
        with pytest.raises(ConfigError, match=r"processing.window_s = 0.02: .*\b99 pulses"):
            validated(Config, document, "here", {})


class TestEverythingAliases:
    """PRF 20 Hz at 77 GHz: PRF/2 is 2 cm/s. A window has its 8 pulses in the shortest drawing."""

    def config(self, engine: str, index: int = 0) -> Config:
        return Config.model_validate(
            SCENE
            | {
                "radar": {"prf_hz": 20, "adc_rate_hz": 5e5},
                "duration_s": {"uniform": [4, 8]},
                "processing": {"window_s": 0.4},
                "engine": {"kind": engine},
            }
        )

    @pytest.mark.parametrize("index", range(4))
    def test_drawn_durations(self, index: int) -> None:
        found = []
        for engine in ("cube", "direct"):
            scene = draw_scene(self.config(engine), ACTIVITIES[7], index)
            assert any("aliases" in warning for warning in scene_warnings(scene))
            asked = ["signal", "frames", "stft", "fsst", "rtm", "image:stft", "image:fsst"]
            recording = record_scene(scene, asked)
            assert 8 <= recording["frames"].length <= 16
            assert recording["image:fsst"].levels.max() >= 102  # that of the noise floor
            found.append(recording["signal"].x[0, 0])
        error = ref.error_db(found[1], found[0])
        print(f"PRF 20 Hz, {found[0].size} pulses drawn: direct {error:.0f} dB")
        assert error < DIRECT_DB


def test_closer_than_5_cm_is_refused() -> None:
    near = {"tx_m": [1.951, 0, 1.2], "rx_m": [1.951, 0, 1.2]}
    motion = {"range_m": 2.0, "angle_deg": 0.0}
    config = config_of(radar=near, motion=motion)
    with pytest.raises(SceneError, match=r"torso comes to 4.9 cm .*\(radar.[tr]x_m\)"):
        scene_warnings(nominal_scene(config, ACTIVITIES[7]))
    config = config_of(radar=AT_5_CM, motion=motion)
    scene_warnings(nominal_scene(config, ACTIVITIES[7]))
