"""Axes of the maps: what their rows and columns mean."""

import numpy as np
import pytest
import reference as ref
from radhar_cli.pipeline.axes import Axes, axes_of

from radhar_cli.activity import activity_named
from radhar_cli.config.schema import MAP_NAMES, Config
from radhar_cli.motion.paper.body import Body
from radhar_cli.pipeline.plan import plan
from radhar_cli.pipeline.run import Recording, run
from radhar_cli.scene import draw_scene

SLOW = {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 128}  # L = 51, odd
FAST = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 1000}  # L = 400, even


def record(radar: dict, maps: tuple[str, ...], **more: object) -> Recording:
    config = Config.model_validate({"radar": radar, "maps": maps, "snr_db": None} | more)
    return run(plan(config, maps), draw_scene(config, activity_named("walking"), 0), config)


@pytest.mark.parametrize("radar", [SLOW, FAST], ids=["odd window", "even window"])
@pytest.mark.parametrize(
    "processing", [{}, {"mti": False}, {"stft_fft_length": 512}, {"range_fft_length": 1000}]
)
def test_every_map_has_an_axis_value_a_row_and_column(radar, processing):
    recording = record(radar, MAP_NAMES, processing=processing, duration_s=2.0)
    for name in MAP_NAMES:
        axes = axes_of(name, recording)
        assert recording.products[name].shape == (axes.vertical.size, axes.time.size)
        assert (np.diff(axes.vertical) > 0).all()
        assert (np.diff(axes.time) > 0).all()


@pytest.mark.parametrize("with_mti", [True, False])
def test_settings_of_the_paper(with_mti):
    """77 GHz: 7.5 m in 200 bins, 2000 Doppler bins of 2.5 Hz, frames every 40 ms."""
    recording = record({}, ("rtm",), processing={"mti": with_mti})
    late = 0.5e-4 * 2 if with_mti else 0.0  # half a pulse interval of 0.2 ms
    rtm, stft = axes_of("rtm", recording), axes_of("stft", recording)
    assert rtm.vertical == pytest.approx(np.arange(200) * ref.C / 8e9)
    kept = 20000 - with_mti
    columns = np.floor((np.arange(256) + 0.5) * kept / 256)
    assert rtm.time == pytest.approx(columns / 5000 + late, abs=1e-12)
    assert stft.vertical == pytest.approx(np.arange(-1000, 1000) * 2.5)
    assert stft.time == pytest.approx(np.arange(stft.time.size) * 0.04 + 0.1999 + late, abs=1e-12)
    assert stft.time.size == (90 if with_mti else 91)


def test_odd_windows_have_zero_doppler_in_the_middle():
    stft = axes_of("fsst_denoised", record(SLOW, ("rtm",)))
    assert stft.vertical == pytest.approx(np.arange(-25, 26) * 128 / 51)


def test_stft_fft_length_is_of_the_stft_alone():
    recording = record(SLOW, ("rtm",), processing={"stft_fft_length": 128})
    assert axes_of("stft_compensated", recording).vertical == pytest.approx(np.arange(-64, 64.0))
    assert axes_of("fsst", recording).vertical.size == 51


def test_extent_is_the_outer_edges():
    axes = Axes(np.array([-1.0, 0.0, 1.0]), np.array([0.25, 0.75]))
    assert axes.extent == pytest.approx((0.0, 1.0, -1.5, 1.5))
    assert Axes(np.array([2.0, 4.0]), np.array([0.3])).extent == pytest.approx((0.3, 0.3, 1, 5))


@pytest.fixture
def only_the_torso(monkeypatch):
    """Leave one scatterer, so that the maps show one ridge."""
    monkeypatch.setattr(Body, "cross_sections", np.eye(13)[0])


# A torso at the height of the antennas that walks radially: its distance is x less 0.4 m.
RADIAL = {
    "subject": {"height_m": 1.8},
    "motion": {"range_m": 3.4, "angle_deg": 0, "speed_mps": 1.0},
}


@pytest.mark.usefixtures("only_the_torso")
def test_range_axis_shows_the_distance_at_the_column_time():
    radar = FAST | {"tx_m": [0.4, 0, 1.2], "rx_m": [0.4, 0, 1.2], "bandwidth_hz": 2e9}
    recording = record(radar, ("rtm",), processing={"range_fft_length": 2000}, **RADIAL)
    axes = axes_of("rtm", recording)
    ridge = axes.vertical[recording.products["rtm"].argmax(axis=0)]
    step = axes.vertical[1]
    assert step == pytest.approx(ref.C / 4e9 / 5)
    assert np.abs(ridge - (3.0 + axes.time)).max() < 0.6 * step


@pytest.mark.usefixtures("only_the_torso")
@pytest.mark.parametrize("name", ["stft", "fsst"])
@pytest.mark.parametrize("with_mti", [True, False])
def test_time_axis_is_the_centre_of_the_frames(name, with_mti):
    """A walker who passes abeam: the Doppler crosses zero there, and the map within a column."""
    radar = FAST | {"tx_m": [0, 0, 1.2], "rx_m": [0, 0, 1.2]}
    motion = {"range_m": 2.0, "cross_range_m": -2.0, "angle_deg": 90, "speed_mps": 1.0}
    recording = record(
        radar,
        (name,),
        subject={"height_m": 1.8},
        motion=motion,
        processing={"mti": with_mti, "window_fraction": 0.05, "overlap_fraction": 0.98},
    )
    axes = axes_of(name, recording)
    power = recording.products[name]
    assert axes.vertical[power.argmax(axis=0)][0] > 0  # still approaching
    doppler = power.T @ axes.vertical / power.sum(axis=0)
    # MTI blinds the map at zero Doppler; the crossing is found from both sides of it.
    away = np.abs(axes.time - 2.0) < 0.6
    slope, offset = np.polyfit(axes.time[away] - 2.0, doppler[away], 1)
    waveform = recording.waveform
    assert slope == pytest.approx(-2 * waveform.f0 / ref.C / 2.0, rel=0.1)
    assert abs(offset / slope) < 0.5 * (axes.time[1] - axes.time[0])
