"""The study sim_to_real.py at the smallest sizes, and on files that are not what it asks for."""

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from helpers import command_line
from scipy import ndimage

from radhar_cli import load_config, sample
from radhar_cli.errors import CaptureError
from radhar_cli.learning.images.opening import open_images

SLUGS = ("walking", "sitting_down", "standing_up", "picking_up", "falling")
OURS = ("walking", "sitting_down", "standing_up", "grabbing", "walking_to_falling")


@pytest.fixture(scope="module")
def script() -> ModuleType:
    path = command_line.ROOT / "scripts/studies/sim_to_real.py"
    spec = importlib.util.spec_from_file_location("sim_to_real", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look for it
    spec.loader.exec_module(module)
    return module


def arrays(count: int = 12, size: int = 64) -> dict[str, Any]:
    """Masks of noise, and a class that has no counterpart."""
    masks = np.random.default_rng(0).random((count, size, size)) < 0.3
    classes = np.array([*SLUGS, "drinking"])
    return {
        "masks": np.packbits(masks, axis=2),
        "label": np.arange(count) % len(classes),
        "classes": classes,
    }


def written(path: Path, **changed: Any) -> Path:
    values = {**arrays(), **changed}
    np.savez(path, **{name: value for name, value in values.items() if value is not None})
    return path


def test_masks_and_our_names_of_their_classes(script: ModuleType, tmp_path: Path) -> None:
    given = arrays()
    masks, slugs = script.read_masks(written(tmp_path / "m.npz"))
    kept = given["label"] != 5
    assert slugs == [OURS[n] for n in given["label"][kept]]
    assert np.array_equal(masks, np.unpackbits(given["masks"][kept], axis=2).astype(bool))
    assert masks.dtype == bool


def test_names_are_matched_however_they_are_written(script: ModuleType, tmp_path: Path) -> None:
    names = np.array(["Walking ", "SITTING DOWN", "standing up", "grabbing", "Falling", "unknown"])
    _, slugs = script.read_masks(written(tmp_path / "m.npz", classes=names))
    assert set(slugs) == set(OURS)
    _, slugs = script.read_masks(written(tmp_path / "b.npz", classes=names.astype("S")))
    assert set(slugs) == set(OURS)


HOSTILE: list[tuple[dict[str, Any], str]] = [
    ({"masks": None}, "one array of images"),
    ({"label": None}, "and label"),
    ({"masks": arrays(size=16)["masks"]}, "should have 32 to 2048 a side"),
    ({"label": np.full(12, 6)}, "indices into classes"),
    ({"classes": np.array(["a", "b", "c", "d", "e", "f"])}, "has no map of walking"),
    ({"label": np.full(12, 5)}, "has no map of walking"),
]


@pytest.mark.parametrize(("changed", "expected"), HOSTILE)
def test_wrong_arrays_are_refused_in_one_line(
    script: ModuleType, tmp_path: Path, changed: dict[str, Any], expected: str
) -> None:
    path = written(tmp_path / "m.npz", **changed)
    with pytest.raises(CaptureError) as error:
        script.read_masks(path)
    assert str(error.value).startswith(f"{path}: ")
    assert expected in str(error.value)
    assert "\n" not in str(error.value)


def measured(path: Path, config: Path, per_class: int) -> int:
    """Write simulated masks of another seed as if they were measured; returns how many count."""
    masks, label = [], []
    for number, slug in enumerate(OURS):
        long = ["duration_s=10"] if slug == "walking" else []
        settings = load_config(config, long)
        for index in range(per_class):
            image = sample(settings, slug, index, seed=77)["maps/stft"]
            masks.append(np.packbits(image > 0, axis=1))
            label.append(number)
    masks.append(masks[0])
    label.append(5)  # drinking, which is left out
    classes = np.array([*SLUGS, "drinking"])
    np.savez(path, masks=np.stack(masks), label=np.array(label), classes=classes)
    return len(label) - 1


@pytest.mark.slow
def test_the_whole_experiment(
    script: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Generates, trains, fixes the network, tests; the last line is the result."""
    config, training = tmp_path / "people.yaml", tmp_path / "train.yaml"
    config.write_text(f"base: {script.SIMULATED}\n")
    training.write_text(f"base: {script.TRAINING}\nepochs: 3\nthreads: 1\n")
    commands: list[tuple[object, ...]] = []
    masks = tmp_path / "masks.npz"
    read = script.read_masks

    def read_masks(path: Path) -> object:
        commands.append(("the masks",))
        return read(path)

    def radhar(*arguments: object) -> None:
        commands.append(arguments)
        done = command_line.radhar(*arguments)
        assert done.returncode == 0, done.stderr

    monkeypatch.setattr(script, "SIMULATED", config)
    monkeypatch.setattr(script, "TRAINING", training)
    monkeypatch.setattr(script, "run_radhar", radhar)
    monkeypatch.setattr(script, "read_masks", read_masks)
    monkeypatch.setattr(script, "SHOTS", (0, 1))
    monkeypatch.setattr(script, "REPEATS", 1)
    count = measured(masks, config, per_class=4)
    out = tmp_path / "out"
    given = ["sim_to_real", str(masks), "-o", str(out), "--per-class", "8", "--jobs", "1"]
    monkeypatch.setattr(sys, "argv", [*given, "--quick"])
    script.main()
    lines = capsys.readouterr().out.splitlines()
    share = r"(0\.\d{3}|1\.000)"
    last = rf"accuracy on measured: {share} \({share} to {share}\), n = {count}"
    found = re.fullmatch(last, lines[-1])
    assert found is not None, lines[-1]
    right, low, high = map(float, found.groups())
    assert low <= right <= high
    assert lines[-2].startswith("accuracy with unlabelled measured maps: ")
    assert lines[-2].endswith(f", n = {count}")
    assert re.fullmatch(r"seed_1: best.safetensors has SHA-256 [0-9a-f]{64}", lines[0])
    assert any(line.startswith("what it takes for something else") for line in lines)
    order = [command[0] for command in commands]
    made = ["generate"] * 5 + ["train"] * 2
    assert order[:8] == [*made, "the masks"], "the networks are fixed before they are opened"
    assert set(order[8:]) == {"adapt"}
    commands.clear()
    script.main()
    assert capsys.readouterr().out.splitlines() == lines, "again: the same"
    assert "generate" not in {command[0] for command in commands}, "what is made is kept"
    script.simulated(out / "papers", 5, 1, script.INSTEAD["the paper's motion"])
    names = {path.name for path in (out / "papers").iterdir()}
    assert names == {"walking_away", "in_place", "falling_walking", "images", "linear", "done"}
    script.curve(
        script.Measured(out / "measured"),
        out / "simulated/images",
        out / "runs/seed_1",
        out / "shots",
    )
    printed = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in printed] == [
        "0 labelled a class, as trained",
        "0 labelled a class, adapted",
        "1 labelled a class, fine-tuned",
        "1 labelled a class, adapted",
        "1 labelled a class, from scratch",
    ]


def test_a_missing_file_is_refused_before_any_work(
    script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = ["sim_to_real", str(tmp_path / "none.npz"), "-o", str(tmp_path / "out")]
    monkeypatch.setattr(sys, "argv", given)
    with pytest.raises(SystemExit, match=r"none\.npz: no such file"):
        script.main()
    assert not (tmp_path / "out").exists()


def test_the_class_is_not_in_the_image(script: ModuleType) -> None:
    rng = np.random.default_rng(4)
    short = ndimage.binary_dilation(rng.random((256, 256)) < 0.002, iterations=6)
    short[120:136] = True
    long = np.concatenate([short[:, ::2], rng.random((256, 128)) < 0.5], axis=1)
    seen = script.network_image(short, "grabbing")
    np.testing.assert_array_equal(seen, script.network_image(long, "walking"))
    assert seen.shape == (32, 32)
    assert 0 < seen.mean() < 255


def test_mistakes_are_drawn_beside_the_nearest_simulated_images(
    script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for slug, level in (("grabbing", 10), ("grabbing", 60), ("walking", 90), ("walking", 200)):
        for folder in ("simulated", "measured"):
            image = np.full((32, 32), level + 5 * (folder == "measured"), np.uint8)
            script.write_image(image, tmp_path / folder / slug / f"{level}.png")
    simulated, measured = (
        open_images(tmp_path / name, None, "gray") for name in ("simulated", "measured")
    )
    drawn: dict[str, list[Any]] = {}

    def pictures_png(rows: dict[str, list[Any]], *_: str) -> bytes:
        drawn.update(rows)
        return b"PNG"

    monkeypatch.setattr(script, "pictures_png", pictures_png)
    right = np.eye(2)[measured.samples.label]
    found = script.Predicted(measured, measured.samples.label, right, measured.classes)
    assert found.accuracy == 1
    assert script.mistakes_png(found, simulated) is None
    wrong = right.copy()
    wrong[list(measured.samples.name).index("grabbing/60")] = 0.2, 0.8
    found = script.Predicted(measured, measured.samples.label, wrong, measured.classes)
    assert found.accuracy == 0.75
    assert script.mistakes_png(found, simulated) == b"PNG"
    assert list(drawn) == ["grabbing\n1 as\nwalking"]
    shown = [(one.words, int(one.levels[0, 0])) for one in drawn["grabbing\n1 as\nwalking"]]
    assert shown == [("measured 60", 65), ("simulated grabbing", 60), ("simulated walking", 90)]
