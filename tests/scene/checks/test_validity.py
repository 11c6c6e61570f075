"""Scenes outside the model are found before any echo: kept with a warning, redrawn or refused."""

import re
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config, load_config
from radhar_cli.echo.motion_in_chirp import moving_beat_matrix
from radhar_cli.echo.paths import Paths
from radhar_cli.errors import SceneError
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.wall import crossing, extra_delay
from radhar_cli.scene.checks import drawing
from radhar_cli.scene.checks.check_grid import check_grids
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import BEHIND_M, Flags
from radhar_cli.scene.checks.sweep import sweep_shift
from radhar_cli.scene.checks.validity import Approach, SceneCheck, check_scene
from radhar_cli.scene.checks.warnings import collect_warnings, config_warnings, scene_warnings
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.radar import waveform_of
from radhar_cli.scene.room import wall_of
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene, scene_numbers

C = 299_792_458.0
WALKING = activity_named("walking")
CONFIGS = Path(__file__).resolve().parents[3] / "configs"
SCENES_SHIPPED = [
    path
    for path in sorted(CONFIGS.rglob("*.yaml"))
    if path.parent.name not in ("measured", "train") and "\nradars:" not in path.read_text()
]
# The paper's fixed person, and the two columns of its table "Experimental Parameter Settings".
PERSON: dict[str, Any] = {
    "subject": {"height_m": 1.8},
    "motion": {
        "model": "paper",
        "range_m": {"per_activity": {"default": 2, "S8": 1, "S9": 1, "S10": 1, "S11": 1, "S12": 1}},
        "angle_deg": 0,
        "paper": {"thigh_deg": 30, "calf_deg": 45, "arm_deg": 35},
        "rotating": {"turn_deg": 45},
    },
}
FREE_SPACE: dict[str, Any] = PERSON
THROUGH_WALL: dict[str, Any] = {
    **PERSON,
    "wall": {},
    "radar": {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 128},
}


def at_every_pulse(scene: Scene) -> np.ndarray:
    """Positions [3, 13, M]."""
    v = scene_numbers(scene)
    pulses = np.arange(round(v["duration_s"] * v["radar.prf_hz"]))
    return motion_of(scene.people[0]).positions(pulses / v["radar.prf_hz"])


def antenna(scene: Scene, name: str) -> np.ndarray:
    return np.array([scene_numbers(scene)[f"radar.{name}_m.{axis}"] for axis in range(3)])


def brute_closest(scene: Scene) -> Approach:
    p = at_every_pulse(scene)
    found = []
    for key, name in (("tx", "transmitter"), ("rx", "receiver")):
        r = np.linalg.norm(p - antenna(scene, key)[:, None, None], axis=0)
        joint, pulse = np.unravel_index(np.argmin(r), r.shape)
        found.append(
            Approach(
                float(r.min()), JOINTS[joint], name, pulse / scene_numbers(scene)["radar.prf_hz"]
            )
        )
    return min(found)


def distance_at(scene: Scene, approach: Approach) -> float:
    """How far the named joint is from the named antenna at the named time."""
    p = motion_of(scene.people[0]).positions(np.array([approach.time]))[
        :, JOINTS.index(approach.joint), 0
    ]
    at = antenna(scene, {"transmitter": "tx", "receiver": "rx"}[approach.antenna])
    return float(np.linalg.norm(p - at))


def brute_delay(scene: Scene) -> np.ndarray:
    """Delay [13, M] at every pulse, the wall's included."""
    p, wall = at_every_pulse(scene), wall_of(scene)
    tau = np.zeros(p.shape[1:])
    for key in ("tx", "rx"):
        at = antenna(scene, key)
        tau += np.linalg.norm(p - at[:, None, None], axis=0) / C
        if wall is not None:
            tau += extra_delay(crossing(p, tuple(at), wall).chord, wall)
    return tau


def with_antenna_at(label: str, at: np.ndarray, name: str = "tx_m", **more: Any) -> Config:
    radar = {name: tuple(float(x) for x in at)}
    return Config(**{**PERSON, "activities": (label,), "radar": radar, **more})


def scene_of(config: Config) -> Scene:
    return nominal_scene(config, config.chosen_activities[0])


