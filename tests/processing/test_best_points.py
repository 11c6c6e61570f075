"""Points of the chain that does what the data allow: interpolated, and separated in angle."""

import numpy as np
import points_on_a_walker
import pytest
from helpers.boards import MARS, cube_of

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.best_points import best_points
from radhar_cli.processing.frame_maps import hann
from radhar_cli.processing.points import board_points
from radhar_cli.radar.board import DEVICES, Array
from radhar_cli.radar.detection import CASO, Cfar, Detection
from radhar_cli.scene.products.run import record


def _strongest(cube: Float, board: object) -> Float:
    found = best_points(cube, board, False, 1e-5).points  # type: ignore[arg-type]
    return found[found[:, 4].argmax()]


@pytest.mark.parametrize("device", ["IWR1443BOOST", "IWR6843ISK", "IWR6843ISK-ODS", "IWR6843AOP"])
def test_places_and_speeds_are_interpolated(device: str) -> None:
    """rms errors of moving scatterers at 20 dB a sample: millimetres, some 0.01 m/s."""
    errors = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        r, az, el = rng.uniform(1, 3), *np.radians(rng.uniform((-45, -20), (45, 25)))
        p = r * np.array([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), np.sin(el)])
        v = rng.normal(size=3)
        cube, board = cube_of(p, v, seed=seed, array=DEVICES[device].array)
        best, middle = _strongest(cube, board), p + v * board.middles[0]
        speed = -v @ middle / np.linalg.norm(middle)
        errors.append([*(best[:3] - middle), best[3] - speed])
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert (rms < (0.006, 0.006, 0.012, 0.01)).all(), rms


def test_two_at_one_range_and_speed_are_two_points() -> None:
    u = np.array([(np.cos(a), np.sin(a), 0) for a in np.radians((10, -10))])
    cube, board = cube_of(2 * u, -u)
    found = best_points(cube, board, True, 1e-5).points
    assert len(found) == 2
    np.testing.assert_allclose(sorted(found[:, 1]), [-0.347, 0.347], atol=0.03)
    np.testing.assert_allclose(found[:, 2], 0, atol=0.03)


def test_false_alarms_are_about_as_many_as_asked_for() -> None:
    cube, board = cube_of((2, 0, 0), (0, 0, 0), snr_db=-90, frames=100)
    cells = MARS.n_fft * MARS.n_doppler * 100
    alarms = best_points(cube, board, False, 1e-4).start[-1]
    assert 0.2 * 1e-4 * cells < alarms < 4 * 1e-4 * cells


def test_a_peak_is_one_point() -> None:
    cube, board = cube_of((2.01, 0.2, 0.1), (-0.9, 0, 0))
    assert len(best_points(cube, board, True, 1e-5).points) == 1


HERE, UP = (0.0, 0.0), (0.0, 1.0)
WIDE = (90.0, 90.0)
# Receivers of one transmitter; what of the direction of a scatterer they tell: left, up.
FEW: dict[str, tuple[tuple[tuple[float, float], ...], bool, bool]] = {
    "one element": ((HERE,), False, False),
    "elements at one place": ((HERE, HERE, HERE), False, False),
    "a column": ((HERE, UP, (0, 2)), False, True),
    "a row of two": ((HERE, (1, 0)), True, False),
    "a row of three": ((HERE, (1, 0), (2, 0)), True, False),
    "a row with a gap": (tuple((float(n), 0.0) for n in (0, 1, 2, 4, 5, 6)), True, False),
    "a wide spacing": (tuple((1.1 * n, 0.0) for n in range(6)), True, False),
}


