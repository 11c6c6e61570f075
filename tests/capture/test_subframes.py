"""Raw captures of frames of several subframes: a recording of each, the maps of the scene."""

from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import pytest
from capture.dca1000_file import words
from helpers.command_line import ok, radhar

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.subframes import read_subframes
from radhar_cli.errors import CaptureError

CFG = (Path(__file__).parents[1] / "radar/cfg/advframe.cfg").read_text()
# A subframe with two transmitters, samples and loops of its own.
UNLIKE = (
    CFG.replace("0 0 30 1 256", "0 0 30 1 128")
    .replace("chirpCfg 1 1 1 0 0 0 0 4", "chirpCfg 1 1 1 0 0 0 0 4\nchirpCfg 2 2 1 0 0 0 0 1")
    .replace("subFrameCfg 1 0 1 1 64", "subFrameCfg 1 0 1 2 32")
)  # fmt: skip
YAML = """
radar: {device: IWR1443BOOST, cfg: board.cfg}
activities: [walking]
motion: {range_m: 4}
duration_s: 0.2
maps: [range_doppler]
image: {size_px: 16}
"""
FRAMES = 2
PRODUCTS = ("--maps", "range_doppler,cube", "--no-figures")


class Capture(NamedTuple):
    """A capture of a simulated scene."""

    folder: Path
    scale: float  # words for a sample of size 1
    frame_bytes: int


