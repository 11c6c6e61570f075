"""The promise of `tolerance_db`: never exceeded, refused only where it must be."""

import numpy as np
import pytest
import reference as ref
from radhar_cli.body.skeleton import JOINTS
from radhar_cli.config.experiment import Config
from radhar_cli.pipeline.body_paths import BodyPaths
from radhar_cli.pipeline.models import waveform_of
from radhar_cli.scenario import draw_scene

from radhar_cli.activity import ACTIVITIES, Activity
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.errors import SceneError
from radhar_cli.pipeline.plan import plan
from radhar_cli.pipeline.run import run
from radhar_cli.radar.waveform import Waveform

SAID_DB = 6.0
CUBE = {"kind": "cube"}


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def random_config(rng: np.random.Generator) -> dict:
    """Any radar from 1 to 140 GHz at any PRF, a fifth of them before a wall."""
    carrier, prf = log_uniform(rng, 1e9, 140e9), log_uniform(rng, 64, 20000)
    chirp = log_uniform(rng, min(1e-5, 0.4 / prf), 0.9 / prf)
    pulses = min(4.0 * prf, log_uniform(rng, 80, 3000))
    return {
        "seed": int(rng.integers(2**31)),
        "snr_db": None,
        "duration_s": pulses / prf,
        "radar": {
            "carrier_hz": carrier,
            "bandwidth_hz": carrier * log_uniform(rng, 1e-3, 0.5),
            "prf_hz": prf,
            "chirp_s": chirp,
            "adc_rate_hz": int(rng.integers(2, 200)) / chirp,
            "residual_video_phase": bool(rng.random() < 0.2),
        },
        "processing": {
            "range_reference": "centre" if rng.random() < 0.8 else "start",
            "window_fraction": 0.5,
        },
        "motion": {
            "range_m": {"uniform": [0.8, 8]},
            "angle_deg": {"uniform": [-180, 180]},
            "gait_hz": {"uniform": [0.3, 3]},
        },
        # Both phases of an activity within however short a recording.
        "timing": {
            name: part * pulses / prf
            for name, part in {
                "seat_start_s": 0.1,
                "seat_duration_s": 0.6,
                "rise_start_s": 0.1,
                "rise_duration_s": 0.4,
                "walk_start_s": 0.5,
                "walk_stop_s": 0.4,
                "sit_duration_s": 0.4,
                "fall_duration_s": 0.3,
                "blend_s": float(rng.choice([0.0, 0.1])),
            }.items()
        }
        if rng.random() < 0.5 and pulses / prf > 1
        else {},
        "wall": {"center_m": [float(rng.uniform(0.8, 4)), 0, 1.25]} if rng.random() < 0.2 else None,
    }


def cube_signal(drawn: dict, activity: Activity) -> tuple[np.ndarray, BodyPaths, Waveform]:
    config = Config.model_validate(drawn | {"engine": CUBE})
    scene = draw_scene(config, activity, 0)
    recording = run(plan(config, ["signal:plain"]), scene, config)
    return (
        recording.products["signal:plain"],
        recording.products["paths"],
        waveform_of(scene, config),
    )


def within(drawn: dict, activity: Activity, tolerance_db: float) -> float | None:
    """The true error (dB) of a random scene, which keeps its tolerance; None where refused."""
    right, paths, waveform = cube_signal(drawn, activity)
    mti = drawn["processing"].get("mti", True)
    canceller = (-1.0, 1.0) if mti else (1.0,)
    try:
        y, accuracy = DirectEcho(paths, waveform, tolerance_db, canceller=canceller).slow_time()
    except AccuracyError as error:
        assert tolerance_db < -100, (activity.slug, waveform, error)
        return None
    found = np.diff(y) if mti else y
    if not right.any():
        assert not found.any()
        return -np.inf
    error_db = ref.error_db(found, right)
    assert error_db <= tolerance_db, (activity.slug, waveform, accuracy)
    # What is said of it is what it is: an estimate from some dozens of pulses.
    assert error_db == pytest.approx(accuracy.error_db, abs=SAID_DB), (activity.slug, waveform)
    return error_db


@pytest.mark.parametrize("block", range(4))
def test_the_tolerance_is_kept(block):
    """48 random scenes, every activity four times, tolerances from -20 to -120 dB."""
    rng = np.random.default_rng(1000 + block)
    found = [
        within(random_config(rng), ACTIVITIES[number % 12], float(rng.uniform(-120, -20)))
        for number in range(48)
    ]
    assert sum(error is not None and np.isfinite(error) for error in found) >= 30


def test_without_mti_it_is_that_of_the_whole_signal():
    """24 scenes more; what stands still counts, so that every one has a signal."""
    rng = np.random.default_rng(7)
    for number in range(24):
        tolerance_db, drawn = float(rng.uniform(-120, -20)), random_config(rng)
        drawn["processing"]["mti"] = False
        within(drawn, ACTIVITIES[number % 12], tolerance_db)


CONFIG = {"snr_db": None, "duration_s": 0.5, "radar": {"prf_hz": 2000}, "maps": ["stft"]}


class TestRefusal:
    def signal(self, engine: dict, **more: object) -> np.ndarray:
        config = Config.model_validate(CONFIG | {"engine": engine} | more)
        scene = draw_scene(config, ACTIVITIES[7], 0)
        return run(plan(config, ["signal:plain"]), scene, config).products["signal:plain"]

    def test_names_sample_key_value_and_what_would_do(self):
        with pytest.raises(
            SceneError, match=r"walking/0: engine\.tolerance_db = -300: .* -\d+ or "
        ):
            self.signal({"tolerance_db": -300})

    def test_says_so_where_no_budget_can_be_kept(self):
        """Feet that stand still to an ulp, alone: what moves is rounding, in either engine."""
        config = Config.model_validate(CONFIG | {"duration_s": 2.0})
        scene = draw_scene(config, ACTIVITIES[5], 0)
        with pytest.raises(
            SceneError, match=r"no budget can be kept here .* engine\.fallback: cube"
        ):
            run(plan(config, ["signal:plain"]), scene, config, (JOINTS.index("right_ankle"),))

    @pytest.mark.parametrize("mti", [True, False])
    def test_falls_back_to_the_cube_itself(self, mti):
        processing = {"processing": {"mti": mti}}
        right = self.signal(CUBE, **processing)
        found = self.signal({"tolerance_db": -300, "fallback": "cube"}, **processing)
        assert np.array_equal(found, right)

    def test_noise_of_a_fallback_has_the_right_size(self):
        engine = {"tolerance_db": -300, "fallback": "cube"}
        quiet, noisy = (self.signal(engine, snr_db=snr) for snr in (None, 0.0))
        direct = self.signal({}, snr_db=0.0) - self.signal({})
        assert np.std(noisy - quiet) == pytest.approx(np.std(direct), rel=1e-6)

    def test_a_range_map_alone_asks_nothing_of_the_budget(self):
        config = Config.model_validate(
            CONFIG | {"engine": {"tolerance_db": -300}, "maps": ["rtm"], "snr_db": 10}
        )
        scene = draw_scene(config, ACTIVITIES[7], 0)
        assert run(plan(config, ["rtm"]), scene, config).products["rtm"].any()

    def test_double_is_double(self):
        assert not np.array_equal(self.signal({}), self.signal({"precision": "double"}))
