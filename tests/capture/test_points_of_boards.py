"""Dumps of the data port of TI's demos, and replay files, as recordings of points."""

import json
import tracemalloc

import h5py
import numpy as np
import pytest
from capture.uart_bytes import (
    compressed,
    counting_packet,
    demo_packet,
    flat_target,
    floats,
    q_points,
    side_info,
    target,
)
from helpers.boards import CFG, CLOUDS
from helpers.command_line import ok, radhar
from helpers.slow import examples
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from radhar_cli.capture.importing_points import (
    PointHeader,
    PointSettings,
    import_points,
    read_point_header,
)
from radhar_cli.capture.point_recording import PointRecording
from radhar_cli.dataset.formats.uart import demo_frames, people_frames
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import CaptureError, RadharError

HEADER = PointHeader(PointSettings(frame_s=0.1, doppler_step_mps=0.25, range_step_m=0.05))
ONE = ((0.3, 1.5, -0.2, 0.5),)  # right, ahead, up (m), receding (m/s)


def imported(tmp_path, data, header=HEADER, name="dump.bin"):
    """{dataset: array} of the recording that is made of bytes, and its description."""
    dump, out = tmp_path / name, tmp_path / "out.h5"
    dump.write_bytes(data)
    info = import_points([dump], out, header)
    with h5py.File(out) as file:
        return {key: file[key][()] for key in file}, info


def polar_row(range_m, azimuth, elevation, doppler, snr):
    """Point of radhar of a polar one of TI, whose bins have the steps of HEADER."""
    level = range_m * np.cos(elevation)
    return [
        level * np.cos(azimuth),
        -level * np.sin(azimuth),
        range_m * np.sin(elevation),
        -doppler,
        snr,
        10 * np.log10(snr),
        round(range_m / 0.05),
        round(-doppler / 0.25),
    ]


@pytest.mark.parametrize("size", [40, 44])
@pytest.mark.parametrize("padded", [True, False])
def test_points_of_sdk3_have_the_axes_of_radhar(tmp_path, size, padded):
    messages = [(1, floats(ONE)), (7, side_info([[15.0, 30.0]]))]
    packets = [demo_packet(n, messages, 1, size, padded) for n in range(4)]
    got, info = imported(tmp_path, b"".join(packets))
    amplitude = 10 ** ((15 + 30) / 20)
    r = np.linalg.norm(ONE[0][:3])
    expected = [1.5, -0.3, -0.2, -0.5, amplitude, 15, round(r / 0.05), -2]
    np.testing.assert_allclose(got["points"], [expected] * 4, rtol=1e-6)
    assert got["points_start"].tolist() == [0, 1, 2, 3, 4]
    assert got["points_person"].tolist() == [-1] * 4
    np.testing.assert_allclose(got["frame_time"], [0, 0.1, 0.2, 0.3])
    assert f"{size} bytes" in info.demo
    assert info.source.findings == []


@pytest.mark.parametrize("size", [36, 40])
def test_points_of_sdk_1_and_2_have_bins_and_q_format(tmp_path, size):
    points = [(30, -3, 412, 0.25, 1.5, -0.125), (31, 4, 97, -0.5, 1.5, 0.0)]
    packets = [demo_packet(n, [(1, q_points(points)), (6, bytes(24))], 2, size) for n in (5, 6)]
    got, _ = imported(tmp_path, b"".join(packets))
    nan = np.nan
    expected = [
        [1.5, -0.25, -0.125, 0.75, 412, nan, 30, 3],
        [1.5, 0.5, 0, -1.0, 97, nan, 31, -4],
    ]
    np.testing.assert_allclose(got["points"], expected * 2, rtol=1e-6)
    assert got["frame_number"].tolist() == [5, 6]


def test_four_q_points_of_52_bytes_and_three_float_points_are_told_apart(tmp_path):
    """Lengths that fit both forms: 4 + 12 m = 16 n for m = 1, 5, 9, ..."""
    five = [(n, 0, 10, 0.0, 1.0 + n, 0.0) for n in range(5)]
    got, _ = imported(tmp_path, demo_packet(0, [(1, q_points(five))], 5))
    np.testing.assert_allclose(got["points"][:, 0], [1, 2, 3, 4, 5])
    four = [(0.0, 1.0 + n, 0.0, 0.0) for n in range(4)]
    got, _ = imported(tmp_path, demo_packet(0, [(1, floats(four))], 4))
    np.testing.assert_allclose(got["points"][:, 0], [1, 2, 3, 4])