@pytest.mark.parametrize("chain", ["best", "board"])
@pytest.mark.parametrize("name", FEW)
def test_few_elements_tell_what_they_can(name: str, chain: str) -> None:
    """A point at the right range and speed, of `best` no other; an angle that is not told is 0."""
    receivers, left, up = FEW[name]
    if chain == "board" and name == "a row with a gap":
        pytest.skip("refused in a config: the firmware takes elements for neighbours")
    p = 2 * np.array([np.sqrt(1 - 0.3**2 - 0.2**2), 0.3, 0.2])
    board = {
        "array": Array((HERE,), receivers, (1.0,) * len(receivers), WIDE),
        "masks": (1,),
        "receivers": tuple(range(len(receivers))),
        "slot_s": 171e-6,
    }
    cube, given = cube_of(p, -p / 2, **board)
    if chain == "best":
        found = best_points(cube, given, True, 1e-6).points
    else:
        cfar = Cfar(CASO, 8, 4, False, 15.0)
        peaks = Detection(cfar, grouping=(True, True), remove_mean=True)
        found = board_points(cube, given, peaks, quantise=False).points
    assert len(found) == 1 or chain == "board"
    x, y, z, speed = found[found[:, 4].argmax(), :4]
    assert np.sqrt(x * x + y * y + z * z) == pytest.approx(2, abs=0.04)
    assert speed == pytest.approx(1, abs=0.1)
    within = 0.03 if chain == "best" else 0.1
    assert y / 2 == pytest.approx(0.3 if left else 0, abs=within)
    assert z / 2 == pytest.approx(0.2 if up else 0, abs=within)


def test_two_equal_in_a_cell_make_no_third_point() -> None:
    rng, frames, strays, errors = np.random.default_rng(5), 40, 0, list[float]()
    for seed in range(frames):
        apart, speed = rng.uniform(20, 80), rng.uniform(0.3, 1.5)
        middle = rng.uniform(-1, 1) * (50 - apart / 2)
        az = np.radians([middle - apart / 2, middle + apart / 2])
        el = np.radians(rng.uniform(-8, 8))
        ways = np.stack(
            [np.cos(az) * np.cos(el), np.sin(az) * np.cos(el), np.full(2, np.sin(el))], axis=1
        )
        p = ways * rng.uniform(1.5, 3) + ways * rng.uniform(0, 0.004, (2, 1))
        cube, board = cube_of(p, ways * speed, snr_db=20.0, seed=seed)
        points = best_points(cube, board, True, 1e-5).points
        nearest = np.linalg.norm(points[:, None, :3] - p, axis=2).min(axis=1)
        strays += bool((nearest > 0.35).any())
        azimuth = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
        error = np.abs(azimuth[:, None] - np.degrees(az)).min(axis=1)
        errors += error[nearest < 0.35].tolist()
    assert strays <= 0.08 * frames
    assert np.sqrt(np.mean(np.square(errors))) < 0.5


@pytest.mark.parametrize("cell_db", [5.6, 20.6, 35.0, 50.6, 70.6, 90.0])
def test_snr_does_not_saturate(cell_db: float) -> None:
    """Power over the noise of the frame, noise of the cell included: 1 dB more at 5.6 dB."""
    fast, slow = hann(MARS.samples), hann(MARS.loops)
    gain = fast.sum() ** 2 / (fast**2).sum() * slow.sum() ** 2 / (slow**2).sum()
    snr_db = cell_db - 10 * float(np.log10(gain))
    expected = 10 * np.log10(1 + 10 ** (cell_db / 10))
    each = []
    for seed in range(4):
        cube, board = cube_of([[2.0, 0.3, 0.1]], [[0.7, 0, 0]], snr_db=snr_db, seed=seed)
        each.append(best_points(cube, board, True, 1e-5).points[:, 5].max())
    assert np.mean(each) == pytest.approx(expected, abs=0.5)


