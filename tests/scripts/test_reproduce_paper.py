"""The paper's tables: one record a run, tables out of the records alone."""

import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import reproduce_paper
from helpers.command_line import ROOT, radhar
from reproduce_paper import Reproduction, Scale, Training

PAGE = ROOT / "docs/records/runs.md"
RESULTS = ROOT / "docs/records/paper"

# 500 pulses a second, two classes, maps of 32 px: everything that a run leaves, in seconds.
QUICK = Scale(
    size_px=32,
    per_class=5,
    fresh_per_class=1,
    trainings=(
        Training("free_space", 30, epochs=2),
        Training("free_space", -10, epochs=2),
        Training("free_space", 30, epochs=2, by_subject=True),
    ),
    generate=("radar.prf_hz=500", "radar.carrier_hz=10e9", "activities=[walking,punching]"),
    train=("batch_size=8", "threads=1"),
)
FIRST, SECOND, APART = (reproduce_paper.run_name(QUICK, training) for training in QUICK.trainings)


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Reproduction]:
    """The first run of QUICK and its record; the program runs in this process."""
    folder = tmp_path_factory.mktemp("quick")

    def run(*words: object) -> None:
        done = radhar(*words)
        assert done.returncode == 0, done.stderr

    work = Reproduction(
        "quick", QUICK, folder / "data", folder / "runs", folder / "docs/paper/quick", jobs=1
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reproduce_paper, "radhar", run)
        patch.setitem(reproduce_paper.SCALES, "quick", QUICK)
        work.train(QUICK.trainings[0])
        for training in QUICK.trainings:
            work.record(training)
        yield work


@pytest.fixture
def records(quick: Reproduction) -> dict[str, dict[str, Any]]:
    """The record of the first run, and one each that the others would leave."""
    first = reproduce_paper.read_records(quick.results)[FIRST]
    second = {**first, "name": SECOND, "snr_db": -10}
    return {
        FIRST: first,
        SECOND: second,
        APART: {**first, "name": APART, "subjects": 5, "fresh": {}},
    }


def lines_of(work: Reproduction, records: dict[str, dict[str, Any]], word: str) -> list[str]:
    return [line for line in reproduce_paper.tables(work.name, records) if word in line]


def test_a_finished_run_leaves_its_record_and_no_other_does(quick: Reproduction) -> None:
    assert [file.name for file in quick.results.glob("*.json")] == [f"{FIRST}.json"]
    found = reproduce_paper.read_records(quick.results)[FIRST]
    assert (found["snr_db"], found["epochs"], found["reduced"]) == (30, 2, True)
    assert found["command"].endswith(f"--scale quick --only {FIRST}")
    assert found["subjects"] is None
    assert found["validation"]["images"] == sum(map(sum, found["validation"]["confusion"])) == 2
    training = found["training"]
    assert len(found["history"]["seconds"]) == 2
    assert training["core_hours"] == pytest.approx(
        sum(found["history"]["seconds"]) * training["threads"] / 3600, abs=1e-3
    )


def test_a_record_says_at_which_commit_its_parts_were_made(
    records: dict[str, dict[str, Any]],
) -> None:
    here = reproduce_paper.commit()
    found = records[FIRST]
    for part in (found["training"], found["data"], found["evaluation"], found["fresh"]["30"]):
        assert part["commits"] == [here]
        assert part["machine"]["cores"] >= 1


def test_the_plain_network_is_tested_at_every_snr_though_it_is_alone(
    quick: Reproduction, records: dict[str, dict[str, Any]]
) -> None:
    alone = {FIRST: records[FIRST]}
    assert {snr: part["snr_db"] for snr, part in alone[FIRST]["fresh"].items()} == {
        "30": 30,
        "-10": -10,
    }
    row = lines_of(quick, alone, "| 30 dB (reduced) |")[0].split("|")[2:4]
    parts = [alone[FIRST]["fresh"][snr] for snr in ("30", "-10")]
    assert [float(cell) for cell in row] == [round(100 * p["accuracy"], 2) for p in parts]


def test_a_record_names_no_folder_of_the_machine(quick: Reproduction) -> None:
    files = list(quick.results.glob("*.json"))
    assert files
    for file in files:
        assert str(quick.runs_root.parent) not in file.read_text()