@pytest.mark.parametrize("kind", [1020, 1000])
def test_compressed_clouds_targets_and_tracks_of_people_tracking(tmp_path, kind):
    cloud = [(0.1, -0.5, 0.28, 3.0, 20.0), (-0.2, 0.3, -0.56, 4.0, 40.0)]
    placed = target(3, (0.5, 2.0, 1.0), (0.1, -0.2, 0.3), (1, 2, 3))
    first = demo_packet(7, [(kind, compressed(cloud)), (1010, placed)], 2)
    second = demo_packet(8, [(1011, bytes([3, 255]))], 0)
    got, info = imported(tmp_path, first + second)
    expected = [
        polar_row(range_m, azimuth, elevation, doppler, snr)
        for elevation, azimuth, doppler, range_m, snr in cloud
    ]
    np.testing.assert_allclose(got["points"], expected, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(
        got["targets"], [[3, 2.0, -0.5, 1.0, -0.2, -0.1, 0.3, 2, -1, 3, 0.9]], rtol=1e-6
    )
    assert got["points_track"].tolist() == [3, -1]
    assert got["targets_start"].tolist() == [0, 1, 1]
    assert info.targets == 1


def test_spherical_floats_of_tlv_1000(tmp_path):
    message = floats([(3.0, 0.5, 0.1, -0.5)])
    got, _ = imported(tmp_path, demo_packet(0, [(1000, message), (7, side_info([[12, 0]]))], 1))
    np.testing.assert_allclose(
        got["points"][0, :4], polar_row(3.0, 0.5, 0.1, -0.5, 1)[:4], rtol=1e-5
    )
    assert got["points"][0, 5] == pytest.approx(12)


def test_points_and_targets_of_xwrl_boards(tmp_path):
    head = np.array([0.001, 0.002, 0.25, 0.5], "<f4").tobytes() + np.array([1, 0], "<u2").tobytes()
    point = np.array([300, 1500, -200, 250], "<i2").tobytes() + bytes([40, 10])
    messages = [(301, head + point), (308, target(1, (1, 2, 3)))]
    got, _ = imported(tmp_path, demo_packet(0, messages, 1))
    np.testing.assert_allclose(
        got["points"][0, :6], [1.5, -0.3, -0.2, -0.5, 10 ** (15 / 20), 10], rtol=1e-5
    )
    np.testing.assert_allclose(got["targets"][0, :4], [1, 2, -1, 3])


@pytest.mark.parametrize("counts_itself", [True, False])
def test_older_3d_people_counting_has_other_numbers(tmp_path, counts_itself):
    cloud = [(0.1, -0.5, 0.28, 3.0, 20.0)]
    messages = [(6, compressed(cloud)), (7, target(4, (0, 2, 1))), (8, bytes([4]))]
    packets = [counting_packet(n, messages, 48, counts_itself) for n in range(3)]
    got, info = imported(tmp_path, b"".join(packets))
    np.testing.assert_allclose(
        got["points"], [polar_row(3.0, -0.5, 0.1, 0.28, 20.0)] * 3, rtol=1e-5, atol=1e-6
    )
    assert got["targets"][:, :4].tolist() == [[4, 2, 0, 1]] * 3
    assert got["points_track"].tolist() == [4, 4, -1]
    assert "people counting" in info.demo


def test_people_counting_in_two_dimensions(tmp_path):
    points = floats([(3.0, -0.5, 0.25, 20.0)] * 5)  # 80 bytes: 5 of 16, or 4 of 20
    messages = [(6, points), (7, flat_target(2, (1.0, 2.0), (0.5, -0.5)))]
    packets = [counting_packet(n, messages, 52) for n in range(3)]
    got, _ = imported(tmp_path, b"".join(packets))
    assert len(got["points"]) == 15
    np.testing.assert_allclose(
        got["points"][0], polar_row(3.0, -0.5, 0.0, 0.25, 20.0), rtol=1e-5, atol=1e-6
    )
    np.testing.assert_allclose(got["targets"][0, :7], [2, 2, -1, 0, -0.5, -0.5, 0])


def test_lost_frames_are_counted_and_numbers_kept(tmp_path):
    packets = [demo_packet(n, [(1, floats(ONE))], 1) for n in (10, 11, 15, 16)]
    got, info = imported(tmp_path, b"".join(packets))
    assert got["frame_number"].tolist() == [10, 11, 15, 16]
    np.testing.assert_allclose(got["frame_time"], [0, 0.1, 0.5, 0.6])
    assert info.lost_frames == 3
    assert info.source.findings == ["3 of 7 frames are lost: their numbers are missing"]
    with PointRecording(tmp_path / "out.h5") as recording:
        cloud = recording.window(0.0, 0.7)
        assert np.diff(cloud.start).tolist() == [1, 1, 0, 0, 0, 1, 1]
        assert np.diff(recording.window(0.5, 0.4).start).tolist() == [1, 1, 0, 0]


def test_a_board_that_begins_again_and_frames_that_come_twice(tmp_path):
    packets = [demo_packet(n, [(1, floats(ONE))], 1) for n in (8, 9, 9, 1, 2)]
    got, info = imported(tmp_path, b"".join(packets))
    assert got["frame_number"].tolist() == [8, 9, 1, 2]
    np.testing.assert_allclose(got["frame_time"], [0, 0.1, 0.2, 0.3])
    assert info.lost_frames == 0
    assert len(info.source.findings) == 2


def test_broken_bytes_cost_only_the_frame_that_they_are_in(tmp_path):
    packets = [demo_packet(n, [(1, floats(ONE * 3))], 3) for n in range(8)]
    packets[2] = packets[2][:50]  # bytes lost on the way
    packets[4] = b"noise" + packets[4]
    packets[5] = packets[5][:12] + b"\xff\xff\xff\xff" + packets[5][16:]  # a length of 4 GiB
    packets[7] = packets[7][:-20]
    got, info = imported(tmp_path, b"\x00" * 77 + b"".join(packets))
    assert got["frame_number"].tolist() == [0, 1, 3, 4, 6]
    assert info.lost_frames == 2
    text = " ".join(info.source.findings)
    assert "2 packets are damaged" in text
    assert "cut off" in text
    assert "outside of whole packets" in text


def test_messages_of_wrong_lengths_leave_their_frame_out(tmp_path):
    good = demo_packet(0, [(1, floats(ONE * 2)), (7, side_info([[1, 1], [2, 2]]))], 2)
    bad = demo_packet(1, [(1, floats(ONE * 2)), (7, side_info([[1, 1]]))], 2)
    huge = demo_packet(2, [(1, floats([(1e30, 0, 0, 0)]))], 1)
    endless = demo_packet(3, [(1, floats([(np.inf, 0, 0, 0)]))], 1)
    got, info = imported(tmp_path, good + bad + huge + endless)
    assert got["frame_number"].tolist() == [0]
    assert "3 frames have messages that do not fit" in info.source.findings[-1]
    assert "frame 1: TLV 7 has 4 bytes" in info.source.findings[-1]


def test_several_files_are_one_stream(tmp_path):
    data = b"".join(demo_packet(n, [(1, floats(ONE))], 1) for n in range(6))
    parts = [tmp_path / f"part{n}.bin" for n in range(2)]
    parts[0].write_bytes(data[:250])
    parts[1].write_bytes(data[250:])
    info = import_points(parts, tmp_path / "out.h5", HEADER)
    assert (info.frames, info.lost_frames, info.source.findings) == (6, 0, [])


def test_points_of_one_subframe_are_read(tmp_path):
    packets = [
        demo_packet(n, [(1, floats([(0, 1.0 + part, 0, 0)]))], 1, subframe=part)
        for n in range(3)
        for part in (0, 1)
    ]
    header = PointHeader(PointSettings(frame_s=0.1, subframe=1))
    got, info = imported(tmp_path, b"".join(packets), header)
    assert got["points"][:, 0].tolist() == [2, 2, 2]
    assert "3 packets of other subframes than 1" in info.source.findings[0]


def test_everything_that_is_missing_is_named_at_once_with_a_command(tmp_path):
    dump = tmp_path / "dump.bin"
    dump.write_bytes(demo_packet(0, [(1, q_points([(1, 1, 1, 0, 1, 0)]))], 1))
    done = radhar("import", dump, "-o", tmp_path / "x.h5")
    assert done.returncode == 2
    assert "frame_s and doppler_step_mps are missing" in done.stderr
    assert "--set frame_s=0.1 --set doppler_step_mps=0.13 -o walk.h5" in done.stderr
    assert "--radar FILE.cfg" in done.stderr
    assert not (tmp_path / "x.h5").exists()


def test_the_cfg_gives_frame_rate_and_bins(tmp_path):
    (tmp_path / "board.cfg").write_text(CFG)
    header = read_point_header(tmp_path / "board.cfg", [])
    assert header.frame_s == pytest.approx(0.1)
    step = 299792458 / (2 * 77e9 * 3 * 57e-6 * 32)  # three transmitters of 57 us, 32 loops
    assert header.steps.speed_mps == pytest.approx(step)
    assert header.steps.range_m == pytest.approx(299792458 * 2.499e6 / (2 * 100e12 * 128))
    got, _ = imported(tmp_path, demo_packet(0, [(1, q_points([(9, 2, 5, 0, 1, 0)]))], 1), header)
    assert got["points"][0, 3] == pytest.approx(-2 * step)


def replay(frames, **extra):
    document = {"cfg": CFG.splitlines(keepends=True), "demo": "3D People Tracking", "data": frames}
    return json.dumps(document | extra).encode()


def test_the_visualizers_json(tmp_path):
    point = [0.3, 1.5, -0.2, 0.5, 20.0, 0.0, 2]
    track = [4, 1.0, 2.0, 0.5, 0.1, 0.2, 0.3, 0, 0, 0, 1.0, 0.8]
    frames = [
        {"frameData": {"frameNum": n, "pointCloud": [point], "trackData": [track]}, "timestamp": t}
        for n, t in ((3, 1000), (4, 1102), (6, 1300))
    ]
    got, info = imported(tmp_path, replay(frames), PointHeader(PointSettings()), "replay_1.json")
    assert info.frame_s == pytest.approx(0.1)  # of its own .cfg
    assert info.lost_frames == 1
    np.testing.assert_allclose(
        got["points"][0, :6], [1.5, -0.3, -0.2, -0.5, 20, 10 * np.log10(20)], rtol=1e-6
    )
    assert got["points_track"].tolist() == [2, 2, 2]
    np.testing.assert_allclose(
        got["targets"][0], [4, 2, -1, 0.5, 0.2, -0.1, 0.3, 0, 0, 0, 0.8], rtol=1e-6
    )
    got, info = imported(
        tmp_path, replay(frames, cfg=None, demo=None), PointHeader(PointSettings()), "r.json"
    )
    assert info.frame_s == pytest.approx(0.1, rel=0.03)
    assert got["points"][0, 5] == pytest.approx(20)  # decibels, of an out-of-box demo


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b'{"data": [{"frameData": {"frameNum": 0, "pointCloud": [[1, 2]]}}]}', "pointCloud[0]"),
        (b'{"data": [{"frameData": {"frameNum": 0, "pointCloud": 3}}]}', "pointCloud should be"),
        (b'{"data": [{"frameData": {"frameNum": "x", "pointCloud": []}}]}', "frameNum = x"),
        (b'{"data": {}}', "is no replay file"),
        (b'{"data": [{}]}', "no frame with a pointCloud"),
        (b'{"data": [', "is not JSON"),
        (b"[" * 100_000, "nested too deeply"),
        (b'{"data": [{"pointCloud": [[1, 2, 3, 1e999]]}]}', "infinite or huge"),
    ],
)
def test_replay_files_that_are_none_are_refused_in_a_line(tmp_path, data, says):
    with pytest.raises(CaptureError) as error:
        imported(tmp_path, data, name="replay.json")
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_points_have_no_samples_to_process(tmp_path):
    """The message says what a recording of points is for."""
    imported(tmp_path, demo_packet(0, [(1, floats(ONE)), (7, side_info([[1, 1]]))], 1))
    config = tmp_path / "config.yaml"
    config.write_text("maps: [stft]\n")
    done = radhar("process", tmp_path / "out.h5", "--config", config, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "is a recording of points, which has no samples" in done.stderr


@settings(
    max_examples=examples(60),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_any_bytes_are_read_or_refused_in_a_line(tmp_path, data):
    """Random bytes in, around and instead of packets: a recording that opens, or one message."""
    whole = bytearray(
        b"".join(
            demo_packet(n, [(1, floats(ONE * 2)), (7, side_info([[1, 1]] * 2))], 2)
            for n in range(4)
        )
    )
    for _ in range(data.draw(st.integers(0, 6))):
        place = data.draw(st.integers(0, len(whole) - 1))
        change = data.draw(st.sampled_from(["flip", "cut", "insert"]))
        noise = data.draw(st.binary(min_size=1, max_size=9))
        if change == "flip":
            whole[place : place + len(noise)] = noise
        elif change == "insert":
            whole[place:place] = noise
        else:
            del whole[place : place + len(noise)]
    message = ""
    try:
        got, info = imported(tmp_path, b"\x02\x01\x04\x03\x06\x05\x08\x07" + bytes(whole))
    except RadharError as error:
        message = str(error)
    if message:
        assert "\n" not in message
        return
    with PointRecording(tmp_path / "out.h5") as recording:
        assert len(recording.number) == info.frames
        assert recording.info.points == len(got["points"])


def test_a_hostile_dump_takes_little_memory(tmp_path):
    """Packets that announce 1 MiB each, and a message of 4 GiB in a packet that is whole."""
    liar = demo_packet(0, [], 0)
    liar = liar[:12] + (2**20).to_bytes(4, "little") + liar[16:]
    tlv = demo_packet(1, [(1, floats(ONE))], 1)
    tlv = tlv[:44] + b"\xff\xff\xff\xff" + tlv[48:]
    good = demo_packet(2, [(1, floats(ONE))], 1)
    dump = tmp_path / "dump.bin"
    dump.write_bytes(good + (liar + tlv) * 5000)
    tracemalloc.start()
    info = import_points([dump], tmp_path / "out.h5", HEADER)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert info.frames == 1
    assert peak < 16 * 2**20


@pytest.mark.parametrize(("write", "rounding"), [(demo_frames, 1e-6), (people_frames, 0.006)])
def test_what_radhar_writes_comes_back(tmp_path, write, rounding):
    """Frames with and without points, of SDK 3 and of people tracking, whose angles are coarse."""
    rng = np.random.default_rng(3)
    frames = [rng.uniform([1, -2, -1, -3], [5, 2, 1, 3], (n, 4)) for n in (4, 0, 7, 1, 0)]
    frames = [
        np.column_stack([f, np.ones(len(f)), rng.uniform(8, 35, len(f)), f[:, :2]]) for f in frames
    ]
    got, info = imported(tmp_path, b"".join(write(iter(frames))))
    assert np.diff(got["points_start"]).tolist() == [4, 0, 7, 1, 0]
    assert info.source.findings == []
    sent = np.concatenate(frames)
    reach = np.linalg.norm(sent[:, :3], axis=1, keepdims=True)
    assert (np.abs(got["points"][:, :3] - sent[:, :3]) / reach).max() < 1.5 * rounding
    np.testing.assert_allclose(got["points"][:, 3], sent[:, 3], atol=1.5e-4)
    np.testing.assert_allclose(got["points"][:, 5], sent[:, 5], atol=0.1)


@pytest.mark.slow
def test_a_data_set_of_dumps_trains_a_network_of_clouds(tmp_path):
    """Windows of recordings have the products of simulated ones, and cloudnet learns them."""
    for person, offset in enumerate((0.0, 0.1)):
        for name, doppler in (("walking", 1.0), ("punching", -0.5)):
            packets = [
                demo_packet(
                    n,
                    [(1, floats([(offset, 1.5, 0.1 * k, doppler) for k in range(n % 4)]))],
                    n % 4,
                )
                for n in range(40)
                if n != 7
            ]
            (tmp_path / "dump.bin").write_bytes(b"".join(packets))
            ok("import", tmp_path / "dump.bin", "--set", "frame_s=0.1", "--label", name,
               "-o", tmp_path / f"{name}{person}.h5")  # fmt: skip
    rows = [f"{name}{p}.h5,{name},{p}" for name in ("walking", "punching") for p in (0, 1)]
    (tmp_path / "manifest.csv").write_text("\n".join(["file,label,person", *rows]) + "\n")
    (tmp_path / "measured.yaml").write_text(
        "maps: [points]\nimage: {size_px: 32}\nrecordings: {window_s: 1, hop_s: 0.5}\n"
        "split: {by: subject, subjects: 2, train: 0.5, validation: 0.5}\n"
    )
    folder = tmp_path / "set"
    ok("generate", tmp_path / "measured.yaml", "--recordings", tmp_path / "manifest.csv",
       "-o", folder, "--jobs", "1", "-q")  # fmt: skip
    ok("verify", folder)
    with open_dataset(folder) as data:
        assert len(data) == 2 * 2 * 7
        starts = data.products["points_start"]
        assert {len(starts[row]) for row in range(len(data))} == {11}  # lost frames are there
        assert np.diff(starts[0]).tolist() == [n % 4 * (n != 7) for n in range(10)]
        assert set(data.products["points_person"][0].tolist()) == {-1}
        assert data.maps["points"].shape[1:] == (32, 32)
    card = (folder / "README.md").read_text()
    assert "a frame" in card
    assert "NaN" in card
    ok("view", folder, "-o", tmp_path / "view.html")
    ok("train", folder, "-o", tmp_path / "run", "--set", "model=cloudnet", "--set", "epochs=1",
       "-q")  # fmt: skip
    done = radhar("train", folder, "-o", tmp_path / "joints", "--set", "model=cloudnet",
                  "--set", "target=skeleton", "-q")  # fmt: skip
    assert done.returncode == 2
    assert "measured data lack" in done.stderr
    done = radhar("convert", folder, "-o", tmp_path / "mars", "--to", "mars")
    assert done.returncode == 2
    assert "is measured" in done.stderr
    ok("convert", folder, "-o", tmp_path / "ti", "--to", "ti", "-q")
    done = radhar("generate", tmp_path / "measured.yaml", "--recordings", tmp_path / "manifest.csv",
                  "--set", "maps=[stft]", "-o", tmp_path / "no")  # fmt: skip
    assert done.returncode == 2
    assert "should be [points]" in done.stderr


def test_what_convert_writes_comes_back(tmp_path):
    """Points of `convert --to ti` are those of the data set, within the rounding of the message."""
    config = CLOUDS.replace("IWR1443BOOST, cfg: board.cfg", "IWR6843ISK, cfg: iwr6843isk")
    config = config.replace("maps: [range_doppler, points]", "maps: [points]")
    (tmp_path / "config.yaml").write_text(config)
    done = radhar("generate", tmp_path / "config.yaml", "-o", tmp_path / "set", "--jobs", "1", "-q")
    assert done.returncode == 0, done.stderr
    done = radhar("convert", tmp_path / "set", "-o", tmp_path / "ti", "--to", "ti", "-q")
    assert done.returncode == 0, done.stderr
    dumps = sorted(tmp_path.glob("ti/*/*/*.bin"))
    assert dumps
    with open_dataset(tmp_path / "set") as data:
        radar = data.config.radar
        (tmp_path / "board.cfg").write_text(radar.cfg)
        everything = [data.products["points"][row] for row in range(len(data))]
    header = read_point_header(tmp_path / "board.cfg", [])
    assert header.frame_s == pytest.approx(radar.timing.period_s)
    matched = 0
    for dump in dumps:
        info = import_points([dump], tmp_path / "again.h5", header)
        with h5py.File(tmp_path / "again.h5") as file:
            points = file["points"][()]
        assert info.source.findings == []
        same = [
            one
            for one in everything
            if one.shape == points.shape and np.allclose(one[:, :3], points[:, :3], atol=1e-4)
        ]
        assert same
        matched += len(points)
        np.testing.assert_allclose(points[:, 3], same[0][:, 3], atol=1e-4)
        np.testing.assert_allclose(points[:, 5], same[0][:, 5], atol=0.051)
        np.testing.assert_array_equal(points[:, 6:], same[0][:, 6:])
    assert matched > 0
