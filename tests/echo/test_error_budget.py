"""The promise of `tolerance_db`: never exceeded, seldom wasted, refused only where it must be."""

from dataclasses import asdict
from statistics import median

import numpy as np
import pytest
import reference as ref
from radhar_cli.pipeline.body_paths import BodyPaths
from radhar_cli.pipeline.models import waveform_of

from radhar_cli.activity import ACTIVITIES, Activity
from radhar_cli.config.schema import Config
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.error_budget import BudgetError
from radhar_cli.errors import SceneError
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.pipeline.plan import plan
from radhar_cli.pipeline.run import run
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scene import draw_scene

# The issue that brought the budget asks for these; a bound that is loose by 30 dB is 5 times too
# many knots.
WASTE_DB, EXCUSED = 30.0, 0.2
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


@pytest.mark.parametrize("block", range(4))
def test_the_budget_is_kept_and_used(block):
    """48 random scenes, every activity four times, budgets from -20 to -120 dB."""
    rng = np.random.default_rng(1000 + block)
    slack, excused, still, refused = [], 0, 0, 0
    for number in range(48):
        activity, budget = ACTIVITIES[number % 12], float(rng.uniform(-120, -20))
        right, paths, waveform = cube_signal(random_config(rng), activity)
        echo = DirectEcho(paths, waveform, budget)
        if echo.beyond_reach:
            assert budget < -100, (activity.slug, waveform, echo.beyond_reach)
            refused += 1
            continue
        found = np.diff(echo.slow_time())
        if not right.any():
            assert not found.any()
            still += 1
            continue
        error = ref.error_db(found, right)
        assert error <= budget, (activity.slug, waveform, echo.settings)
        if echo.settings.cheapest:
            excused += 1
        else:
            slack.append(budget - error)
    print(
        f"{still} scenes without motion, {refused} refused below -100 dB, {excused} excused "
        f"(nothing cheaper exists), {len(slack)} others {median(slack):.1f} dB within their "
        f"budget in the median, {min(slack):.1f} at least"
    )
    assert len(slack) + excused >= 30
    assert median(slack) < WASTE_DB
    assert excused <= EXCUSED * (len(slack) + excused)


def test_without_mti_the_budget_is_that_of_the_whole_signal():
    """24 scenes more; what stands still counts, so that every one has a signal."""
    rng = np.random.default_rng(7)
    for number in range(24):
        activity, budget = ACTIVITIES[number % 12], float(rng.uniform(-120, -20))
        drawn = random_config(rng)
        drawn["processing"]["mti"] = False
        right, paths, waveform = cube_signal(drawn, activity)
        echo = DirectEcho(paths, waveform, budget, mti=False)
        assert ref.error_db(echo.slow_time(), right) <= budget, (activity.slug, waveform)


RADAR = ref.Radar(adc_rate=1e6, duration=0.5)


def walk(t: np.ndarray) -> np.ndarray:
    return (2 + 1.5 * t)[None]


def echo_of(budget: float, **more: float | int) -> DirectEcho:
    return DirectEcho(ref.Points(walk), Waveform(**asdict(RADAR) | more), budget)


def test_every_term_is_within_what_it_was_given():
    for budget in np.arange(-150.0, -10.0, 10):
        bounds = echo_of(float(budget)).settings.bounds_db
        assert set(bounds) == {"interpolation", "table", "rounding"}
        together = sum(10 ** (bound / 20) for bound in bounds.values())
        assert 20 * np.log10(together) <= budget


def test_tighter_budgets_never_take_less():
    found = [echo_of(float(budget)).settings for budget in np.arange(-10.0, -200, -10)]
    assert [s.step for s in found] == sorted((s.step for s in found), reverse=True)
    assert [s.table_oversampling for s in found] == sorted(s.table_oversampling for s in found)
    assert [s.single for s in found] == sorted((s.single for s in found), reverse=True)
    assert found[0].single
    assert not found[-1].single


def test_the_limit_that_a_refusal_names_can_be_kept():
    """And a dB less cannot: it is the limit, not a guess."""
    refusal = echo_of(-390.0).beyond_reach
    assert isinstance(refusal, BudgetError)
    assert echo_of(refusal.limit_db + 1).beyond_reach is None
    assert echo_of(refusal.limit_db - 1).beyond_reach is not None


def test_float64_says_less_of_a_signal_of_which_the_mti_leaves_less():
    """A phase is held to 1e-16 of its cycles, whatever the PRF; x shrinks with it."""
    slow, fast = (
        echo_of(-150.0, prf=prf).settings.bounds_db["rounding"] for prf in (5000.0, 20000.0)
    )
    assert fast == pytest.approx(slow + 12, abs=1)
    assert slow < -190


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
