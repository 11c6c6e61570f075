"""Every target with every command of learning: each works, or is refused in a line."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from helpers.boards import CFG, CLOUDS
from helpers.command_line import Done, radhar
from helpers.slow import slow
from PIL import Image

from radhar_cli.learning import adaptation, few_shots

IMAGES = """
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 500}
activities: [walking, punching]
samples_per_class: 9
duration_s: 1
motion: {range_m: {per_activity: {default: 2.5, walking: 5}}}
image: {size_px: 32}
people: [{activity: {choice: [walking, sitting_down]}, share: 0.6, motion: {range_m: 4}}]
maps: [stft, rtm]
split: {train: 0.67, validation: 0.33}
"""
QUICK = ("device=cpu", "precision=float32", "threads=1", "epochs=1", "batch_size=4")
NETWORKS = {
    "classes": ("images", "smallnet", "classes"),
    "labels": ("images", "smallnet", "labels"),
    "count": ("images", "smallnet", "count"),
    "classes of clouds": ("board", "cloudnet", "classes"),
    "joints of clouds": ("board", "cloudnet", "skeleton"),
    "joints of frames": ("board", "framenet", "skeleton"),
}
JOINTS = ("joints of clouds", "joints of frames")
# {command: {network: what it is refused with}}; what is not there works.
REFUSED = {
    "adapt": {
        "labels": "finds several labels at a time; should be a run of classes",
        **dict.fromkeys(JOINTS, "finds joints; should be a run of classes"),
    },
}
REFUSED |= dict.fromkeys(("adapt --epochs", "adapt --mix", "few shots"), REFUSED["adapt"])


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two data sets of images, two of a board, and what was trained on the first of each."""
    folder = tmp_path_factory.mktemp("targets")
    (folder / "board.cfg").write_text(CFG)
    (folder / "board.yaml").write_text(
        CLOUDS.replace("samples_per_class: 5", "samples_per_class: 9")
    )
    (folder / "images.yaml").write_text(IMAGES)
    for kind in ("board", "images"):
        for number in (1, 2):
            made = radhar(
                *("generate", folder / f"{kind}.yaml", "-o", folder / f"{kind}{number}"),
                *("--jobs", 1, "-q", "--set", f"seed={number}", "--set", "output.png=false"),
            )
            assert made.returncode == 0, made.stderr
    return folder


def train(place: Path, name: str, out: Path, *more: object, of: tuple[int, ...] = (1,)) -> Done:
    kind, model, target = NETWORKS[name]
    data = [place / f"{kind}{number}" for number in of]
    settings = [word for setting in QUICK for word in ("--set", setting)]
    return radhar("train", *data, "-o", out, "--model", model, "--target", target, *settings, *more)


@pytest.fixture(scope="module", params=NETWORKS)
def network(request: pytest.FixtureRequest, place: Path) -> tuple[str, Path]:
    """(name, folder of its run)."""
    run = place / request.param.replace(" ", "_")
    done = train(place, request.param, run)
    assert done.returncode == 0, done.stderr
    if request.param in JOINTS:
        assert "warning: the class" not in done.stderr, "which joints have none of"
    return request.param, run


def few(run: Path, data: Path, out: Path) -> Done:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(few_shots, "SHOWN", 8)
        return radhar("train", data, "-o", out, "--init", run, "--shots", 2, "--repeats", 1)


def check_files(name: str, arrays: Path, table: Path, documents: Path, overlay: Path) -> None:
    """The three files hold the same, with the names of what was found."""
    with np.load(arrays) as stored:
        values = stored["joints" if name in JOINTS else "probabilities"]
        names = stored["joint_names" if name in JOINTS else "classes"].tolist()
        samples = stored["samples"].tolist()
    assert len(values) == len(samples) > 2
    assert values.shape[2 if name in JOINTS else 1] == len(names)
    read = json.loads(documents.read_text())
    assert [document["sample"] for document in read] == samples
    rows = list(csv.DictReader(table.read_text().splitlines()))
    if name in JOINTS:
        known = values[0][np.isfinite(values[0]).all((1, 2))]
        np.testing.assert_allclose([*read[0]["joints"].values()], known.swapaxes(0, 1), rtol=1e-6)
        assert (rows[0]["joint"], rows[0]["frame"]) == (names[0], "0")
        assert float(rows[0]["x_m"]) == pytest.approx(values[0, 0, 0, 0], abs=1e-4)
    else:
        assert [*read[0]["probabilities"]] == names
        best = [names[number] for number in values.argmax(1)]
        assert [document["class"] for document in read] == [row["class"] for row in rows] == best
        one = [float(rows[0][key]) for key in names]
        np.testing.assert_allclose(one, values[0], atol=1e-6)
    with Image.open(overlay) as picture:
        assert picture.format == "PNG"


