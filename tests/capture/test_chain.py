"""The processing chain on recordings: a simulated recording gives the maps of its scene."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from capture.dca1000_file import Radar, body, echo, words, write_studio
from helpers.command_line import radhar

from radhar_cli.capture.chain import Maps, maps_of
from radhar_cli.capture.importing import import_capture, read_settings, write_simulated
from radhar_cli.capture.recording import Label, Recording
from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processing.image import decibels
from radhar_cli.processing.look import RangeSum
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.single.simulate import Simulation, simulate

SCENE = """
activities: [walking]
duration_s: 2
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 1000, adc_rate_hz: 2.5e6, chirp_s: 40e-6}
motion: {range_m: 2, angle_deg: 0}
engine: {kind: cube}
"""
RADAR, FRAMES = Radar(samples=128, rate_ksps=5000, loops=64), 50


def config_of(folder: Path, *overrides: str, text: str = SCENE) -> Config:
    (folder / "scene.yaml").write_text(text)
    return load_config(folder / "scene.yaml", overrides)


def processed(path: Path, config: Config, *names: str, **options: object) -> Maps:
    with Recording(path) as recording:
        return maps_of(recording, config, names, **options)  # type: ignore[arg-type]


def apart(one: PowerMap, other: PowerMap, depth: float = 40.0) -> float:
    """Mean difference of two maps in dB, down to so far below the largest."""
    return float(np.abs(decibels(one.power, depth) - decibels(other.power, depth)).mean())


@pytest.mark.every(3)
@pytest.mark.parametrize(
    "overrides",
    [
        [],
        ["processing.clutter=mean"],
        ["processing.clutter=highpass"],
        ["processing.range_reference=start"],
        ["processing.range_fft_length=128"],
        ["processing.range_sum=gated"],
        ["engine.kind=direct"],
    ],
    ids=lambda o: "-".join(o) or "paper",
)
def test_a_simulated_recording_gives_the_maps_of_its_scene(
    tmp_path: Path, overrides: list[str]
) -> None:
    """But for rounding; compensation and gate go by the track that was found, not by the truth."""
    config = config_of(tmp_path, *overrides)
    scene = simulate(config, seed=3, raw=True, maps="all")
    assert scene.beat is not None
    write_simulated(tmp_path / "r.h5", scene.beat[None], scene.waveform, Label(label="walking"))
    names = possible_maps(config)
    found = processed(tmp_path / "r.h5", config, *names).maps
    for name in names:
        one, other = found[name], scene.maps[name]
        assert np.allclose(one.rows.values, other.rows.values)
        assert np.allclose(one.columns.values, other.columns.values)
        if "compensated" not in name:
            assert apart(one, other) < (0.1 if "gate" in str(overrides) else 1e-6), name


CW = "radar={waveform: cw, carrier_hz: 24e9, prf_hz: 1000}"
REAL = "radar={waveform: cw, output: real, carrier_hz: 24e9, prf_hz: 1000}"
IMPULSE = [
    "radar={waveform: impulse, carrier_hz: 2e9, bandwidth_hz: 1e9, prf_hz: 200, "
    "profile_m: [0.1, 6], profile_samples: 600}",
    "engine.kind=direct",
    "processing.range_sum=gated",
    "maps=[rtm, stft]",
]
IQ = [IMPULSE[0].replace("impulse,", "impulse, output: iq,").replace("600", "60"), IMPULSE[1]]
LAYERS = "wall={size_m: [null, 5, 2.5], echoes: exact, layers: [{eps_r: 4, thickness_m: 0.1}]}"


@pytest.mark.every(4)
@pytest.mark.parametrize(
    ("holds", "overrides"),
    [
        ("slow_time", [CW]),
        ("slow_time", [CW, "engine.kind=direct"]),
        ("slow_time", [REAL, "engine.kind=direct"]),
        ("slow_time", [CW, "processing.clutter=highpass", "wall={}"]),
        ("slow_time", [REAL, "receiver.tones=[{doppler_hz: 100}]"]),
        ("profiles", IMPULSE),
        ("profiles", [*IMPULSE, "wall={}", "processing.clutter=mean"]),
        ("profiles", [*IMPULSE, LAYERS, "processing.gate_m=[1, 5]"]),
        ("profiles", [*IQ, "maps=[rtm, stft]"]),
        ("profiles", [*IQ, LAYERS, "maps=[rtm, stft]"]),
    ],
    ids=[
        "cw",
        "cw-direct",
        "cw-real-direct",
        "cw-wall",
        "cw-real",
        "impulse",
        "impulse-wall",
        "impulse-layers",
        "iq",
        "iq-layers",
    ],
)
def test_radars_without_chirps_are_recorded_too(
    tmp_path: Path, holds: str, overrides: list[str]
) -> None:
    """CW as slow time, impulses as range profiles; real samples are stored as such."""
    config = config_of(tmp_path, "duration_s=1", "maps=[stft]", *overrides)
    command = ("simulate", tmp_path / "scene.yaml", "--raw", "--no-figures")
    command = (*command, "--maps", "all", "-o", tmp_path / "out")
    sets = [word for one in ("duration_s=1", "maps=[stft]", *overrides) for word in ("--set", one)]
    done = radhar(*command, *sets, "--seed", 3)
    assert done.returncode == 0, done.stderr
    with Recording(tmp_path / "out/recording.h5") as recording:
        assert recording.info.content.dataset == holds
        is_complex = CW in overrides or any("output: iq" in text for text in overrides)
        assert recording.samples.parts == (2 if is_complex else 1)
        static = recording.beat(0, 8).mean(axis=2)
    names = [name for name in possible_maps(config) if "compensated" not in name]
    found = processed(tmp_path / "out/recording.h5", config, *names).maps
    with h5py.File(tmp_path / "out/scene.h5") as scene:
        for name in names:
            right, rows = scene[f"maps/{name}"][:], found[name].rows
            assert np.allclose(rows.values, scene[f"axes/{name}/{rows.name}"][:])
            follows_track = holds == "profiles" and "gate_m" not in str(overrides)
            largest = {"stft": 0.1, "stft_cadence": 0.2} if follows_track else {}
            off = np.abs(decibels(found[name].power, 40.0) - decibels(right, 40.0)).mean()
            assert off < largest.get(name, 1e-4), name  # scene.h5 holds float32
    assert np.abs(static).max() > 0.1  # the leakage of -10 dB


def test_range_profiles_know_who_approaches(tmp_path: Path) -> None:
    """Real samples have no sign of the Doppler; the track has, by the phase along the range."""
    walk = ["motion={range_m: 5, angle_deg: 180}", "snr_db=40", "processing.gate_m=1"]
    walk.append("timing.onset=0.5")
    config = config_of(tmp_path, "duration_s=1.5", *IMPULSE, *walk)
    scene = simulate(config, seed=3, raw=True)
    assert scene.beat is not None
    write_simulated(tmp_path / "r.h5", scene.beat[None], scene.waveform, Label(label="walking"))
    track = processed(tmp_path / "r.h5", config, "rtm").track
    assert track is not None
    middle = slice(track.time.size // 4, -track.time.size // 4)
    assert (track.velocity[middle] < -0.5).all()
    torso = scene.truth.positions[:, scene.motion.names.index("torso")]
    place = np.linalg.norm(torso - np.array([0.4, 0, 1.5]), axis=1)
    right = np.interp(track.time, scene.truth.time, place)
    assert np.abs(track.range - right)[middle].max() < 0.3


def test_the_filter_of_denoised_maps_may_be_longer_than_a_window(tmp_path: Path) -> None:
    config = config_of(
        tmp_path,
        "duration_s=1",
        "processing.window_s=0.03",
        "processing.savgol.frame=61",
        "maps=[stft_denoised]",
    )
    scene = simulate(config, seed=3, raw=True)
    assert scene.beat is not None
    write_simulated(tmp_path / "r.h5", scene.beat[None], scene.waveform, Label(label="walking"))
    found = processed(tmp_path / "r.h5", config, "stft_denoised").maps["stft_denoised"]
    assert apart(found, scene.maps["stft_denoised"]) < 1e-6
    with pytest.raises(CaptureError, match=r"processing\.savgol\.frame = 61: should be at most 49"):
        processed(tmp_path / "r.h5", config, "stft_denoised", stop=0.05)


def stft_of_frames(beat: Complex, times: np.ndarray, length: int) -> PowerMap:
    """The paper's chain written anew: difference, compression, sum, one Hann window a frame."""
    from radhar_cli.processing.power_map import Axis

    x = RangeSum(RADAR.waveform)(beat)[0]
    frames = np.diff(x.reshape(FRAMES, RADAR.loops), axis=1)[:, :length]
    window = np.sin(np.pi * (np.arange(length) + 0.5) / length) ** 2
    power = np.abs(np.fft.fftshift(np.fft.fft(frames * window, axis=1), axes=1)) ** 2
    prf = RADAR.waveform.prf
    rows = np.fft.fftshift(np.fft.fftfreq(length, 1 / prf))
    starts = times.reshape(FRAMES, -1)[:, 0] + length / 2 / prf
    return PowerMap(power.T, Axis("frequency", "Hz", rows), Axis("time", "s", starts))


