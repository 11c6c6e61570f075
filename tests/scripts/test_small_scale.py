"""scripts/small_scale.py: an experiment leaves one record, and the tables are made of records."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import reproduce_paper
import small_scale
from command_line import ROOT, radhar
from small_scale import Bench, Experiment

PAGE = ROOT / "docs" / "results.md"
RESULTS = ROOT / "docs" / "results" / "small"
QUICK = Experiment(
    small_scale.BOUND,
    "quick",
    "free_space",
    -10,
    (
        "radar.prf_hz=500",
        "radar.carrier_hz=10e9",
        "activities=[walking, punching]",
        "samples_per_class=8",
        "image.size_px=32",
        "maps=[stft, rtm]",
    ),
    ("model=smallnet", "epochs=1", "batch_size=4", "map=stft"),
    seeds=(1, 2),
)
OTHER = replace(QUICK, label="other", train=(*QUICK.train, "map=rtm"))
BOTH = replace(QUICK, label="both", of=("quick", "other"))


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """Records of two experiments and of both together; the program runs in this process."""

    def run(*words: object) -> None:
        done = radhar(*words)
        assert done.returncode == 0, done.stderr

    folder = tmp_path_factory.mktemp("small")
    bench = Bench(folder / "out", folder / "results")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(small_scale, "radhar", run)
        patch.setattr(small_scale, "EXPERIMENTS", (QUICK, OTHER, BOTH))
        for one in (BOTH, QUICK, OTHER):
            bench.record(one)
    return bench


def record_of(bench: Bench, one: Experiment) -> dict[str, Any]:
    return reproduce_paper.read_json(bench.results / f"{one.name}.json")


def test_a_record_counts_what_each_seed_and_all_together_get_right(bench: Bench) -> None:
    found = record_of(bench, QUICK)
    assert found["tested"] == 6
    assert len(found["correct"]) == 2
    each = [bench.probabilities(QUICK, seed) for seed in (1, 2)]
    truth = each[0][1]
    assert found["correct"] == [(p.argmax(1) == truth).sum() for p, _ in each]
    assert found["correct_together"] == (sum(p for p, _ in each).argmax(1) == truth).sum()
    assert np.sum(found["confusion_together"]) == 6
    assert found["commits"] == [reproduce_paper.commit()]


def test_probabilities_of_two_experiments_are_averaged_seed_by_seed(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(small_scale, "EXPERIMENTS", (QUICK, OTHER, BOTH))
    mean = np.mean([bench.probabilities(one, 2)[0] for one in (QUICK, OTHER)], axis=0)
    assert np.array_equal(bench.probabilities(BOTH, 2)[0], mean)
    assert not np.array_equal(mean, bench.probabilities(QUICK, 2)[0])
    assert record_of(bench, BOTH)["of"] == ["quick", "other"]


def test_a_row_without_a_record_says_so(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(QUICK, label="missing")
    monkeypatch.setattr(small_scale, "EXPERIMENTS", (QUICK, missing))
    text = small_scale.page_text(bench.results)
    assert "| free space | -10 | missing | not run |" in text
    assert f"results/small/{QUICK.name}.json" in text


def test_names_are_told_apart_and_parts_of_a_mean_exist() -> None:
    names = [one.name for one in small_scale.EXPERIMENTS]
    assert len(set(names)) == len(names)
    for one in small_scale.EXPERIMENTS:
        for label in one.of:
            assert replace(one, label=label).name in names


def test_the_committed_tables_are_those_of_the_records() -> None:
    inside = PAGE.read_text().partition(small_scale.BEGIN)[2].partition(reproduce_paper.END)[0]
    assert inside.strip() == small_scale.page_text(RESULTS).strip()


def test_committed_records_name_no_folder_and_no_stranger() -> None:
    names = {one.name for one in small_scale.EXPERIMENTS}
    files = sorted(RESULTS.glob("*.json"))
    assert files
    for file in files:
        assert file.stem in names
        assert str(Path.home()) not in file.read_text()
        assert '"/' not in file.read_text(), "an absolute path"
