"""Evaluation and its report: numbers, figures, warnings."""

import csv
import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from helpers.listener import Listener
from helpers.small import small_config
from learning.patterns import CLASSES, clear_line, plant, split_tree, trained, tree
from PIL import Image

from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.learning.evaluation import (
    last_features,
    measure_speed,
    open_for_model,
    predict_classes,
)
from radhar_cli.learning.onnx_export import export
from radhar_cli.learning.report import evaluate
from radhar_cli.learning.run_files import BEST
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.trained_run import load_run

CPU = torch.device("cpu")


@pytest.fixture(scope="session")
def learned(tmp_path_factory):
    """(run, data) of a run that gets everything right, its last layer planted: S2, S3 and S8."""
    place = tmp_path_factory.mktemp("learned")
    root = split_tree(place / "tree", train=8, val=3)
    trained(root, place / "good", epochs=1)
    plant(place / "good", root)
    return place / "good", root


def evaluated(learned, data=None, **more):
    listener = Listener()
    places = learned[1] if data is None else data
    places = places if isinstance(places, list) else [places]
    return evaluate([learned[0]], places, EvalOptions(**more), CPU, listener), listener


def only(report):
    (run,) = report.numbers["runs"].values()
    (numbers,) = run["data"].values()
    found: dict[str, Any] = numbers
    return found