def write_capture(folder: Path, cfg: str) -> Capture:
    """Simulate a scene of a board, and write its cubes in the order in which chirps are sent."""
    (folder / "board.cfg").write_text(cfg)
    (folder / "scene.yaml").write_text(YAML)
    ok("simulate", folder / "scene.yaml", "-o", folder / "scene", "--raw", *PRODUCTS)
    with h5py.File(folder / "scene/scene.h5") as file:
        cubes = [file[f"cube{end}"][:] for end in ("", "_sf1")]  # [frame, loop, virtual, sample]
    scale = 30_000 / max(float(np.abs(cube).max()) for cube in cubes)
    stream = [
        words(cube[frame].transpose(1, 2, 0), cube.shape[2] // 4, scale=scale)
        for frame in range(FRAMES)
        for cube in cubes
    ]
    q_first = np.concatenate(stream).reshape(-1, 2, 2)[:, ::-1]  # adcbufCfg SampleSwap = 1
    np.ascontiguousarray(q_first).tofile(folder / "adc.bin")
    return Capture(folder, scale, (folder / "adc.bin").stat().st_size // FRAMES)


@pytest.fixture(scope="module", params=[CFG, UNLIKE], ids=["alike", "unlike"])
def capture(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Capture:
    return write_capture(tmp_path_factory.mktemp("capture"), request.param)


def test_import_then_process_gives_the_maps_of_the_scene(capture: Capture, tmp_path: Path) -> None:
    """Half a step of the converter in each part of a sample is the only difference."""
    folder = capture.folder
    told = ok(
        "import", folder / "adc.bin", "--radar", folder / "board.cfg", "-o", tmp_path / "w.h5"
    )
    assert [line for line in told.stdout.splitlines() if "subframe" in line] == [
        "subframe 0:",
        "subframe 1:",
    ]
    for end, number in (("", 0), ("_sf1", 1)):
        out = tmp_path / f"maps{end}"
        ok(
            *("process", tmp_path / f"w{end}.h5", "--config", folder / "scene.yaml", "-o", out),
            *("--set", f"radar.subframe={number}", *PRODUCTS),
        )
        with h5py.File(folder / "scene/scene.h5") as scene, h5py.File(out / "maps.h5") as file:
            cube = file[f"cube{end}"][:] / capture.scale
            assert np.abs(cube - scene[f"cube{end}"][:]).max() < 0.75 / capture.scale
            wanted = scene[f"range_doppler{end}"][:]
            found = file[f"range_doppler{end}"][:] / capture.scale**2
            assert np.abs(found - wanted).max() < 1e-3 * wanted.max()
            np.testing.assert_allclose(
                file.attrs[f"frame_times{end}"], scene.attrs[f"frame_times{end}"], rtol=1e-12
            )


def test_a_subframe_that_is_chosen_is_the_only_recording(capture: Capture, tmp_path: Path) -> None:
    folder, out = capture.folder, tmp_path / "only.h5"
    command = ("import", folder / "adc.bin", "--radar", folder / "board.cfg", "-o", out)
    ok(*command, "--set", "subframe=1")
    assert [path.name for path in tmp_path.iterdir()] == ["only.h5"]
    with Recording(out) as found, Recording(folder / "scene/recording_sf1.h5") as scene:
        assert found.info.shape == scene.info.shape
        np.testing.assert_allclose(found.segments.start, scene.segments.start, rtol=1e-12)
        np.testing.assert_allclose(found.info.receiver_delay_s, scene.info.receiver_delay_s)
    result = radhar(*command, "--set", "subframe=2", "--overwrite")
    assert result.returncode == 2
    assert "board.cfg: subframe = 2: should be 0 or 1, of the subframes" in result.stderr


def test_a_last_frame_that_is_not_whole_is_left_out(capture: Capture, tmp_path: Path) -> None:
    cut = (capture.folder / "adc.bin").read_bytes()[: capture.frame_bytes + 1000]
    (tmp_path / "adc.bin").write_bytes(cut)
    for number, settings in read_subframes(capture.folder / "board.cfg", []).items():
        out = tmp_path / f"{number}.h5"
        told = import_capture([tmp_path / "adc.bin"], out, settings).source.findings
        assert "the last 1000 bytes (an incomplete frame of all subframes) are left out" in told
        with Recording(out) as recording:
            assert recording.segments.lengths.tolist() == [settings.frame_pulses]
    (tmp_path / "adc.bin").write_bytes(cut[: capture.frame_bytes - 2])
    with pytest.raises(
        CaptureError,
        match=rf"adc\.bin: holds {capture.frame_bytes - 2} bytes; a frame of all subframes by "
        rf"board\.cfg takes {capture.frame_bytes}$",
    ):
        import_capture([tmp_path / "adc.bin"], tmp_path / "o.h5", settings, "board.cfg")


def test_a_header_of_other_chirps_is_refused_before_anything_is_written(
    capture: Capture, tmp_path: Path
) -> None:
    text = (capture.folder / "board.cfg").read_text()
    (tmp_path / "other.cfg").write_text(text.replace("70 1 256", "70 1 200"))
    command = ("import", capture.folder / "adc.bin", "--radar", tmp_path / "other.cfg")
    result = radhar(*command, "-o", tmp_path / "walk.h5")
    assert result.returncode == 2
    assert "other.cfg: subframe 0: samples = 200, receivers = 4, transmitters = 1" in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not [*tmp_path.glob("*.h5")]


def test_an_array_is_of_the_subframe_that_is_chosen(tmp_path: Path) -> None:
    (tmp_path / "board.cfg").write_text(UNLIKE)
    rng = np.random.default_rng(0)
    beat = rng.standard_normal((3, 32, 2, 4, 128, 2)) @ [1, 1j]
    np.save(tmp_path / "cube.npy", beat.astype(np.complex64))
    command = ("import", tmp_path / "cube.npy", "--radar", tmp_path / "board.cfg")
    result = radhar(*command, "-o", tmp_path / "walk.h5")
    assert result.returncode == 2
    assert "cube.npy: .npy holds one subframe; " in result.stderr
    axes = "axes=[frame, pulse, transmitter, receiver, sample]"
    keys = ("--set", "subframe=1", "--set", axes)
    unclear = radhar(*command, "-o", tmp_path / "walk.h5", *keys)  # of noise alone
    assert "the sign of the beat is unclear; should be told by --set beat=" in unclear.stderr
    ok(*command, "-o", tmp_path / "walk.h5", *keys, "--set", "beat=positive")
    with Recording(tmp_path / "walk.h5") as recording:
        assert recording.info.shape == (8, 128, 96)
        assert recording.segments.start == pytest.approx([0.05, 0.15, 0.25])


def test_an_existing_recording_of_a_subframe_is_not_replaced(
    capture: Capture, tmp_path: Path
) -> None:
    (tmp_path / "walk_sf1.h5").write_text("mine")
    command = ("import", capture.folder / "adc.bin", "--radar", capture.folder / "board.cfg")
    result = radhar(*command, "-o", tmp_path / "walk.h5")
    assert result.returncode == 2
    assert "walk_sf1.h5: already exists" in result.stderr
    assert not (tmp_path / "walk.h5").exists()


def test_subframes_that_are_not_sent_are_not_in_the_stream(tmp_path: Path) -> None:
    path = tmp_path / "board.cfg"
    path.write_text(CFG + "\nlvdsStreamCfg 0 0 0 0\nlvdsStreamCfg 1 0 1 0\n")
    [(number, settings)] = read_subframes(path, []).items()
    assert (number, settings.frame_delay_s) == (1, pytest.approx(0.05))
    path.write_text(CFG + "\nlvdsStreamCfg -1 0 0 0\n")
    assert [*read_subframes(path, [])] == [0, 1]


def test_a_capture_without_subframes_has_none_to_choose() -> None:
    with pytest.raises(CaptureError, match="--set: subframe = 1: should be 0"):
        read_settings(None, ["subframe=1"])
