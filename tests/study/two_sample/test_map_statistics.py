"""Statistics of maps whose numbers are known."""

import numpy as np
import pytest

from radhar_cli.numerics.arrays import Float
from radhar_cli.study.two_sample.map_statistics import (
    STATISTICS,
    DopplerMap,
    mask_statistics,
    power_statistics,
)

ROWS, COLUMNS, SECONDS = 100, 200, 4.0
DOPPLER: Float = 10.0 * (49.5 - np.arange(ROWS))  # 10 Hz a row, from 495 to -495 Hz
ZERO = 20.0  # four rows at 5 and 15 Hz


def map_of_a_bump(shift=0):
    """A zero line of four rows; +-95 Hz from 1 to 2 s above it, to 2.5 s below it."""
    cells = np.zeros((ROWS, COLUMNS), bool)
    cells[48:52] = True
    cells[40:48, 50 + shift : 100 + shift] = True
    cells[52:60, 50 + shift : 125 + shift] = True
    return cells


def test_numbers_of_a_bump():
    found = mask_statistics(map_of_a_bump(), DOPPLER, SECONDS, ZERO)
    assert found.keys() == {name for name, one in STATISTICS.items() if not one.of_power}
    expected = {
        "active": 1.5,
        "first": 1.0,
        "receding": 60.0,  # 75 of 125 columns
        "zero_line": 100.0,
        "zero_line_offset": 0.0,
        "start_height": 40.0,
        "upper_envelope": 95.0,
        "lower_envelope": -95.0,
        "swings": 0.0,  # as much up as down, then down
        "stray": 0.0,
        "occupied": 100 * 8 * 125 / (96 * 200),
    }
    for name, value in expected.items():
        assert found[name] == pytest.approx(value), name
    assert found["width"] == pytest.approx(180, abs=15)


def test_a_shift_in_time_changes_times_alone():
    early = mask_statistics(map_of_a_bump(), DOPPLER, SECONDS, ZERO)
    late = mask_statistics(map_of_a_bump(25), DOPPLER, SECONDS, ZERO)
    assert late["first"] == pytest.approx(early["first"] + 0.5)
    assert all(late[n] == pytest.approx(early[n]) for n in early if n != "first")


def test_a_mirrored_map_recedes_as_much_as_it_approached():
    one = mask_statistics(map_of_a_bump(), DOPPLER, SECONDS, ZERO)
    other = mask_statistics(map_of_a_bump()[::-1], DOPPLER, SECONDS, ZERO)
    assert other["receding"] == pytest.approx(100 - one["receding"])
    assert other["upper_envelope"] == pytest.approx(-one["lower_envelope"])
    assert other["active"] == one["active"]


def test_interference_and_noise_are_stray():
    cells = map_of_a_bump()
    clean = mask_statistics(cells, DOPPLER, SECONDS, ZERO)
    cells[20] = True  # a line at 295 Hz
    cells[80, 10] = True
    dirty = mask_statistics(cells, DOPPLER, SECONDS, ZERO)
    assert dirty["stray"] == pytest.approx(100 * 201 / (96 * 200))
    assert all(dirty[name] == clean[name] for name in clean if name != "stray")


def test_fading_of_the_zero_line():
    cells = map_of_a_bump()
    cells[:, 180:] = False
    found = mask_statistics(cells, DOPPLER, SECONDS, ZERO)
    assert found["zero_line"] == pytest.approx(90)


@pytest.mark.parametrize("full", [False, True])
def test_maps_of_nothing_and_of_everything(full):
    found = mask_statistics(np.full((ROWS, COLUMNS), full), DOPPLER, SECONDS, ZERO)
    assert found["occupied"] == (100 if full else 0)
    assert found["active"] == (SECONDS if full else 0)
    assert np.isfinite(found["receding"]) == full


def test_a_range_time_map_has_no_line_at_zero():
    cells = np.zeros((ROWS, COLUMNS), bool)
    cells[30:40] = True
    metres = (np.arange(ROWS)[::-1] + 0.5) / 10
    found = mask_statistics(cells, metres, SECONDS, -1)
    assert found["upper_envelope"] == pytest.approx(6.95)
    assert found["lower_envelope"] == pytest.approx(6.05)
    assert found["active"] == SECONDS


