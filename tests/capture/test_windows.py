"""A data set of windows of recordings: the contract of any other, and what the manifest says."""

import csv
from pathlib import Path

import numpy as np
import pytest
from command_line import radhar

from radhar_cli.capture.chain import maps_of
from radhar_cli.capture.importing import write_simulated
from radhar_cli.capture.recording import Label, Recording
from radhar_cli.config import load_config, resolved
from radhar_cli.config.schema import MeasuredConfig
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.learning.images.opening import open_images
from radhar_cli.pipeline.products import image_of
from radhar_cli.simulation.simulate import simulate

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
        assert data.class_slugs.index("drinking") == 12, "after the twelve"
        walking = data.label == data.class_slugs.index("walking")
        assert data.scene["start"][:][walking].tolist() == [0, 0.5, 1, 0, 0.5, 1, 1.5, 2]
        row = int(np.flatnonzero(walking)[4])
        config = data.config
        with Recording(recordings / "p2/walking.h5") as one:
            part = maps_of(one, config, ["stft"], 0.5, 1.5)
        image = image_of(config, part.maps["stft"])
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
    assert len(set(images.scenes)) == 28, "every window is another scene"


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