@given(
    st.sampled_from([a.label for a in ACTIVITIES]),
    st.sampled_from(JOINTS),
    st.floats(0, 4),
    st.tuples(*3 * [st.floats(-0.06, 0.06)]),
    st.sampled_from(["tx_m", "rx_m"]),
)
@settings(deadline=None, max_examples=40)
def test_a_scatterer_within_5_cm_of_an_antenna_is_found(
    label: str, joint: str, time: float, offset: tuple[float, float, float], name: str
) -> None:
    """The antenna is beside the path of a joint, often nearest between two times of the grid."""
    body = motion_of(scene_of(Config(**PERSON, activities=(label,))).people[0])
    beside = body.positions(np.array([time]))[:, JOINTS.index(joint), 0] + offset
    config = with_antenna_at(label, beside, name)
    scene = scene_of(config)
    found, expected = check_scene(scene), brute_closest(scene)
    assert found.too_close == (expected.distance < 0.05)
    if found.too_close:
        assert found.closest.distance == pytest.approx(expected.distance, abs=1e-12)
        assert distance_at(scene, found.closest) == pytest.approx(expected.distance, abs=1e-12)


def test_a_fast_ankle_is_found_between_grid_times() -> None:
    """At 6.2 m/s an ankle goes 3 cm in 5 ms: nearest at 4.5 cm, it is 5.4 cm away on the grid."""
    time = 0.425  # half-way between two times of the grid, 10 ms apart
    body = motion_of(scene_of(Config(**PERSON, activities=("S8",))).people[0])
    aside = np.array([0.0, 0.045, 0.0])
    config = with_antenna_at("S8", body.positions(np.array([time]))[:, 10, 0] + aside)
    scene = scene_of(config)
    looks = body.positions(np.arange(0, 4, 0.01))
    assert np.linalg.norm(looks - antenna(scene, "tx")[:, None, None], axis=0).min() > 0.05
    found = check_scene(scene).closest
    assert found.distance == pytest.approx(0.045, abs=1e-6)
    assert found.joint == "right_ankle"
    assert found.time == pytest.approx(time, abs=1e-3)


def test_the_message_names_sample_joint_time_and_distance() -> None:
    """A head at 1.5 m/s along 30 degrees passes, after 1 s, 2 cm below a transmitter."""
    at = (1 + 1.5 * np.cos(radians(30)), 1.5 * np.sin(radians(30)), 1.52)
    config = with_antenna_at(
        "S8", np.array(at), motion={**PERSON["motion"], "angle_deg": 30, "range_m": 1}
    )
    with pytest.raises(SceneError) as caught:
        draw_valid_scene(config, WALKING, 7)
    message = str(caught.value)
    for part in ("walking/7", "head", "transmitter", "2 cm", "t = 1.000 s", "5 cm"):
        assert part in message


def test_who_is_too_small_for_a_walk_is_refused_by_name() -> None:
    """A child of 1.0 m at 2.8 m/s: v^2/(g l) is 1.7, where people run."""
    walk = {"speed_mps": 2.8, "period_scale": 1.05, "speed_variation": 0.06}
    config = Config.model_validate(
        {"activities": ["walking"], "subject": {"height_m": 1.0}, "motion": {"walking": walk}}
    )
    keys = r"\(motion\.\*, timing\.\*, subject\.height_m\)"
    with pytest.raises(SceneError, match=rf"walking/0: a limb of 0\.460 m cannot reach .* {keys}"):
        draw_valid_scene(config, WALKING, 0)


@pytest.mark.parametrize(("above", "found"), [(0.0499, True), (0.0501, False)])
def test_the_limit_is_5_cm(above: float, found: bool) -> None:
    config = with_antenna_at("S1", np.array([2.0, 0.0, 1.5 + above]))
    assert check_scene(scene_of(config)).too_close == found


@pytest.mark.parametrize("setting", [FREE_SPACE, THROUGH_WALL], ids=["free space", "wall"])
@pytest.mark.parametrize("activity", ACTIVITIES, ids=lambda a: a.label)
def test_half_band_aliasing_and_wall_as_at_every_pulse(setting: Any, activity: Any) -> None:
    config = Config(**setting)
    scene = nominal_scene(config, activity)
    found = check_scene(scene)
    tau, v = brute_delay(scene), scene_numbers(scene)
    mid = v["radar.carrier_hz"] + v["radar.bandwidth_hz"] / 2
    doppler = np.abs(np.diff(tau, axis=1)).max() * v["radar.prf_hz"] * mid
    half_band = C * 10e6 / (4 * v["radar.bandwidth_hz"] / 40e-6)
    wall = wall_of(scene)
    assert (Flags.ALIASING in found.flags) == (doppler > v["radar.prf_hz"] / 2)
    assert (Flags.HALF_BAND in found.flags) == (tau.max() * C / 2 >= half_band)
    assert (Flags.WALL in found.flags) == (
        wall is not None and wall.contains(at_every_pulse(scene)).any()
    )
    assert not found.too_close


