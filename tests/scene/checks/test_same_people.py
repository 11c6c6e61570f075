"""Every radar of several sees the same people, in scenes that are drawn again, too."""

from pathlib import Path

import numpy as np
import pytest
from helpers.slow import slow

from radhar_cli.config import Config, load_config, load_radars
from radhar_cli.config.several_radars import OWN_SECTIONS
from radhar_cli.errors import SceneError
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.radar import antennas_of
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.simulate import simulate

COUNT = 12
KINDS = {
    "fine": "{carrier_hz: 77e9, bandwidth_hz: 1.6e9, prf_hz: 6400, chirp_s: 40e-6, "
    "adc_rate_hz: 4e6, tx_m: [{uniform: [0.2, 0.6]}, -0.1, 1.5]}",  # its half-band ends at 3.7 m
    "coarse": "{carrier_hz: 77e9, bandwidth_hz: 0.5e9, prf_hz: 6400, chirp_s: 40e-6, "
    "adc_rate_hz: 4e6}",
    "cw": "{waveform: cw, carrier_hz: 24e9, prf_hz: 2000}",
    "stepped": "{waveform: sfcw, carrier_hz: 2e9, prf_hz: 200, bandwidth_hz: 1e9, steps: 128, "
    "dwell_s: 2e-5}",
    "uwb": "{waveform: impulse, output: iq, carrier_hz: 7e9, bandwidth_hz: 1.5e9, prf_hz: 256, "
    "profile_m: [0.3, 12]}",
    "board": "{cfg: iwr1843boost, device: IWR1843BOOST, yaw_deg: {uniform: [-5, 5]}}",
    "frames": "{frame: {chirps: 64}, carrier_hz: 60e9, bandwidth_hz: 1e9, prf_hz: 2000, "
    "aspect: {angle_deg: 90, distance_m: 6, about_m: [3, 0]}}",
}
MOTIONS = {
    "starts": "{range_m: {uniform: [3, 9]}, walking: {speed_mps: 0.7, lane_m: 2}}",
    "places": "{place: {range_m: {uniform: [2, 6]}}}",
}


def configs_of(folder: Path, motion: str, more: str = "", **kinds: str) -> dict[str, Config]:
    path = folder / "several.yaml"
    entries = "".join(f"  {name}: {radar}\n" for name, radar in kinds.items())
    path.write_text(
        f"seed: 3\nsamples_per_class: {COUNT}\nduration_s: 3\nmaps: [stft]\n"
        f"activities: [walking, grabbing]\nmotion: {motion}\n{more}radars:\n{entries}"
    )
    return load_radars(path)


TWO = "people: [{activity: walking, share: 0.5}]\n"


@pytest.mark.parametrize(
    ("motion", "more"), [("starts", ""), ("places", TWO), *slow([("places", ""), ("starts", TWO)])]
)
def test_every_kind_of_radar_sees_the_same_people(tmp_path, motion, more):
    configs = configs_of(tmp_path, MOTIONS[motion], more, **KINDS)
    t, redrawn = np.linspace(0, 3, 31), 0
    count = COUNT if motion == "starts" else 3
    for activity in configs["cw"].chosen_activities:
        for index in range(count):
            drawn = {n: draw_valid_scene(c, activity, index) for n, c in configs.items()}
            assert len({scene.attempt for scene, _ in drawn.values()}) == 1
            assert not any(Flags.REDRAWN in flags for _, flags in drawn.values())
            assert len({len(scene.people) for scene, _ in drawn.values()}) == 1
            positions = [
                [motion_of(person).positions(t) for person in scene.people]
                for scene, _ in drawn.values()
            ]
            for others in positions[1:]:
                assert np.array_equal(others, positions[0])
            redrawn += drawn["cw"][0].attempt > 0
            # where a radar is does not depend on which of them is looked at
            for name, (scene, _) in drawn.items():
                for other in scene.of_each_radar:
                    assert other.radar == drawn[str(other.config.radar_name)][0].radar, name
    assert (redrawn > 3) == (motion == "starts")  # or nothing is shown


def test_two_boards_in_two_files_had_other_people_and_one_file_has_the_same(tmp_path):
    fine = {name: KINDS[name] for name in ("fine", "coarse")}
    together = configs_of(tmp_path, MOTIONS["starts"], **fine)
    alone = configs_of(tmp_path, MOTIONS["starts"], coarse=KINDS["coarse"])["coarse"]
    activity = alone.chosen_activities[0]
    attempts = [
        [draw_valid_scene(one, activity, index)[0].attempt for index in range(COUNT)]
        for one in (*together.values(), alone)
    ]
    assert attempts[0] == attempts[1] != attempts[2]