def walker(limb_db, ripple=0.0):
    """A torso near 100 Hz, 40 dB over exponential noise, a limb at 300 Hz, a zero line."""
    rng = np.random.default_rng(0)
    power = rng.exponential(1.0, (ROWS, COLUMNS))
    torso = 105 + ripple / 2 * np.sign(np.sin(np.arange(COLUMNS) / 15))
    for column, doppler in enumerate(torso):
        row = int(np.abs(DOPPLER - doppler).argmin())
        power[row - 2 : row + 3, column] += 1e4 * np.array([0.25, 0.5, 1, 0.5, 0.25])
    power[np.abs(DOPPLER - 305).argmin()] += 1e4 * 10 ** (-limb_db / 10)
    power[49] += 100
    return DopplerMap(power, DOPPLER)


def test_power_of_a_walker():
    found = power_statistics(walker(15), ZERO, 430, 20)
    assert found.keys() == {name for name, one in STATISTICS.items() if one.of_power}
    assert found["peak_over_floor"] == pytest.approx(40, abs=0.2)
    assert found["limb_below_torso"] == pytest.approx(15, abs=0.2)
    assert found["noise_sd"] == pytest.approx(5.57, abs=0.3)  # of an exponential's decibels
    assert found["torso_median"] == pytest.approx(105)
    assert found["torso_ripple"] == 0
    share = 10**-1.5 / 2.5  # of five rows of the torso
    assert found["fast_energy"] == pytest.approx(100 * share / (1 + share), abs=0.3)
    assert found["torso_energy"] == pytest.approx(100 / (1 + share), abs=0.3)
    assert abs(found["receding_energy"]) < 0.3


def test_a_brighter_limb_and_a_torso_that_ripples():
    assert power_statistics(walker(5), ZERO, 430, 20)["limb_below_torso"] < 6
    found = power_statistics(walker(30, ripple=40), ZERO, 430, 20)
    assert found["torso_ripple"] == pytest.approx(40)


def test_a_limb_is_as_bright_as_in_its_brighter_columns():
    """The 75th percentile over time: limbs that swing are bright in less than half of it."""
    walk = walker(15)
    swinging = walk.power.copy()
    swinging[(DOPPLER > 190) & (DOPPLER < 430), : 2 * COLUMNS // 5] *= 10
    found = power_statistics(DopplerMap(swinging, DOPPLER), ZERO, 430, 20)
    assert found["limb_below_torso"] == pytest.approx(5, abs=0.3)


def test_a_receding_walker_has_the_same_limbs():
    one = walker(15)
    away = power_statistics(DopplerMap(one.power[::-1], DOPPLER), ZERO, 430, 20)
    assert away["limb_below_torso"] == pytest.approx(15, abs=0.2)
    assert away["torso_median"] == pytest.approx(-105)
    assert away["receding_energy"] > 99


def test_a_map_without_power():
    found = power_statistics(DopplerMap(np.zeros((ROWS, COLUMNS)), DOPPLER), ZERO, 430, 20)
    assert np.isnan(found["fast_energy"])
    assert not DopplerMap(np.zeros((ROWS, COLUMNS)), DOPPLER).signal_mask(430).any()


@pytest.mark.parametrize("limb_db", [10, 30])
def test_shares_of_an_energy_that_noise_hides_are_left_out(limb_db):
    """Noise after a first difference is weaker near zero; a share is from 0 to 100 %, or none."""
    noise = np.random.default_rng(2).exponential(1.0, (ROWS, COLUMNS))
    noise *= np.sin(np.pi * DOPPLER / 1000)[:, None] ** 2
    body = walker(limb_db).power
    body[body < 50] = 0
    shares = ("fast_energy", "receding_energy", "torso_energy")
    known = []
    for weaker in 10 ** np.arange(-2.0, 5.0, 0.25):
        found = power_statistics(DopplerMap(noise + body / weaker, DOPPLER), ZERO, 430, 20)
        assert all(np.isnan(found[name]) or 0 <= found[name] <= 100 for name in shares)
        assert len({bool(np.isnan(found[name])) for name in shares}) == 1
        known.append(np.isfinite(found["torso_energy"]))
        if np.isfinite(found["limb_below_torso"]):
            assert found["limb_below_torso"] == pytest.approx(limb_db, abs=1)
    assert known[0]
    assert not known[-1]
    assert known == sorted(known, reverse=True)


def test_where_nobody_is_seen_noise_is_no_torso():
    rng = np.random.default_rng(1)
    one = DopplerMap(rng.exponential(size=(ROWS, COLUMNS)), DOPPLER)
    cells = mask_statistics(one.signal_mask(430), DOPPLER, SECONDS, ZERO)
    assert cells["active"] == 0
    found = power_statistics(one, ZERO, 430, 15, cells["active"] > 0)
    finite = {name for name, value in found.items() if np.isfinite(value)}
    assert finite == {"peak_over_floor", "noise_sd"}
    assert found.keys() == {name for name, statistic in STATISTICS.items() if statistic.of_power}