@pytest.mark.parametrize(("start", "leaves"), [(1.5, False), (1.55, True)])
def test_a_walker_from_beyond_1_5_m_leaves_the_half_band(start: float, leaves: bool) -> None:
    config = Config(**{**PERSON, "motion": {**PERSON["motion"], "range_m": start}})
    found = check_scene(nominal_scene(config, WALKING))
    assert (Flags.HALF_BAND in found.flags) == leaves
    assert (found.invalid is None) == (not leaves)


def test_the_walls_delay_counts_in_the_half_band() -> None:
    """The ankles stand 7.36 m off, below 7.49 m; 24 cm of wall delay as another 35 cm of air."""
    standing = {**PERSON, "motion": {**PERSON["motion"], "range_m": 7.6}, "activities": ("S1",)}
    free, behind = Config(**standing), Config(**standing, wall={"loss_tangent": 0})
    assert Flags.HALF_BAND not in check_scene(scene_of(free)).flags
    assert Flags.HALF_BAND in check_scene(scene_of(behind)).flags


def test_aliasing_is_that_of_the_frequency_the_doppler_is_read_at() -> None:
    """At 2 GHz an ankle of S3 reaches 4.3 m/s: above PRF/2 at mid-chirp, below it at the start."""
    centre = Config(**THROUGH_WALL)
    start = Config(**THROUGH_WALL, processing={"range_reference": "start"})
    kicking = activity_named("kicking")
    assert Flags.ALIASING in check_scene(nominal_scene(centre, kicking)).flags
    assert Flags.ALIASING not in check_scene(nominal_scene(start, kicking)).flags


def by_kind(config: Config) -> dict[str, tuple[int, str]]:
    found = [
        draw_valid_scene(config, activity, index)[1]
        for activity in config.chosen_activities
        for index in range(config.samples_per_class)
    ]
    counts = {flag: sum(flag in flags for flags in found) for flag in Flags}
    return {w["kind"]: (w["recordings"], w["message"]) for w in collect_warnings(config, counts)}


def test_warnings_at_the_papers_free_space_settings() -> None:
    """The five walks alias: ankles reach 6.2 m/s, the radar 4.7. From x = 1 m none gets too far.

    The paper's falls turn about the torso, feet and head 0.2 m below the floor.
    """
    found = by_kind(Config(**FREE_SPACE, samples_per_class=1))
    assert found.keys() == {"aliasing", "floor"}
    assert found["floor"] == (2, "2 of 12 recordings: a scatterer goes below the floor")
    assert found["aliasing"][0] == 5
    assert "5 of 12 recordings" in found["aliasing"][1]


def test_warnings_at_the_papers_through_the_wall_settings() -> None:
    """S8 to S12 start inside the wall; they and the kick alias."""
    found = by_kind(Config(**THROUGH_WALL, samples_per_class=1))
    assert {kind: count for kind, (count, _) in found.items()} == {
        "wall": 5,
        "aliasing": 6,
        "floor": 2,
    }
    assert "5 of 12 recordings: the body passes through the wall" in found["wall"][1]


def test_warnings_of_the_papers_randomised_walkers() -> None:
    config = Config(activities=("S8",), samples_per_class=20, motion={"model": "paper"})
    scenes = [draw_scene(config, WALKING, index) for index in range(20)]
    half_band = C * 10e6 / (4 * 1e14)
    leaving = sum(bool(brute_delay(scene).max() * C / 2 >= half_band) for scene in scenes)
    found = by_kind(config)
    assert 0 < leaving < 20
    assert found["half_band"][0] == leaving
    assert f"{leaving} of 20 recordings" in found["half_band"][1]
    assert "half-band" in found["half_band"][1]


def test_a_recording_that_ends_before_the_second_phase_is_warned_of() -> None:
    found = by_kind(
        Config(**FREE_SPACE, activities=("S5", "S12"), samples_per_class=2, duration_s=1.5)
    )
    assert found["timing"][0] == 2
    assert "S12" in found["timing"][1]


