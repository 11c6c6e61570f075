"""Accuracy after learning from a few labelled images of each class."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from command_line import radhar
from documented import KEYS
from learning.patterns import CLASSES, Watched, one_clear_line, plant, same, tree

from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning import shots as module
from radhar_cli.learning.evaluation import open_for, predict
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.run_folder import load_best, read_metadata
from radhar_cli.learning.shots import (
    ADAPTED,
    AS_TRAINED,
    SCRATCH,
    TUNED,
    Draw,
    ShotCurve,
    ShotOptions,
    ShotPoint,
    drawn,
    few_shots,
    missing,
    most_shots,
)
from radhar_cli.learning.single_result import EvalOptions, EvalSet

CPU = torch.device("cpu")
QUICK = ("epochs=2", "batch_size=12", "threads=1", "workers=0")


@pytest.fixture(autouse=True)
def few_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """Short epochs."""
    monkeypatch.setattr(module, "SHOWN", 24)


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Eight images of each class, without splits."""
    return tree(tmp_path_factory.mktemp("measured") / "tree", seed=9)


def opened(path: Path, persons: tuple[str, ...] | None = None) -> EvalSet:
    images = replace(open_images(path, None, "rgb"), persons=persons)
    return EvalSet(images, np.arange(len(images)), "all")


def curve(
    run: Path, data: Path, out: Path, progress: Watched | None = None, **options: object
) -> ShotCurve:
    given = ShotOptions((0, 1, 2), repeats=2, overrides=QUICK)
    given = replace(given, **options)  # type: ignore[arg-type]
    return few_shots(run, data, out, given, EvalOptions("all"), CPU, progress or Watched())


def test_draws_are_k_of_each_class_and_all_others_are_tested(measured: Path) -> None:
    some = opened(measured)
    for k in (1, 3):
        draw = drawn(some, k, seed=1, repeat=0)
        assert np.bincount(some.images.label[draw.labelled]).tolist() == [k] * len(CLASSES)
        assert sorted([*draw.labelled, *draw.tested]) == list(range(24))
    larger, other = drawn(some, 5, 1, 0), drawn(some, 5, 1, 1)
    assert set(draw.labelled) < set(larger.labelled), "more labels are the fewer ones and others"
    assert set(other.labelled) != set(larger.labelled), "every repeat draws anew"
    assert drawn(some, 0, 1, 0).tested.tolist() == list(range(24))


def test_a_class_that_has_too_few_is_named(measured: Path) -> None:
    some = opened(measured)
    assert missing(some, drawn(some, 7, 1, 0), 7) is None
    assert missing(some, drawn(some, 8, 1, 0), 8) == "punching has 8 images"
    assert missing(some, drawn(some, 9, 1, 0), 9) == "punching has 8 images"


def test_the_most_that_can_be_drawn(measured: Path) -> None:
    for some in (opened(measured), opened(measured, tuple("abcd"[row % 4] for row in range(24)))):
        most = most_shots(some, 1, 3)
        assert all(missing(some, drawn(some, most, 1, n), most) is None for n in range(3))
        assert any(missing(some, drawn(some, most + 1, 1, n), most + 1) for n in range(3))


def test_labelled_images_come_from_other_persons_than_tested_ones(measured: Path) -> None:
    persons = tuple("abcd"[row % 4] for row in range(24))
    some = opened(measured, persons)

    def who(rows: np.ndarray) -> set[str]:
        return {persons[row] for row in rows}

    for repeat in range(6):
        one, more = (drawn(some, k, 1, repeat) for k in (1, 4))
        assert who(one.tested) == who(more.tested), "tested on the same persons, whatever k"
        assert len(who(more.labelled)) == len(who(more.tested)) == 2
        assert not who(more.labelled) & who(more.tested)
        assert np.bincount(some.images.label[more.labelled]).tolist() == [4, 4, 4]
        assert sorted([*more.labelled, *more.tested]) == list(range(24))
    assert missing(some, more, 4) is None
    assert missing(some, drawn(some, 5, 1, 0), 5) == (
        "punching has 8 images, 4 of the persons to learn from"
    )


