"""Static echoes of `room.faces`: the radar's own image in walls, floor and corners."""

from itertools import product
from typing import Any

import numpy as np
import pytest
from helpers.boards import CFG
from helpers.command_line import ROOT
from scipy.optimize import minimize

from radhar_cli.config.data_set import Config
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.face_echoes import echoes_of_faces
from radhar_cli.echo.static_returns import leakage
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.room import Face, Leg
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.raw_echo import RAW_ECHO, RAW_PROFILES

C = 299792458.0
WALKING = activity_named("walking")
BOX = {"x": [-0.5, 3.5], "y": [-2.5, 2.0], "height": 2.7}
PLACE = {"tx_m": [0.4, -0.1, 1.1], "rx_m": [0.3, 0.15, 1.2]}
RADAR = {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500, "adc_rate_hz": 4e6, **PLACE}
METAL = dict.fromkeys(("floor", "ceiling", "left", "right", "back"), "metal")
QUIET = {"snr_db": None, "receiver": {"noise_figure_db": None}}


def config(**more: Any) -> Config:
    document = {"radar": RADAR, "activities": ["walking"], "duration_s": 0.3, "snr_db": None}
    document |= {"room": {"box_m": BOX, "faces": METAL}, "motion": {"range_m": 3}}
    return Config.model_validate(document | more)


def test_a_face_gives_the_power_of_the_radars_own_image() -> None:
    """P_r = P_t G^2 lambda^2 |r|^2/((4 pi)^2 (2 d)^2) at right angles, a delay of 2 d/c."""
    d, gain, fc, eps = 3.0, 8.0, 77e9, 5.24 - 0.2j
    antennas = Antennas((1, 0, 1), (1, 0, 1), gain, 0.0)
    way = Leg((Face("back", 0, 1 + d, eps),))
    (delay, amplitude, _) = echoes_of_faces(antennas, [way], None, fc).paths
    r = ((1 - np.sqrt(eps)) / (1 + np.sqrt(eps))).real
    power = gain**2 * (C / fc) ** 2 * r**2 / ((4 * np.pi) ** 2 * (2 * d) ** 2)
    assert amplitude.item() ** 2 == pytest.approx(power, rel=1e-12)
    assert amplitude.item() < 0  # the field is turned
    assert delay.item() == pytest.approx(2 * d / C, rel=1e-12)


@pytest.mark.parametrize("parallel", [True, False])
def test_the_wave_takes_the_shortest_way_by_the_face(parallel: bool) -> None:
    """Fermat's way by a floor, found by a search; Fresnel's coefficient at its angle."""
    tx, rx, eps, fc = (0.2, -0.7, 1.4), (0.5, 0.9, 0.8), 4 - 0.3j, 24e9
    floor = Face("floor", 2, 0.0, eps, parallel)
    paths = echoes_of_faces(Antennas(tx, rx, 4.0, 0.0), [Leg((floor,))], None, fc).paths

    def length(at: Any) -> float:
        place = np.array([at[0], at[1], 0])
        return float(np.linalg.norm(place - tx) + np.linalg.norm(place - rx))

    best = minimize(length, [0, 0], tol=1e-14)
    assert paths.delay.item() * C == pytest.approx(best.fun, rel=1e-9)
    cosine = tx[2] / np.linalg.norm(np.array([*best.x, 0]) - tx)
    sine2 = 1 - cosine**2
    if parallel:
        r = (cosine - np.sqrt(eps - sine2)) / (cosine + np.sqrt(eps - sine2))
    else:
        r = (eps * cosine - np.sqrt(eps - sine2)) / (eps * cosine + np.sqrt(eps - sine2))
    right = 4.0 * C / fc * r.real / (4 * np.pi * best.fun)
    assert paths.amplitude.item() == pytest.approx(right, rel=1e-5)


