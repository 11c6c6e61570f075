"""Coloured noise and interference lines: their spectrum, and that every form of the echo agrees."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config.data_set import Config
from radhar_cli.echo.receiver.flicker import FlickerNoise
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.echo.receiver.interference import InterferenceLine
from radhar_cli.echo.receiver.noise import WhiteNoise
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.numerics.randomness import NOISE, stream
from radhar_cli.processing import look as look_module
from radhar_cli.processing.canceller import Fir
from radhar_cli.processing.look import FastTime, Look, RangeBins, RangeSum, RawSamples
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, draw_scene, scene_numbers

PRF, SAMPLES = 1000.0, 16


def waveform(pulses: int, fft_length: int | None = None) -> Waveform:
    return Waveform(24e9, 1e9, 32e-6, SAMPLES / 32e-6, PRF, pulses / PRF, fft_length)


def named(name: str) -> np.random.Generator:
    return stream(7, NOISE, 0, 0, name=name)


def flicker(corner: float, slope: float = 10.0) -> FlickerNoise:
    return FlickerNoise(1.0, named, corner, slope)


def alone(impairment: Impairment, fast: FastTime, name: str = "any", **more: object) -> np.ndarray:
    """What an impairment adds to an echo of zero, as all pulses show it [K, M]."""
    look = Look.of_all(name, fast, **more)
    return impairment.apply(np.zeros((fast.rows, look.count), complex), look)


def spectrum(x: np.ndarray, band: tuple[float, float]) -> float:
    """Mean power of the samples' spectrum between two frequencies, 1 for white noise of power 1."""
    power = np.mean(np.abs(np.fft.fft(x, axis=-1)) ** 2, axis=0) / x.shape[-1]
    f = np.abs(np.fft.fftfreq(x.shape[-1], 1 / PRF))
    return float(np.mean(power[(f >= band[0]) & (f < band[1])]))


@pytest.mark.parametrize("slope", [5.0, 10.0, 20.0])
def test_the_spectrum_of_coloured_noise(slope):
    """The model's own spectrum is the one asked for, from 1/T to PRF/2, within 1 dB."""
    pole, sd = flicker(20.0, slope).processes(waveform(4000))
    f = np.geomspace(1 / 4.0, PRF / 3, 50)[:, None]
    turn = np.exp(-2j * np.pi * f / PRF)
    found = np.sum(sd**2 * (1 - pole**2) / np.abs(1 - pole * turn) ** 2, axis=1)
    right = (20.0 / f[:, 0]) ** (slope / 10)
    strong = right > 0.05  # below that it vanishes in the white noise, of power 1
    assert np.abs(10 * np.log10(found / right))[strong].max() < 1.0


def test_every_form_has_that_spectrum():
    """As strong as white noise at the corner, 10 dB stronger at a tenth of it: 5 sd of the mean."""
    noise, w = flicker(50.0), waveform(4000)
    forms = {
        "some bins": alone(noise, RangeBins(w, slice(0, 8))) / np.sqrt(SAMPLES),
        "all bins": alone(noise, RangeBins(w)) / np.sqrt(SAMPLES),
        "raw": alone(noise, RawSamples(w)),
    }
    for name, x in forms.items():
        for band, right in (((45.0, 55.0), 1.0), ((4.5, 5.5), 10.0), ((300.0, 400.0), 0.145)):
            count = len(x) * 2 * 4 * (band[1] - band[0])
            assert spectrum(x, band) == pytest.approx(right, rel=0.15 + 5 / np.sqrt(count)), name


def test_the_sum_over_the_bins_amplifies_coloured_noise_as_it_does_white():
    w, coherent = waveform(200), RangeSum(waveform(200))
    trials = [
        FlickerNoise(1.0, lambda name, n=n: stream(n, NOISE, name=name), 50.0, 10.0)
        for n in range(300)
    ]
    direct = np.mean([np.abs(alone(one, coherent)) ** 2 for one in trials])
    cube = np.mean([np.abs(coherent(alone(one, RawSamples(w)))) ** 2 for one in trials])
    assert direct == pytest.approx(cube, rel=0.2)


def test_two_of_a_kind_in_one_receiver_are_each_their_own():
    """Two coloured noises have each its spectrum, two of any kind no random numbers in common."""
    raw = RawSamples(waveform(4000))
    first, second = flicker(50.0, 10.0), flicker(50.0, 20.0)
    twins = [(first, second), (WhiteNoise(1.0, named), WhiteNoise(1.0, named))]
    for one, other in twins:
        look = Look.of_all("any", raw)
        zero = np.zeros((SAMPLES, look.count), complex)
        x, y = (impairment.apply(zero, look) for impairment in (one, other))
        assert np.array_equal(x, alone(one, raw))  # the first as if it were alone
        common = np.abs(np.vdot(x[:, :400], y[:, :400]))
        assert common < 0.3 * np.linalg.norm(x[:, :400]) * np.linalg.norm(y[:, :400])
        for band in (45.0, 55.0), (4.5, 5.5):
            assert spectrum(y, band) == pytest.approx(spectrum(alone(other, raw), band), rel=0.7)


@given(st.lists(st.integers(1, 40), min_size=1, max_size=6))
@settings(max_examples=20, deadline=None)
def test_blocks_of_any_length_give_the_same(lengths):
    total = sum(lengths)
    for impairment in (
        flicker(30.0),
        InterferenceLine(0.3, 123.0, waveform(total), named, "line 0"),
        InterferenceLine(
            0.3, 123.0, waveform(total), named, "line 0", mean_on_s=0.01, mean_off_s=0.01
        ),
    ):
        raw = RawSamples(waveform(total))
        whole, look = alone(impairment, raw), Look.of_all("any", raw)
        edges = np.cumsum([0, *lengths])
        blocks = [
            impairment.apply(np.zeros((SAMPLES, stop - first), complex), look.part(first, stop))
            for first, stop in pairwise(edges)
        ]
        assert np.concatenate(blocks, axis=1) == pytest.approx(whole)


