"""One trial: a small fixed network learns from data of one setting, is tested on data of another.

Results are cached by what they depend on: both configs, the training settings, the versions.
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
from radhar_cli.dataset.build import build
from radhar_cli.dataset.identity import identity
from radhar_cli.progress import Progress
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
class Sizes:
    """Samples a class, training seeds, epochs, and most SNRs tried."""

    train_per_class: int
    test_per_class: int
    seeds: tuple[int, ...]
    epochs: int
    snr_tries: int


FULL = Sizes(train_per_class=30, test_per_class=25, seeds=(1, 2, 3), epochs=15, snr_tries=8)
QUICK = Sizes(train_per_class=6, test_per_class=5, seeds=(1,), epochs=3, snr_tries=2)


@dataclass(frozen=True)
class Experiment:
    """What all trials have in common.

    Attributes:
        config: YAML file that scenes are drawn from.
        folder: for data sets and training runs while they are needed.
        cache: of results.
        progress: receives progress and warnings.
        jobs: processes that build data sets.
        sizes: FULL or QUICK.
        overrides: of the config, for all trials.
    """

    config: Path
    folder: Path
    cache: ResultCache
    progress: Progress
    jobs: int = 1
    sizes: Sizes = FULL
    overrides: tuple[str, ...] = ()

    def remove_data(self, keep: Collection[str] = ()) -> None:
        """Delete the data sets but those whose names are given."""
        for folder in (self.folder / DATA).glob("*"):
            if folder.name not in keep:
                shutil.rmtree(folder)

    def remove_all(self) -> None:
        """Delete data sets and training runs; the cache is kept."""
        for part in (DATA, RUNS):
            shutil.rmtree(self.folder / part, ignore_errors=True)


@dataclass(frozen=True)
class TrialData:
    """A trial and the configs of its data, drawn with two seeds."""

    trial: Trial
    train: Config
    test: Config

    @classmethod
    def of(cls, experiment: Experiment, trial: Trial, snr_db: float) -> "TrialData":
        """Configs of the data of a trial.

        Raises:
            ConfigError: an override that does not fit.
        """
        base = load_config(experiment.config, experiment.overrides)
        common = (
            *experiment.overrides,
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
            return load_config(experiment.config, (*common, *own, *fixed))

        return cls(
            trial,
            config(trial.train, experiment.sizes.train_per_class, base.seed),
            config(trial.test, experiment.sizes.test_per_class, (base.seed + 1) % 2**63),
        )

    @property
    def data(self) -> tuple[str, str]:
        """Names of the training and the test data, made of what decides their bytes."""
        return _fingerprint(identity(self.train)), _fingerprint(identity(self.test))


@dataclass(frozen=True)
class TestResult:
    """Test images recognised, of how many."""

    right: int
    images: int

    @property
    def share(self) -> float:
        return self.right / self.images


def score(experiment: Experiment, setup: TrialData, seed: int) -> TestResult:
    """What a network of one training seed scores: from the cache, or trained and tested.

    Raises:
        as `measure`.
    """
    settings = _settings(experiment.sizes, seed)
    what = _fingerprint([*setup.data, settings.model_dump(mode="json"), _torch_version()])
    key = f"accuracy {what}"
    known = experiment.cache.get(key, TestResult)
    if known is None:
        run = experiment.folder / RUNS / what
        known = _train_and_test(experiment, setup, settings, run)
        experiment.cache.put(key, asdict(known))
        shutil.rmtree(run)
    return known


def _settings(sizes: Sizes, seed: int) -> "TrainConfig":
    """The same on every machine; on one thread of the processor, so that numbers repeat."""
    from radhar_cli.learning.settings import ScheduleConfig, TrainConfig

    return TrainConfig(
        model="smallnet",
        seed=seed,
        epochs=sizes.epochs,
        batch_size=32,
        optimiser="adam",
        learning_rate=3e-3,
        weight_decay=1e-4,
        warmup_epochs=0.0,
        schedule=ScheduleConfig(kind="cosine"),
        device="cpu",
        precision="float32",
        threads=1,
    )


def _train_and_test(
    experiment: Experiment, setup: TrialData, settings: "TrainConfig", run: Path
) -> TestResult:
    from radhar_cli.learning import training
    from radhar_cli.learning.evaluation import open_for, predict
    from radhar_cli.learning.machine import choose_device
    from radhar_cli.learning.run_folder import load_best

    learned, asked = (experiment.folder / DATA / name for name in setup.data)
    for config, folder in ((setup.train, learned), (setup.test, asked)):
        build(config, folder, experiment.jobs, experiment.progress)
    label = f"training {setup.trial.name}, seed {settings.seed}"
    training.train(settings, learned, run, _Epochs(experiment.progress, label))
    metadata, model = load_best(run)
    images = open_for(metadata, asked, None)
    device, batch = choose_device(settings.device), settings.images_a_step
    answers = predict(model, metadata, images, images.rows("all"), device, batch)
    return TestResult(int((answers.predicted == answers.truth).sum()), len(images))


@dataclass
class _Epochs:
    """Shows a training run as a stage of a build, with its warnings but not its other messages."""

    progress: Progress
    label: str
    started: bool = False

    def say(self, message: str) -> None:
        if message.startswith("warning"):
            self.progress.say(message)

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        if not self.started:
            self.progress.stage(self.label, epochs, number - 1)
            self.started = True

    def step(self, loss: float, accuracy: float) -> None:
        pass

    def epoch_done(self, row: "Epoch", best: bool) -> None:
        self.progress.advance(1)


@dataclass(frozen=True)
class DistinctMessages:
    """Passes progress on; a message that was shown before is not repeated."""

    progress: Progress
    shown: set[str] = field(default_factory=set)

    def stage(self, name: str, total: int, done: int) -> None:
        self.progress.stage(name, total, done)

    def advance(self, count: int) -> None:
        self.progress.advance(count)

    def say(self, message: str) -> None:
        if message not in self.shown:
            self.shown.add(message)
            self.progress.say(message)


def _torch_version() -> str:
    from importlib.metadata import version

    return version("torch")


def _fingerprint(value: object) -> str:
    text = json.dumps(value, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