def images(order: int, box: dict[str, Any]) -> list[tuple[Any, Any, int, int]]:
    """Sign and shift of images of a point in a closed metal box, their bounces and horizontal ones.

    An axis is bounced off n times: once by either end, or twice by both, in either order.
    """
    ends = [tuple(box["x"]), tuple(box["y"]), (0.0, box["height"])]
    single = [(1.0, 0.0, 0)]
    ways = []
    for low, high in ends:
        once = [(-1.0, 2 * low, 1), (-1.0, 2 * high, 1)]
        width = 2 * (high - low)
        ways.append([*single, *once, (1.0, width, 2), (1.0, -width, 2)])
    found = []
    for x, y, z in product(*ways):
        bounces = x[2] + y[2] + z[2]
        if 1 <= bounces <= order:
            sign, shift = np.array([x[0], y[0], z[0]]), np.array([x[1], y[1], z[1]])
            found.append((sign, shift, bounces, z[2]))
    return found


@pytest.mark.parametrize("order", [1, 2])
def test_a_raw_recording_has_the_images_of_a_closed_box(order: int) -> None:
    faces = METAL | {"front": "metal"}
    scene = nominal_scene(config(room={"box_m": BOX, "faces": faces, "order": order}), WALKING)
    asked = ["raw_echo", "paths", "waveform", "antennas"]
    made = record(scene, asked, [RAW_ECHO])
    waveform, antennas = made["waveform"], made["antennas"]
    moving = made["paths"](waveform.times(np.arange(float(waveform.n_pulses))))
    still = made["raw_echo"] - beat_matrix(moving.delay, moving.amplitude, waveform)
    lines = [leakage(antennas)]
    for sign, shift, bounces, horizontal in images(order, BOX):
        distance = np.linalg.norm(np.array(PLACE["tx_m"]) - (sign * PLACE["rx_m"] + shift))
        turned = (-1) ** (bounces - horizontal)  # of vertical field, floor and ceiling do not
        field = turned * antennas.gain * C / waveform.fc / (4 * np.pi * distance)
        lines.append((distance / C, field))
    assert len(lines) == {1: 7, 2: 25}[order]
    delay, amplitude = np.array(lines).T[..., None]
    right = beat_matrix(delay, amplitude, waveform)
    assert np.abs(still - right).max() < 1e-12 * np.abs(right).max()


def test_a_wall_between_weakens_and_delays_both_ways() -> None:
    """The radar stands before the front: a back wall is seen through the slab, twice."""
    wall = {"center_m": [1.5, 0, 1.25], "size_m": [0.2, 9, 9], "rays": "straight"}
    box = {"x": [1.6, 5], "y": [-3, 3], "height": 2.7}
    at = {"tx_m": [0, 0, 1.2], "rx_m": [0, 0, 1.2]}
    room = {"box_m": box, "faces": {"back": "metal", "front": "metal"}, "order": 2}
    scene = nominal_scene(config(radar=RADAR | at, room=room, wall=wall), WALKING)
    made = record(scene, ["raw_echo", "paths", "waveform", "antennas", "wall"], [RAW_ECHO])
    waveform, antennas, slab = made["waveform"], made["antennas"], made["wall"]
    moving = made["paths"](waveform.times(np.arange(float(waveform.n_pulses))))
    still = made["raw_echo"] - beat_matrix(moving.delay, moving.amplitude, waveform)
    n = slab.refractive_index
    loss = np.exp(-2 * np.pi * waveform.fc / C * abs(n.imag) * 0.2) * 4 * n.real / abs(1 + n) ** 2
    field = antennas.gain * C / waveform.fc / (4 * np.pi)
    wall_echo = (1.4 * 2 / C, abs((1 - n) / (1 + n)) * field / 2.8)
    back = ((10 + 2 * 0.2 * (n.real - 1)) / C, -field / 10 * loss**2)
    delay, amplitude = np.array([leakage(antennas), wall_echo, back]).T[..., None]
    right = beat_matrix(delay, amplitude, waveform)
    assert np.abs(still - right).max() < 1e-9 * np.abs(right).max()


def test_no_bounce_and_what_the_antennas_are_mounted_on_give_no_echo() -> None:
    for room in (
        {"box_m": BOX, "faces": METAL, "order": 0},
        {"faces": {"floor": "metal"}},
    ):
        at = PLACE if "box_m" in room else {"tx_m": [0, 0, 0.04], "rx_m": [0, 0.1, 0.04]}
        scene = nominal_scene(config(radar=RADAR | at, room=room), WALKING)
        made = record(scene, ["raw_echo", "paths", "waveform", "antennas"], [RAW_ECHO])
        waveform = made["waveform"]
        moving = made["paths"](waveform.times(np.arange(float(waveform.n_pulses))))
        still = made["raw_echo"] - beat_matrix(moving.delay, moving.amplitude, waveform)
        leak = leakage(made["antennas"])
        right = beat_matrix(np.array([[leak.delay]]), np.array([[leak.amplitude]]), waveform)
        assert np.abs(still - right).max() < 1e-12 * np.abs(right).max()


