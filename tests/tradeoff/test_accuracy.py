"""Accuracy of a network trained on a setting's data: measured once, repeatable, with intervals."""

import dataclasses
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from listener import Listener
from pydantic import TypeAdapter
from small import SMALL, small_config

from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning import training
from radhar_cli.tradeoff import trial as trial_module
from radhar_cli.tradeoff.accuracy import BAND, REFERENCE, Accuracy, find_snr, measure, searched
from radhar_cli.tradeoff.trial import QUICK, Experiment, Trial, TrialData

EFFORT = dataclasses.replace(QUICK, seeds=(1, 2))
CUBE = ("engine.kind=cube",)
TRIALS = (
    Trial("coarse", ("engine.tolerance_db=-20",), REFERENCE),
    Trial("same data", ("engine.tolerance_db=-20",), REFERENCE),
    Trial("reference", REFERENCE, REFERENCE),
)


class Memory:
    """A cache that keeps what a file would."""

    def __init__(self) -> None:
        self.text: dict[str, str] = {}

    def get(self, key: str, kind: Any = Any) -> Any | None:
        text = self.text.get(key)
        return None if text is None else TypeAdapter(kind).validate_json(text)

    def put(self, key: str, value: Any) -> None:
        self.text[key] = json.dumps(value)


def experiment(folder: Path, **more: Any) -> Experiment:
    folder.mkdir(exist_ok=True)
    return Experiment(
        config=small_config(folder),
        folder=folder / "work",
        **{"cache": Memory(), "progress": Listener(), "sizes": EFFORT, **more},
    )


@dataclasses.dataclass
class Counts:
    built: list[str]
    trained: list[str]
    stop_at: int = 0


@pytest.fixture
def counts(monkeypatch: pytest.MonkeyPatch) -> Iterator[Counts]:
    """What was built and trained; a training run can be interrupted."""
    found = Counts([], [])
    build, train = trial_module.build, training.train

    def counted_build(config: Any, folder: Path, *rest: Any) -> Any:
        done = build(config, folder, *rest)
        if done.made:
            found.built.append(folder.name)
        return done

    def counted_train(config: Any, data: Path, folder: Path, *rest: Any) -> Any:
        found.trained.append(folder.name)
        if len(found.trained) == found.stop_at:
            raise KeyboardInterrupt
        return train(config, data, folder, *rest)

    monkeypatch.setattr(trial_module, "build", counted_build)
    monkeypatch.setattr(training, "train", counted_train)
    return found


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> list[Accuracy]:
    """The trials in one uninterrupted go."""
    return measure(experiment(tmp_path_factory.mktemp("whole")), TRIALS, 30.0)


def test_shared_work_is_done_once_and_temporary_files_are_removed(
    counts: Counts, tmp_path: Path, measured: list[Accuracy]
) -> None:
    mine = experiment(tmp_path)
    found = measure(mine, TRIALS, 30.0)
    assert len(counts.built) == 3, "coarse, reference, and one test set"
    assert len(counts.trained) == 4, "two settings, two seeds"
    assert not list(mine.folder.rglob("*")), "a disk is finite"
    assert found == measured, "the same numbers again"
    again = measure(mine, TRIALS, 30.0)
    assert again == found
    assert len(counts.built) == 3
    assert len(counts.trained) == 4


def test_resuming_after_an_interruption_repeats_nothing(
    counts: Counts, tmp_path: Path, measured: list[Accuracy]
) -> None:
    mine = experiment(tmp_path)
    counts.stop_at = 2
    with pytest.raises(KeyboardInterrupt):
        measure(mine, TRIALS, 30.0)
    assert len(mine.cache.text) == 1
    assert measure(mine, TRIALS, 30.0) == measured
    assert len(counts.trained) == 4 + 1, "the one that was interrupted, again"
    assert len(counts.built) == 3


def test_numbers_are_consistent(measured: list[Accuracy]) -> None:
    for one in measured:
        assert one.images == 3 * EFFORT.test_per_class, "all of the test set, whatever its split"
        assert len(one.seeds) == 2
        assert one.mean == pytest.approx(sum(one.seeds) / 2)
        assert 0 <= one.low <= one.mean <= one.high <= 1
        assert one.high - one.low > 0.2, "15 images tell little"
    assert dataclasses.replace(measured[1], name="coarse") == measured[0]


def test_training_and_test_scenes_differ_in_their_seed_alone(tmp_path: Path) -> None:
    setup = TrialData.of(experiment(tmp_path), TRIALS[2], 12.5)
    assert (setup.train.seed, setup.test.seed) == (7, 8)
    assert (setup.train.samples_per_class, setup.test.samples_per_class) == (6, 5)
    same = {"seed": 0, "samples_per_class": 1}
    assert setup.train.model_copy(update=same) == setup.test.model_copy(update=same)
    assert setup.train.snr_db == 12.5
    assert setup.train.maps == ("rtm",), "the config's first"
    assert not setup.train.output.png