def test_images_that_each_have_a_recording_of_their_own_are_just_different(measured: Path) -> None:
    alone = opened(measured, tuple(map(str, range(24))))
    plain = opened(measured)
    assert drawn(alone, 2, 1, 0).tested.tolist() == drawn(plain, 2, 1, 0).tested.tolist()


def test_persons_come_from_data_sets(tmp_path: Path) -> None:
    by_person = "split={by: subject, subjects: 3, train: 0.34, validation: 0.33, test: 0.33}"
    sets = ("samples_per_class=5", "activities=[walking, punching]", "maps=[stft]", by_person)
    out, plain = tmp_path / "set", tmp_path / "plain"
    command = ("generate", "configs/quickstart.yaml", "--jobs", 1, "--set", "image.size_px=32")
    command = (*command, "--set", "output.png=false", "--set", "duration_s=1")
    assert radhar(*command, "-o", out, *(x for s in sets for x in ("--set", s))).returncode == 0
    done = radhar(*command, "-o", plain, *(x for s in sets[:3] for x in ("--set", s)))
    assert done.returncode == 0, done.stderr
    images = open_images(out, None, "gray")
    assert images.persons == tuple("01201") * 2
    walking = images.renamed({"punching": None})
    assert walking.persons == tuple("01201")
    assert open_images(plain, None, "gray").persons is None


@pytest.mark.parametrize("named", [True, False])
def test_persons_or_recordings_come_from_recorded_sets(tmp_path: Path, named: bool) -> None:
    x = (np.random.default_rng(0).random((6, 32, 32)) < 0.3).astype(np.uint8)
    who = {"person": np.array(list("aabbcc"))} if named else {}
    np.savez(tmp_path / "m.npz", masks=x, label=np.array(["walking", "falling"] * 3), **who)
    (tmp_path / "c.yaml").write_text(
        "maps: [stft]\nrecordings: {window_s: 5, rows: [-500, 500]}\n"
        "split: {train: 0.5, validation: 0.5}\n"
    )
    out = tmp_path / "set"
    done = radhar("generate", tmp_path / "c.yaml", "--recordings", tmp_path / "m.npz", "-o", out)
    assert done.returncode == 0, done.stderr
    persons = open_images(out, None, "gray").persons
    assert persons is not None
    assert set(persons) == (set("abc") if named else {f"file m.npz/{n}" for n in range(6)})


def test_mixed_images_are_shown_as_often_as_labelled_ones_unless_these_are_few(
    run_dir: Path, data: Path, measured: Path
) -> None:
    metadata, _ = load_best(run_dir)
    few = open_for(metadata, measured, None).some(np.array([0, 8, 16]))
    mixed = module.training_images(metadata, data)
    for most, of_few in ((100, 24), (2, 6)):
        images, weights = module._learned_from(metadata, few, [mixed], most)
        rows = images.rows("train")
        shown = np.bincount(images.source[rows], np.array(weights)[images.source[rows]])
        assert shown == pytest.approx([of_few, 24])
        assert images.rows("val").size == 3
        assert (images.source[images.rows("val")] == 0).all(), "the mixed ones choose no epoch"
        assert images.classes == metadata.classes


def test_the_curve_of_a_run(run_dir: Path, data: Path, measured: Path, tmp_path: Path) -> None:
    watched = Watched()
    found = curve(run_dir, measured, tmp_path, watched, mix=(data,), shots=(0, 2, 8), adapting=1)
    ways = [(p.shots, p.how) for p in found.points]
    assert ways == [(0, AS_TRAINED), (0, ADAPTED), (2, TUNED), (2, ADAPTED), (2, SCRATCH)]
    assert found.left_out == {8: "punching has 8 images"}
    assert any("8 a class: left out" in line for line in watched.messages)
    zero, _, tuned, _, scratch = found.points
    metadata, as_trained = load_best(run_dir)
    every = predict(as_trained, metadata, opened(measured).images, np.arange(24), CPU, 8)
    assert zero.accuracies == ((every.predicted == every.truth).mean(),)
    assert tuned.tested == scratch.tested == (18, 18)
    for repeat, share in enumerate(tuned.accuracies):
        one = tmp_path / f"2_a_class/{repeat + 1}/fine_tuned"
        about, model = load_best(one)
        draw = drawn(opened(measured), 2, metadata.config["seed"], repeat)
        again = predict(model, about, opened(measured).images, draw.tested, CPU, 8)
        assert share == (again.predicted == again.truth).mean()
        assert about.data["val"] == 6
        assert "start" in about.work
        about, adapted = load_best(one.parent / "adapted")
        assert about.work["adapted_epochs"] == 1
        assert torch.equal(adapted.head.weight, as_trained.head.weight), "not the fine-tuned one"
        assert not torch.equal(adapted.head.weight, model.head.weight)
        assert "start" not in read_metadata(one.parent / "from_scratch").work


