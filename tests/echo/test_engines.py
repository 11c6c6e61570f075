"""Both engines give the same slow-time signal, for every activity and many radars."""

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.config.data_set import Config
from radhar_cli.motion.activities.activity import ACTIVITIES, Activity
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene

# The default tolerance; what the maps show is 50 dB deep.
DEFAULT_DB = -80
TIGHT_DB = -110

# Both phases of every activity within 1.5 s, at ends that fall between pulses and on them. The
# shortest ramps, blend and fall, keep their default length: no motion is faster than it would be.
SOON = {
    "seat_start_s": 0.21,
    "seat_duration_s": 1.0,
    "rise_start_s": 0.1,
    "rise_duration_s": 0.77,
    "walk_start_s": 0.9,
    "walk_stop_s": 0.5137,
    "sit_duration_s": 0.8,
}
FAST = {"duration_s": 1.5, "timing": SOON}


def radar(carrier_ghz: float, bandwidth_ghz: float, prf: float, **more: object) -> dict:
    return {"carrier_hz": carrier_ghz * 1e9, "bandwidth_hz": bandwidth_ghz * 1e9, "prf_hz": prf} | (
        more
    )


CASES = {
    "free space 77 GHz": {},
    "through the wall 2 GHz": {"radar": radar(2, 1, 128), "wall": {}},
    "through the wall, high PRF": FAST | {"radar": radar(2, 1, 2000), "wall": {}},
    "plane wave through a wall": FAST | {"radar": radar(2, 1, 2000), "wall": {"rays": "plane"}},
    "refracted, Fresnel by angle": FAST
    | {"radar": radar(2, 1, 2000), "wall": {"rays": "refracted", "fresnel": "parallel"}},
    "24 GHz 1 kHz": FAST | {"radar": radar(24, 1, 1000)},
    "60 GHz, 7 GHz wide": FAST | {"radar": radar(60, 7, 5000)},
    "narrow band": FAST | {"radar": radar(77, 0.04, 3000)},
    "5.8 GHz 400 Hz, odd N_ADC": FAST
    | {"radar": radar(5.8, 0.4, 400, adc_rate_hz=2e6, chirp_s=50.5e-6)},
    "odd N_ADC, interpolated": FAST | {"radar": radar(24, 1, 2000, chirp_s=10.1e-6)},
    "eight samples a chirp": FAST | {"radar": radar(77, 4, 3000, adc_rate_hz=2e5)},
    "zero-padded range FFT": FAST
    | {"radar": radar(10, 1, 1000), "processing": {"range_fft_length": 1024}},
    "range reference start": FAST
    | {"radar": radar(77, 4, 5000), "processing": {"range_reference": "start"}},
    "residual video phase": FAST | {"radar": radar(77, 4, 2000, residual_video_phase=True)},
    "hard switch": FAST | {"radar": radar(77, 4, 2000), "timing": SOON | {"blend_s": 0}},
    "fast gait": FAST | {"radar": radar(77, 4, 3000), "motion": {"paper": {"gait_hz": 2.5}}},
    "past the antennas": FAST
    | {"radar": radar(77, 4, 3000), "motion": {"range_m": 1.2, "angle_deg": 180}},
}
# Every case with three activities and every activity with four cases; the other pairs are slow.
PAIRS = [
    pytest.param(case, activity, marks=() if (i + j) % 4 == 0 else pytest.mark.slow)
    for i, case in enumerate(CASES)
    for j, activity in enumerate(ACTIVITIES)
]


def config_of(case: str, engine: dict, **more: object) -> Config:
    document = {"snr_db": None} | CASES[case] | {"engine": engine} | more
    document["motion"] = {"model": "paper"} | document.get("motion", {})
    return Config.model_validate(document)


def signal(activity: Activity, config: Config) -> np.ndarray:
    return record(draw_scene(config, activity, 0), ["signal"])["signal"].x[0, 0]


@pytest.mark.parametrize(
    ("case", "activity"), PAIRS, ids=lambda one: getattr(one, "slug", str(one))
)
def test_engines_agree(case, activity):
    right = signal(activity, config_of(case, {"kind": "cube"}))
    default = signal(activity, config_of(case, {"kind": "direct"}))
    tight = signal(activity, config_of(case, {"kind": "direct", "tolerance_db": TIGHT_DB}))
    assert default.shape == tight.shape == right.shape
    if activity.slug == "stationary":
        assert not right.any()
        assert not default.any()
        assert not tight.any()
    else:
        default_error, tight_error = (ref.error_db(found, right) for found in (default, tight))
        assert default_error < DEFAULT_DB
        assert tight_error < TIGHT_DB


@pytest.mark.parametrize(
    "case", ["free space 77 GHz", "through the wall 2 GHz", "eight samples a chirp", "24 GHz 1 kHz"]
)
@pytest.mark.parametrize("slug", ["stationary", "walking_to_falling"])
@pytest.mark.parametrize("tolerance_db", [DEFAULT_DB, TIGHT_DB])
def test_engines_agree_without_mti(case, slug, tolerance_db):
    """Then what stands still counts too, and the tolerance is that of the whole signal."""
    activity = next(a for a in ACTIVITIES if a.slug == slug)
    processing, direct = {"clutter": "none"}, {"kind": "direct", "tolerance_db": tolerance_db}
    right, found = (
        signal(activity, config_of(case, engine, processing=processing))
        for engine in ({"kind": "cube"}, direct)
    )
    assert np.abs(right).max() > 0
    assert ref.error_db(found, right) < tolerance_db


@pytest.mark.parametrize("case", ["free space 77 GHz", "through the wall, high PRF"])
@pytest.mark.parametrize("reference", ["free_space", "received"])
def test_engines_agree_on_the_signal_power(case, reference):
    """1e-6 is 4e-6 dB of SNR."""
    powers = []
    for kind in ("cube", "direct"):
        config = config_of(case, {"kind": kind}, snr_db=20, snr_reference=reference)
        powers.append(record(draw_scene(config, ACTIVITIES[11], 0), ["signal_power"]))
    cube, direct = (recording["signal_power"] for recording in powers)
    assert direct == pytest.approx(cube, rel=1e-6)