def test_an_impulse_comes_back_from_the_wall() -> None:
    radar = {"waveform": "impulse", "carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 200}
    at = {"tx_m": [0, 0, 1.2], "rx_m": [0, 0, 1.2], "profile_m": [0.3, 5.5]}
    box = {"x": [-1, 5], "y": [-9, 9], "height": 9}
    document = {"radar": radar | at, "room": {"box_m": box, "faces": {"back": "metal"}}}
    document |= {"maps": ["rtm"], "activities": ["walking"], "duration_s": 0.2, "snr_db": None}
    scene = nominal_scene(Config.model_validate(document | {"motion": {"range_m": 2}}), WALKING)
    made = record(scene, ["raw_echo", "profiles", "waveform", "antennas"], [RAW_PROFILES])
    waveform = made["waveform"]
    far = waveform.range_axis() > 4.5  # no person, no leakage, only the wall at 5 m
    still = (made["raw_echo"] - made["profiles"])[far]
    t = (2 * waveform.range_axis()[far] - 10) / C
    right = -made["antennas"].gain * waveform.wavelength / (4 * np.pi * 10) * waveform.pulse(t)
    assert np.abs(still - right[:, None]).max() < 1e-9 * np.abs(right).max()


def board_config(**more: Any) -> Config:
    radar = {"device": "IWR1443BOOST", "cfg": CFG, "position_m": [0, 0.3, 1.1], "yaw_deg": 10}
    document = {"radar": radar, "activities": ["punching"], "duration_s": 0.2, **QUIET}
    document |= {"motion": {"range_m": 2.2}, "maps": ["points"], "body": {"scatterers": "points"}}
    document["room"] = {"box_m": BOX, "faces": METAL | {"left": "concrete"}}
    return Config.model_validate(document | more)


ISK_BPM = (ROOT / "radhar_cli/config/radars/iwr6843isk.cfg").read_text()


def still_of(made: Any) -> Any:
    """Samples [virtual, sample] that a cube has besides the echo of who moves."""
    difference = made["cube"].astype(complex) - made["echo"].cube
    assert np.abs(difference - difference[:1, :1]).max() < 1e-5 * np.abs(difference).max()
    return difference[0, 0]


def by_hand(board: Any, k: int, r: int) -> Any:
    """Samples [sample] of a metal back wall at 3.5 m alone, by the pattern of both elements."""
    antennas = board.antennas(k, r)
    tx, rx = np.array(antennas.tx), np.array(antennas.rx)
    image = np.array([7 - rx[0], rx[1], rx[2]])
    distance = np.linalg.norm(image - tx)
    pattern = 1.0
    for other in (image, [7 - tx[0], tx[1], tx[2]]):
        ahead, left, up = np.array(board.aim.axes) @ (np.array(other) - board.position)
        angles = np.degrees([np.arctan2(left, ahead), np.arctan2(up, np.hypot(ahead, left))])
        pattern *= np.exp(-np.log(2) / 2 * np.sum((angles / board.aim.half_power_deg) ** 2))
    w = board.waveform
    a = -antennas.gain * C / board.centre_hz / (4 * np.pi * distance) * pattern
    f = w.fc + w.slope * np.arange(board.samples) / board.adc_rate_hz
    return a * np.exp(-2j * np.pi * f * distance / C)


def test_every_pair_of_a_board_sees_the_wall_by_its_own_way() -> None:
    room = {"box_m": BOX, "faces": {"back": "metal"}}
    scene = nominal_scene(board_config(room=room), activity_named("punching"))
    made = record(scene, ["cube", "echo", "board", "faces_echo"])
    board = made["board"]
    right = np.array([by_hand(board, k, r) for k, r in board.pairs]) * board.signs[:, None]
    assert np.abs(made["faces_echo"] - right).max() < 1e-10 * np.abs(right).max()
    assert np.abs(still_of(made) - right).max() < 1e-5 * np.abs(right).max()  # of float32


def test_two_transmitters_at_once_send_sum_and_difference() -> None:
    cfg = ISK_BPM.replace("chirpCfg 0 0 0 0 0 0 0 1", "chirpCfg 0 0 0 0 0 0 0 5")
    lines = [line for line in cfg.splitlines() if not line.startswith("chirpCfg")]
    masks = [f"chirpCfg {n} {n} 0 0 0 0 0 {mask}" for n, mask in enumerate((5, 2, 5))]
    lines[-1:-1] = [*masks, "bpmCfg -1 1 0 2"]
    radar = {"device": "IWR6843ISK", "cfg": "\n".join(lines), "position_m": [0, 0, 1]}
    room = {"box_m": BOX, "faces": {"back": "metal"}}
    scene = nominal_scene(board_config(radar=radar, room=room), activity_named("punching"))
    made = record(scene, ["board", "faces_echo"])
    board, still = made["board"], made["faces_echo"]
    alone = np.array([by_hand(board, k, r) for k, r in board.pairs])
    lower, higher = alone[board.sums], alone[board.differences]
    assert np.allclose(still[board.sums], lower + higher, rtol=1e-9, atol=0)
    assert np.allclose(still[board.differences], lower - higher, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("kind", ["direct", "cube"])
def test_the_tolerance_of_what_moves_is_kept_beside_a_strong_wall(kind: str) -> None:
    far = {"motion": {"range_m": 3.2}, "subject": {"weight_kg": 50}}
    scene = nominal_scene(board_config(engine={"kind": kind}, **far), activity_named("punching"))
    made = record(scene, ["cube", "echo", "faces_echo"])
    exact = nominal_scene(board_config(engine={"kind": "cube"}, **far), activity_named("punching"))
    right = record(exact, ["echo"])["echo"].cube
    moving = made["cube"] - made["faces_echo"]
    assert np.linalg.norm(made["faces_echo"][0]) > np.linalg.norm(right[0, 0, 0])
    error = np.linalg.norm(moving - right) / np.linalg.norm(right)
    assert 20 * np.log10(error) < -80


def test_a_wall_beyond_the_largest_range_is_filtered_out() -> None:
    for x, seen in ((3.7, True), (3.8, False)):  # c fs/(2 K) is 3.746 m
        room = {"box_m": BOX | {"x": [-0.5, x]}, "faces": {"back": "metal"}}
        scene = nominal_scene(board_config(room=room), activity_named("punching"))
        assert record(scene, ["faces_echo"])["faces_echo"].any() == seen


def test_clutter_removal_leaves_nothing_of_the_room() -> None:
    scene = nominal_scene(board_config(), activity_named("punching"))
    names = ["range_doppler", "range_azimuth", "points"]
    made = record(scene, [*names, "faces_echo"])
    bare = record(scene, names, faces_echo=np.zeros_like(made["faces_echo"]))
    for name in names[:2]:
        one, other = made[name].power, bare[name].power
        assert np.abs(one - other).max() < 1e-5 * other.max()
    assert len(made["points"]) == len(bare["points"])


def test_without_clutter_removal_the_wall_is_in_the_frames() -> None:
    room = {"box_m": BOX | {"x": [-0.5, 3]}, "faces": {"back": "metal"}}
    clutter = {"processing": {"clutter": "none"}, "motion": {"range_m": 1.5}}
    scene = nominal_scene(board_config(room=room, **clutter), activity_named("punching"))
    made = record(scene, ["range_doppler", "cloud"])
    at_rest = made["range_doppler"].power[0, :, 16]  # zero Doppler of 32 bins
    ranges = made["range_doppler"].rows.values
    beyond = ranges > 2.3  # the person
    assert ranges[beyond][np.argmax(at_rest[beyond])] == pytest.approx(3, abs=0.05)
    points = made["cloud"].points
    reach = np.linalg.norm(points[:, :3], axis=1)
    at_wall = points[(np.abs(reach - 3) < 0.1) & (points[:, 3] == 0)]
    assert len(at_wall)
    azimuth = np.degrees(np.arctan2(at_wall[:, 1], at_wall[:, 0]))
    assert abs(np.median(azimuth) + 10) < 3  # of a board turned 10 degrees to the left
