"""A data set of windows of recordings: the contract of any other, and what the manifest says."""

import csv
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import radhar

from radhar_cli.capture.chain import maps_of
from radhar_cli.capture.importing import write_simulated
from radhar_cli.capture.recording import Label, Recording
from radhar_cli.config import load_config, resolved
from radhar_cli.config.data_set import MeasuredConfig
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.learning.images.opening import open_images
from radhar_cli.scene.products.images import draw_measured_map
from radhar_cli.scene.single.simulate import simulate

CONFIG = """
duration_s: 3
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 256, adc_rate_hz: 2.5e6}
motion: {model: paper, range_m: 3}
engine: {kind: cube}
maps: [rtm, stft]
image: {size_px: 32}
recordings: {window_s: 1, hop_s: 0.5}
"""
SLUGS = ("walking", "punching", "kicking")


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three activities of two persons, 3 s each, and their manifest."""
    folder = tmp_path_factory.mktemp("measured")
    (folder / "c.yaml").write_text(CONFIG)
    config = load_config(folder / "c.yaml")
    rows = []
    for person in (1, 2):
        for slug in SLUGS:
            scene = simulate(config, slug, person, maps=("stft",), raw=True)
            assert scene.beat is not None
            name = f"p{person}/{slug}.h5"
            write_simulated(folder / name, scene.beat[None], scene.waveform, Label(label=slug))
            label = "drinking" if slug == "kicking" else slug
            rows.append({"file": name, "label": label, "person": f"P{person}", "stop": ""})
    rows[0] |= {"stop": "2"}
    with (folder / "manifest.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, ["file", "label", "person", "stop"])
        writer.writeheader()
        writer.writerows(rows)
    return folder


def generate(folder: Path, out: Path, *more: object) -> str:
    manifest = folder / "manifest.csv"
    command = ("generate", folder / "c.yaml", "--recordings", manifest, "-o", out, "--jobs", 1)
    done = radhar(*command, *more)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def test_windows_are_samples(recordings: Path, tmp_path: Path) -> None:
    output = generate(recordings, tmp_path / "set")
    assert "may lie in several parts" in output
    with open_dataset(tmp_path / "set") as data:
        # 3 s hold 5 windows of 1 s every 0.5 s; 2 s hold 3.
        counts = {slug: int((data.label == n).sum()) for n, slug in enumerate(data.class_slugs)}
        assert {slug: n for slug, n in counts.items() if n} == {
            "walking": 8,
            "punching": 10,
            "drinking": 10,
        }
        assert data.classes == ("punching", "walking", "drinking"), "new labels last"
        assert data.label.max() == 2
        walking = data.label == data.class_slugs.index("walking")
        assert data.scene["start"][:][walking].tolist() == [0, 0.5, 1, 0, 0.5, 1, 1.5, 2]
        row = int(np.flatnonzero(walking)[4])
        config = data.config
        with Recording(recordings / "p2/walking.h5") as one:
            part = maps_of(one, config, ["stft"], 0.5, 1.5)
        image = draw_measured_map(config, part.maps["stft"])
        assert np.array_equal(data.maps["stft"][row], image.levels)
    assert len([*(tmp_path / "set/png/stft").rglob("*.png")]) == 28


def test_every_command_accepts_it(recordings: Path, tmp_path: Path) -> None:
    out = tmp_path / "set"
    generate(recordings, out)
    assert "is complete" in generate(recordings, out)
    for command in (
        ("verify", out),
        ("inspect", out),
        ("preview", out, "--map", "stft"),
        ("view", out),
    ):
        done = radhar(*command)
        assert done.returncode == 0, done.stdout + done.stderr
    images = open_images(out, "stft", "rgb")
    assert sorted(images.classes) == ["drinking", "punching", "walking"]
    assert len(set(images.samples.scene)) == 28, "every window is another scene"


def test_any_number_of_workers_and_batches_give_the_same(recordings: Path, tmp_path: Path) -> None:
    generate(recordings, tmp_path / "a", "--set", "output.png=false", "--batch", 1)
    generate(recordings, tmp_path / "b", "--set", "output.png=false", "--batch", 7)
    a, b = ((tmp_path / name / "dataset.h5").read_bytes() for name in "ab")
    assert a == b


def test_no_person_is_in_two_splits(recordings: Path, tmp_path: Path) -> None:
    more = [f"split={{by: subject, subjects: 9, train: {0.5}, validation: 0.5}}"]
    generate(recordings, tmp_path / "set", "--set", *more)
    with open_dataset(tmp_path / "set") as data:
        assert data.config.split.subjects == 2
        person = data.scene["subject"][:]
        assert {(int(p), int(s)) for p, s in zip(person, data.split, strict=True)} in (
            {(0, 0), (1, 1)},
            {(0, 1), (1, 0)},
        )


def test_a_changed_recording_is_another_data_set(recordings: Path, tmp_path: Path) -> None:
    generate(recordings, tmp_path / "set")
    path = recordings / "p1/punching.h5"
    before = path.read_bytes()
    try:
        path.write_bytes(before + b" ")
        command = ("generate", recordings / "c.yaml", "-o", tmp_path / "set")
        done = radhar(*command, "--recordings", recordings / "manifest.csv")
    finally:
        path.write_bytes(before)
    assert done.returncode == 2
    assert "recordings.sha256.p1/punching.h5" in done.stderr


WRONG = [
    ("file,label\n../x.h5,walking\n", "below the manifest's folder"),
    ("file,label\n/etc/passwd,walking\n", "below the manifest's folder"),
    ("file,label\nnone.h5,walking\n", "none.h5"),
    ("file,lable\np1/walking.h5,walking\n", "did you mean 'label'"),
    ("file,label\np1/walking.h5,\n", "label is missing"),
    ("file,label,start\np1/walking.h5,walking,soon\n", "start = 'soon'"),
    ("file,label,stop\np1/walking.h5,walking,9\n", "within its 3 s"),
    ("file,label,stop\np1/walking.h5,walking,0.5\n", "recordings.window_s = 1"),
    ("file,label\np1/walking.h5,4 walks!\n", "label"),
    ("file,label\n", "lists nothing"),
    ("file,label,stop\n" + "p1/walking.h5,walking,1.5\n" * 10_001, "at most 10000"),
]


@pytest.mark.parametrize(("text", "expected"), WRONG)
def test_wrong_manifest_is_refused_in_one_line(
    recordings: Path, tmp_path: Path, text: str, expected: str
) -> None:
    manifest = recordings / "wrong.csv"
    manifest.write_text(text)
    command = ("generate", recordings / "c.yaml", "--recordings", manifest)
    done = radhar(*command, "-o", tmp_path / "set")
    assert done.returncode in (1, 2)
    assert expected in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "set").exists()


def test_a_config_with_recordings_needs_their_manifest(recordings: Path, tmp_path: Path) -> None:
    done = radhar("generate", recordings / "c.yaml", "-o", tmp_path / "set")
    assert done.returncode == 2
    assert "--recordings" in done.stderr


@pytest.mark.parametrize(
    "key",
    [
        "maps=[stft, points]",
        "output.column_labels=true",
        "output.slow_time=true",
        "output.products=[receiver]",
    ],
)
def test_what_recordings_do_not_have_is_refused(recordings: Path, tmp_path: Path, key: str) -> None:
    text = "radar: {device: IWR1443BOOST, cfg: iwr1443boost}\nrecordings: {window_s: 1}\n"
    (recordings / "board.yaml").write_text(text if "maps" in key else CONFIG)
    command = ("generate", recordings / "board.yaml", "--recordings", recordings / "manifest.csv")
    done = radhar(*command, "-o", tmp_path / "set", "--set", key)
    assert done.returncode == 2
    assert f"{key.partition('=')[0]} = " in done.stderr
    assert done.stderr.count("\n") == 1


def test_what_only_a_simulation_has_is_left_out(recordings: Path, tmp_path: Path) -> None:
    """Noise, interference, people; numbers that are drawn take their middle."""
    more = ["snr_db=20", "receiver.tones=[{doppler_hz: 50, level_db: 0}]"]
    more += ["motion.model=human", "people=[{activity: walking}]", "image.kind=cfar"]
    more += ["image.cfar={training: [4, 4], guard: [1, 1], floor_db: {uniform: [10, 20]}}"]
    generate(recordings, tmp_path / "set", *(word for key in more for word in ("--set", key)))
    with open_dataset(tmp_path / "set") as data:
        assert isinstance(data.config, MeasuredConfig)
        assert not {"motion", "people", "receiver"} & resolved(data.config).keys()
        assert data.config.image.cfar.floor_db == 15
    recording = recordings / "p1/walking.h5"
    command = ("process", recording, "--config", recordings / "c.yaml", "-o", tmp_path / "maps")
    done = radhar(*command, "--set", more[-2], "--set", more[-1], "--no-figures")
    assert done.returncode == 0, done.stderr


def test_yaml_is_a_manifest_too(recordings: Path, tmp_path: Path) -> None:
    from radhar_cli.capture.windows import read_manifest

    text = "- {file: p1/walking.h5, label: S8, person: 1, start: 0.5}\n"
    (tmp_path / "m.yaml").write_text(text)
    assert read_manifest(tmp_path / "m.yaml") == [
        {"file": "p1/walking.h5", "label": "walking", "person": "1", "start_s": 0.5, "stop_s": None}
    ]


def test_a_hop_that_makes_too_many_windows_is_refused(recordings: Path, tmp_path: Path) -> None:
    manifest = recordings / "manifest.csv"
    command = ("generate", recordings / "c.yaml", "--recordings", manifest, "-o", tmp_path / "set")
    done = radhar(*command, "--set", "recordings.hop_s=1e-9")
    assert done.returncode == 2
    assert "windows; hop_s makes" in done.stderr


OTHER_RADAR = """
radar: {prf_hz: 100, bandwidth_hz: 8e9}
maps: [stft]
image: {size_px: 32}
output: {png: false}
recordings: {window_s: 1, hop_s: 0.5}
"""
# Each fits the recordings, and is refused by simulations with the radar above or with defaults.
FITTING = [
    ["processing.range_fft_length=128"],
    ["image.doppler_limits_mps=[-1.5, 1.5]"],
    ["radar.prf_hz=10e3", "processing.stft_fft_length=300"],
    ["processing.range_sum=gated", "processing.gate_m=[1, 6]"],
]
WITHOUT_EFFECT = [
    ["split={by: subject, subjects: 400, train: 0.5, validation: 0.5}"],
    ["samples_per_class=3", "split={by: subject, subjects: 8, train: 0.5, validation: 0.5}"],
    ["duration_s=0.3", "processing.window_s=0.5"],
    ["motion.model=file"],
    ["people=[{activity: flying}]"],
    ["snr_db=null", "receiver.tones=[{doppler_hz: 50, level_db: 0}]"],
]


def settings(texts: list[str]) -> list[str]:
    return [word for text in texts for word in ("--set", text)]


@pytest.mark.every(4)
@pytest.mark.parametrize("texts", FITTING + WITHOUT_EFFECT, ids=" ".join)
def test_settings_are_checked_against_the_radar_of_the_recordings(
    recordings: Path, tmp_path: Path, texts: list[str]
) -> None:
    (tmp_path / "other.yaml").write_text(OTHER_RADAR)
    manifest, out = recordings / "manifest.csv", tmp_path / "set"
    command = ("generate", tmp_path / "other.yaml", "--recordings", manifest, "-o", out)
    done = radhar(*command, "--jobs", 1, *settings(texts))
    assert done.returncode == 0, done.stderr
    with open_dataset(out) as data:
        assert data.config.radar.prf_hz == 256


@pytest.mark.parametrize("texts", FITTING + WITHOUT_EFFECT[2:], ids=" ".join)
def test_process_checks_settings_against_the_radar_of_the_recording(
    recordings: Path, tmp_path: Path, texts: list[str]
) -> None:
    (tmp_path / "other.yaml").write_text(OTHER_RADAR)
    command = ("process", recordings / "p1/walking.h5", "--config", tmp_path / "other.yaml")
    done = radhar(*command, "-o", tmp_path / "maps", "--no-figures", *settings(texts))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("key", "value", "right"),
    [
        ("processing.range_fft_length", "64", "at least the 100 ADC samples"),
        ("image.doppler_limits_mps", "[-3.0, 3.0]", "within the unambiguous band, -1.8"),
        ("processing.gate_m", "[1.0, 9.0]", "before the range half-band does, at 7.4"),
        ("image.kind", '"signed"', "decibel or cfar"),
        ("processing.range_fft_lenght", "128", "did you mean 'range_fft_length'"),
    ],
)
def test_what_does_not_fit_the_recordings_is_refused_where_it_stands(
    recordings: Path, tmp_path: Path, key: str, value: str, right: str
) -> None:
    section, _, name = key.partition(".")
    text = (
        "maps: [stft]\nprocessing:\n  range_sum: gated\n  gate_m: [1, 6]\nimage:\n  size_px: 32\n"
    )
    text = text.replace("  gate_m: [1, 6]\n", "") if name == "gate_m" else text
    text = text.replace(f"{section}:\n", f"{section}:\n  {name}: {value}\n")
    file, out = tmp_path / "c.yaml", tmp_path / "out"
    file.write_text(text + "recordings: {window_s: 1}\n")
    for command in (
        ("generate", file, "--recordings", recordings / "manifest.csv", "-o", out),
        ("process", recordings / "p1/walking.h5", "--config", file, "-o", out),
    ):
        done = radhar(*command)
        assert done.returncode == 2
        line = 1 + text.splitlines().index(f"  {name}: {value}")
        assert f"{file}:{line}: {key} = {value}: " in done.stderr
        assert right in done.stderr
        assert done.stderr.count("\n") == 1


def test_recordings_of_several_radars_are_refused(recordings: Path, tmp_path: Path) -> None:
    config = load_config(recordings / "c.yaml", ["radar.prf_hz=200", "engine.kind=direct"])
    scene = simulate(config, "walking", 3, maps=("stft",), raw=True)
    assert scene.beat is not None
    write_simulated(recordings / "slow.h5", scene.beat[None], scene.waveform, Label(label="x"))
    (recordings / "two.csv").write_text("file,label\np1/walking.h5,walking\nslow.h5,walking\n")
    command = ("generate", recordings / "c.yaml", "--recordings", recordings / "two.csv")
    done = radhar(*command, "-o", tmp_path / "set")
    assert done.returncode == 2
    assert "two.csv: slow.h5: prf_hz = 200: should be 256, as in p1/walking.h5" in done.stderr
    assert done.stderr.count("\n") == 1


def test_recordings_of_another_radar_than_the_config_has_are_refused(
    recordings: Path, tmp_path: Path
) -> None:
    (tmp_path / "board.yaml").write_text("radar: {device: IWR1443BOOST, cfg: iwr1443boost}\n")
    manifest, out = recordings / "manifest.csv", tmp_path / "set"
    command = ("generate", tmp_path / "board.yaml", "--recordings", manifest, "-o", out)
    done = radhar(*command, "--set", "maps=[range_doppler]", "--set", "recordings.window_s=1")
    assert done.returncode == 2
    assert "should be" in done.stderr
    assert "receivers = 1: should be 12, as radar.cfg has it" in done.stderr
    points = radhar(*command, "--set", "maps=[points]", "--set", "recordings.window_s=1")
    assert "`radhar process` makes the points of a recording" in points.stderr


@pytest.mark.parametrize("command", ["generate", "process"])
def test_a_cfg_without_its_board_is_refused(recordings: Path, tmp_path: Path, command: str) -> None:
    (tmp_path / "board.yaml").write_text("radar: {cfg: iwr1443boost}\n")
    words: tuple[object, ...] = ("--recordings", recordings / "manifest.csv")
    words = (tmp_path / "board.yaml", *words)
    if command == "process":
        words = (recordings / "p1/walking.h5", "--config", tmp_path / "board.yaml")
    done = radhar(command, *words, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "radar.device" in done.stderr
    assert done.stderr.count("\n") == 1