def test_an_interrupted_measurement_resumes_to_the_same_result(
    run_dir: Path, measured: Path, tmp_path: Path
) -> None:
    class Stopped(Watched):
        def say(self, message: str) -> None:
            if "from scratch, 1 of" in message:
                raise KeyboardInterrupt
            super().say(message)

    whole = curve(run_dir, measured, tmp_path / "whole", shots=(1,))
    with pytest.raises(KeyboardInterrupt):
        curve(run_dir, measured, tmp_path / "cut", Stopped(), shots=(1,))
    first = tmp_path / "cut/1_a_class/1/fine_tuned/best.safetensors"
    written = first.stat().st_mtime_ns
    assert not (tmp_path / "cut/1_a_class/2/from_scratch").exists()
    assert curve(run_dir, measured, tmp_path / "cut", shots=(1,)).points == whole.points
    assert first.stat().st_mtime_ns == written, "what was finished is kept"
    one, two = (
        load_best(tmp_path / name / "1_a_class/2/from_scratch")[1] for name in ("whole", "cut")
    )
    assert same(one.state_dict(), two.state_dict())


def test_other_settings_in_the_same_folder_are_refused(
    run_dir: Path, measured: Path, tmp_path: Path
) -> None:
    curve(run_dir, measured, tmp_path, shots=(1,), repeats=1)
    changed = ("batch_size=8", *QUICK[:1], *QUICK[2:])
    with pytest.raises(Exception, match="batch_size: 12 there, 8 here"):
        curve(run_dir, measured, tmp_path, shots=(1,), repeats=1, overrides=changed)
    curve(run_dir, measured, tmp_path, shots=(1,), repeats=1, overrides=changed, overwrite=True)


def test_further_numbers_of_images_are_added_to_the_curve(
    run_dir: Path, measured: Path, tmp_path: Path
) -> None:
    whole = curve(run_dir, measured, tmp_path / "whole", shots=(0, 1))
    for shots in ((1,), (0,)):
        found = curve(run_dir, measured, tmp_path / "parts", shots=shots)
        found.write(tmp_path / "parts")
    assert found.points == whole.points
    with pytest.raises(FolderError, match="as repeats differs; --overwrite starts again"):
        curve(run_dir, measured, tmp_path / "parts", shots=(0,), repeats=1)
    again = curve(run_dir, measured, tmp_path / "parts", shots=(0,), repeats=1, overwrite=True)
    assert [point.shots for point in again.points] == [0]
    (tmp_path / "parts/shots.json").write_text("[]")
    with pytest.raises(FolderError, match="is not a curve"):
        curve(run_dir, measured, tmp_path / "parts", shots=(0,))


def test_settings_are_the_runs_with_fewer_epochs_to_fine_tune(
    run_dir: Path, measured: Path, tmp_path: Path
) -> None:
    found = curve(run_dir, measured, tmp_path, shots=(0,), overrides=("epochs=9",))
    tuned, scratch = (found.about["settings"][how] for how in (TUNED, SCRATCH))
    assert (scratch["epochs"], tuned["epochs"]) == (9, 5)
    assert {key for key in tuned if tuned[key] != scratch[key]} == {"epochs"}
    other = curve(run_dir, measured, tmp_path, shots=(0,), tuning=("epochs=5",))
    assert other.about["settings"][TUNED]["epochs"] == 5
    with pytest.raises(ConfigError) as error:
        curve(run_dir, measured, tmp_path, shots=(0,), tuning=("epochs=0",))
    one_clear_line(error.value, "--tune: epochs = 0", "greater than or equal to 1")


