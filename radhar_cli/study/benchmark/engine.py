"""Trainings and tests of a protocol: what is learned from, row by row, seed by seed, fold by fold.

Each training is a run of its own in a folder that the digest of all it depends on names, with the
scores of the samples that it was tested on: the same call goes on where it was stopped.
"""

import hashlib
import json
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from pydantic import TypeAdapter, ValidationError

from radhar_cli.dataset.code_digest import code_digest
from radhar_cli.dataset.files import write_whole
from radhar_cli.errors import ConfigError, FolderError, RadharError
from radhar_cli.files.plain_json import plain
from radhar_cli.files.untrusted import read_json
from radhar_cli.learning.adaptation import EPOCHS as ADAPTING
from radhar_cli.learning.adaptation import AdaptOptions, Mixed, adapt
from radhar_cli.learning.evaluation import predict
from radhar_cli.learning.few_shots import BATCH, MAX_SHOWN, join_labelled
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.images.scan import content_hash
from radhar_cli.learning.intervals import numbers_of_mean, numbers_of_share
from radhar_cli.learning.machine import choose_device
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.training import QuietTraining, TrainOptions, train
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import Progress
from radhar_cli.study.benchmark.protocols import Protocol
from radhar_cli.study.benchmark.sets import BothSets, Fold, learning_set, training_part

SIMULATION, ADAPTED, MEASURED, TOGETHER = "simulation", "adapted", "measured", "together"
ROWS = (SIMULATION, ADAPTED, "1", "5", "10", "20", MEASURED, TOGETHER)
MAX_SHOTS = 10_000
SCORES = "scores.json"


def parse_rows(text: str) -> tuple[str, ...]:
    """Rows of a text such as simulation,adapted,1,20,measured, in the order of the table.

    Raises:
        ConfigError: one is no row.
    """
    names = {word.strip() for word in text.split(",")}
    shots = {str(int(name)) for name in names if name.isdecimal() and len(name) < 6}
    unknown = sorted(
        name for name in names - set(ROWS) if name not in shots or not 0 < int(name) <= MAX_SHOTS
    )
    if unknown:
        raise ConfigError(
            f"--rows {unknown[0]}: is no row; should be of {', '.join(ROWS)}, or another number of "
            "labels a class"
        )
    order = (SIMULATION, ADAPTED, *sorted(shots, key=int), MEASURED, TOGETHER)
    return tuple(name for name in order if name in names)


def row_in_words(row: str) -> str:
    """Row of the table, in words."""
    words = {
        SIMULATION: "simulated alone",
        ADAPTED: "simulated, adapted without labels",
        MEASURED: "measured",
        TOGETHER: "measured and simulated",
    }
    return words.get(row, f"simulated, then {row} measured a class")


@dataclass(frozen=True)
class RowResult:
    """Result of a row: mean score over samples and seeds, or why there is none."""

    row: str
    learned_from: str  # in words
    value: float | None = None
    interval_95: tuple[float, float] | None = None
    by_seed: tuple[float, ...] = ()
    more: dict[str, float] = field(default_factory=dict)  # further scores by name
    tested: int = 0  # samples
    over: dict[str, Any] = field(default_factory=dict)  # what the interval is drawn over
    why_not: str = ""


class RowTraining(NamedTuple):
    """Training and test of a row: its seed and fold."""

    row: str
    seed: int
    fold: int


