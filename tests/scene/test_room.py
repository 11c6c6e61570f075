"""`room:` reflectors: a zero line that a canceller leaves, and an SNR that is the person's."""

import numpy as np
import pytest
from helpers.small import SMALL, small_config

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.identity import resolved
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.run import record
from radhar_cli.scene.room import reflectors_of
from radhar_cli.scene.scene import Scene, draw_scene, scene_numbers

RADAR = {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500, "adc_rate_hz": 1e6}
STRONG = {"position_m": [3.0, 1.0, 1.0], "rcs_dbsm": 10, "residual_m": 1e-4, "highest_hz": 5}


def scene_of(index: int = 0, slug: str = "walking", **more: object) -> Scene:
    document = {"radar": RADAR, "snr_db": None, "motion": {"angle_deg": 0, "range_m": 3}} | more
    return draw_scene(Config.model_validate(document), activity_named(slug), index)


def zero_line(scene: Scene) -> float:
    """Power at zero Doppler over that of the whole map."""
    stft = record(scene, ["stft"])["stft"]
    near = np.abs(stft.rows.values) < 15
    return float(stft.power[near].sum() / stft.power.sum())


def test_a_canceller_leaves_a_zero_line_of_what_moves_a_little():
    strong, mean = STRONG | {"rcs_dbsm": 30}, {"processing": {"clutter": "mean"}}
    still = zero_line(scene_of(room={"reflectors": [strong | {"residual_m": 0}]}, **mean))
    moving = zero_line(scene_of(room={"reflectors": [strong]}, **mean))
    nobody = zero_line(scene_of(**mean))
    assert still == pytest.approx(nobody, rel=1e-6)
    assert moving > 3 * nobody


def test_a_sum_of_small_sines():
    scene = scene_of(room={"reflectors": [STRONG, STRONG | {"residual_m": 3e-4}]})
    room = reflectors_of(scene)
    assert room is not None
    t = np.arange(200_000) / 200.0
    away = room.positions(t) - room.places.T[:, :, None]
    assert np.sqrt(np.mean(np.sum(away**2, axis=0), axis=1)) == pytest.approx(
        [1e-4, 3e-4], rel=0.05
    )
    along = room.towards - room.places
    assert np.cross(away[:, 0, 1234], along[0]) == pytest.approx(0, abs=1e-15)
    spectrum = np.abs(np.fft.rfft(np.linalg.norm(away[:, 0], axis=0) * np.sign(away[0, 0])))
    f = np.fft.rfftfreq(t.size, 1 / 200)
    assert np.sum(spectrum[(f > 0.4) & (f < 5.1)] ** 2) > 0.98 * np.sum(spectrum**2)


@pytest.mark.parametrize("wall", [None, {}])
@pytest.mark.parametrize("reference", ["free_space", "received"])
@pytest.mark.parametrize("kind", ["direct", "cube"])
def test_the_snr_is_that_of_the_person_alone(kind, reference, wall):
    def sigma(**more: object) -> float:
        more |= {"wall": wall, "snr_db": 10, "snr_reference": reference, "engine": {"kind": kind}}
        return record(scene_of(duration_s=1.0, **more), ["noise"])["noise"].sigma

    assert sigma(room={"reflectors": [STRONG]}) == pytest.approx(sigma(), rel=1e-6)


@pytest.mark.parametrize("clutter", ["difference", "none"])
@pytest.mark.parametrize("fastest", [0.5, 10, 100])
def test_the_direct_engine_keeps_its_promise(clutter, fastest):
    reflectors = [STRONG | {"highest_hz": fastest, "residual_m": 2e-3}] * 2
    more = {"room": {"reflectors": reflectors}, "processing": {"clutter": clutter}}
    direct, cube = (
        record(scene_of(duration_s=2.0, engine={"kind": kind}, **more), ["signal"])["signal"].x[
            0, 0
        ]
        for kind in ("direct", "cube")
    )
    assert np.linalg.norm(direct - cube) <= 1e-4 * np.linalg.norm(cube)  # engine.tolerance_db: -80


def test_a_number_of_reflectors_is_drawn_each_on_its_own():
    scene = scene_of(room={"reflectors": [{}, {}, {}]})
    numbers = scene_numbers(scene)
    places = {numbers[f"room.reflectors.{i}.position_m.0"] for i in range(3)}
    assert len(places) == 3
    assert places.isdisjoint(
        {
            scene_numbers(scene_of(1, room={"reflectors": [{}, {}, {}]}))[
                "room.reflectors.0.position_m.0"
            ]
        }
    )
    again = Config.model_validate(resolved(scene.config))
    assert again.room == scene.config.room
    assert scene_numbers(draw_scene(again, scene.activity, 0)) == numbers


