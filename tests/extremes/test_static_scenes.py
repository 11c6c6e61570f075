"""Static echoes: the MTI removes them completely, however strong they are."""

import numpy as np
import pytest
from helpers.extreme_scenes import config_of, record

from radhar_cli.config import MAP_NAMES, Config
from radhar_cli.echo.exact import beat_blocks
from radhar_cli.echo.static_returns import leakage, wall_echo
from radhar_cli.errors import SceneError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.look import RangeSum
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.track import PulseTrack
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.products.run import process
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.products.signal import SIGNALS
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.raw_echo import RAW_ECHO
from radhar_cli.scene.single.simulate import simulate

ALL = [f"{kind}{name}" for name in MAP_NAMES for kind in ("", "image:")]


@pytest.mark.parametrize("engine", ["cube", "direct"])
@pytest.mark.parametrize("wall", [None, {}], ids=["free space", "wall"])
def test_a_motionless_scene_is_black(engine: str, wall: dict | None) -> None:
    """Zeros all along: signals, maps, entropies, levels; and no warning from NumPy."""
    config = config_of(engine, wall=wall)
    found = record(config, *SIGNALS, *ALL, activity="stationary")
    for name in SIGNALS:
        assert not found[name].x.any()
    for name in MAP_NAMES:
        assert found[name].power.size
        assert not found[name].power.any()
        image = found[f"image:{name}"]
        assert image.entropy == 0
        assert image.levels.shape == (32, 32)
        assert not image.levels.any()


@pytest.mark.parametrize("engine", ["cube", "direct"])
def test_a_motionless_scene_without_mti_is_not(engine: str) -> None:
    config = config_of(engine, processing={"clutter": "none"})
    found = record(config, *ALL, activity="stationary")
    for name in MAP_NAMES:
        assert np.isfinite(found[name].power).all()
        assert found[f"image:{name}"].levels.max() == 255


# Rounding of a static return 1e3 times as strong as the echo, beside the 1e-2 that MTI leaves of
# it, would be 1e-11 of x; in power, over the map, far below this.
MAP_ERROR = 1e-6


def maps_of(beat: np.ndarray, config: Config) -> dict[str, np.ndarray]:
    """Power of all nine maps of a raw beat matrix."""
    given = record(config, "waveform", "canceller", "torso_track")
    waveform, canceller = given["waveform"], given["canceller"]
    moving = canceller(beat)
    x = RangeSum(waveform)(moving)[None]
    times = PulseTimes.even(moving.shape[1], waveform.prf, canceller.delay / waveform.prf)
    doppler = [name for name in MAP_NAMES if name != "rtm"]
    t = np.arange(given["torso_track"].size) / waveform.prf
    track = PulseTrack(t, given["torso_track"])
    found = process(Signal(x, times, waveform.f0), config, doppler, torso_track=track)
    return {"rtm": np.abs(range_compression(moving, waveform)) ** 2} | {
        name: found[name].power for name in doppler
    }


@pytest.mark.parametrize("snr_db", [None, 20.0], ids=["noiseless", "20 dB"])
def test_leakage_and_wall_echo_leave_no_trace(snr_db: float | None) -> None:
    """Raw beat with both static returns, and without: nine maps, the same."""
    motion = {"range_m": 4.0, "angle_deg": 20.0}
    config = config_of(radar={"carrier_hz": 2e9}, wall={}, snr_db=snr_db, motion=motion)
    scene = nominal_scene(config, activity_named("walking"))
    asked = ["paths", "waveform", "antennas", "wall", "receiver", "raw_echo"]
    recording = record_scene(scene, asked, [RAW_ECHO])
    paths, waveform, raw = recording["paths"], recording["waveform"], recording["raw_echo"]
    body = np.hstack([*beat_blocks(paths, waveform, recording["receiver"])])
    power = np.mean(np.sum(paths(waveform.times(np.arange(200.0))).amplitude ** 2, axis=0))
    for name, static in (
        ("leakage", leakage(recording["antennas"])),
        ("wall echo", wall_echo(recording["antennas"], recording["wall"], waveform)),
    ):
        above = 10 * np.log10(static.amplitude**2 / power)
        print(f"{name}: {above:.0f} dB above the body")
        assert above > 20
    assert body.shape == raw.shape == (20, 200)
    assert np.linalg.norm(raw) > 2 * np.linalg.norm(body)
    with_static, without = maps_of(raw, config), maps_of(body, config)
    assert set(with_static) == set(MAP_NAMES)
    for name, power in without.items():
        error = np.abs(with_static[name] - power).max() / power.max()
        print(f"{name}: differs by {error:.0e} of its maximum")
        assert power.max() > 0
        assert error < MAP_ERROR
        assert entropy_bits(with_static[name]) == pytest.approx(entropy_bits(power), abs=1e-4)


def test_a_wall_at_the_antennas_has_no_echo_in_a_raw_recording() -> None:
    """The antennas stand over the wall, in the plane of its near face: refused."""
    at = {"tx_m": [0.875, -0.1, 2.6], "rx_m": [0.875, 0.1, 2.6]}
    config = config_of(radar=at, wall={"size_m": [0.25, 5, 2.5]})
    assert simulate(config, "walking", nominal=True).beat is None
    with pytest.raises(SceneError, match=r"near face .*wall.center_m.* is 0 cm .*radar.tx_m"):
        simulate(config, "walking", nominal=True, raw=True)