@pytest.mark.parametrize(
    ("document", "key"),
    [
        (
            {"processing": {"gate_m": 2.0}},
            "processing.gate_m has no effect with processing.range_sum: coherent; it needs "
            "processing.range_sum: gated",
        ),
        ({"processing": {"gate_sum": "magnitude"}}, "processing.gate_sum has no effect"),
        ({"processing": {"highpass": {"order": 2}}}, "processing.highpass has no effect"),
        ({"image": {"cfar": {"pfa": 0.2}}}, "image.cfar has no effect"),
        (
            {"image": {"kind": "cfar", "cfar": {"floor_db": 40.0, "domain": "power"}}},
            "image.cfar.floor_db has no effect",
        ),
        ({"processing": {"savgol": {"order": 3}}}, "processing.savgol has no effect with maps"),
        ({"processing": {"fsst_threshold": 0.1}}, "processing.fsst_threshold has no effect"),
        ({"maps": ["rtm"], "processing": {"window_s": 0.2}}, "processing.window_s has no effect"),
        ({"body": {"shadowing": False}}, "body.shadowing has no effect"),
        ({"engine": {"kind": "cube", "tolerance_db": -60.0}}, "engine.tolerance_db has no effect"),
        (
            {"engine": {"tolerance_db": -40.0}},
            "engine.tolerance_db: -40 is looser than the default and runs as -80: a larger "
            "error would save less than a tenth of a sample's time",
        ),
        (
            {"snr_reference": "received"},
            "snr_reference has no effect with wall: null, radar.beam: null, "
            "radar.waveform: fmcw; it "
            "needs wall or radar.beam or radar.cfg",
        ),
        (
            {"snr_reference": "received", "wall": {}, "snr_db": None},
            "snr_reference has no effect with snr_db: null",
        ),
        (
            {"receiver": {"noise_slope_db": 12.0}},
            "receiver.noise_slope_db has no effect with receiver.noise_corner_hz: 0.0; it needs "
            "receiver.noise_corner_hz above 0",
        ),
        (
            {"snr_db": 30, "receiver": {"noise_figure_db": 12.0}},
            "receiver.noise_figure_db has no effect with snr_db: 30.0; it needs snr_db: null",
        ),
        ({"cloud": {"pfa": 1e-4}}, "cloud has no effect with maps: [stft]"),
        (
            {"motion": {"paper": {"gait_hz": 1.5}}},
            "motion.paper.gait_hz has no effect with motion.model: human",
        ),
        ({"timing": {"blend_s": 0.5}}, "timing.blend_s has no effect with motion.model: human"),
        (
            {"motion": {"model": "paper", "falling": {"direction": "sideways"}}},
            "motion.falling.direction has no effect with motion.model: paper",
        ),
        (
            {"motion": {"model": "paper"}, "subject": {"chest_m": 0.01}},
            "subject.chest_m has no effect with motion.model: paper",
        ),
        ({"receiver": {"tones": [{"doppler_hz": -6000}]}}, "receiver.tones.0.doppler_hz reaches"),
    ],
)
def test_keys_without_effect_and_aliased_lines_are_warned_of(document: Any, key: str) -> None:
    config = Config(activities=("S1",), samples_per_class=1, **document)
    count, message = by_kind(config)["config"]
    assert count == 1
    assert message.startswith(key)
    assert message in scene_warnings(draw_scene(config, activity_named("stationary"), 0))


@pytest.mark.parametrize("model", ["human", "paper"])
def test_no_warning_for_defaults(model: str) -> None:
    for activity in ACTIVITIES:
        for scene in (
            draw_scene(Config(motion={"model": model}), activity, 0),
            nominal_scene(Config(motion={"model": model}), activity),
        ):
            assert config_warnings(scene.config) == []
    scene = draw_scene(Config(**FREE_SPACE), activity_named("stationary"), 0)
    assert isinstance(scene.config.image.cfar.floor_db, float)
    assert scene_warnings(scene) == []


def test_no_warning_for_keys_with_effect() -> None:
    config = Config(
        processing={
            "range_sum": "gated",
            "gate_m": 2.0,
            "clutter": "highpass",
            "highpass": {"order": 2},
        },
        image={"kind": "cfar", "cfar": {"pfa": 0.2}},
        receiver={"tones": [{"doppler_hz": 2000}]},
    )
    assert config_warnings(config) == []
    assert config_warnings(Config.model_validate_json(config.model_dump_json())) == []


def test_no_warning_for_scenes_inside_the_model() -> None:
    motion = {"model": "paper", "range_m": 2, "angle_deg": 0}
    assert by_kind(Config(motion=motion, activities=("S1", "S5"), samples_per_class=3)) == {}


def near_the_wall(on_invalid: str) -> Config:
    """S1 somewhere from before the wall to behind it: some stand inside."""
    motion = {**PERSON["motion"], "range_m": {"uniform": [0.7, 1.7]}, "angle_deg": 0}
    wall = {"size_m": [0.5, 5, 2.5], "center_m": [1.2, 0, 1.25]}
    return Config(
        activities=("S1",), motion=motion, wall=wall, on_invalid=on_invalid, samples_per_class=20
    )


STANDING = ACTIVITIES[0]


