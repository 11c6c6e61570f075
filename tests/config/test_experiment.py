"""The whole config: limits, identity of a data set, frozen sections."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from helpers.boards import CFG
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from radhar_cli.config import (
    MAP_NAMES,
    Config,
    config_hash,
    resolved,
    timing_warnings,
)
from radhar_cli.config.motion import EARLIER_KEYS
from radhar_cli.config.people import PersonConfig, SubjectConfig
from radhar_cli.config.radar import ArrayConfig, BeamConfig
from radhar_cli.config.receiver import ToneConfig
from radhar_cli.config.recordings import RecordingsConfig
from radhar_cli.config.room import BoxConfig, FacesConfig, LayerConfig, ReflectorConfig
from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.config.stream import StreamConfig
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.schema.number import Uniform
from radhar_cli.schema.section import Section


def test_the_defaults_of_the_paper_are_its_free_space_data_set() -> None:
    config = Config(motion={"model": "paper"})
    assert (config.samples_per_class, config.duration_s, config.snr_db) == (300, 4.0, 30.0)
    assert config.chosen_activities == ACTIVITIES
    radar = config.radar
    assert (radar.carrier_hz, radar.bandwidth_hz, radar.prf_hz) == (77e9, 4e9, 5000)
    assert (radar.adc_rate_hz, radar.chirp_s) == (10e6, 40e-6)
    assert (radar.tx_m, radar.rx_m) == ((0.4, -0.1, 1.5), (0.4, 0.1, 1.5))
    assert (config.split.train, config.split.validation) == (0.8, 0.2)
    assert config.wall is None
    assert config.snr_reference == "free_space"
    assert config.on_invalid == "keep"
    assert config.processing.window_s == 0.4


def test_activities_keep_their_order_which_labels_follow_and_maps_have_one_of_their_own() -> None:
    config = Config(activities=("S12", "walking", "s2"), maps=("fsst", "rtm", "stft"))
    assert [a.label for a in config.chosen_activities] == ["S12", "S8", "S2"]
    assert config.maps == ("rtm", "stft", "fsst")
    assert len(MAP_NAMES) == 9


# The possible side of every limit whose impossible side test_reading.py tries.
POSSIBLE: list[dict[str, Any]] = [
    {"samples_per_class": 3, "split": {"by": "subject", "subjects": 3}},
    {"radar": {"prf_hz": 24999}},
    {"radar": {"adc_rate_hz": 3.75e4}},
    {"radar": {"adc_rate_hz": 26.2144e9}},
    {"processing": {"range_fft_length": 400}},
    {"duration_s": 4e-4, "maps": ("rtm",)},
    {"duration_s": 0.0002, "maps": ("rtm",), "radar": {"prf_hz": 1e4}},
    {"duration_s": 0.015},
    {"duration_s": 0.0102, "processing": {"window_s": 0.01}},
    {"duration_s": 0.01, "processing": {"window_s": 0.0099, "clutter": "none"}},
    {
        "duration_s": 0.0204,
        "maps": ("stft_denoised",),
        "processing": {"savgol": {"order": 3, "frame": 101}},
    },
    {"duration_s": 0.02, "processing": {"savgol": {"order": 3, "frame": 101}}},
    {"processing": {"stft_fft_length": 2000}},
    {"wall": {}, "radar": {"tx_m": (0.8799, 0.0, 1.0)}},
    {"wall": {"eps_r": 1, "loss_tangent": 0}, "radar": {"tx_m": (0.4, 0.0, 2.6)}},
    {
        "motion": {
            "model": "paper",
            "walking": {"speed_mps": 0},
            "paper": {"gait_hz": 0},
            "range_m": -1,
        }
    },
    {"engine": {"kind": "cube", "motion_in_chirp": True}},
    {"motion": {"model": "paper"}, "timing": {"blend_s": 0, "rise_duration_s": 0}},
]


@pytest.mark.parametrize("values", POSSIBLE, ids=str)
def test_values_at_the_limits_are_accepted(values: dict[str, Any]) -> None:
    Config(**values)


def test_sections_are_frozen() -> None:
    config = Config(
        motion={"model": "paper"}, wall={}, subject={"height_m": {"uniform": [1.5, 1.9]}}
    )
    frozen = [config, *_sections(config), config.subject.height_m]
    assert len(frozen) > 14
    for section in frozen:
        key = next(iter(type(section).model_fields))
        with pytest.raises(ValidationError, match="frozen"):
            setattr(section, key, getattr(section, key))


def _sections(section: Section) -> Iterator[Section]:
    for key, field in type(section).model_fields.items():
        inner = getattr(section, key)
        if field.exclude:  # another spelling
            continue
        if isinstance(inner, Section):
            yield inner
            yield from _sections(inner)


def _keys(section: Section, prefix: str = "") -> Iterator[str]:
    for key, field in type(section).model_fields.items():
        inner = getattr(section, key)
        if field.exclude:  # another spelling
            continue
        if isinstance(inner, Section):
            yield from _keys(inner, f"{prefix}{key}.")
        else:
            yield prefix + key


def changed(section: Section, key: str, value: object) -> Any:
    """A copy with one dotted key changed, whether or not the whole is still consistent."""
    first, _, rest = key.partition(".")
    inner = changed(getattr(section, first), rest, value) if rest else value
    return section.model_copy(update={first: inner})


WITH_WALL = Config(motion={"model": "paper"}, wall={})
OF_THE_PAPER = {
    f"motion.{name}"
    for name in ("speed_mps", "gait_hz", "thigh_deg", "calf_deg", "arm_deg", "turn_deg")
}
OF_OTHER_MOVEMENTS = tuple(
    f"motion.{section}."
    for section in (
        *("running", "limping", "aids", "carrying", "crawling", "gestures", "kneeling", "lying"),
    )
)
OF_PEOPLE_ALONE = (
    *(key for key in _keys(WITH_WALL) if key.startswith(OF_OTHER_MOVEMENTS)),
    *(
        f"subject.{name}"
        for name in SubjectConfig.model_fields
        if name not in ("height_m", "weight_kg")
    ),
    *(
        key
        for key, earlier in EARLIER_KEYS.items()
        if earlier not in OF_THE_PAPER and key != "motion.falling.direction"
    ),
    *("timing.grab_start_s", "timing.grab_duration_s", "timing.overlap_s"),
)
# Keys that a config of a radar alone does not write.
OF_SEVERAL = {"radars", "radar_name", "other_radars"}
CHANGES: dict[str, object] = {
    "seed": 2,
    "samples_per_class": 299,
    "activities": ("walking",),
    "duration_s": 3.0,
    "radar.carrier_hz": 2e9,
    "radar.bandwidth_hz": 1e9,
    "radar.prf_hz": 128.0,
    "radar.adc_rate_hz": 5e6,
    "radar.chirp_s": 20e-6,
    "radar.tx_m": (0.4, -0.1, 1.4),
    "radar.rx_m": (0.4, 0.1, 1.4),
    "radar.antenna_gain_dbi": 7.0,
    "radar.antenna_isolation_db": 20.0,
    "radar.residual_video_phase": True,
    "radar.polarisation": "horizontal",
    "radar.beam": BeamConfig(),
    "radar.cfg": CFG.replace("frameCfg 0 2 32", "frameCfg 0 2 16"),
    "radar.device": "IWR6843ISK",
    "radar.array": ArrayConfig(),
    "radar.position_m": (0.0, 0.0, 1.5),
    "radar.yaw_deg": 5.0,
    "radar.tilt_deg": 5.0,
    "radar.roll_deg": 5.0,
    "radar.half_power_deg": (20.0, 10.0),
    "radar.half_wavelength_m": 1.9e-3,
    "radar.transmit_power_dbm": 10.0,
    "radar.output": "real",
    "radar.steps": 100,
    "radar.dwell_s": 1e-5,
    "radar.profile_m": (0.0, 5.0),
    "radar.profile_samples": 128,
    "subject.height_m": Uniform(uniform=(1.5, 1.8)),
    "subject.weight_kg": 80.0,
    "motion.place.range_m": 3.0,
    "motion.place.cross_range_m": 0.1,
    "motion.place.instant": 0.1,
    "motion.range_m": 2.0,
    "motion.cross_range_m": 0.1,
    "motion.angle_deg": 0.0,
    "motion.walking.speed_mps": 1.4,
    "motion.paper.gait_hz": 1.1,
    "motion.paper.thigh_deg": 30.0,
    "motion.paper.calf_deg": 45.0,
    "motion.paper.arm_deg": 35.0,
    "motion.rotating.turn_deg": 45.0,
    "motion.model": "human",
    "motion.falling.direction": "sideways",
    "classes": {"coming_home": SequenceConfig(sequence=("walking",))},
    **dict.fromkeys(OF_PEOPLE_ALONE, 0.123),
    "timing.onset": 0.1,
    "timing.visible": 0.9,
    "timing.seat_start_s": 0.6,
    "timing.seat_duration_s": 1.0,
    "timing.rise_start_s": 0.6,
    "timing.rise_duration_s": 1.0,
    "timing.walk_begin_s": 0.4,
    "timing.walk_start_s": 2.1,
    "timing.walk_stop_s": 2.1,
    "timing.sit_duration_s": 1.0,
    "timing.fall_duration_s": 0.9,
    "timing.blend_s": 0.0,
    "wall.center_m": (1.0, 0.0, 1.2),
    "wall.size_m": (0.2, 5.0, 2.5),
    "wall.eps_r": 4.0,
    "wall.loss_tangent": 0.02,
    "wall.rays": "refracted",
    "wall.fresnel": "parallel",
    "wall.echoes": "exact",
    "wall.layers": (LayerConfig(material="brick"),),
    "body.scatterers": "segments",
    "body.points_per_segment": 6,
    "body.cross_section_sd_db": 3.0,
    "body.shadowing": False,
    "snr_db": None,
    "people": (PersonConfig(),),
    "room.reflectors": (ReflectorConfig(),),
    "room.box_m": BoxConfig(),
    "room.faces": FacesConfig(floor="wood"),
    "room.order": 2,
    "room.back_wall_m": 9.0,
    "room.back_wall_reflection_db": -6.0,
    "receiver.noise_corner_hz": 3.0,
    "receiver.noise_slope_db": 20.0,
    "receiver.tones": (ToneConfig(doppler_hz=100.0),),
    "receiver.noise_figure_db": 10.0,
    "receiver.channel_gain_db": 1.0,
    "receiver.channel_phase_deg": 10.0,
    "receiver.channel_errors": "sample",
    "snr_reference": "received",
    "on_invalid": "redraw",
    "processing.clutter": "mean",
    "processing.highpass.order": 2,
    "processing.highpass.cutoff_hz": 5.0,
    "processing.highpass.zero_phase": True,
    "processing.highpass.remove_mean": False,
    "processing.range_sum": "gated",
    "processing.gate_m": 0.5,
    "processing.gate_sum": "magnitude",
    "processing.range_fft_length": 512,
    "processing.range_reference": "start",
    "processing.range_gain_power": 2.0,
    "processing.range_window": "taylor",
    "processing.range_sidelobes_db": 40.0,
    "processing.window_s": 0.3,
    "processing.overlap_fraction": 0.5,
    "processing.stft_fft_length": 4096,
    "processing.savgol.order": 3,
    "processing.savgol.frame": 13,
    "processing.fsst_hop_pulses": 1,
    "processing.fsst_threshold": 0.0,
    "cloud.boundary_box": True,
    "cloud.chain": "board",
    "cloud.pfa": 1e-3,
    "cloud.quantise": False,
    "cloud.doppler_carrier": "start",
    "image.size_px": (128, 256),
    "image.dynamic_range_db": 40.0,
    "image.reference": "peak",
    "image.colour_map": "gray",
    "image.kind": "cfar",
    "image.clipped": 0.05,
    "image.doppler_limits_mps": (-3.0, 3.0),
    "image.range_limits_m": (0.5, 5.0),
    "image.cadence_limit_hz": 4.0,
    "image.cfar.guard": (9, 2),
    "image.cfar.training": (40, 10),
    "image.cfar.pfa": 0.1,
    "image.cfar.domain": "power",
    "image.cfar.floor_db": 20.0,
    "image.cfar.edges": "shrink",
    "maps": ("stft", "rtm"),
    "split.by": "subject",
    "split.train": 0.7,
    "split.validation": 0.1,
    "split.test": 0.1,
    "split.subjects": 10,
    "engine.kind": "cube",
    "engine.tolerance_db": -100.0,
    "engine.fallback": "cube",
    "engine.precision": "double",
    "engine.motion_in_chirp": True,
    "output.png": False,
    "output.column_labels": True,
    "output.png_level": 9,
    "output.hdf5_level": 9,
    "output.power": "float16",
    "output.slow_time": True,
    "output.products": ("torso_track",),
    "output.license": "cc-by-4.0",
    "stream": StreamConfig(),
    "recordings": RecordingsConfig(window_s=2.0),
}


PAPER_RADARS = [
    {"waveform": "fmcw"},
    {"waveform": "sfcw", "steps": 64, "dwell_s": 1e-6},
    {"waveform": "cw"},
    {"waveform": "impulse", "carrier_hz": 6e9, "bandwidth_hz": 1e9, "profile_m": [0, 2]},
    {"cfg": CFG, "device": "IWR1443BOOST"},
]
BASES = [
    Config(motion={"model": "paper"}, wall={}, radar=radar, maps=["rtm"])
    if radar.get("waveform") != "cw"
    else Config(motion={"model": "paper"}, wall={}, radar=radar)
    for radar in PAPER_RADARS
]


def base_with(key: str) -> Config:
    """The first config whose radar has a key."""
    return next(base for base in BASES if key in _keys(base))


def test_the_table_of_changes_knows_every_key() -> None:
    keys = {key for base in BASES for key in _keys(base)}
    assert set(CHANGES) == keys - {"radar.waveform", "radar.subframe", *OF_SEVERAL}


@pytest.mark.parametrize("key", list(CHANGES))
def test_the_identity_is_every_key_that_decides_bytes(key: str) -> None:
    base = base_with(key)
    same = config_hash(changed(base, key, CHANGES[key])) == config_hash(base)
    assert same == (key in ("output.png", "output.license"))


def test_the_identity_tells_radars_apart() -> None:
    assert len({config_hash(base) for base in BASES}) == len(BASES)


def test_the_identity_tells_subframes_apart() -> None:
    cfg = (Path(__file__).parents[1] / "radar/cfg/advframe.cfg").read_text()
    radars = [{"device": "IWR1443BOOST", "cfg": cfg, "subframe": number} for number in (0, 1)]
    assert len({config_hash(Config(radar=radar)) for radar in radars}) == 2


def test_the_identity_tells_a_wall_from_none() -> None:
    assert config_hash(Config()) != config_hash(WITH_WALL)


def test_the_identity_ignores_how_a_config_is_written() -> None:
    terse = Config(activities=("S8",), motion={"model": "paper", "range_m": 2})
    wordy = Config(
        motion={"walking": {"speed_mps": 1.5}, "range_m": 2.0, "model": "paper"},
        activities=("walking",),
        seed=1,
        wall=None,
    )
    assert config_hash(terse) == config_hash(wordy)


NUMBERS = st.one_of(
    st.floats(0.5, 2.5),
    st.tuples(st.floats(0.5, 1), st.floats(1, 2.5)).map(lambda pair: {"uniform": pair}),
    st.floats(1, 2).map(lambda mean: {"normal": [mean, 0.1], "min": 0.5}),
    st.lists(st.floats(0.5, 2.5), min_size=1, max_size=4).map(lambda drawn: {"choice": drawn}),
    st.tuples(st.floats(0.5, 2.5), st.floats(0, 0.5)).map(lambda pair: {"vary": pair}),
)
BY_ACTIVITY = st.dictionaries(st.sampled_from([a.slug for a in ACTIVITIES]), NUMBERS)


@given(NUMBERS, NUMBERS, BY_ACTIVITY, st.sampled_from([None, {}, {"eps_r": 4}]))
@settings(deadline=None, max_examples=40)
def test_a_resolved_config_is_the_config(
    height: Any, default: Any, by_activity: dict[str, Any], wall: Any
) -> None:
    config = Config(
        subject={"height_m": height},
        motion={"model": "paper", "range_m": {"per_activity": {"default": default, **by_activity}}},
        wall=wall,
    )
    again = Config.model_validate(json.loads(json.dumps(resolved(config))))
    assert again == config
    assert config_hash(again) == config_hash(config)


def test_a_resolved_config_names_every_key() -> None:
    found = resolved(WITH_WALL)
    for key in set(_keys(WITH_WALL)) - OF_SEVERAL:
        value: Any = found
        for name in key.split("."):
            value = value[name]


@pytest.mark.parametrize(
    ("label", "key"),
    [
        ("S5", "seat_start_s"),
        ("S6", "seat_start_s"),
        ("S9", "walk_start_s"),
        ("S10", "walk_stop_s"),
        ("S11", "walk_start_s"),
        ("S12", "walk_stop_s"),
    ],
)
def test_a_recording_too_short_for_the_second_phase_is_warned_of(label: str, key: str) -> None:
    long_enough = Config(activities=(label,), duration_s=2.01)
    assert timing_warnings(long_enough) == []
    (message,) = timing_warnings(Config(activities=(label,), duration_s=2.0, timing={key: 2.0}))
    assert label in message
    assert activity_named(label).slug in message
    assert f"timing.{key} = 2 s" in message


def test_activities_without_a_second_phase_are_never_too_short() -> None:
    config = Config(activities=("S1", "S2", "S3", "S4", "S7", "S8"), duration_s=0.1)
    assert timing_warnings(config) == []


def test_timing_warnings_follow_the_activity() -> None:
    late = {"per_activity": {"default": 2.0, "S12": 7.0}}
    messages = timing_warnings(Config(timing={"walk_stop_s": late}))
    assert [line.split()[0] for line in messages] == ["S12"]
