"""Sequences of frames and clouds: how they are read, learned from, and evaluated."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
import torch
from helpers.boards import CFG, CLOUDS
from helpers.command_line import radhar
from helpers.slow import slow
from torch.utils.data import DataLoader

import radhar_cli
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.evaluation import open_for_model, predict
from radhar_cli.learning.images.h5 import open_h5_sequences
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.images.scan import scan
from radhar_cli.learning.images.sequences import cloud_frames, fit_length
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.models.cloudnet import moving_centroid
from radhar_cli.learning.models.outputs import Outputs, OutputShape
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.task import create_task

QUICK = ("--set", "device=cpu", "--set", "precision=float32", "--set", "threads=1")


@pytest.fixture(scope="module")
def boards(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sequences")
    (folder / "board.cfg").write_text(CFG)
    (folder / "config.yaml").write_text(CLOUDS)
    made = radhar("generate", folder / "config.yaml", "-o", folder / "data", "--jobs", "1", "-q")
    assert made.returncode == 0, made.stderr
    return folder


def trained(boards: Path, model: str, target: str, *words: object) -> Path:
    run = boards / f"{model}_{target}"
    if not run.exists():
        options = ("--model", model, "--target", target, "--set", "batch_size=2", *words, *QUICK)
        made = radhar("train", boards / "data", "-o", run, *options)
        assert made.returncode == 0, made.stderr
    return run


def test_the_longest_sequences_are_cut_in_the_middle_and_short_ones_filled_up() -> None:
    values = np.arange(5.0)[:, None]
    np.testing.assert_array_equal(fit_length(values, 3, 0)[:, 0], [1, 2, 3])
    np.testing.assert_array_equal(
        fit_length(values, 7, np.nan)[:, 0], [0, 1, 2, 3, 4, *[np.nan] * 2]
    )


def test_of_too_many_points_those_of_the_highest_snr_stay_in_their_order() -> None:
    points = np.zeros((5, 8), np.float32)
    points[:, 0], points[:, 5] = [1, 2, 3, 4, 5], [30, 10, 20, 40, 15]
    clouds = cloud_frames(points, np.array([0, 4, 5, 5]), 2)
    np.testing.assert_array_equal(clouds[:, :, 0], [[1, 4], [5, 0], [0, 0]])
    np.testing.assert_allclose(clouds[:, :, 4], [[3, 4], [1.5, 0], [0, 0]])
    np.testing.assert_array_equal(clouds[:, :, 5], [[1, 1], [1, 0], [0, 0]])


def test_sequences_are_the_products_of_the_data_set(boards: Path) -> None:
    clouds = radhar_cli.Sequences(boards / "data", split="train", points=128)
    frames = radhar_cli.Sequences(boards / "data", "range_doppler", split="train")
    with open_dataset(boards / "data") as data:
        rows = np.flatnonzero(data.split == 0)
        assert len(clouds) == len(frames) == len(rows) == 6
        for item, row in enumerate(rows):
            points = data.products["points"][int(row)]
            found = clouds[item]
            present = found["clouds"][..., 5] > 0
            np.testing.assert_array_equal(found["clouds"][present][:, :4], points[:, :4])
            np.testing.assert_allclose(found["clouds"][present][:, 4], points[:, 5] / 10, rtol=1e-6)
            skeleton = data.products["skeleton"][int(row)]
            np.testing.assert_array_equal(found["skeleton"], skeleton[:, 0])
            levels = data.products["range_doppler"][int(row)]
            np.testing.assert_array_equal(frames[item]["frames"], levels)
            assert found["label"] == data.label[row]


def test_a_loader_with_workers_makes_batches_of_them(boards: Path) -> None:
    clouds = radhar_cli.Sequences(boards / "data", frames=7, points=16)
    batch = next(iter(DataLoader(clouds, batch_size=10, num_workers=2)))
    assert batch["clouds"].shape == (10, 7, 16, 6)
    assert re.fullmatch(r"<Sequences .*dataset.h5: 10 x 7 frames of points; .*>", repr(clouds))
    assert batch["skeleton"].shape == (10, 7, 13, 3)
    assert batch["skeleton"].isnan().any(3).any(2).nonzero()[:, 1].tolist() == [5, 6] * 10
    assert batch["label"].bincount().tolist() == [5, 5]


def test_a_product_that_is_not_there_is_named(boards: Path) -> None:
    with pytest.raises(
        radhar_cli.errors.FolderError,
        match="has no frames of 'range_azimuth'; it has range_doppler",
    ):
        radhar_cli.Sequences(boards / "data", "range_azimuth")


def expected_shape(shape: OutputShape, frames: int) -> tuple[int, ...]:
    """Of six outputs for two inputs."""
    return {
        OutputShape.INPUT: (2, 6),
        OutputShape.FRAMES: (2, frames, 6),
        OutputShape.PLACES: (2, frames, 2, 3),
    }[shape]


@pytest.mark.parametrize("shape", OutputShape)
def test_cloudnet_heeds_neither_the_order_nor_the_missing_ones_of_points(
    shape: OutputShape,
) -> None:
    torch.manual_seed(0)
    network = build_model("cloudnet", Outputs(6, shape), (4, 8)).eval()
    clouds = torch.randn(2, 6, 4, 8)
    clouds[:, 5] = (torch.arange(8) < 5).float()
    other = clouds[..., torch.randperm(8)]
    other[:, :5] += 9 * (1 - other[:, 5:])
    with torch.inference_mode():
        torch.testing.assert_close(network(other), network(clouds), rtol=1e-4, atol=1e-5)
        assert network(clouds).shape == expected_shape(shape, frames=4)


def test_the_centre_of_a_frame_without_points_is_that_of_all() -> None:
    clouds = torch.zeros(1, 6, 11, 4)
    clouds[0, :3, 0], clouds[0, 5, 0] = 2.0, 1.0
    torch.testing.assert_close(moving_centroid(clouds), torch.full((1, 3, 11), 2.0))


@pytest.mark.parametrize("shape", OutputShape)
def test_framenet_takes_any_number_of_frames(shape: OutputShape) -> None:
    network = build_model("framenet", Outputs(6, shape), (16, 24)).eval()
    for frames in (1, 5):
        found = network(torch.randn(2, frames, 16, 24))
        assert found.shape == expected_shape(shape, frames)


def test_framenet_takes_each_sequence_alone() -> None:
    network = build_model("framenet", Outputs(6, OutputShape.INPUT), (16, 24)).eval()
    frames = torch.randn(3, 4, 16, 24)
    with torch.inference_mode():
        alone = torch.cat([network(sequence[None]) for sequence in frames])
        torch.testing.assert_close(network(frames), alone, rtol=1e-4, atol=1e-5)


def test_the_loss_of_skeletons_leaves_out_what_is_not_there() -> None:
    joints = torch.zeros(2, 3, 2, 3)
    joints[1, 1:] = torch.nan
    found = torch.zeros(2, 3, 2, 3)
    found[:, 0, 0, 0] = 0.3
    task = create_task(TrainConfig(model="cloudnet", target="skeleton"))
    np.testing.assert_allclose(task.loss(found, joints), [0.3 / 18, 0.3 / 6])
    np.testing.assert_allclose(task.score(found, joints), [5 / 6, 1 / 2])


def test_statistics_of_frames_are_of_all_of_them_and_clouds_have_none(boards: Path) -> None:
    frames = open_h5_sequences(boards / "data", None, "frames")
    levels = np.stack([frames.pixels.read(row) for row in range(3)]) / 255
    found = scan(frames, [0, 1, 2])
    np.testing.assert_allclose([found.mean[0], found.sd[0]], [levels.mean(), levels.std()])
    assert len(found.mean) == 1
    clouds = open_h5_sequences(boards / "data", None, "clouds")
    found = scan(clouds, [0, 1])
    read = torch.from_numpy(clouds.pixels.read(0))
    torch.testing.assert_close(Normalisation(found.mean, found.sd)(read), read)


def test_joined_and_chosen_sequences_keep_their_skeletons(boards: Path) -> None:
    clouds = open_h5_sequences(boards / "data", None, "clouds")
    both = joined([clouds, clouds]).take(np.array([12, 3]))
    for row, of in enumerate((2, 3)):
        np.testing.assert_array_equal(both.skeletons[row], clouds.skeletons[of])
        np.testing.assert_array_equal(both.pixels.read(row), clouds.pixels.read(of))


@pytest.mark.parametrize("model", ["cloudnet", *slow(["framenet"])])
def test_a_network_of_sequences_tells_punching_from_walking(boards: Path, model: str) -> None:
    run = trained(boards, model, "classes")
    done = radhar("eval", run, boards / "data", "-o", boards / f"eval_{model}")
    assert done.returncode == 0, done.stderr
    report = json.loads((boards / f"eval_{model}/report.json").read_text())
    numbers = report["runs"][run.name]["data"]["data"]
    assert numbers["images"] == 4
    assert numbers["accuracy"] >= 0.75  # one of four may be wrong
    assert (boards / f"eval_{model}/confusion.png").exists()
    answer = radhar("predict", run, boards / "data", "--split", "val")
    assert answer.stdout.count("\n") == 4
    assert all(line.split(": ")[1] for line in answer.stdout.splitlines())


def test_joints_are_found_nearer_than_by_a_person_who_stands_still(boards: Path) -> None:
    run = trained(boards, "cloudnet", "skeleton", "--set", "epochs=60")
    done = radhar("eval", run, boards / "data", "-o", boards / "eval_joints")
    assert done.returncode == 0, done.stderr
    report = json.loads((boards / "eval_joints/report.json").read_text())
    numbers = report["runs"][run.name]["data"]["data"]
    metadata, model = load_best(run)
    images = open_for_model(metadata, boards / "data", None)
    rows = images.rows("val")
    found = predict(model, metadata, images, rows, torch.device("cpu"), 3).values
    true = np.stack([images.skeletons[int(row)] for row in rows])
    off = 100 * np.linalg.norm(found - true, axis=3)
    assert numbers["frames"] == 20
    assert numbers["mpjpe_cm"] == pytest.approx(off.mean(), rel=1e-5)
    assert numbers["mean_absolute_error_cm"] == pytest.approx(100 * np.abs(found - true).mean())
    assert numbers["joints"]["head"]["mpjpe_cm"] == pytest.approx(off[..., 1].mean(), rel=1e-5)
    assert numbers["mpjpe_cm"] < 25
    metrics = json.loads((run / "metrics.json").read_text())
    assert metrics["score"] == "joints within 15 cm"
    assert 0 <= metrics["val_within_15_cm"] <= 1
    assert "val_accuracy" not in metrics
    for name in ("joints.csv", "joints.png", "skeletons.png", "report.html"):
        assert (boards / "eval_joints" / name).exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--target", "skeleton"), "should have model: cloudnet or framenet"),
        (("--target", "bones"), "'person', 'frames' or 'skeleton'"),
        (("--model", "framenet", "--map", "points"), "has no frames of 'points'"),
        (("--model", "cloudnet", "--set", "augment.noise=0.1"), "should have no augment"),
        (("--model", "cloudnett"), "did you mean 'cloudnet'?"),
    ],
)
def test_what_cannot_be_learned_is_refused(
    boards: Path, words: tuple[str, ...], message: str
) -> None:
    done = radhar("train", boards / "data", "-o", boards / "refused", *words)
    assert done.returncode == 2
    assert message in " ".join(done.stderr.split())
    assert not (boards / "refused/run.json").exists()


def test_images_are_refused_where_a_network_reads_clouds(boards: Path) -> None:
    run = trained(boards, "cloudnet", "skeleton", "--set", "epochs=60")
    for words, message in (
        (
            ("eval", run, boards / "data/png/points", "-o", boards / "x"),
            "is no data set with clouds",
        ),
        (("eval", run, boards / "data", "--resize"), "reads clouds, which have no size"),
        (("eval", run, boards / "data", "--tsne"), "reads clouds; it is of images"),
        (("predict", run, boards / "data", "-o", boards / "x.txt"), "end in .npz, .csv or .json"),
    ):
        done = radhar(*words)
        assert done.returncode == 2, done.stderr
        assert message in " ".join(done.stderr.split())


@pytest.mark.parametrize("model", ["cloudnet", *slow(["framenet"])])
def test_joints_go_to_a_file_to_python_and_to_onnx_alike(boards: Path, model: str) -> None:
    import onnx
    import onnxruntime

    words = ("--set", "epochs=60") if model == "cloudnet" else ("--set", "epochs=1")
    run, data = trained(boards, model, "skeleton", *words), boards / "data"
    for name in ("found.npz", "found.csv"):
        options = ("--split", "val", "--device", "cpu", "--json")
        done = radhar("predict", run, data, "-o", boards / name, *options)
        assert done.returncode == 0, done.stderr
        assert json.loads(done.stdout)["samples"] == 4
    loaded = radhar_cli.load_run(run, device="cpu")
    with np.load(boards / "found.npz") as found:
        joints, first, names = (found[key] for key in ("joints", "first_frame", "joint_names"))
        samples = found["samples"].tolist()
    assert joints.shape == (4, *joints.shape[1:3], 3)
    assert tuple(names) == loaded.joints
    assert first.tolist() == [0] * 4
    again = loaded.predict(data, split="val")
    np.testing.assert_array_equal(again.joints.astype(np.float32), joints)
    assert list(again.samples) == samples
    with (boards / "found.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == joints[..., 0].size
    last = rows[-1]
    assert (last["sample"], last["joint"]) == (samples[-1], names[-1])
    assert int(last["frame"]) == joints.shape[1] - 1
    place = [float(last[f"{axis}_m"]) for axis in "xyz"]
    np.testing.assert_allclose(place, joints[-1, -1, -1], atol=1e-4)
    stored = radhar("export", run, "-o", boards / f"{model}.onnx")
    assert stored.returncode == 0, stored.stderr
    about = {p.key: p.value for p in onnx.load(boards / f"{model}.onnx").metadata_props}
    assert tuple(json.loads(about["joints"])) == loaded.joints
    session = onnxruntime.InferenceSession(
        boards / f"{model}.onnx", providers=["CPUExecutionProvider"]
    )
    images = open_for_model(loaded.metadata, data, None)
    levels = images.pixels.read(int(images.rows("val")[0])).transpose(2, 0, 1)[None]
    (answer,) = session.run(["joints"], {session.get_inputs()[0].name: levels})
    np.testing.assert_allclose(answer[0], joints[0], atol=1e-3)


def test_joints_end_with_their_sample(boards: Path, tmp_path: Path) -> None:
    """A network of seven frames on samples of five; a network of three reads the middle ones."""
    for frames, first, known in ((7, 0, [True] * 5 + [False] * 2), (3, 1, [True] * 3)):
        run = tmp_path / str(frames)
        options = ("--model", "cloudnet", "--target", "skeleton", "--set", "epochs=1")
        done = radhar(
            "train", boards / "data", "-o", run, *options, *QUICK, "--set", f"frames={frames}"
        )
        assert done.returncode == 0, done.stderr
        found = radhar_cli.load_run(run, device="cpu").predict(boards / "data", split="val")
        assert found.first_frame.tolist() == [first] * 4
        there = np.isfinite(found.joints).all((2, 3))
        np.testing.assert_array_equal(there, [known] * 4)
