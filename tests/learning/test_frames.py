"""Windows of streams, and networks that label their columns."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from typer.testing import CliRunner

from radhar_cli.cli import program
from radhar_cli.config import Config
from radhar_cli.dataset.build import build
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.images.windows import cut_windows
from radhar_cli.learning.settings import TrainConfig, WindowConfig
from radhar_cli.learning.tasks.frames import FrameLabels
from radhar_cli.learning.tasks.task import create_task
from radhar_cli.processes.progress import NO_PROGRESS

VALUES: dict[str, Any] = {
    "activities": ("walking", "grabbing", "punching"),
    "duration_s": 12.0,
    "stream": {"count": 6, "bout_s": {"uniform": [1.5, 3]}, "pause_s": 0.5, "order": "rounds"},
    "radar": {
        "carrier_hz": 5.8e9,
        "bandwidth_hz": 250e6,
        "prf_hz": 400.0,
        "chirp_s": 1e-3,
        "adc_rate_hz": 2e5,
    },
    "processing": {"window_s": 0.25},
    "image": {"size_px": 32},
    "split": {"train": 0.5, "validation": 0.5},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("frames") / "streams"
    build(Config(**VALUES), path, 1, NO_PROGRESS)
    return path


def run(*words: object) -> str:
    result = CliRunner().invoke(program(), [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result.output


def test_windows_are_pieces_of_streams_in_one_part_of_the_split(folder: Path) -> None:
    images = open_images(folder, None, "gray")
    windows = cut_windows(images, WindowConfig(length_s=3.0, hop_s=0.5))
    assert windows.size == (32, 30)
    assert len(windows) == 6 * 19
    recordings = windows.samples.recording
    assert recordings is not None
    assert windows.samples.split is not None
    for name in set(recordings.tolist()):
        assert len(set(windows.samples.split[recordings == name].tolist())) == 1
    assert (windows.pixels.read(20) == images.pixels.read(1)[:, 5:35]).all()


@pytest.mark.parametrize("label", ["majority", "centre"])
def test_a_window_has_the_class_of_its_columns(folder: Path, label: Any) -> None:
    images = open_images(folder, None, "gray")
    windows = cut_windows(images, WindowConfig(length_s=2.0, hop_s=1.0, label=label))
    columns = windows.samples.frame_labels
    assert columns is not None
    for number, labels in zip(windows.samples.label, columns, strict=True):
        known = labels[labels >= 0]
        right = labels[10] if label == "centre" else np.bincount(known).argmax()
        assert windows.classes[number] == images.frame_classes[right]


def test_windows_are_of_streams_that_are_long_enough(folder: Path) -> None:
    images = open_images(folder, None, "gray")
    with pytest.raises(FolderError, match=r"should be from 0.1 to 12 s"):
        cut_windows(images, WindowConfig(length_s=20.0))


def test_columns_are_learned_and_reported(folder: Path, tmp_path: Path) -> None:
    common = ("--set", "epochs=2", "--set", "workers=0", "--set", "input=gray")
    window = ("--set", "window={length_s: 6, hop_s: 3}")
    run("train", folder, "-o", tmp_path / "run", "--model", "tcn", "--target", "frames",
        *common, *window)  # fmt: skip
    output = run("eval", tmp_path / "run", folder, "-o", tmp_path / "report")
    assert "segment F1 at IoU 0.10, 0.25, 0.50" in output
    report = json.loads((tmp_path / "report/report.json").read_text())
    numbers = report["runs"]["run"]["data"]["streams"]
    assert numbers["streams"] == 3
    assert numbers["frames"] == 3 * 120
    assert 0 <= numbers["segment_f1_50"] <= numbers["segment_f1_10"] <= 1
    assert (tmp_path / "report/streams.png").exists()
    found = tmp_path / "found.json"
    run("predict", tmp_path / "run", folder, "-o", found, "--overlay", tmp_path / "found.png")
    first = json.loads(found.read_text())[0]
    assert {len(first["class"]), *map(len, first["probabilities"].values())} == {60}
    assert set(first["class"]) <= {*first["probabilities"]}
    lines = run("predict", tmp_path / "run", folder).splitlines()
    assert lines[0].startswith(f"{first['sample']}: {first['class'][0]} from 0")
    done = run("export", tmp_path / "run", "-o", tmp_path / "run.onnx")
    assert "ONNX Runtime agrees" in done


@pytest.fixture(scope="module")
def frames_run(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("runs") / "run"
    rare = ("--set", "class_weights=inverse_root")
    run("train", folder, "-o", path, "--model", "tcn", "--target", "frames", *rare,
        "--set", "epochs=1", "--set", "workers=0", "--set", "input=gray",
        "--set", "window={length_s: 6, hop_s: 3}")  # fmt: skip
    return path


def test_events_are_reported_over_the_threshold(
    folder: Path, frames_run: Path, tmp_path: Path
) -> None:
    words = ("--events", "punching, grabbing", "--event-threshold", "0.35")
    output = run("eval", frames_run, folder, "-o", tmp_path / "report", *words)
    assert "events (punching, grabbing) found at a threshold of 0.35" in output
    assert "false alarms an hour" in output
    report = json.loads((tmp_path / "report/report.json").read_text())
    numbers = report["runs"]["run"]["data"]["streams"]
    events = numbers["events"]
    assert events["hours"] == pytest.approx(36 / 3600)
    assert events["events"] == sum(of["events"] for of in events["by_class"].values()) > 0
    assert events["found"] == sum(of["found"] for of in events["by_class"].values())
    assert [*events["by_class"]] == ["punching", "grabbing"]
    lines = (tmp_path / "report/events.csv").read_text().splitlines()
    assert len(lines) == 1 + len(events["curve"]) == 1 + 14  # thresholds, and 0.35
    alarms = (tmp_path / "report/alarms.csv").read_text().splitlines()
    assert len(alarms) == 1 + events["events"] + events["false_alarms"]["count"]
    segments = numbers["segments_by_class"]
    assert sum(of["segments"] for of in segments.values()) == numbers["segments"]
    assert (tmp_path / "report/events.png").exists()


def test_data_without_events_have_false_alarms_alone(
    folder: Path, frames_run: Path, tmp_path: Path
) -> None:
    names = tmp_path / "names.yaml"
    names.write_text("grabbing: walking\n")
    words = ("--events", "grabbing", "--classes", names)
    output = run("eval", frames_run, folder, "-o", tmp_path / "report", *words)
    assert "no grabbing in these data, so that recall is not measured" in output
    report = json.loads((tmp_path / "report/report.json").read_text())
    events = report["runs"]["run"]["data"]["streams"]["events"]
    assert (events["events"], events["recall"]) == (0, None)
    assert not (tmp_path / "report/events.png").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--events", "grabbing,falls"], "--events = falls: is no class of run; should be of walk"),
        (["--events", "grabbing,"], "should be names of classes, separated by commas"),
        (["--events", "grabbing", "--event-threshold", "nan"], "--event-threshold = nan: should"),
        (["--events", "grabbing", "--event-tolerance", "-1"], "should be from 0 to 3600"),
    ],
)
def test_events_that_cannot_be_found_are_refused(
    folder: Path, frames_run: Path, words: list[str], message: str
) -> None:
    result = CliRunner().invoke(program(), ["eval", str(frames_run), str(folder), *words])
    assert message in str(result.exception)


def test_rare_columns_weigh_more_and_all_as_much_as_without_weights(folder: Path) -> None:
    settings = TrainConfig(model="tcn", target="frames", class_weights="inverse_root")
    task = create_task(settings)
    images = task.relabel(open_images(folder, None, "gray"))
    weighted = task.weighted_for(images)
    assert isinstance(weighted, FrameLabels)
    assert weighted.weights is not None
    targets = torch.as_tensor(task.targets(images)[images.rows("train")])
    counts = torch.bincount(targets.flatten(), minlength=5)
    present = counts > 0
    weights = torch.tensor(weighted.weights)
    assert torch.allclose((weights * counts.sqrt())[present].diff(), torch.zeros(1), atol=1e-3)
    assert float(weights[targets].mean()) == pytest.approx(1, abs=1e-5)
    outputs = torch.zeros(*targets.shape, 5)  # every column has the same loss
    assert float(weighted.loss(outputs, targets).mean()) == pytest.approx(
        float(task.loss(outputs, targets).mean()), rel=1e-5
    )


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"class_weights": "inverse_root"}, "should have class_weights: equal for target: classes"),
        ({"target": "frames", "model": "tcn", "sampling": "balanced"}, "class_weights: inverse"),
    ],
)
def test_weights_are_of_columns_and_sampling_is_of_images(
    settings: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        TrainConfig(**settings)


def test_windows_are_learned_as_images_are(folder: Path, tmp_path: Path) -> None:
    window = "window={length_s: 3, hop_s: 1}"
    run("train", folder, "-o", tmp_path / "run", "--set", "epochs=1", "--set", window)
    assert "run" in run("eval", tmp_path / "run", folder, "-o", tmp_path / "report")
    words = ["eval", str(tmp_path / "run"), str(folder), "--events", "grabbing"]
    refused = CliRunner().invoke(program(), words)
    assert "events are found by a run of target: frames" in str(refused.exception)


def test_frames_need_a_network_and_streams_of_their_own(folder: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(
        program(), ["train", str(folder), "-o", str(tmp_path / "run"), "--target", "frames"]
    )
    assert "should have model: tcn for target: frames" in str(result.exception)