@pytest.mark.drawn
def test_report_of_a_good_run(learned, tmp_path):
    report, listener = evaluated(learned, tsne=True, in_place_vs_moving=True, batch=4)
    numbers = only(report)
    assert numbers["accuracy"] == 1.0
    assert numbers["confusion"] == np.diag([3, 3, 3]).tolist()
    assert numbers["in_place_vs_moving"] == [[6, 0], [0, 3]]
    assert numbers["seen_in_training"] == {"images": 0, "scenes": 0}
    assert not any("trained on" in line for line in listener.messages)
    out = tmp_path / "report"
    report.write(out)
    stored = json.loads((out / "report.json").read_text())
    assert stored["split"] is None
    assert only(report)["split"] == "val"
    page = (out / "report.html").read_text()
    assert "://" not in page
    sources = re.findall(r'src="([^"]{0,30})', page)
    assert len(sources) == len(report.figures) == 6
    assert all(source.startswith("data:image/png;base64,") for source in sources)
    for name in ("confusion", "reliability", "hardest", "tsne", "curves"):
        assert (out / f"{name}.png").read_bytes().startswith(b"\x89PNG"), name
    with (out / "predictions.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["true"] for row in rows] == [row["predicted"] for row in rows]
    assert rows[0]["image"] == "kicking/000"
    assert (out / "confusion.csv").exists()
    timing = stored["runs"]["good"]["speed"]
    assert timing["batch"] == 4
    assert timing["image_s"] > 0


def test_planted_confusions_appear_in_the_matrix(learned, tmp_path):
    """The folders of punching and walking change their names; kicking loses an image."""
    root = tmp_path / "swapped"
    shutil.copytree(learned[1], root)
    val = root / "val"
    (val / "punching").rename(val / "x")
    (val / "walking").rename(val / "punching")
    (val / "x").rename(val / "walking")
    (val / "walking/000.png").unlink()
    numbers = only(evaluated(learned, root, in_place_vs_moving=True)[0])
    assert numbers["confusion"] == [[3, 0, 0], [0, 0, 3], [0, 2, 0]]
    assert numbers["in_place_vs_moving"] == [[3, 3], [2, 0]]
    assert numbers["accuracy"] == 3 / 8
    assert numbers["classes"]["walking"] == {"precision": 0, "recall": 0, "f1": 0, "images": 2}


def test_some_of_the_classes_are_matched_by_name(learned, tmp_path):
    for name in ("walking", "kicking"):
        shutil.copytree(learned[1] / "val" / name, tmp_path / "t/val" / name)
    numbers = only(evaluated(learned, tmp_path / "t")[0])
    assert numbers["confusion"] == np.diag([3, 0, 3]).tolist()
    assert numbers["accuracy"] == 1


def test_evaluation_on_training_images_is_warned_of(learned):
    report, listener = evaluated(learned, split="train")
    assert only(report)["seen_in_training"]["images"] == 24
    assert any("24 of these 24 images" in line for line in listener.messages)
    report, _ = evaluated(learned, split="all")
    assert only(report)["seen_in_training"]["images"] == 24


def test_the_part_that_chose_the_epoch_is_said_to_have(learned, tmp_path):
    """Of val alone, of all, and of a copy under another name; not of a test part."""
    report, listener = evaluated(learned)
    assert only(report)["chose_the_epoch"] == 9
    (line,) = [line for line in listener.messages if "chose the epoch" in line]
    assert line.strip().startswith("val chose the epoch")
    assert "split.test" in line
    report.write(tmp_path / "report")
    assert "val chose the epoch" in (tmp_path / "report/report.html").read_text()
    shutil.copytree(learned[1] / "val", tmp_path / "copy")
    shutil.copytree(learned[1] / "val", tmp_path / "mixed/test")
    shutil.copytree(split_tree(tmp_path / "fresh", 1, 2, seed=9) / "val", tmp_path / "new/test")
    for data, count in (("copy", 9), ("mixed", 9), ("new", 0)):
        report, listener = evaluated(learned, tmp_path / data)
        assert only(report)["chose_the_epoch"] == count
        assert any("chose the epoch" in line for line in listener.messages) == (count > 0)


def test_a_test_part_is_scored_where_there_is_one(learned, tmp_path):
    shutil.copytree(learned[1], tmp_path / "tree")
    other = split_tree(tmp_path / "other", train=1, val=2, seed=5)
    shutil.copytree(other / "val", tmp_path / "tree/test")
    report, listener = evaluated(learned, tmp_path / "tree")
    numbers = only(report)
    assert (numbers["split"], numbers["images"], numbers["chose_the_epoch"]) == ("test", 6, 0)
    report, listener = evaluated(learned, tmp_path / "tree", split="val")
    assert only(report)["chose_the_epoch"] == 9
    assert any("--split test" in line for line in listener.messages)


@pytest.mark.drawn
def test_several_data_sets_give_robustness(learned, tmp_path):
    noisy = split_tree(tmp_path / "noisy", 1, 2, seed=4)
    report, _ = evaluated(learned, [learned[1], noisy], in_place_vs_moving=True)
    report.write(tmp_path / "out")
    with (tmp_path / "out/robustness.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["data"] for row in rows] == ["tree", "noisy"]
    assert float(rows[0]["accuracy"]) == 1.0
    assert float(rows[0]["low_95"]) < 1.0 <= float(rows[0]["high_95"]) + 1e-9
    assert (tmp_path / "out/robustness.png").exists()
    assert (tmp_path / "out/confusion_good__noisy.png").exists()


def test_several_runs_overlay_their_curves(learned, run_dir, monkeypatch):
    from radhar_cli.learning import report as module

    drawn: list[list[str]] = []
    draw = module.curves_png

    def recorded(series, *rest):
        drawn.append(list(series))
        return draw(series, *rest)

    monkeypatch.setattr(module, "curves_png", recorded)
    report = evaluate([learned[0], run_dir], [learned[1]], EvalOptions(), CPU, Listener())
    assert drawn == [["good", "plain"]]
    assert list(report.numbers["runs"]) == ["good", "plain"]
    assert not any(name == "robustness.png" for name, _, _ in report.figures)


def test_weights_alone_are_evaluated_without_curves(learned, tmp_path):
    shutil.copy(learned[0] / BEST, tmp_path / "model.safetensors")
    report = evaluate(
        [tmp_path / "model.safetensors"], [learned[1]], EvalOptions(), CPU, Listener()
    )
    assert only(report)["accuracy"] == 1.0
    assert not any(name == "curves.png" for name, _, _ in report.figures)


def test_batch_size_does_not_change_predictions(learned):
    metadata, model = load_best(learned[0])
    images = open_for_model(metadata, learned[1], None)
    rows = images.rows("val")[::-1].copy()
    one, many = (predict_classes(model, metadata, images, rows, CPU, batch) for batch in (1, 5))
    np.testing.assert_allclose(one.probabilities, many.probabilities, atol=1e-5)
    np.testing.assert_allclose(many.probabilities.sum(1), 1, atol=1e-6)
    assert np.array_equal(one.truth, images.samples.label[rows])
    assert last_features(model, metadata, images, rows, CPU).shape == (9, 128)


@pytest.mark.parametrize(
    ("classes", "parts", "size", "expected"),
    [
        (("walkin",), {"val": 1}, 32, ["'walkin' is unknown to the model", "'walking'"]),
        (CLASSES, {"val": 1}, 64, ["64 x 64 px", "32 x 32 px"]),
        (CLASSES, {"train": 1}, 32, ["has no val images"]),
    ],
)
def test_data_that_does_not_fit_the_model_is_refused(
    learned, tmp_path, classes, parts, size, expected
):
    root = tree(tmp_path / "t", classes, parts, size)
    with clear_line(FolderError, *expected, root):
        evaluated(learned, root)


def test_two_groups_need_the_twelve_classes(tmp_path):
    root = split_tree(tmp_path / "t", 2, 1, classes=("a", "b"))
    trained(root, tmp_path / "run", epochs=1)
    with pytest.raises(RadharError, match="'a' is none of the twelve activities"):
        evaluated((tmp_path / "run", root), in_place_vs_moving=True)


def test_the_same_data_twice_is_refused(learned):
    with pytest.raises(FolderError, match="is given twice"):
        evaluated(learned, [learned[1], learned[1]])


@pytest.mark.drawn
def test_tsne_needs_two_images(learned, tmp_path):
    one = tree(tmp_path / "one", ("walking",), {"val": 1})
    with clear_line(RadharError, "--tsne", "at least 2 images"):
        evaluated(learned, one, tsne=True)
    report, _ = evaluated(
        learned, tree(tmp_path / "two", ("walking", "kicking"), {"val": 1}), tsne=True
    )
    assert any(name == "tsne.png" for name, _, _ in report.figures)


def test_speed_times_what_the_paper_times(learned):
    metadata, _ = load_best(learned[0])
    found = measure_speed(learned[0], open_for_model(metadata, learned[1], None), 0, CPU, 3)
    assert set(found) == {
        *("load_s", "image_s", "load_and_image_s"),
        *("batch", "images_per_s", "images_per_s_with_loading"),
    }
    assert found["images_per_s_with_loading"] < found["images_per_s"]
    assert found["load_and_image_s"] > found["load_s"] > 0


def test_predict_of_files_and_folders(learned):
    run, root = learned
    network, file = load_run(run, "cpu"), root / "val/walking/001.png"
    one, many = network.predict(file, split="val"), network.predict(root, split="val")
    assert one.samples == (str(file),)
    assert many.samples[0] == f"{root}: kicking/000"
    assert len(many) == 9
    assert many.classes == ("kicking", "punching", "walking")
    np.testing.assert_allclose(many.probabilities.sum(1), 1, atol=1e-6)
    assert all(best in name for best, name in zip(many.likeliest, many.samples, strict=True))
    place = many.samples.index(f"{root}: walking/001")
    np.testing.assert_allclose(many.probabilities[place], one.probabilities[0], atol=1e-5)


def test_predict_needs_no_labels(learned, tmp_path):
    root = tree(tmp_path / "t", ("who", "knows"), {"": 1})
    assert len(load_run(learned[0], "cpu").predict(root)) == 2


def test_predict_refuses_other_sizes_and_damage(learned, tmp_path):
    Image.new("RGB", (64, 32)).save(tmp_path / "a.png")
    Image.new("RGB", (32, 32)).save(tmp_path / "b.png")
    (tmp_path / "b.png").write_bytes((tmp_path / "b.png").read_bytes()[:50])
    network = load_run(learned[0], "cpu")
    for name, expected in (("a", "32 x 64 px"), ("b", "truncated"), ("c", "no such file")):
        with clear_line(FolderError, tmp_path / f"{name}.png", expected):
            network.predict(tmp_path / f"{name}.png")


def test_onnx_runtime_gives_the_same_probabilities(learned, tmp_path):
    import onnx
    import onnxruntime

    path = tmp_path / "new/model.onnx"
    assert export(learned[0], path) <= 1e-4
    stored = {p.key: p.value for p in onnx.load(path).metadata_props}
    assert json.loads(stored["classes"]) == ["kicking", "punching", "walking"]
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
    metadata, model = load_best(learned[0])
    images = open_for_model(metadata, learned[1], None)
    rows = images.rows("val")
    levels = np.stack([images.pixels.read(int(r)).transpose(2, 0, 1) for r in rows])
    (logits,) = session.run(["logits"], {"pixels": levels})
    with torch.no_grad():
        expected = model(metadata.normalisation(torch.from_numpy(levels))).numpy()
    np.testing.assert_allclose(logits, expected, atol=1e-4, rtol=1e-4)
    assert np.array_equal(logits.argmax(1), images.samples.label[rows])


SET = """
seed: 3
samples_per_class: 4
activities: [punching, walking]
duration_s: 2.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
snr_db: 20
maps: [rtm, stft]
image: {size_px: 32}
split: {train: 0.5, validation: 0.5}
"""


def test_hdf5_and_png_train_and_evaluate_the_same(tmp_path):
    build(load_config(small_config(tmp_path, SET)), tmp_path / "set", progress=Listener(), jobs=1)
    stored, files = tmp_path / "set", tmp_path / "set/png/stft"
    trained(stored, tmp_path / "run", epochs=1, batch_size=4, map="stft")
    on_both = []
    for data in (stored, files):
        listener = Listener()
        report = evaluate([tmp_path / "run"], [data], EvalOptions(), CPU, listener)
        on_both.append(only(report))
    for key in ("accuracy", "confusion", "calibration_error"):
        assert on_both[0][key] == on_both[1][key]
    assert on_both[0]["snr_db"] == 20.0
    seen = [
        only(evaluate([tmp_path / "run"], [data], EvalOptions(split="train"), CPU, Listener()))
        for data in (stored, files)
    ]
    assert seen[0]["seen_in_training"] == {"images": 4, "scenes": 4}
    assert seen[1]["seen_in_training"] == {"images": 4, "scenes": 0}
    with pytest.raises(FolderError, match="has no map 'stfft'"):
        evaluate([tmp_path / "run"], [stored], EvalOptions(map="stfft"), CPU, Listener())


@pytest.fixture(scope="module")
def mistaken(learned, tmp_path_factory):
    """The report of a network on a tree where punching and walking have changed their names."""
    root = tmp_path_factory.mktemp("mistaken") / "tree"
    shutil.copytree(learned[1], root)
    val = root / "val"
    for old, new in (("punching", "x"), ("walking", "punching"), ("x", "walking")):
        (val / old).rename(val / new)
    report, _ = evaluated(learned, root)
    report.write(root.parent / "report")
    return root, root.parent / "report"


def test_the_most_confident_mistakes_are_shown_with_their_files(mistaken):
    root, out = mistaken
    with (out / "predictions.csv").open() as file:
        wrong = [row for row in csv.DictReader(file) if row["true"] != row["predicted"]]
    with (out / "hardest.csv").open() as file:
        shown = list(csv.DictReader(file))
    assert len(shown) == len(wrong) == 6
    surest = sorted((float(row["probability"]) for row in wrong), reverse=True)
    assert [float(row["probability"].rstrip(" %")) for row in shown] == [
        pytest.approx(100 * value, abs=0.06) for value in surest
    ]
    for row in shown:
        path = Path(row["image"])
        assert path.is_file()
        assert path.parent.name == row["true"].replace(" ", "_")
    page = (out / "report.html").read_text()
    assert "Most confident mistakes" in page
    assert str(root / "val") in page


@pytest.mark.drawn
def test_the_page_is_for_people_and_the_same_each_time(mistaken, learned, tmp_path):
    page = (mistaken[1] / "report.html").read_text()
    assert "<title>good on tree</title>" in page
    assert not re.search(r"<h[123]>[^<]*\.csv", page), "a title is no file name"
    assert not re.search(r"<td>[^<]*\d\.\d{8,}", page), "a number has few digits"
    assert "label smoothing" in page.lower()
    assert "learning_rate" in page
    other, _ = evaluated(learned, mistaken[0])
    other.write(tmp_path)

    def untimed(text):  # but for how long an image took
        return re.sub(r"(?s)<h3>Size and speed.*?</table>", "", text)

    assert untimed((tmp_path / "report.html").read_text()) == untimed(page)


def test_the_calibration_error_is_the_distance_of_the_bins_from_the_line(mistaken):
    (run,) = json.loads((mistaken[1] / "report.json").read_text())["runs"].values()
    (numbers,) = run["data"].values()
    bins = numbers["calibration"]
    assert sum(bins["images"]) == numbers["images"]
    gap = sum(
        n * abs(share - sure)
        for n, share, sure in zip(
            *(bins[k] for k in ("images", "accuracy", "confidence")), strict=True
        )
        if n
    )
    assert numbers["calibration_error"] == pytest.approx(gap / numbers["images"])


@pytest.mark.slow
@pytest.mark.drawn
def test_weights_of_global_filters_are_drawn_by_network_and_layer(learned, tmp_path):
    names = ("one", "two")
    for number, name in enumerate(names):
        trained(learned[1], tmp_path / name, epochs=1, model="fftnet", seed=number)
    runs = [tmp_path / "one", tmp_path / "two", learned[0]]
    options = EvalOptions(filters=True)
    report = evaluate(runs, [learned[1]], options, CPU, Listener())
    assert list(report.numbers["filters"]) == list(names), "the third has none"
    for rows in report.numbers["filters"].values():
        assert [(row["height"], row["width"]) for row in rows] == [(8, 8)] * 2 + [(4, 4)] * 2 + [
            (2, 2)
        ] * 2
    assert any(name == "filters.png" for name, _, _ in report.figures)
    with clear_line(RadharError, "--filters", "fftnet has six"):
        evaluated(learned, filters=True)