@dataclass(frozen=True)
class Bench:
    """Two data sets of a protocol, and the folder of what is trained on them."""

    protocol: Protocol
    config: TrainConfig  # of the first seed
    both: BothSets
    folder: Path
    progress: Progress
    adapting: int = ADAPTING  # epochs without labels

    def steps(self, row: str, seeds: int) -> list[RowTraining]:
        """Trainings of a row: one a seed and, of what learns from measured samples, a fold."""
        folds = 1 if row == SIMULATION else len(self.both.folds)
        return [
            RowTraining(row, seed, fold) for seed in range(1, seeds + 1) for fold in range(folds)
        ]

    def measure_row(self, row: str, seeds: int) -> RowResult:
        """Score of a row over all seeds and folds; what is done already is not trained again."""
        words = row_in_words(row)
        scores = dict[str, list[Float]]()
        try:
            steps = self.steps(row, seeds)
            self.progress.stage(f"{self.protocol.data}, {words}", len(steps), 0, "network")
            for step in steps:
                rows, of_step = self._measure_step(step)
                for name, values in of_step.items():
                    if step.fold == 0:
                        scores.setdefault(name, []).append(np.full(len(self.both.measured), np.nan))
                    scores[name][-1][rows] = values
                self.progress.advance(1)
        except RadharError as error:
            return RowResult(row, words, why_not=str(error))
        return self._summarise(row, scores)

    def _summarise(self, row: str, scores: dict[str, list[Float]]) -> RowResult:
        """Result of a row.

        Args:
            scores: {name: [N] score of each measured sample, NaN of one not tested, a seed each};
                the first name is that of the main score.
        """
        (main, of_seeds), *others = scores.items()
        table = np.stack(of_seeds)
        rows = np.flatnonzero(np.isfinite(table).all(0))
        values = table[:, rows].mean(0)
        groups = self.both.measured.samples.groups(rows)
        interval_of = numbers_of_mean if self.protocol.find_joints else numbers_of_share
        numbers = interval_of(main, values, groups)
        ends = numbers[f"{main}_95"]
        return RowResult(
            row,
            row_in_words(row),
            float(values.mean()),
            None if ends is None else (ends[0], ends[1]),
            tuple(table[:, rows].mean(1).tolist()),
            {name: float(np.nanmean(np.stack(each))) for name, each in others},
            rows.size,
            numbers["interval_over"],
        )

    def _measure_step(self, step: RowTraining) -> tuple[Index, dict[str, Float]]:
        """Rows that a step tests, and their scores by name.

        Raises:
            RadharError: it cannot be trained.
        """
        folds = self.both.folds
        fold = folds[step.fold]
        tested = fold.tested
        if step.row == SIMULATION:
            tested = np.sort(np.concatenate([fold.tested for fold in folds]))
        elif step.row == ADAPTED and self.protocol.find_joints:
            raise FolderError("adapting without labels is of classes")
        elif fold.why_not:
            raise FolderError(fold.why_not)
        run = self._run_folder(step)
        scores = _read_scores(run / SCORES, tested.size)
        if scores is None:
            self._train(step, fold, run)
            scores = self._test(run, tested)
            content = {name: plain(values.tolist()) for name, values in scores.items()}
            write_whole(run, run / SCORES, (json.dumps(content) + "\n").encode())
        return tested, scores

    def _run_folder(self, step: RowTraining) -> Path:
        """Folder of a step, which all that its run depends on names."""
        depends = [
            version("torch"),
            code_digest((), (__name__,)),
            self.config.model_dump(mode="json", exclude={"device", "workers", "threads"}),
            self.adapting if step.row == ADAPTED else None,
            self._contents["simulated"] if step.row != MEASURED else None,
            self._contents["measured"],
            [rows.tolist() for rows in self.both.folds[step.fold][:2]],
        ]
        digest = hashlib.sha256(json.dumps(depends).encode()).hexdigest()[:12]
        return self.folder / f"{step.row}_{step.seed}_{step.fold + 1}_{digest}"

    @cached_property
    def _contents(self) -> dict[str, str]:
        """Digests of the two data sets."""
        sets = {"measured": self.both.measured, "simulated": self.both.simulated}
        return {name: content_hash(images, images.rows("all")) for name, images in sets.items()}

    def _train(self, step: RowTraining, fold: Fold, run: Path) -> None:
        """Train a step in its folder.

        Raises:
            RadharError: it cannot be trained.
        """
        config = self.config.model_copy(update={"seed": step.seed})
        simulated, quiet = self.both.simulated, QuietTraining(self.progress)
        if step.row == SIMULATION:
            train(config, simulated, run, quiet)
            return
        learned = learning_set(self.both, fold, config)
        if step.row == MEASURED:
            train(config, learned, run, quiet)
        elif step.row == TOGETHER:
            train(config, joined([learned, training_part(simulated)]), run, quiet)
        elif step.row == ADAPTED:
            self._adapt(self._trained_on_simulation(step.seed), learned, run)
        else:
            labelled = learned.take(draw_labelled(learned, int(step.row), step.seed))
            self._tune(self._trained_on_simulation(step.seed), labelled, step.seed, run)

    def _trained_on_simulation(self, seed: int) -> Path:
        """Run that learned from the simulation alone."""
        step = RowTraining(SIMULATION, seed, 0)
        run = self._run_folder(step)
        self._train(step, self.both.folds[0], run)
        return run

    def _adapt(self, start: Path, learned: ImageSet, run: Path) -> None:
        """Adapt a run to measured samples without their labels; the simulated are shown on."""
        mixed = Mixed(training_part(self.both.simulated))
        options = AdaptOptions(overwrite=True, epochs=self.adapting, mix=mixed)
        device = choose_device(self.config.device)
        adapt(start, (learned, np.arange(len(learned))), run, device, options)

    def _tune(self, start: Path, labelled: ImageSet, seed: int, run: Path) -> None:
        """Fine-tune a run with a few labelled samples a class, half as long as it was trained."""
        simulated = training_part(self.both.simulated)
        images, weights = join_labelled(load_best(start)[0], labelled, [simulated], MAX_SHOWN)
        config = self.config
        half = {
            "seed": seed,
            "epochs": -(-config.epochs // 2),
            "warmup_epochs": config.warmup_epochs / 2,
            "data_weights": (weights[0], min(weights[1], 1.0)),
        }
        quiet = QuietTraining(self.progress)
        train(config.model_copy(update=half), images, run, quiet, TrainOptions(start=start))

    def _test(self, run: Path, rows: Index) -> dict[str, Float]:
        """Scores [len(rows)] of measured samples by name, the main score first."""
        metadata, network = load_best(run)
        device = choose_device(self.config.device)
        images = self.both.measured
        predictions = predict(network.to(device), metadata, images, rows, device, BATCH)
        if not self.protocol.find_joints:
            truth = labels_for(images, predictions.names)[rows]
            return {"accuracy": (predictions.values.argmax(1) == truth).astype(float)}
        true = np.stack([images.skeletons[int(row)] for row in rows])
        return joint_errors(predictions.values, true, predictions.names.index("hip"))


def draw_labelled(images: ImageSet, shots: int, seed: int) -> Index:
    """Draw rows of some samples a class of the training part.

    Those of a smaller number are among those of a larger one.

    Raises:
        FolderError: a class has fewer.
    """
    order = stream(seed, TRAINING, name="benchmark shots").permutation(images.rows("train"))
    label = images.samples.label[order]
    drawn = list[Index]()
    for number in np.unique(images.samples.label):
        rows = order[label == number]
        if rows.size < shots:
            name = images.classes[number]
            raise FolderError(f"{name} has {rows.size} samples to learn from, fewer than {shots}")
        drawn.append(rows[:shots])
    return np.concatenate(drawn)


def joint_errors(estimated: Float, true: Float, root: int) -> dict[str, Float]:
    """Mean distance of the joints of each sequence [N], cm: absolute, and about the root.

    Args:
        estimated: [N, T, joint, 3], m.
        true: [N, T, joint, 3], m; NaN where a frame has none. A sequence without any is NaN.
        root: number of the joint that root-relative errors are about.
    """
    errors = {}
    for name, centre in (("mpjpe_cm", False), ("root_relative_cm", True)):
        deviation = estimated - true
        if centre:
            deviation = deviation - deviation[:, :, root : root + 1]
        distance = np.linalg.norm(deviation, axis=3).mean(2)  # [N, T]
        known = np.isfinite(distance)
        total = np.where(known, distance, 0).sum(1)
        errors[name] = np.where(known.any(1), 100 * total / np.maximum(known.sum(1), 1), np.nan)
    return errors


def _read_scores(path: Path, count: int) -> dict[str, Float] | None:
    """Scores of a step that is done; None where it is not, or its file is damaged."""
    if not path.exists():
        return None
    try:
        lists = TypeAdapter(dict[str, list[float | None]]).validate_python(read_json(path))
    except (FolderError, ValidationError):
        return None
    if not lists or any(len(values) != count for values in lists.values()):
        return None
    return {name: np.array(values, float) for name, values in lists.items()}
