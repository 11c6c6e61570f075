"""What does not move: nothing of it is left after the MTI, however strong it is."""

import numpy as np
import pytest
from extreme_scenes import config_of, record
from radhar_cli.pipeline.models import waveform_of
from radhar_cli.processing.mti import mti

from radhar_cli.activity import activity_named
from radhar_cli.config import MAP_NAMES, Config
from radhar_cli.echo import cube
from radhar_cli.echo.static_returns import leakage, wall_echo
from radhar_cli.errors import SceneError
from radhar_cli.pipeline.plan import plan
from radhar_cli.pipeline.run import run
from radhar_cli.processing import fsst, stft
from radhar_cli.processing.denoising import savgol
from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.range_compression import (
    half_band_signal,
    range_bins,
    range_compression,
    range_power,
)
from radhar_cli.scene import nominal_scene
from radhar_cli.simulation.simulate import raw_echo, simulate

ALL = [f"{kind}{name}" for name in MAP_NAMES for kind in ("", "levels:", "entropy:")]
SIGNALS = [f"signal:{n}" for n in ("plain", "compensated", "denoised", "compensated_denoised")]


@pytest.mark.parametrize("engine", ["cube", "direct"])
@pytest.mark.parametrize("wall", [None, {}], ids=["free space", "wall"])
def test_a_motionless_scene_is_black(engine: str, wall: dict | None) -> None:
    """Zeros all along: signals, maps, entropies, levels; and no warning from NumPy."""
    config = config_of(engine, wall=wall)
    products = record(config, *SIGNALS, *ALL, activity="stationary").products
    for name in SIGNALS:
        assert not products[name].any()
    for name in MAP_NAMES:
        assert products[name].size
        assert not products[name].any()
        assert products[f"entropy:{name}"] == 0
        assert products[f"levels:{name}"].shape == (32, 32)
        assert not products[f"levels:{name}"].any()


@pytest.mark.parametrize("engine", ["cube", "direct"])
def test_a_motionless_scene_without_mti_is_not(engine: str) -> None:
    config = config_of(engine, processing={"mti": False, "window_fraction": 0.25})
    products = record(config, *ALL, activity="stationary").products
    for name in MAP_NAMES:
        assert np.isfinite(products[name]).all()
        assert products[f"levels:{name}"].max() == 255


# Rounding of a static return 1e3 times as strong as the echo, beside the 1e-2 that MTI leaves of
# it, would be 1e-11 of x; in power, over the map, far below this.
MAP_ERROR = 1e-6


def maps_of(beat: np.ndarray, config: Config) -> dict[str, np.ndarray]:
    """All nine maps of a raw beat matrix, by the functions of `processing` alone."""
    scene = nominal_scene(config, activity_named("walking"))
    waveform, processing = waveform_of(scene, config), config.processing
    frames = Frames.of(
        processing.window_fraction, processing.overlap_fraction, waveform.duration, waveform.prf
    )
    moving = mti(beat)
    maps = {"rtm": range_power(range_bins(moving, waveform))}
    x = half_band_signal(range_compression(moving, waveform))
    track = record(config, "torso_track").products["torso_track"]
    order, frame = processing.savgol.order, processing.savgol.frame
    still = compensate(x, track, waveform.f0)
    signals = {
        "": x,
        "_compensated": still,
        "_denoised": savgol(x, order, frame),
        "_compensated_denoised": savgol(still, order, frame),
    }
    for suffix, signal in signals.items():
        spectra = stft.Spectra(signal, frames, frames.length)
        blocks = {
            "stft": stft.power_blocks(spectra),
            "fsst": fsst.power_blocks(spectra, processing.fsst_threshold),
        }
        for kind, (power,) in blocks.items():
            maps[f"{kind}{suffix}"] = np.ldexp(power.T, 2 * spectra.exponent)
    return maps


@pytest.mark.parametrize("snr_db", [None, 20.0], ids=["noiseless", "20 dB"])
def test_leakage_and_wall_echo_leave_no_trace(snr_db: float | None) -> None:
    """Raw beat with both static returns, and without: nine maps, the same."""
    motion = {"range_m": 4.0, "angle_deg": 20.0}
    config = config_of(radar={"carrier_hz": 2e9}, wall={}, snr_db=snr_db, motion=motion)
    scene = nominal_scene(config, activity_named("walking"))
    wanted = ["paths"] if snr_db is None else ["paths", "signal_power"]
    recording = run(plan(config, wanted), scene, config)
    paths, waveform = recording.products["paths"], recording.waveform
    rng = None if snr_db is None else recording.noise("beat")
    blocks = cube.beat_blocks(paths, waveform, recording.sigma, rng)
    body = np.concatenate([block for _, block in blocks], axis=1)
    raw = raw_echo(recording)
    power = np.mean(np.sum(paths(waveform.times(np.arange(200.0))).amplitude ** 2, axis=0))
    for name, static in (
        ("leakage", leakage(paths.antennas)),
        ("wall echo", wall_echo(paths.antennas, paths.wall, waveform)),
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