@pytest.mark.parametrize(("lanes", "order"), [(2, 1), (4, 0)])
def test_a_dca1000_capture_gives_the_maps_of_its_scene(
    tmp_path: Path, lanes: int, order: int
) -> None:
    """TDM-MIMO, frames with gaps, TI's sign, whole numbers: import, process, and it is the scene.

    What differs is the converter's rounding, 1/4 to 1/2 step of 8000.
    """
    config = config_of(
        tmp_path, "duration_s=2", "motion.range_m=3", "motion.angle_deg=180", "motion.model=paper"
    )
    beat = echo(RADAR, body(config), FRAMES)
    words(beat, 2, lanes, not order).tofile(tmp_path / "adc_data_Raw_0.bin")
    header = write_studio(
        tmp_path / "r.mmwave.json",
        RADAR,
        laneEn="0x3" if lanes == 2 else "0xF",
        chInterleave=order,
    )
    out = tmp_path / "r.h5"
    done = radhar("import", tmp_path / "adc_data_Raw_0.bin", "--radar", header, "-o", out)
    assert done.returncode == 0, done.stderr
    for receiver in range(4):
        found = processed(out, config, "stft", "rtm", receiver=receiver)
        wanted = stft_of_frames(beat[receiver], RADAR.times(FRAMES), RADAR.loops - 1)
        one = found.maps["stft"]
        assert np.allclose(one.rows.values, wanted.rows.values)
        assert np.allclose(one.columns.values, wanted.columns.values)
        assert apart(one, wanted) < 0.05
        assert any("windows have the 63 pulses" in note for note in found.notes)
    together = processed(out, config, "stft").maps["stft"].power
    each = [processed(out, config, "stft", receiver=n).maps["stft"].power for n in range(4)]
    assert np.allclose(together, sum(each))
    # The walker comes from 3 m at 1.5 m/s, seen across gaps.
    track = processed(out, config, "rtm").track
    assert track is not None
    t = np.linspace(0.1, 1.9, 50)
    place = body(config).torso(t)[:, 0] - np.array([[0.0], [0.05], [1.2]])
    assert np.sqrt(np.mean((track.range_at(t) - np.linalg.norm(place, axis=0)) ** 2)) < 0.15
    assert track.confidence.mean() > 0.8