def first_valid(config: Config, index: int) -> int:
    attempt = 0
    while 0.95 <= draw_scene(config, STANDING, index, attempt).config.motion.range_m <= 1.45:
        attempt += 1
    return attempt


def test_keep_takes_the_first_draw_with_its_warnings() -> None:
    config = near_the_wall("keep")
    drawn = [draw_valid_scene(config, STANDING, index) for index in range(20)]
    assert all(scene.attempt == 0 for scene, _ in drawn)
    for index, (_, flags) in enumerate(drawn):
        assert (Flags.WALL in flags) == (first_valid(config, index) > 0)
    assert 0 < sum(Flags.WALL in flags for _, flags in drawn) < 20


def test_redraw_takes_the_first_draw_inside_the_model() -> None:
    config = near_the_wall("redraw")
    drawn = [draw_valid_scene(config, STANDING, index) for index in range(20)]
    attempts = [first_valid(config, index) for index in range(20)]
    assert [scene.attempt for scene, _ in drawn] == attempts
    assert max(attempts) > 1
    assert not any(flags & (Flags.WALL | Flags.HALF_BAND) for _, flags in drawn)


def test_error_stops_and_names_the_sample_and_why() -> None:
    config = near_the_wall("error")
    inside = [index for index in range(20) if first_valid(config, index)]
    outside = sorted(set(range(20)) - set(inside))
    assert draw_valid_scene(config, STANDING, outside[0])[0].attempt == 0
    with pytest.raises(SceneError, match=rf"stationary/{inside[0]}: .*the wall.*redraw draws such"):
        draw_valid_scene(config, STANDING, inside[0])


@pytest.mark.parametrize("on_invalid", ["redraw", "error"])
def test_leaving_the_half_band_is_invalid_but_aliasing_is_not(on_invalid: str) -> None:
    config = Config(**FREE_SPACE, on_invalid=on_invalid)
    assert Flags.ALIASING in draw_valid_scene(config, WALKING, 0)[1]
    far = {**PERSON["motion"], "range_m": {"uniform": [1.2, 1.8]}}
    config = Config(**{**PERSON, "motion": far}, on_invalid=on_invalid)
    leaves = [
        index
        for index in range(20)
        if Flags.HALF_BAND in check_scene(draw_scene(config, WALKING, index)).flags
    ]
    if on_invalid == "redraw":
        scene, flags = draw_valid_scene(config, WALKING, leaves[0])
        assert scene.attempt > 0
        assert Flags.HALF_BAND not in flags
    else:
        with pytest.raises(SceneError, match=rf"walking/{leaves[0]}: .*half-band"):
            draw_valid_scene(config, WALKING, leaves[0])


@pytest.mark.parametrize("on_invalid", ["keep", "error"])
def test_a_scatterer_at_an_antenna_stops_unless_redrawn(on_invalid: str) -> None:
    at = np.array([2.0, 0.0, 1.51])
    config = with_antenna_at("S1", at, on_invalid=on_invalid)
    cure = "on_invalid: redraw draws such scenes again"
    with pytest.raises(SceneError, match=rf"stationary/0: head comes to 1 cm .*; {cure}"):
        draw_valid_scene(config, STANDING, 0)
    about = {**PERSON["motion"], "range_m": {"uniform": [1.5, 2.5]}}
    config = with_antenna_at("S1", at, on_invalid="redraw", motion=about)
    attempts = [draw_valid_scene(config, STANDING, index)[0].attempt for index in range(8)]
    assert max(attempts) > 0


