"""One trial: a small fixed network learns from data of one setting, is tested on data of another.

A result is known by what decides it (both configs, the training settings, the versions), so that
what was measured once is not measured again, whoever asks.
"""

import hashlib
import json
import shutil
from collections.abc import Collection
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from radhar_cli.config import load_config
from radhar_cli.config.schema import Config
from radhar_cli.dataset.build import Progress, build
from radhar_cli.dataset.identity import identity
from radhar_cli.tradeoff.result_cache import ResultCache

if TYPE_CHECKING:
    from radhar_cli.learning.run_folder import Epoch
    from radhar_cli.learning.settings import TrainConfig

SIZE_PX = 64
DATA, RUNS = "data", "runs"


@dataclass(frozen=True)
class Trial:
    """A setting to train on and the reference to test on.

    Attributes:
        name: of the setting.
        train, test: overrides `key=value` of the config for the training and the test data. They
            win over the image size, the map and the SNR that are common to all trials.
    """

    name: str
    train: tuple[str, ...]
    test: tuple[str, ...]


@dataclass(frozen=True)
class Effort:
    """How much is spent: samples a class, training seeds, epochs, and SNRs tried."""

    train_per_class: int
    test_per_class: int
    seeds: tuple[int, ...]
    epochs: int
    snr_tries: int


FULL = Effort(train_per_class=30, test_per_class=25, seeds=(1, 2, 3), epochs=15, snr_tries=8)
QUICK = Effort(train_per_class=6, test_per_class=5, seeds=(1,), epochs=3, snr_tries=2)


@dataclass(frozen=True)
class Bench:
    """Where trials are measured, and from what.

    Attributes:
        config: YAML file that scenes are drawn from.
        folder: for data sets and training runs while they are needed.
        ledger: keeps the results.
        progress: who is told.
        jobs: processes that build data sets.
        effort: FULL or QUICK.
        overrides: of the config, for all trials.
    """

    config: Path
    folder: Path
    ledger: ResultCache
    progress: Progress
    jobs: int = 1
    effort: Effort = FULL
    overrides: tuple[str, ...] = ()

    def remove_data(self, keep: Collection[str] = ()) -> None:
        """Delete the data sets but those whose names are given."""
        for folder in (self.folder / DATA).glob("*"):
            if folder.name not in keep:
                shutil.rmtree(folder)

    def remove_all(self) -> None:
        """Delete data sets and training runs; the ledger is elsewhere."""
        for part in (DATA, RUNS):
            shutil.rmtree(self.folder / part, ignore_errors=True)


@dataclass(frozen=True)
class Setup:
    """A trial and the configs of its data, drawn with two seeds."""

    trial: Trial
    train: Config
    test: Config

    @classmethod
    def of(cls, bench: Bench, trial: Trial, snr_db: float) -> "Setup":
        """Settle the data of a trial.

        Raises:
            ConfigError: an override that does not fit.
        """
        base = load_config(bench.config, bench.overrides)
        common = (
            *bench.overrides,
            f"image.size_px={SIZE_PX}",
            f"maps=[{base.maps[0]}]",
            f"snr_db={float(snr_db)!r}",
        )

        def config(own: tuple[str, ...], per_class: int, seed: int) -> Config:
            fixed = (
                f"samples_per_class={per_class}",
                f"seed={seed}",
                "split={by: sample, train: 0.8, validation: 0.2}",
                "output.png=false",
            )
            return load_config(bench.config, (*common, *own, *fixed))

        return cls(
            trial,
            config(trial.train, bench.effort.train_per_class, base.seed),
            config(trial.test, bench.effort.test_per_class, (base.seed + 1) % 2**63),
        )

    @property
    def data(self) -> tuple[str, str]:
        """Names of the training and the test data, made of what decides their bytes."""
        return _fingerprint(identity(self.train)), _fingerprint(identity(self.test))


@dataclass(frozen=True)
class Score:
    """Test images recognised, of how many."""

    right: int
    images: int

    @property
    def share(self) -> float:
        return self.right / self.images


def score(bench: Bench, setup: Setup, seed: int) -> Score:
    """What a network of one training seed scores: from the ledger, or trained and tested.

    Raises:
        as `measure`.
    """
    settings = _settings(bench.effort, seed)
    what = _fingerprint([*setup.data, settings.model_dump(mode="json"), _torch_version()])
    key = f"accuracy {what}"
    known = bench.ledger.get(key, Score)
    if known is None:
        run = bench.folder / RUNS / what
        known = _train_and_test(bench, setup, settings, run)
        bench.ledger.put(key, asdict(known))
        shutil.rmtree(run)
    return known


def _settings(effort: Effort, seed: int) -> "TrainConfig":
    """The same on every machine; on one thread of the processor, so that numbers repeat."""
    from radhar_cli.learning.settings import ScheduleConfig, TrainConfig

    return TrainConfig(
        model="smallnet",
        seed=seed,
        epochs=effort.epochs,
        batch_size=32,
        learning_rate=3e-3,
        schedule=ScheduleConfig(kind="cosine"),
        device="cpu",
        precision="float32",
        threads=1,
    )


def _train_and_test(bench: Bench, setup: Setup, settings: "TrainConfig", run: Path) -> Score:
    from radhar_cli.learning import training
    from radhar_cli.learning.evaluation import open_for, predict
    from radhar_cli.learning.machine import choose_device
    from radhar_cli.learning.run_folder import load_best

    learned, asked = (bench.folder / DATA / name for name in setup.data)
    for config, folder in ((setup.train, learned), (setup.test, asked)):
        build(config, folder, bench.jobs, bench.progress)
    label = f"training {setup.trial.name}, seed {settings.seed}"
    training.train(settings, learned, run, _Epochs(bench.progress, label))
    about, model = load_best(run)
    images = open_for(about, asked, None)
    device, batch = choose_device(settings.device), settings.batch_size
    answers = predict(model, about, images, images.rows("all"), device, batch)
    return Score(int((answers.predicted == answers.truth).sum()), len(images))


@dataclass
class _Epochs:
    """Tells a build's listener of a training run; of what that says, warnings are news here."""

    progress: Progress
    label: str
    begun: bool = False

    def say(self, message: str) -> None:
        if message.startswith("warning"):
            self.progress.say(message)

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        if not self.begun:
            self.progress.stage(self.label, epochs, number - 1)
            self.begun = True

    def step(self, loss: float, accuracy: float) -> None:
        pass

    def epoch_done(self, row: "Epoch", best: bool) -> None:
        self.progress.advance(1)


@dataclass(frozen=True)
class SaidOnce:
    """Passes on what a build says, but for what another data set has said word for word."""

    progress: Progress
    said: set[str] = field(default_factory=set)

    def stage(self, name: str, total: int, done: int) -> None:
        self.progress.stage(name, total, done)

    def advance(self, samples: int) -> None:
        self.progress.advance(samples)

    def say(self, message: str) -> None:
        if message not in self.said:
            self.said.add(message)
            self.progress.say(message)


def _torch_version() -> str:
    from importlib.metadata import version

    return version("torch")


def _fingerprint(value: object) -> str:
    text = json.dumps(value, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