def test_too_few_images_to_draw_from_are_refused_in_one_line(
    run_dir: Path, measured: Path, tmp_path: Path
) -> None:
    with pytest.raises(FolderError) as error:
        curve(run_dir, measured, tmp_path, shots=(50,))
    one_clear_line(
        error.value, measured, "--shots 50: punching has 8 images", "should be at most 7"
    )


def test_accuracy_below_the_baselines_is_reported() -> None:
    found = ShotCurve("", {"mix": []})
    found.points = [
        ShotPoint(0, AS_TRAINED, (10,), (0.8,)),
        ShotPoint(1, TUNED, (10,), (0.7,)),
        ShotPoint(1, SCRATCH, (10,), (0.5,)),
        ShotPoint(5, TUNED, (10,), (0.85,)),
        ShotPoint(5, SCRATCH, (10,), (0.9,)),
    ]
    no_labels, from_scratch = found.shortfalls()
    assert "1 a class: fine-tuned is below no labels (70.0 and 80.0 %); --mix" in no_labels
    assert "5 a class: fine-tuned is below from scratch (85.0 and 90.0 %)" in from_scratch


def test_the_command_writes_table_figure_and_numbers(
    run_dir: Path, data: Path, measured: Path, tmp_path: Path
) -> None:
    sets = [part for text in QUICK for part in ("--set", text)]
    given = ("eval", run_dir, measured, "--shots", "1,0", "--repeats", 1, "--mix", data, *sets)
    done = radhar(*given, "-o", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told.keys() == KEYS["eval --shots"]
    numbers = json.loads((tmp_path / "out/shots.json").read_text())
    assert numbers["mix"] == [str(data)]
    assert [p["shots"] for p in numbers["points"]] == [0, 1, 1]
    for point in numbers["points"]:
        share, low, high = told["accuracy"][point["learned"]][str(point["shots"])]
        assert share == point["accuracy"]
        assert low <= share <= high
        assert [low, high] == point["accuracy_95"]
    assert len((tmp_path / "out/shots.csv").read_text().splitlines()) == 4
    assert (tmp_path / "out/shots.png").read_bytes().startswith(b"\x89PNG")
    table = radhar(*given, "-o", tmp_path / "out").stdout
    assert "labelled a class" in table
    assert f"{100 * numbers['points'][1]['accuracy']:5.1f} %" in table


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--shots", "1;5"), "should be whole numbers with commas"),
        (("--shots", "-1"), "should be whole numbers with commas"),
        (("--shots", "1", "--tsne"), "--tsne: is not drawn with --shots"),
        (("--mix", "{data}"), "--mix: belongs to --shots"),
        (("--tune", "epochs=1"), "--tune: belongs to --shots"),
        (("--repeats", "2"), "--repeats: belongs to --shots"),
        (("--adapt", "2"), "--adapt: belongs to --shots"),
        (("--shots", "0,50000", "--repeats", "0"), "--repeats 0: should be greater than"),
        (("--shots", "1", "--set", "epoch=1"), "did you mean 'epochs'"),
        (("--shots", "1", "--mix", "{data}/none"), "no such file or folder"),
        (("--shots", "1", "{data}"), "should have one of each"),
    ],
)
def test_wrong_use_is_refused_in_one_line(
    run_dir: Path,
    data: Path,
    measured: Path,
    tmp_path: Path,
    options: tuple[str, ...],
    message: str,
) -> None:
    given = [option.replace("{data}", str(data)) for option in options]
    done = radhar("eval", run_dir, measured, "-o", tmp_path / "out", *given)
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not list(tmp_path.glob("out/*"))


def test_zero_shots_is_the_accuracy_of_the_run(
    run_dir: Path, measured: Path, tmp_path: Path
) -> None:
    """What 0 shots reports is the run's own accuracy: 1 where it is right about everything."""
    from shutil import copytree

    sure = copytree(run_dir, tmp_path / "sure")
    plant(sure, measured)
    found = curve(sure, measured, tmp_path / "out", shots=(0,))
    assert found.points[0].accuracy == 1
    assert found.points[0].interval[1] == 1


def test_a_draw_is_of_the_rows_of_the_split_alone(measured: Path) -> None:
    some = replace(opened(measured), rows=np.arange(0, 24, 2))
    draw: Draw = drawn(some, 2, 1, 0)
    assert not np.isin([*draw.labelled, *draw.tested], np.arange(1, 24, 2)).any()