def test_a_band_that_is_too_short_for_people_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Walkers who start 9 to 12 m away, with a half-band of 7.5 m."""
    monkeypatch.setattr(drawing, "MAX_ATTEMPTS", 3)
    motion = {"range_m": {"uniform": [9, 12]}}
    config = Config(radar={"bandwidth_hz": 4e9}, motion=motion)
    with pytest.raises(SceneError, match=r"half-band, with .*; a smaller radar.bandwidth_hz"):
        draw_valid_scene(config, WALKING, 0)


def test_no_valid_scene_ends_the_redraws(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing, "MAX_ATTEMPTS", 3)
    about = {**PERSON["motion"], "range_m": {"uniform": [1.99, 2.01]}}
    config = with_antenna_at("S1", np.array([2.0, 0.0, 1.51]), on_invalid="redraw", motion=about)
    with pytest.raises(SceneError, match=r"stationary/4: .* 3 draws .*head comes to .*range_m"):
        draw_valid_scene(config, STANDING, 4)


def test_what_no_draw_can_change_is_drawn_once() -> None:
    config = with_antenna_at("S1", np.array([2.0, 0.0, 1.51]), on_invalid="redraw")
    with pytest.raises(SceneError, match=r"in 1 draw, and nothing is drawn again .*head comes to"):
        draw_valid_scene(config, STANDING, 4)


IN_THE_WALL = {"center_m": [3, 0, 1.25], "size_m": [4, 5, 2.5]}


@pytest.mark.parametrize(
    ("more", "draws", "why"),
    [
        ({"wall": {"eps_r": 1e6}}, 50, "half-band"),
        ({"wall": IN_THE_WALL, "motion": {"range_m": 3}}, 50, "wall"),
        ({"wall": IN_THE_WALL, "motion": {"range_m": {"choice": [2.9, 3]}}}, 200, "wall"),
    ],
)
def test_hopeless_draws_end_early(more: dict[str, Any], draws: int, why: str) -> None:
    """None of them comes near the model: each misses by more than they differ."""
    config = Config.model_validate({"activities": ["punching"]} | more)
    with pytest.raises(SceneError, match=rf"in {draws} draws .*{why}"):
        draw_valid_scene(config, activity_named("punching"), 0)


def test_a_scene_that_is_found_late_is_still_found() -> None:
    """Some centimetres of 6 m leave room: misses differ by more than the best of them."""
    wall = {"center_m": [4.1, 0, 1.25], "size_m": [5.8, 5, 2.5]}
    motion = {"range_m": {"uniform": [1.5, 7.36]}, "angle_deg": 180}
    config = Config.model_validate({"wall": wall, "motion": motion, "radar": {"prf_hz": 500}})
    standing = activity_named("stationary")
    attempts = [draw_valid_scene(config, standing, index)[0].attempt for index in range(6)]
    assert max(attempts) > 50


@pytest.mark.parametrize(
    ("distance", "wall", "band", "why"),
    [
        (1.0, False, False, None),
        (0.01, True, True, "head comes to 1 cm"),
        (1.0, True, True, "wall"),
        (1.0, False, True, "half-band"),
    ],
)
def test_the_most_serious_reason_is_given(
    distance: float, wall: bool, band: bool, why: Any
) -> None:
    closest = Approach(distance, "head", "receiver", 0.5)
    flags = Flags.ALIASING | (Flags.HALF_BAND * band) | (Flags.WALL * wall)
    invalid = SceneCheck(closest, Flags(flags)).invalid
    assert (invalid is None) if why is None else (invalid is not None and why in invalid)


@pytest.mark.parametrize(
    ("gate_m", "leaves"),
    [([0.0, 7.0], False), ([0.0, 3.0], True), ([3.0, 7.0], True), (1.0, False)],
)
def test_a_torso_that_leaves_a_fixed_gate_is_warned_of(gate_m, leaves):
    """From 2 m, 1.5 m/s away for 3 s; a gate around the torso goes with it."""
    motion = {"model": "paper", "range_m": 2.0, "angle_deg": 0.0, "walking": {"speed_mps": 1.5}}
    config = Config.model_validate(
        {
            "duration_s": 3.0,
            "motion": motion,
            "processing": {"range_sum": "gated", "gate_m": gate_m},
        }
    )
    messages = scene_warnings(draw_scene(config, activity_named("walking"), 0))
    assert (
        any("the torso leaves the ranges of processing.gate_m" in one for one in messages) == leaves
    )


@pytest.mark.every(2)
@pytest.mark.parametrize("scatterers", ["points", "segments"])
def test_the_echo_needs_no_other_instants_than_the_check(monkeypatch, scatterers) -> None:
    """But for the pulses at which it measures its error, and those that count a segment's points:
    what the check has seen is remembered."""
    asked, gather = [], HumanMotion._gather

    def noted(self, t, *rest):
        asked.append(t)
        return gather(self, t, *rest)

    monkeypatch.setattr(HumanMotion, "_gather", noted)
    config = Config(body={"scatterers": scatterers}, processing={"gate_m": (0.5, 6)})
    scene, _ = draw_valid_scene(config, WALKING, 0)
    placing, checked = asked  # 24 steps of a course, in which walkers are laid through their place
    assert placing.size == 25
    record(scene, ["echo", "torso_track"])
    assert checked.size > 1000 > max(t.size for t in asked[2:])
    # The grid is no coarser than what the motion needs, and ends with the recording.
    motion, shared = scene.people[0].held["motion"], True
    each = next(check_grids(motion, waveform_of(scene), shared)).pulses
    assert np.diff(each).max() <= waveform_of(scene).prf / 120
    assert each[0] == 0
    assert each[-1] >= waveform_of(scene).n_pulses - 1


def walker(model: str, **motion: Any) -> dict[str, Any]:
    return {
        "duration_s": 4,
        "motion": {
            "model": model,
            "range_m": 2.5,
            "angle_deg": 180,
            "walking": {"speed_mps": 1.3},
            **motion,
        },
        "activities": ["walking"],
    }


@pytest.mark.parametrize("model", ["human", "paper"])
def test_who_walks_through_the_radar_is_found(model: str) -> None:
    """From 2.5 m towards it for 4 s; beside it people are behind it then, away from it nothing."""
    both = Flags.RADAR | Flags.BEHIND
    towards, aside, away = (
        check_scene(scene_of(Config(**walker(model, **how))))
        for how in ({}, {"cross_range_m": 0.8}, {"angle_deg": 0})
    )
    assert towards.flags & both == both
    assert str(towards.invalid).startswith("a person walks through the radar")
    assert aside.flags & both == Flags.BEHIND
    assert aside.invalid is None
    assert not away.flags & both
    high = {"tx_m": [0, 0.1, 2.6], "rx_m": [0, -0.1, 2.6]}
    over = check_scene(scene_of(Config(**walker(model), radar=high)))
    assert over.flags & both == Flags.BEHIND
    down = {**high, "beam": {"azimuth_deg": 60, "elevation_deg": 60, "tilt_deg": 90}}
    assert not check_scene(scene_of(Config(**walker(model), radar=down))).flags & both


def test_who_walks_through_the_radar_is_drawn_again_or_refused() -> None:
    config = Config(**walker("human", range_m={"uniform": [2.5, 9]}))
    for index in range(8):
        scene, flags = draw_valid_scene(config, WALKING, index)
        assert not flags & Flags.RADAR
        assert scene_numbers(scene)["motion.range_m"] > 4
    with pytest.raises(SceneError, match=r"a person walks through the radar: .*motion\.range_m"):
        draw_valid_scene(Config(**walker("human"), on_invalid="error"), WALKING, 0)


@pytest.mark.parametrize("name", ["exercises", "older", "free_space_77GHz", "people"])
def test_nobody_walks_past_the_radar_in_shipped_configs_without_walls(name: str) -> None:
    """Whatever is drawn: 40 of each class."""
    config = load_config(CONFIGS / f"human/{name}.yaml")
    for activity in config.chosen_activities:
        if not {"walking", "tripping"} & {*activity.movements}:
            continue
        for index in range(40):
            scene = draw_scene(config, activity, index)
            torso = motion_of(scene.people[0]).torso(np.linspace(0, scene.seconds, 30))
            assert torso[0].min() > scene.radar.tx_m[0] - BEHIND_M, (activity.slug, index)


SLOW = Waveform(fc=24e9, bandwidth=5e8, chirp=0.05, adc_rate=2e4, prf=19, duration=0.2)


@pytest.mark.parametrize("speed", [-1.3, 0.2, 0.7])
def test_motion_in_a_sweep_moves_an_echo_as_the_warning_says(speed: float) -> None:
    """Against the echo itself, of a point at 5 m where a sweep begins."""

    def point(t: Float) -> Paths:
        return Paths(2 / C * (5 + speed * t)[None], np.ones((1, t.size)))

    beat, padded = moving_beat_matrix(point, SLOW, np.zeros(1))[:, 0], 2**15
    spectrum = np.abs(np.fft.fft(np.conj(beat), padded))
    apparent = int(spectrum.argmax()) * SLOW.adc_rate / padded * C / (2 * SLOW.slope)
    assert apparent - 5 == pytest.approx(speed * sweep_shift(SLOW), abs=0.02)


def sweeps(share: float, waveform: str = "sfcw", **engine: Any) -> dict[str, Any]:
    """A walker whose fastest joint is moved by a share of a cell in a sweep of 24 to 24.5 GHz."""
    document: dict[str, Any] = {
        **{"activities": ["walking"], "duration_s": 2, "maps": ["rtm"], "engine": engine},
        "motion": {
            "range_m": 8,
            "angle_deg": 180,
            "walking": {"speed_mps": 1.3, "speed_variation": 0},
        },
        "radar": {"carrier_hz": 24e9, "bandwidth_hz": 5e8, "prf_hz": 400},
    }
    p = at_every_pulse(scene := scene_of(Config(**document)))
    legs = [np.linalg.norm(p - antenna(scene, one)[:, None, None], axis=0) for one in ("tx", "rx")]
    fastest = np.abs(np.diff(sum(legs) / 2)).max() * 400
    seconds = share * C / (2 * 24.5e9 * fastest)
    form: dict[str, Any] = {"waveform": waveform, "steps": 100, "dwell_s": seconds / 100}
    if waveform == "fmcw":
        form = {"chirp_s": seconds, "adc_rate_hz": 100 / seconds}
    return {**document, "radar": {**document["radar"], **form, "prf_hz": 0.99 / seconds}}


@pytest.mark.parametrize("waveform", ["fmcw", "sfcw"])
def test_sweeps_too_slow_for_frozen_positions_are_warned_of(waveform: str) -> None:
    slow, fast = sweeps(1.15, waveform), sweeps(0.85, waveform)
    assert not check_scene(scene_of(Config(**fast))).flags & Flags.SWEEP
    assert check_scene(scene_of(Config(**slow))).flags & Flags.SWEEP
    moving = sweeps(1.15, waveform, kind="cube", motion_in_chirp=True)
    assert not check_scene(scene_of(Config(**moving))).flags & Flags.SWEEP


def test_the_warning_of_a_slow_sweep_has_the_shift_and_the_remedies() -> None:
    """Its ridge is 3 m from where it belongs (24 GHz, 0.5 GHz, 50 ms, 1.3 m/s)."""
    config = Config.model_validate(
        {
            **{"activities": ["walking"], "duration_s": 3, "maps": ["rtm"], "samples_per_class": 1},
            "motion": {
                "range_m": 8,
                "angle_deg": 180,
                "walking": {"speed_mps": 1.3, "speed_variation": 0},
            },
            "radar": {
                **{"waveform": "sfcw", "carrier_hz": 24e9, "bandwidth_hz": 5e8, "prf_hz": 19},
                **{"steps": 1000, "dwell_s": 5e-5},
            },
        }
    )
    (said,) = (one for one in scene_warnings(scene_of(config)) if "frozen during a sweep" in one)
    assert "by 2.5 m at 1 m/s, with 0.05 s a sweep and cells of 0.3 m" in said
    for key in ("engine.motion_in_chirp", "engine.kind: cube", "radar.dwell_s", "radar.steps"):
        assert key in said
    (counted,) = collect_warnings(config, {Flags.SWEEP: 1})
    assert counted["kind"] == "sweep"
    assert said in counted["message"]


@pytest.mark.parametrize("path", SCENES_SHIPPED, ids=lambda path: path.stem)
def test_sweeps_of_the_shipped_configs_are_fast_enough_for_any_joint(path: Path) -> None:
    """A limb at 15 m/s, a kick's, is moved by less than a cell."""
    if path.stem in ("ancortek2400ad", "urad", "vtrigu", "vtrigu_4x20"):
        pytest.skip("sweeps as long as its maker says")
    config = load_config(path)
    w = waveform_of(scene_of(config))
    if config.radar.waveform in ("fmcw", "sfcw"):
        assert 15 * sweep_shift(w) < C / (2 * w.bandwidth)