def test_lost_pulses_leave_no_bright_line(tmp_path: Path) -> None:
    """Ten lost pulses are a bright line over all of the Doppler, unless they are filled in.

    What is filled in is right to 0.1 dB, or to 0.7 dB while a foot is at its fastest (seed 3).
    """
    config = config_of(tmp_path, "snr_db=30")
    scene = simulate(config, seed=4, raw=True)
    assert scene.beat is not None
    beat = scene.beat.copy()
    beat[:, 900:910] = 0
    parts = np.ascontiguousarray(beat).view(float).reshape(1, *beat.shape, 2)
    np.save(tmp_path / "x.npy", parts)
    w = scene.waveform
    keys = [f"carrier_hz={w.fc}", f"bandwidth_hz={w.bandwidth}", f"adc_rate_hz={w.adc_rate}"]
    keys += [f"prf_hz={w.prf}", "axes=[receiver, sample, pulse, iq]"]
    told = import_capture([tmp_path / "x.npy"], tmp_path / "x.h5", read_settings(None, keys))
    assert any("10 of 2000 pulses" in line for line in told.source.findings)
    found = processed(tmp_path / "x.h5", config, "stft").maps["stft"]
    assert apart(found, scene.maps["stft"]) < 0.5
    with h5py.File(tmp_path / "x.h5", "r+") as file:
        file["flags"][:] = 0
    kept = processed(tmp_path / "x.h5", config, "stft").maps["stft"]
    assert apart(kept, scene.maps["stft"]) > 2