@pytest.mark.parametrize("taps", [(1.0,), (-1.0, 1.0), (1.0, -2.0, 1.0)])
def test_coloured_noise_at_some_pulses_is_that_of_all(taps, monkeypatch):
    """Also where the pulses come in several blocks."""
    monkeypatch.setattr(look_module, "BLOCK", 50)
    bins, pulses = RangeBins(waveform(400)), np.array([0, 7, 49, 50, 51, 99, 380])
    look = Look("any", bins, pulses, taps)
    found = flicker(30.0).apply(np.zeros((bins.rows, pulses.size), complex), look)
    assert found == pytest.approx(Fir(taps)(alone(flicker(30.0), bins))[:, pulses])


@pytest.mark.parametrize("fft_length", [None, 64])
@pytest.mark.parametrize("taps", [(1.0,), (-1.0, 1.0)])
@pytest.mark.parametrize("off", [0.0, 0.02])
def test_a_line_is_the_same_in_every_form(taps, fft_length, off):
    w = waveform(120, fft_length)
    line = InterferenceLine(0.3, 123.0, w, named, "line 0", mean_on_s=0.02, mean_off_s=off)
    beat = alone(line, RawSamples(w))
    there = np.abs(line.tone(np.arange(120)))
    assert np.abs(beat) == pytest.approx(np.tile(0.3 * there, (SAMPLES, 1)))
    assert off or beat.all()
    for fast in (RangeSum(w), RangeBins(w), RangeBins(w, slice(2, 6))):
        assert alone(line, fast) == pytest.approx(fast(beat))
        pulses = np.array([0, 7, 50, 118])
        look = Look("any", fast, pulses, taps)
        found = line.apply(np.zeros((fast.rows, 4), complex), look)
        assert found == pytest.approx(fast(Fir(taps)(beat)[:, pulses]))


def test_a_real_line_is_on_both_sides_at_the_same_times():
    w, pulses = waveform(4000), np.arange(4000)
    given = (1.0, 50.0, w, named, "line 0", 0.3, 0.3)
    one, both = (
        InterferenceLine(*given).tone(pulses),
        InterferenceLine(*given, real=True).tone(pulses),
    )
    assert both == pytest.approx(2 * one.real)
    spectrum = np.abs(np.fft.fft(both))
    at = round(50 * pulses.size / w.prf)
    assert spectrum[at] == pytest.approx(spectrum[-at])
    assert spectrum[at] > 0.9 * spectrum.max()


def test_a_line_comes_and_goes_as_often_as_it_should():
    """Exponential times: on for on/(on + off) of the time, also at the first pulse."""
    w = waveform(200_000)
    line = InterferenceLine(1.0, 0.0, w, named, "line 0", mean_on_s=0.02, mean_off_s=0.06)
    there = np.abs(line.tone(np.arange(w.n_pulses))) > 0.5
    edges = np.flatnonzero(np.diff(there))
    spells = np.diff(edges)[~there[edges[:-1]]] / w.prf  # from off to on: of being there
    assert there.mean() == pytest.approx(0.25, abs=0.03)
    assert spells.mean() == pytest.approx(0.02, rel=0.15)
    assert np.std(spells) == pytest.approx(0.02, rel=0.25)
    first = [
        InterferenceLine(
            1.0, 0.0, w, lambda name, k=k: np.random.default_rng([k, 1]), "l", 1.0, 3.0
        ).tone(np.arange(1))[0]
        for k in range(400)
    ]
    assert np.count_nonzero(first) == pytest.approx(100, abs=40)


RADAR = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 1000, "adc_rate_hz": 5e5}
LINES = [{"doppler_hz": -100, "level_db": 0}, {"doppler_hz": {"uniform": [200, 300]}}]


def scene_of(index: int = 0, **more: object) -> Scene:
    document = {"radar": RADAR, "processing": {"clutter": "none"}} | more
    return draw_scene(Config.model_validate(document), activity_named("stationary"), index)


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_lines_lie_at_their_doppler(engine):
    """Approaching is positive; each sample has its own draw, which is a number of the scene."""
    scene = scene_of(receiver={"tones": LINES}, engine={"kind": engine}, snr_db=-20)
    drawn = scene_numbers(scene)["receiver.tones.1.doppler_hz"]
    assert 200 <= drawn <= 300
    assert (
        drawn
        != scene_numbers(scene_of(1, receiver={"tones": LINES}))["receiver.tones.1.doppler_hz"]
    )
    stft = record(scene, ["stft"])["stft"]
    profile, f = stft.power.mean(axis=1), stft.rows.values
    far = np.abs(f) > 50
    strongest = f[far][np.argsort(profile[far])[::-1]]
    assert abs(strongest[0] + 100) <= 5
    assert abs(strongest[np.abs(strongest + 100) > 20][0] - drawn) <= 5


def test_lines_leave_the_white_noise_unchanged():
    plain, more = (
        record(scene_of(receiver=receiver), ["noise", "signal"])
        for receiver in ({}, {"noise_corner_hz": 10, "tones": LINES})
    )
    assert plain["noise"].sigma == more["noise"].sigma
    assert not np.array_equal(plain["signal"].x, more["signal"].x)
    again = record(scene_of(receiver={"noise_corner_hz": 10, "tones": LINES}), ["signal"])
    assert np.array_equal(again["signal"].x, more["signal"].x)


def test_lines_are_off_by_default_and_add_no_numbers():
    assert not [key for key in scene_numbers(scene_of()) if key.startswith(("receiver", "room"))]
