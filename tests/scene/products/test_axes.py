"""Axes of the maps: what their rows and columns mean."""

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import MAP_NAMES
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.scene.products.run import Results
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.scene import draw_scene

SLOW = {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 128}  # L = 51, odd
FAST = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 1000}  # L = 400, even
PAPER = {"motion": {"model": "paper"}}


def record(radar: dict, maps: tuple[str, ...], **more: object) -> Results:
    config = Config.model_validate({"radar": radar, "maps": maps, "snr_db": None} | more)
    scene = draw_scene(config, activity_named("walking"), 0)
    return record_scene(scene, [*maps, "waveform"])


@pytest.mark.parametrize("radar", [SLOW, FAST], ids=["odd window", "even window"])
@pytest.mark.parametrize(
    "processing", [{}, {"clutter": "none"}, {"stft_fft_length": 512}, {"range_fft_length": 1000}]
)
def test_every_map_has_an_axis_value_a_row_and_column(radar, processing):
    recording = record(radar, MAP_NAMES, processing=processing, duration_s=2.0, **PAPER)
    for name in MAP_NAMES:
        found = recording[name]
        assert found.power.shape == (found.rows.values.size, found.columns.values.size)
        assert (np.diff(found.rows.values) > 0).all()
        assert (np.diff(found.columns.values) > 0).all()


@pytest.mark.parametrize("with_mti", [True, False])
def test_settings_of_the_paper(with_mti):
    """77 GHz: 7.5 m in 200 bins, 2000 Doppler bins of 2.5 Hz, frames every 40 ms."""
    recording = record(
        {}, ("rtm", "stft"), processing={"clutter": "difference" if with_mti else "none"}, **PAPER
    )
    late = 0.5e-4 * 2 if with_mti else 0.0  # half a pulse interval of 0.2 ms
    rtm, stft = recording["rtm"], recording["stft"]
    assert rtm.rows.values == pytest.approx(np.arange(200) * ref.C / 8e9)
    kept = 20000 - with_mti
    columns = np.floor((np.arange(256) + 0.5) * kept / 256)
    assert rtm.columns.values == pytest.approx(columns / 5000 + late, abs=1e-12)
    assert stft.rows.values == pytest.approx(np.arange(-1000, 1000) * 2.5)
    assert stft.columns.values == pytest.approx(
        np.arange(stft.columns.values.size) * 0.04 + 0.1999 + late, abs=1e-12
    )
    assert stft.columns.values.size == (90 if with_mti else 91)


def test_odd_windows_have_zero_doppler_in_the_middle():
    stft = record(SLOW, ("fsst_denoised",), **PAPER)["fsst_denoised"]
    assert stft.rows.values == pytest.approx(np.arange(-25, 26) * 128 / 51)


def test_stft_fft_length_is_of_the_stft_alone():
    processing = {"stft_fft_length": 128}
    recording = record(SLOW, ("stft_compensated", "fsst"), processing=processing, **PAPER)
    assert recording["stft_compensated"].rows.values == pytest.approx(np.arange(-64, 64.0))
    assert recording["fsst"].rows.values.size == 51


def test_extent_is_the_outer_edges():
    def extent(rows: list[float], columns: list[float]) -> tuple[float, ...]:
        axes = Axis("frequency", "Hz", np.array(rows)), Axis("time", "s", np.array(columns))
        return PowerMap(np.zeros((len(rows), len(columns))), *axes).extent

    assert extent([-1.0, 0.0, 1.0], [0.25, 0.75]) == pytest.approx((0.0, 1.0, -1.5, 1.5))
    assert extent([2.0, 4.0], [0.3]) == pytest.approx((0.3, 0.3, 1, 5))


@pytest.fixture
def only_the_torso(monkeypatch):
    """Leave one scatterer, so that the maps show one ridge."""
    monkeypatch.setattr(PaperBody, "cross_sections", lambda self, t: np.eye(13)[0][:, None])


# A torso at the height of the antennas that walks radially: its distance is x less 0.4 m.
RADIAL = {
    "subject": {"height_m": 1.8},
    "motion": {"model": "paper", "range_m": 3.4, "angle_deg": 0, "walking": {"speed_mps": 1.0}},
}


@pytest.mark.usefixtures("only_the_torso")
def test_range_axis_shows_the_distance_at_the_column_time():
    radar = FAST | {
        "tx_m": [0.4, 0, 1.2],
        "rx_m": [0.4, 0, 1.2],
        "bandwidth_hz": 2e9,
        "antenna_isolation_db": 300,
    }
    recording = record(radar, ("rtm",), processing={"range_fft_length": 2000}, **RADIAL)
    rtm = recording["rtm"]
    ridge = rtm.rows.values[rtm.power.argmax(axis=0)]
    step = rtm.rows.values[1]
    assert step == pytest.approx(ref.C / 4e9 / 5)
    assert np.abs(ridge - (3.0 + rtm.columns.values)).max() < 0.6 * step


@pytest.mark.usefixtures("only_the_torso")
@pytest.mark.parametrize("name", ["stft", "fsst"])
@pytest.mark.parametrize("with_mti", [True, False])
def test_time_axis_is_the_centre_of_the_frames(name, with_mti):
    """A walker who passes abeam: the Doppler crosses zero there, and the map within a column."""
    radar = FAST | {"tx_m": [0, 0, 1.2], "rx_m": [0, 0, 1.2], "antenna_isolation_db": 300}
    motion = {
        "model": "paper",
        "range_m": 2.0,
        "cross_range_m": -2.0,
        "angle_deg": 90,
        "walking": {"speed_mps": 1.0},
    }
    recording = record(
        radar,
        (name,),
        subject={"height_m": 1.8},
        motion=motion,
        processing={
            "clutter": "difference" if with_mti else "none",
            "window_s": 0.2,
            "overlap_fraction": 0.98,
        },
    )
    power = recording[name].power
    frequency, time = recording[name].rows.values, recording[name].columns.values
    assert frequency[power.argmax(axis=0)][0] > 0  # still approaching
    doppler = power.T @ frequency / power.sum(axis=0)
    # MTI blinds the map at zero Doppler; the crossing is found from both sides of it.
    away = np.abs(time - 2.0) < 0.6
    slope, offset = np.polyfit(time[away] - 2.0, doppler[away], 1)
    waveform = recording["waveform"]
    assert slope == pytest.approx(-2 * waveform.f0 / ref.C / 2.0, rel=0.1)
    assert abs(offset / slope) < 0.5 * (time[1] - time[0])