def test_doppler_of_imported_slow_time(tmp_path: Path) -> None:
    config = config_of(tmp_path, "processing.clutter=none")
    np.save(tmp_path / "x.npy", np.exp(2j * np.pi * 120 / 1000 * np.arange(3000)))
    keys = ["carrier_hz=24e9", "prf_hz=1000"]
    import_capture([tmp_path / "x.npy"], tmp_path / "x.h5", read_settings(None, keys))
    found = processed(tmp_path / "x.h5", config, "stft", start=1.0, stop=2.5).maps["stft"]
    peak = found.rows.values[found.power.sum(axis=1).argmax()]
    assert peak == pytest.approx(120, abs=5)
    assert 1.0 < found.columns.values[0] < found.columns.values[-1] < 2.5
    for name in ("rtm", "stft_compensated"):
        with pytest.raises(CaptureError, match="slow time without ranges"):
            processed(tmp_path / "x.h5", config, name)


def recorded(folder: Path) -> tuple[Config, Simulation]:
    """A config, and a simulation of it whose recording is r.h5."""
    config = config_of(folder)
    scene = simulate(config, seed=3, raw=True, maps=("stft",))
    assert scene.beat is not None
    write_simulated(folder / "r.h5", scene.beat[None], scene.waveform, Label(label="walking"))
    return config, scene


def test_too_much_at_once_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config, scene = recorded(tmp_path)
    size = 16 * 50 * scene.waveform.n_pulses
    monkeypatch.setattr("radhar_cli.capture.chain.MAX_BYTES", size // 4)
    with pytest.raises(CaptureError, match=r"should choose at most 0\.5 s"):
        processed(tmp_path / "r.h5", config, "stft")
    assert processed(tmp_path / "r.h5", config, "stft", stop=0.45).maps["stft"].power.any()


@pytest.mark.parametrize("slow_time", [False, True])
def test_one_receiver_is_advised_where_it_helps_and_nowhere_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, slow_time: bool
) -> None:
    path, config = tmp_path / "two.h5", config_of(tmp_path)
    pulses, bins = 2000, 1
    if slow_time:
        pulse = np.exp(2j * np.pi * 0.12 * np.arange(pulses))
        np.save(tmp_path / "x.npy", np.stack([pulse, 1j * pulse]))
        keys = ["carrier_hz=24e9", "prf_hz=1000", "axes=[receiver, pulse]"]
        import_capture([tmp_path / "x.npy"], path, read_settings(None, keys))
    else:
        _, scene = recorded(tmp_path)
        assert scene.beat is not None
        np.save(tmp_path / "x.npy", np.stack([scene.beat, 1j * scene.beat]))
        w, bins = scene.waveform, scene.waveform.n_bins
        keys = [f"carrier_hz={w.fc}", f"bandwidth_hz={w.bandwidth}", f"adc_rate_hz={w.adc_rate}"]
        keys += [f"prf_hz={w.prf}", "axes=[receiver, sample, pulse]"]
        import_capture([tmp_path / "x.npy"], path, read_settings(None, keys))
    monkeypatch.setattr("radhar_cli.capture.chain.MAX_BYTES", 16 * pulses * bins)
    with pytest.raises(CaptureError, match=r"2 receivers take .*, or --receiver 0 one receiver"):
        processed(path, config, "stft")
    assert processed(path, config, "stft", receiver=1).maps["stft"].power.any()
    monkeypatch.setattr("radhar_cli.capture.chain.MAX_BYTES", 4 * pulses * bins)
    with pytest.raises(CaptureError, match=r"s of a receiver take .* s$"):
        processed(path, config, "stft", receiver=1)