def test_a_person_moves_the_same_with_and_without_them():
    with_room, without = scene_of(room={"reflectors": [{}, {}, {}]}), scene_of()
    kept = {k: v for k, v in scene_numbers(with_room).items() if not k.startswith("room.")}
    assert kept == scene_numbers(without)


def test_a_wall_behind_people_shows_them_again_with_the_opposite_doppler():
    """At twice the wall's range less theirs; the SNR stays that of the person alone."""
    more = {"body": {"scatterers": "points"}, "duration_s": 2.0, "snr_db": 20}
    more |= {"radar": RADAR | {"adc_rate_hz": 2e6}, "subject": {"height_m": 1.75}}
    more |= {
        "motion": {
            "angle_deg": 180,
            "range_m": 5,
            "walking": {"speed_mps": 0.6},
            "repeating": {"cycle_phase": 0},
        }
    }
    mirror = {"back_wall_m": 5.2, "back_wall_reflection_db": 0}

    def sides(kind: str, room: dict[str, object]) -> tuple[float, float]:
        scene = scene_of(room=room, engine={"kind": kind}, **more)
        made = record(scene, ["stft", "noise"])
        stft = made["stft"]
        towards = stft.power[stft.rows.values > 20].sum() / stft.power.sum()
        return float(towards), float(made["noise"].sigma)

    for kind in ("cube", "direct"):
        (alone, noise), (mirrored, same) = sides(kind, {}), sides(kind, mirror)
        assert alone > 0.9
        assert 0.6 < mirrored < 0.88
        assert same == pytest.approx(noise)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("motion: {range_m: 5}\nroom: {back_wall_m: 4.5}", "beyond the people"),
        ("wall: {}\nroom: {back_wall_m: 40}", "null with a wall"),
    ],
)
def test_a_wall_behind_people_is_behind_them_and_the_only_one(text, words, tmp_path):
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=rf"room.back_wall_m.*{words}"):
        load_config(path)


def test_a_reflector_at_an_antenna_is_refused():
    config = Config.model_validate(
        {"room": {"reflectors": [{"position_m": [0.4, 0.1, 1.52]}]}, "activities": ["S1"]}
    )
    with pytest.raises(SceneError, match=r"reflector 0 comes to 2 cm from the receiver"):
        draw_valid_scene(config, activity_named("stationary"), 0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("room: {reflectors: [{residual_m: 0.1}]}", "room.reflectors.0.residual_m"),
        ("room: {reflectors: [{rcs_dbsm: 500}]}", "room.reflectors.0.rcs_dbsm"),
        ("receiver: {tones: [{level_db: 3}]}", "receiver.tones.0.doppler_hz"),
        ("snr_db: null\nreceiver: {tones: [{doppler_hz: 3}]}", "receiver.tones is relative to"),
        ("snr_db: null\nreceiver: {noise_corner_hz: 3}", "receiver.noise_corner_hz is relative"),
        ("receiver: {noise_slope_db: 30}", "receiver.noise_slope_db"),
    ],
)
def test_mistakes(text, words, tmp_path):
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    (line,) = str(caught.value).splitlines()
    assert words in line


def test_a_data_set_with_all_of_it(tmp_path):
    """The same from two workers; every number of it is a column."""
    more = """
room: {reflectors: [{}, {}]}
receiver: {noise_corner_hz: {uniform: [1, 20]}, tones: [{doppler_hz: 50}]}
"""
    config = load_config(small_config(tmp_path, SMALL + more))
    build(config, tmp_path / "set", 1, BarProgress())
    build(config, tmp_path / "again", 2, BarProgress())
    assert verify(tmp_path / "set", 100).problems == []
    one, two = ((tmp_path / name / "dataset.h5").read_bytes() for name in ("set", "again"))
    assert one == two
    with open_dataset(tmp_path / "set") as data:
        units = {field.name: field.unit for field in data.fields}
    assert units["reflector_1_position_y"] == "m"
    assert units["reflector_0_rcs"] == "dBsm"
    assert units["noise_corner"] == "Hz"
    assert units["tone_0_level"] == "dB"