@pytest.mark.parametrize("device", ["IWR1443BOOST", "IWR6843ISK-ODS"])
def test_what_moves_is_nowhere_at_rest(device: str) -> None:
    """The mean of its loops, which is taken out, is no echo at speed 0."""
    rng = np.random.default_rng(8)
    for seed in range(25):
        r, az = rng.uniform(1, 3), np.radians(rng.uniform(-50, 50))
        way, speed = (
            np.array([np.cos(az), np.sin(az), 0]),
            rng.uniform(0.3, 2) * rng.choice([-1, 1]),
        )
        changes = {"array": DEVICES[device].array, "seed": seed, "snr_db": 30.0}
        cube, board = cube_of(r * way, speed * way, **changes)
        points = best_points(cube, board, True, 1e-7).points
        np.testing.assert_allclose(points[:, 3], -speed, atol=0.1)


def test_noise_makes_a_point_a_cell_that_exceeds_by_chance() -> None:
    rng, counts = np.random.default_rng(3), []
    for _ in range(20):
        cube, board = cube_of([[2.0, 0, 0]], [[0, 0, 0]], snr_db=None)
        noise = rng.standard_normal((2, *cube.shape)).astype(np.float32)
        counts.append(len(best_points(noise[0] + 1j * noise[1], board, True, 1e-3).points))
    cells = board.n_fft * board.n_doppler
    assert 0.2e-3 * cells < np.mean(counts) < 1.5e-3 * cells


@pytest.fixture(scope="module", params=["iwr1443boost", "bgt60tr13c", "tinyrad24g"])
def clouds(request: pytest.FixtureRequest) -> dict[str, tuple[float, float]]:
    """Points a frame on a walker about 4 m away and off, of each noise."""
    noises = ["default", "none", "20 dB", "60 dB", "120 dB"]
    made = points_on_a_walker.clouds_of_walk(request.param, 4.0, 1, noises)
    counts = [points_on_a_walker.count_points(*of_noise) for of_noise in made]
    return dict(zip(noises, counts, strict=True))


def test_a_walker_has_points_at_any_noise(clouds: dict[str, tuple[float, float]]) -> None:
    for near, _ in clouds.values():
        assert near > 5


def test_little_noise_makes_no_phantoms(clouds: dict[str, tuple[float, float]]) -> None:
    for noise in ("none", "60 dB", "120 dB"):
        near, off = clouds[noise]
        assert off < 0.2 * near
    assert clouds["none"][0] == pytest.approx(clouds["120 dB"][0], rel=0.1)


@pytest.mark.parametrize("remove_mean", [True, False])
@pytest.mark.parametrize("snr_db", [0.0, 30.0, 60.0, 100.0])
def test_a_scatterer_is_one_point_at_any_noise(snr_db: float, remove_mean: bool) -> None:
    rng = np.random.default_rng(6)
    for seed in range(8):
        way = np.array([np.cos(azimuth := rng.uniform(-0.8, 0.8)), np.sin(azimuth), 0])
        speed = rng.uniform(0.4, 2) * rng.choice([-1, 1])
        cube, board = cube_of(rng.uniform(1, 3) * way, speed * way, snr_db=snr_db, seed=seed)
        (point,) = best_points(cube, board, remove_mean, 1e-7).points
        assert point[3] == pytest.approx(-speed, abs=0.1)


@pytest.mark.parametrize("remove_mean", [True, False])
def test_frames_without_an_echo_have_no_points(remove_mean: bool) -> None:
    cube, board = cube_of((2, 0, 0), (0, 0, 0))
    assert not len(best_points(np.zeros_like(cube), board, remove_mean, 1e-5).points)


@pytest.mark.parametrize("name", ["iwr1443boost", "bgt60tr13c"])
def test_points_do_not_follow_from_rounding(name: str) -> None:
    """Echoes that were taken out leave rounding, on which no further point depends."""
    scene = points_on_a_walker.walk(name, 3.0, 1, "default")
    made = record(scene, ["cube", "board"])
    cube, board = made["cube"], made["board"]
    one, other = (best_points(samples, board, True, 1e-5) for samples in (cube, 1.7 * cube))
    np.testing.assert_array_equal(one.start, other.start)
    np.testing.assert_allclose(one.points[:, :4], other.points[:, :4], atol=1e-3)