def test_segments_of_a_part_keep_their_times() -> None:
    from radhar_cli.capture.chain import _within

    segments = PulseTimes(np.array([0.0, 1.0, 2.0]), np.array([0, 100, 200]), 300, 1000.0)
    part = _within(segments, 150, 250)
    assert part.first.tolist() == [0, 50]
    assert part.start.tolist() == [1.05, 2.0]
    assert np.array_equal(part.times(np.arange(100)), segments.times(np.arange(150, 250)))


WRONG = [
    (["--start", "9"], "there are 0 pulses"),
    (["--receiver", "3"], "receiver 3: should be below 1"),
    (["--maps", "stff"], "is not a map"),
]


@pytest.mark.parametrize(("more", "expected"), WRONG)
def test_wrong_use_is_refused_in_one_line(tmp_path: Path, more: list[str], expected: str) -> None:
    recorded(tmp_path)
    command = ("process", tmp_path / "r.h5", "--config", tmp_path / "scene.yaml")
    done = radhar(*command, *more, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert expected in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_program_writes_maps_track_and_figure(tmp_path: Path) -> None:
    recorded(tmp_path)
    command = ("process", tmp_path / "r.h5", "--config", tmp_path / "scene.yaml")
    done = radhar(*command, "--maps", "rtm,stft", "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "torso from" in done.stdout
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["maps.h5", "maps.png"]
    with h5py.File(tmp_path / "out/maps.h5") as file:
        assert sorted(file["maps"]) == ["rtm", "stft"]
        assert file["track/range"].shape == file["track/confidence"].shape
        assert "m/s" in file["track/velocity"].attrs["unit"]


@pytest.mark.slow
def test_what_rests_in_an_empty_room_is_called_no_torso(tmp_path: Path) -> None:
    """A reflector at rest, and nobody; a person who stands breathes, and is a torso."""
    config = tmp_path / "room.yaml"
    config.write_text(
        "radar: {device: IWR6843AOP, cfg: iwr6843aop, position_m: [0, 0, 2], tilt_deg: 15}\n"
        "maps: [range_doppler]\nduration_s: 2\nroom: {reflectors: [{}, {}]}\n"
        "activities: [nobody, stationary]\nmotion: {place: {range_m: 3}}\n"
    )
    for slug, expected in (("nobody", "something at rest at"), ("stationary", "torso from")):
        simulated, out = tmp_path / slug, tmp_path / f"{slug}_maps"
        done = radhar(
            "simulate", config, "--activity", slug, "--raw", "--no-figures", "-o", simulated
        )
        assert done.returncode == 0, done.stderr
        recording = simulated / "recording.h5"
        done = radhar("process", recording, "--config", config, "--no-figures", "-o", out)
        assert expected in done.stdout, done.stderr