def test_overrides_of_a_trial_win_over_common_ones(tmp_path: Path) -> None:
    own = ("image.size_px=32", "maps=[stft]", "snr_db=3")
    mine = experiment(tmp_path, overrides=("duration_s=2.0", "image.size_px=80"))
    setup = TrialData.of(mine, Trial("own", own, CUBE), 30.0)
    assert setup.train.image.size_px == (32, 32)
    assert (setup.train.maps, setup.train.snr_db) == (("stft",), 3)
    assert setup.test.image.size_px == (64, 64)
    assert setup.test.engine.kind == "cube"
    assert setup.test.duration_s == 2.0


def test_a_config_split_by_subjects_is_split_by_samples(tmp_path: Path) -> None:
    """Six samples cannot be ten people's, and every training set needs validation images."""
    mine = experiment(tmp_path)
    by_subject = SMALL.replace(
        "split: {train: 0.67, validation: 0.33}",
        "split: {by: subject, subjects: 3, train: 1.0, validation: 0.0}",
    )
    assert by_subject != SMALL
    mine.config.write_text(by_subject)
    assert TrialData.of(mine, TRIALS[0], 30.0).train.split.by == "sample"


def test_a_wrong_override_is_refused_before_any_work(counts: Counts, tmp_path: Path) -> None:
    wrong = Trial("wrong", ("engine.tolerance=-20",), REFERENCE)
    with pytest.raises(ConfigError, match="tolerance_db"):
        measure(experiment(tmp_path), [TRIALS[0], wrong], 30.0)
    assert not counts.built


def test_tests_of_another_size_are_refused(tmp_path: Path) -> None:
    other = Trial("other size", (), ("image.size_px=32",))
    with pytest.raises(FolderError, match="32 x 32 px; the model was trained on 64 x 64"):
        measure(experiment(tmp_path, sizes=dataclasses.replace(QUICK, epochs=1)), [other], 30.0)


def test_a_warning_of_several_data_sets_is_given_once(tmp_path: Path) -> None:
    """Two training sets of the same scenes, whose Doppler aliases at this PRF."""
    sizes = dataclasses.replace(QUICK, epochs=1)
    mine = experiment(tmp_path, sizes=sizes, overrides=("radar.prf_hz=100",))
    measure(mine, [TRIALS[0], TRIALS[2]], 30.0)
    aliased = [message for message in mine.progress.messages if "aliases" in message]
    assert [message.split()[3] for message in aliased] == ["18", "15"], "training, test"


def test_snr_is_found_by_trials_that_are_kept(counts: Counts, tmp_path: Path) -> None:
    mine = experiment(tmp_path, sizes=dataclasses.replace(QUICK, snr_tries=1))
    snr_db = find_snr(mine)
    assert find_snr(mine) == snr_db
    assert len(counts.trained) == 1
    assert len(counts.built) == 2
    measure(mine, [TRIALS[2]], snr_db)
    assert len(counts.trained) == 1, "the reference was measured on the way"


def test_tradeoff_without_training_needs_no_pytorch() -> None:
    code = "import sys, radhar_cli.tradeoff.accuracy; print('torch' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "False", done.stderr


@pytest.mark.parametrize(
    ("steep_at", "tried"),
    [
        (0.0, [0.0]),
        (12.0, [0.0, 5.0, 10.0]),
        (-12.0, [0.0, -5.0, -10.0]),
    ],
)
def test_snr_goes_towards_the_band(steep_at: float, tried: list[float]) -> None:
    """An accuracy that rises by 0.05 a dB and is 0.8 at `steep_at`."""
    asked: list[float] = []

    def accuracy_at(snr_db: float) -> float:
        asked.append(snr_db)
        return min(max(0.8 + 0.05 * (snr_db - steep_at), 0.1), 1.0)

    found = searched(accuracy_at, 8)
    assert asked == tried
    assert found == tried[-1]


@given(middle=st.floats(-20, 20), slope=st.floats(0.1, 3))
def test_snr_of_a_steep_rise_is_between_two_steps(middle: float, slope: float) -> None:
    """The band is 0.25 / slope dB wide, at least 0.08: six halves of 5 dB after five tries."""

    def accuracy_at(snr_db: float) -> float:
        return min(max(0.825 + slope * (snr_db - middle), 0.0), 1.0)

    found = searched(accuracy_at, 14)
    assert BAND[0] <= accuracy_at(found) <= BAND[1]


def test_without_a_match_the_nearest_snr_is_taken() -> None:
    assert searched(lambda snr_db: 0.2 + snr_db / 1000, 8) == 35.0
    assert searched(lambda snr_db: 0.99 + snr_db / 10_000, 8) == -35.0
    steep = {0.0: 0.5, 5.0: 1.0, 2.5: 0.69}
    assert searched(steep.__getitem__, 3) == 2.5