def test_rows_accumulate_and_missing_runs_delete_none(
    quick: Reproduction, records: dict[str, dict[str, Any]]
) -> None:
    alone, both = {FIRST: records[FIRST]}, {name: records[name] for name in (FIRST, SECOND)}
    assert "not run" in lines_of(quick, alone, "| free space | -10 |")[0]
    assert "not run" not in lines_of(quick, both, "| free space | -10 |")[0]
    assert set(lines_of(quick, alone, f"{FIRST}.json")) <= set(
        lines_of(quick, both, f"{FIRST}.json")
    )
    apart = lines_of(quick, both, "| free space | 30 |")[-1]
    assert "not run" in apart
    assert apart != lines_of(quick, records, "| free space | 30 |")[-1]


def test_runs_that_take_a_gpu_are_named_below_the_tables(
    quick: Reproduction, records: dict[str, dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(reproduce_paper.SCALES, "quick", replace(QUICK, on_gpu=True))
    lines = reproduce_paper.tables("quick", {FIRST: records[FIRST]})
    assert any(f"{FIRST}.json" in line for line in lines)
    assert not any(line.startswith("| free space | -10 |") for line in lines)
    assert f"Not run: {SECOND}, {APART}." in lines


def test_a_deleted_run_keeps_its_record_and_figures(quick: Reproduction, tmp_path: Path) -> None:
    shutil.copytree(quick.results, tmp_path / "paper" / "quick")
    before = {file.name: file.read_bytes() for file in (tmp_path / "paper/quick").iterdir()}
    assert f"{FIRST}_tsne.png" in before
    elsewhere = Reproduction(
        "quick", QUICK, tmp_path / "data", tmp_path / "runs", tmp_path / "paper" / "quick"
    )
    for training in QUICK.trainings:
        elsewhere.record(training)
    assert before == {file.name: file.read_bytes() for file in elsewhere.results.iterdir()}


def test_the_page_needs_no_run(quick: Reproduction, tmp_path: Path) -> None:
    shutil.copytree(quick.results, tmp_path / "paper" / "quick")
    page = tmp_path / "page.md"
    page.write_text(f"Before.\n{reproduce_paper.BEGIN}\nold\n{reproduce_paper.END}\nAfter.\n")
    reproduce_paper.report("quick", page)
    text = page.read_text()
    assert text.startswith("Before.\n")
    assert text.endswith("\nAfter.\n")
    assert "old" not in text
    assert "| free space | 30 | 2 (reduced) |" in text
    for figure in (f"{FIRST}_tsne.png", "free_space_snr.png"):
        assert f"](paper/quick/{figure})" in text
        assert (tmp_path / "paper" / "quick" / figure).exists()


def test_confusion_is_shown_where_there_are_mistakes_on_the_fresh_seed(
    tmp_path: Path, records: dict[str, dict[str, Any]]
) -> None:
    def drawn(accuracy: float, **more: Any) -> bool:
        part = {**records[FIRST]["fresh"]["-10"], "accuracy": accuracy}
        record = {**records[FIRST], "snr_db": -10, **more, "fresh": {"-10": part}}
        (tmp_path / "quick").mkdir(exist_ok=True)
        file = tmp_path / "quick" / "one_confusion.png"
        file.unlink(missing_ok=True)
        reproduce_paper.confusion_figures("quick", tmp_path, {"one": record})
        return file.exists()

    assert drawn(0.5)
    assert not drawn(0.995)
    assert drawn(0.5, snr_db=None, scenario="free_space")
    assert not drawn(0.5, snr_db=None, scenario="through_wall")  # whose 10 dB it was not tested at


def test_a_record_that_the_scale_does_not_name_has_a_row(
    quick: Reproduction, records: dict[str, dict[str, Any]]
) -> None:
    other = {**records[FIRST], "name": "other", "model": "resnet50"}
    assert lines_of(quick, {"other": other}, "| free space | resnet50 | 2 (reduced) |")


def test_rows_with_a_record_of_all_epochs_are_not_run_again(
    tmp_path: Path, records: dict[str, dict[str, Any]]
) -> None:
    def names(*words: str, again: bool = False) -> list[str]:
        found = reproduce_paper.wanted(QUICK, list(words), tmp_path, again)
        return [reproduce_paper.run_name(QUICK, training) for training in found]

    for name, reduced in ((FIRST, False), (SECOND, True)):
        (tmp_path / f"{name}.json").write_text(json.dumps({**records[name], "reduced": reduced}))
    assert names() == [SECOND, APART]
    assert names(again=True) == [FIRST, SECOND, APART]
    assert names("subjects") == [APART]


def test_unknown_values_are_marked(quick: Reproduction, records: dict[str, dict[str, Any]]) -> None:
    nothing = {"commits": [], "machine": None}
    record = {**records[FIRST], "best_epoch": None, "speed": None, "fresh": {}}
    record["training"] = {**record["training"], **nothing, "core_hours": None}
    row = lines_of(quick, {FIRST: record}, "| free space | 30 |")[0]
    assert row.count("not recorded") == 4  # best epoch, fresh seed, core hours, commit


def test_one_network_learns_from_a_drawn_snr_by_its_own_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[list[str]] = []
    monkeypatch.setattr(reproduce_paper, "radhar", lambda *words: said.append([*map(str, words)]))
    work = Reproduction("quick", QUICK, tmp_path / "data", tmp_path / "runs", tmp_path / "results")
    work.train(Training("free_space", None))
    work.train(Training("free_space", 30))
    drawn, robust, fixed, plain = said
    assert "snr_db={uniform: [-20, 30]}" in drawn
    assert "snr_db=30" in fixed
    assert robust[robust.index("--config") + 1].endswith("robust.yaml")
    assert plain[plain.index("--config") + 1].endswith("paper.yaml")
    assert drawn[3] == robust[1] != fixed[3]


def test_one_network_stands_beside_those_of_one_snr(
    quick: Reproduction, records: dict[str, dict[str, Any]]
) -> None:
    part = records[FIRST]["fresh"]["30"]
    fresh = {str(snr): {**part, "accuracy": 0.5 + snr / 100} for snr in (30, 20, 10, 0, -10, -20)}
    one = {**records[FIRST], "name": "one", "snr_db": None, "fresh": fresh}
    lines = lines_of(quick, {**records, "one": one}, "")
    at = lines.index("### One network for every SNR")
    ours, theirs = (line.split(" | ") for line in lines[at + 6 : at + 8])
    assert [float(cell.split()[0]) for cell in ours[2:8]] == [80, 70, 60, 50, 40, 30]
    assert theirs[2] == f"{reproduce_paper.percent(part)} (reduced)"
    assert theirs[3:6] == ["not run"] * 3
    by_snr = lines[lines.index("### Accuracy by SNR and scenario") : at]
    assert not any("one.json" in line for line in by_snr)


def test_the_committed_page_is_that_of_its_records() -> None:
    inside = PAGE.read_text().partition(reproduce_paper.BEGIN)[2]
    inside = inside.partition(reproduce_paper.END)[0]
    assert inside.strip() == reproduce_paper.page_text(reproduce_paper.PAGE_SCALES, RESULTS).strip()


def test_committed_records_are_whole_and_name_no_folder() -> None:
    files = [
        file for scale in reproduce_paper.PAGE_SCALES for file in (RESULTS / scale).glob("*.json")
    ]
    assert files
    for file in files:
        record = json.loads(file.read_text())
        assert record["name"] == file.stem
        assert record["reduced"] == (record["epochs"] < reproduce_paper.PAPER_EPOCHS)
        assert '"/' not in file.read_text(), "an absolute path"


def test_filters_are_drawn_of_the_networks_of_a_scenario(
    quick: Reproduction, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of its plain networks, by SNR; what is trained already is not trained again."""
    from PIL import Image

    asked = []
    run = reproduce_paper.radhar

    def watched(*words: object) -> None:
        asked.append(words)
        run(*words)

    monkeypatch.setattr(reproduce_paper, "radhar", watched)
    quick.draw_filters([QUICK.trainings[0], QUICK.trainings[2]], tmp_path / "images")
    (command,) = asked
    assert command[:2] == ("eval", quick.run(QUICK.trainings[0]))
    with Image.open(tmp_path / "images/filters_free_space.png") as figure:
        assert figure.mode == "RGB"
    assert not (tmp_path / "images/filters_through_wall.png").exists()