ROOM = {"box_m": {"x": [0, 7], "y": [-3, 3]}, "faces": {"left": "concrete"}}
STILL = {"range_m": 3.0, "angle_deg": 0.0}


def room_error(**document):
    base = {"room": ROOM, "activities": ["stationary"], "on_invalid": "error"}
    config = Config.model_validate(base | document)
    with pytest.raises(SceneError) as caught:
        draw_valid_scene(config, config.chosen_activities[0], 0)
    return str(caught.value)


def test_another_person_who_walks_out_of_the_room_is_named_with_the_remedy():
    """There is no wall, and the sample's own person stands still."""
    walker = {
        "activity": "walking",
        "motion": {"range_m": 4.0, "angle_deg": 0, "walking": {"speed_mps": 1.2}},
    }
    said = room_error(motion=STILL, people=[walker], duration_s=8)
    assert "people.0: the body leaves room.box_m, at x = " in said
    assert ", beyond 7 m, with people.0.motion.range_m = 4" in said
    assert "people.0.motion.walking.lane_m lets people turn round" in said
    assert "wall" not in said


def test_a_walker_who_leaves_the_room_is_told_of_the_lane():
    said = room_error(activities=["walking"], motion={"range_m": 5, "angle_deg": 0}, duration_s=8)
    assert "the body leaves room.box_m, at x = " in said
    assert said.endswith(
        "motion.walking.lane_m lets people turn round; motion.range_m and "
        "motion.cross_range_m, room.box_m and duration_s should leave room"
    )


def test_who_reaches_out_of_the_room_is_told_where_and_of_no_lane():
    said = room_error(motion={"range_m": 6.98, "angle_deg": 0.0})
    assert re.search(r"the body leaves room.box_m, at x = 7\.\d+ m, beyond 7 m", said)
    assert "lane_m" not in said