COMMANDS = (
    *("eval", "predict", "predict -o", "adapt --epochs", "init", "two data sets", "compare"),
    *slow(["adapt", "adapt --mix", "few shots", "init of other classes", "resume"]),
    *slow(["eval of two runs", "export"]),
)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_target_works_or_is_refused_in_a_line(
    network: tuple[str, Path],
    command: str,
    place: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (name, run), out = network, tmp_path / "out"
    kind = NETWORKS[name][0]
    one, other = place / f"{kind}1", place / f"{kind}2"
    monkeypatch.setattr(adaptation, "EPOCHS", 1, raising=False)
    classes = tmp_path / "classes.yaml"
    classes.write_text("walking: strolling\n")
    match command:
        case "eval":
            done = radhar("eval", run, other, "-o", out)
        case "eval of two runs":
            again = tmp_path / "again"
            shutil.copytree(run, again)
            done = radhar("eval", run, again, one, other, "-o", out, "--split", "all")
        case "predict":
            done = radhar("predict", run, other)
        case "predict -o":
            files = [tmp_path / f"found.{kind}" for kind in ("npz", "csv", "json")]
            overlay = ("--overlay", tmp_path / "found.png")
            done = [radhar("predict", run, other, "-o", file, *overlay) for file in files][-1]
            check_files(name, *files, tmp_path / "found.png")
        case "export":
            done = radhar("export", run, "-o", tmp_path / "network.onnx")
        case "adapt":
            done = radhar("adapt", run, other, "-o", out)
        case "adapt --epochs":
            done = radhar("adapt", run, other, "-o", out, "--epochs", 1)
        case "adapt --mix":
            done = radhar("adapt", run, other, "-o", out, "--mix", one)
        case "few shots":
            done = few(run, other, out)
        case "init":
            done = train(place, name, out, "--init", run, of=(2,))
        case "init of other classes":
            done = train(place, name, out, "--init", run, "--classes", classes)
        case "two data sets":
            done = train(place, name, out, of=(1, 2))
        case "resume":
            done = train(place, name, run)
            assert "nothing to do" in done.stdout
        case "compare":
            done = radhar("compare", one, other, "-o", out)
    expected = REFUSED.get(command, {}).get(name)
    if expected is None:
        assert done.returncode == 0, done.stderr
        if name in JOINTS:
            assert "learned from nothing" not in done.stderr
            assert "does not know" not in done.stderr
    else:
        assert done.returncode == 2
        assert expected in done.stderr
        assert done.stderr.count("\n") == 1, done.stderr


def test_joints_of_classes_that_no_network_knows_are_evaluated(place: Path, tmp_path: Path) -> None:
    """A network of joints has no classes: another movement than those of its training counts."""
    from radhar_cli.learning.evaluation import open_for_model
    from radhar_cli.learning.run_folder import load_best

    run, classes = tmp_path / "run", tmp_path / "classes.yaml"
    classes.write_text("walking: null\n")
    done = train(place, "joints of clouds", run, "--classes", classes)
    assert done.returncode == 0, done.stderr
    images = open_for_model(load_best(run)[0], place / "board2", None)
    assert set(images.classes) == {"punching", "walking"}
    assert len(images) == 18
    assert not images.left_out


def test_labels_are_validated_by_whoever_shows_them(place: Path, tmp_path: Path) -> None:
    """Nobody's main activity is sitting down, which others do in the validation images."""
    done = train(place, "labels", tmp_path / "run")
    assert "'sitting_down' has no validation image" not in done.stderr