def test_a_radar_of_radars_alone_has_the_people_of_radar(tmp_path):
    named = configs_of(tmp_path, MOTIONS["places"], fine=KINDS["coarse"])["fine"]
    path = tmp_path / "several.yaml"
    plain = tmp_path / "plain.yaml"
    text = path.read_text().replace("radars:\n  fine:", "radar:")
    plain.write_text(text)
    config = load_config(plain)
    t = np.linspace(0, 3, 31)
    for index in range(4):
        activity = config.chosen_activities[0]
        scenes = [draw_valid_scene(one, activity, index)[0] for one in (named, config)]
        one, other = (motion_of(scene.people[0]).positions(t) for scene in scenes)
        assert np.array_equal(one, other)


def test_numbers_and_noise_of_radars_are_independent(tmp_path):
    law = "{prf_hz: 2000, tx_m: [{uniform: [0.0, 1.0]}, -0.1, 1.5]}"
    configs = configs_of(tmp_path, MOTIONS["places"], a=law, b=law)
    scenes = [draw_scene(one, one.chosen_activities[0], 0) for one in configs.values()]
    places = [antennas_of(scene).tx[0] for scene in scenes]
    assert places[0] != places[1]
    noise = [scene.noise_stream("noise").standard_normal(8) for scene in scenes]
    assert not np.isclose(*noise).any()
    again = configs_of(tmp_path, MOTIONS["places"], b=law, a=law)
    scene = draw_scene(again["a"], again["a"].chosen_activities[0], 0)
    assert antennas_of(scene).tx[0] == places[0]


def test_refusal_names_the_radar_that_does_not_see_people(tmp_path):
    near = "{waveform: impulse, output: iq, carrier_hz: 7e9, bandwidth_hz: 1.5e9, prf_hz: 256, "
    near += "profile_m: [0.3, 1.0]}"
    configs = configs_of(tmp_path, "{range_m: 4}", far="{prf_hz: 2000}", near=near)
    messages = set()
    for config in configs.values():
        with pytest.raises(SceneError) as error:
            draw_valid_scene(config, config.chosen_activities[1], 0)
        messages.add(str(error.value))
    assert len(messages) == 1
    assert "radar near: a scatterer leaves the range half-band" in messages.pop()


def test_people_stay_before_each_radar_that_has_no_pattern(tmp_path):
    side = "{prf_hz: 2000, aspect: {angle_deg: 90, distance_m: 5, about_m: [3, 0]}}"
    configs = configs_of(tmp_path, MOTIONS["places"], front="{prf_hz: 2000}", side=side)
    t, activity = np.linspace(0, 3, 31), configs["side"].chosen_activities[0]
    for index in range(COUNT):
        scene = draw_valid_scene(configs["side"], activity, index)[0]
        torso = motion_of(scene.people[0]).torso(t)[:2, 0]
        assert torso[1].min() > -5 + 0.5
        assert torso[0].min() > 0.4 + 0.5


def test_sections_of_their_own_are_keys_of_a_config():
    assert set(OWN_SECTIONS) <= Config.model_fields.keys()


@pytest.mark.every(3)
@pytest.mark.parametrize("kind", [name for name in KINDS if name not in ("fine", "board")])
def test_two_radars_at_one_place_see_the_same_but_for_their_noise(tmp_path, kind):
    silent = "snr_db: null\nreceiver: {noise_figure_db: null}\n"
    loud = KINDS[kind][:-1] + ", snr_db: 10}"
    radars = {"a": KINDS[kind], "b": KINDS[kind], "c": loud}
    configs = configs_of(tmp_path, MOTIONS["places"], silent, **radars)
    scenes = {key: simulate(config, "grabbing") for key, config in configs.items()}
    one, other, noisy = (scene.maps["stft"].power for scene in scenes.values())
    assert np.array_equal(one, other)
    assert not np.array_equal(one, noisy)
    positions = [scene.truth.positions for scene in scenes.values()]
    assert np.array_equal(positions[0], positions[2])


@pytest.mark.parametrize("radar", ["", "roll_deg: 90, cfg: iwr1843boost, device: IWR1843BOOST"])
def test_a_turn_of_360_degrees_changes_nothing(tmp_path, radar):
    turned = {
        f"at_{n}": f"{{{radar}{', ' * bool(radar)}aspect: "
        f"{{angle_deg: {angle}, distance_m: 4, about_m: [3, 0]}}}}"
        for n, angle in enumerate((180, -180))
    }
    configs = configs_of(tmp_path, MOTIONS["places"], "snr_db: null\n", **turned)
    places = [antennas_of(draw_scene(one, one.chosen_activities[0], 0)) for one in configs.values()]
    for place in places[1:]:
        assert np.allclose(place.places, places[0].places, atol=1e-9)
