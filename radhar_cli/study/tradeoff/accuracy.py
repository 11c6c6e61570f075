"""Accuracy of networks that learned from images of a setting, by seed.

A network learns from images of the setting and is tested on images of the config as it is, of other
scenes: the price of cheap training data on good data. Images of another size or with other axes are
another question to the network, so that a setting that changes them is tested on images of its own
alone, where training and test are alike; so is one whose map or classes the config does not have.

Seed i has the same scenes, the same split and the same first weights under every setting, so that
differences from the default are paired. Data sets, networks and a record for each setting and seed
lie in a folder, and a study that was stopped goes on from there. Settings that give the same images
share the network.
"""

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, TypeAdapter

from radhar_cli.config.data_set import Config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import DATASET, Rows
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.files.replacing import write_result
from radhar_cli.files.untrusted import read_json
from radhar_cli.learning import run_files
from radhar_cli.learning.evaluation import open_for_model, predict_classes
from radhar_cli.learning.images.scan import content_hash
from radhar_cli.learning.machine import choose_device
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.training import QuietTraining, train
from radhar_cli.learning.training_set import open_training_set
from radhar_cli.processes.progress import Progress
from radhar_cli.study.tradeoff.samples import Scenes
from radhar_cli.study.tradeoff.settings import DEFAULT, Overrides
from radhar_cli.study.tradeoff.sweep import AccuracyNumbers, Interval, Sweep
from radhar_cli.study.trials import Budget

FEWEST_SEEDS = 2  # of which an interval can be made
TEST_BATCH = 64


@dataclass(frozen=True)
class Sizes:
    """Numbers of images and epochs for the networks of a study; two cores need some minutes."""

    learned: int = 50  # images a class, a fifth of which validate; fewer where the config has fewer
    tested: int = 25  # images a class, of each test
    epochs: int = 20


@dataclass(frozen=True)
class SeedAccuracy:
    """Accuracies of one network, 0 to 1."""

    # on images of the config as it is; None where they are not alike
    on_default: Annotated[float, Field(ge=0, le=1)] | None
    on_own: Annotated[float, Field(ge=0, le=1)]  # on images of the setting


@dataclass(frozen=True)
class AccuracyStudy:
    """Networks of the settings of one config, in a folder."""

    scenes: Scenes  # of which the config is
    folder: Path
    progress: Progress  # receives the networks done, and why there is no accuracy
    sizes: Sizes = Sizes()

    def measure(self, setting: Overrides, seeds: int, budget: Budget) -> AccuracyNumbers | None:
        """Accuracy of networks that learned from a setting; earlier runs are not repeated.

        Args:
            setting: overrides of the setting; none for the config as it is.
            seeds: number of networks.
            budget: time in which networks are begun.

        Returns:
            The accuracy; None where nothing can be learned, or there was no time for two networks.

        Raises:
            ConfigError: the setting does not fit the config.
        """
        name = " ".join(setting) or DEFAULT
        why, results = self.obstacle(setting), list[SeedAccuracy]()
        if why is None:
            self.progress.stage(f"accuracy, {name}", seeds, 0, "network")
            try:
                while len(results) < seeds and budget.left > 0:
                    results.append(self.measure_seed(setting, len(results) + 1))
                    self.progress.advance(1)
                if len(results) < min(seeds, FEWEST_SEEDS):
                    why = f"the time was over after {len(results)} networks"
            except RadharError as error:
                why = str(error) if len(results) < min(seeds, FEWEST_SEEDS) else None
        if why is not None:
            self.progress.say(f"no accuracy of {name}: {why}")
            return None
        by_seed = tuple(result.on_default for result in results if result.on_default is not None)
        tested_on = "default" if by_seed else "own"
        by_seed = by_seed or tuple(result.on_own for result in results)
        return AccuracyNumbers(by_seed, *Interval.of(by_seed), tested_on)

    def obstacle(self, setting: Overrides) -> str | None:
        """Return why no network of classes can learn from a setting; None if one can."""
        config = self.scenes.config(setting)
        if config.stream is not None:
            return "streams have no single class"
        if not config.maps:
            return "no map is made"
        return "there is a single class" if len(Rows.of(config).activities) < 2 else None

    def measure_seed(self, setting: Overrides, number: int) -> SeedAccuracy:
        """Accuracies of the network of a setting and a seed, made here or found in the folder.

        Raises:
            RadharError: the data set cannot be made, or the network cannot be trained.
        """
        record = self._record_path(setting, number)
        if record.exists():
            try:
                return TypeAdapter(SeedAccuracy).validate_python(read_json(record)["accuracy"])
            except (FolderError, KeyError, TypeError, ValueError):
                self.progress.say(f"{record}: is damaged; the network is tested again")
        folders = {name: self._build(part) for name, part in self.parts(setting, number).items()}
        run = self._train(folders.pop("learned"), self._train_config(number))
        shares = {name: measure_share(run, folder) for name, folder in folders.items()}
        accuracy = SeedAccuracy(shares.get("default"), shares["own"])
        about = {"setting": list(setting), "seed": number, "run": run.name}
        data = json.dumps({**about, "accuracy": asdict(accuracy)}, indent=2) + "\n"
        write_result(self.folder, record, data.encode())
        return accuracy

    def _record_path(self, setting: Overrides, number: int) -> Path:
        kinds = ((setting, False), (setting, True), ((), True))
        names = [self._data(self._part(each, number, tested)).name for each, tested in kinds]
        text = json.dumps([names, self._train_config(number).model_dump_json()])
        return self.folder / "records" / f"{_digest(text)}.json"

    def parts(self, setting: Overrides, number: int) -> dict[str, Config]:
        """Configs of the data sets of a seed: learned from, and tested on, by name."""
        parts = {name: self._part(setting, number, name == "own") for name in ("learned", "own")}
        if self._is_alike(setting, number):
            (name,) = parts["learned"].maps
            parts["default"] = self._part((f"maps=[{name}]",), number, True)
        return parts

    def _part(self, setting: Overrides, number: int, tested: bool) -> Config:
        """Config of the data set of a seed under a setting: of the first map, without PNGs."""
        config = self.scenes.config(setting)
        count = min(self.sizes.learned, max(Rows.of(config).counts))
        further = (
            f"maps=[{config.maps[0]}]",
            f"samples_per_class={min(self.sizes.tested, count) if tested else count}",
            f"seed={config.seed + 2 * (number - 1) + tested}",
            "output.png=false",
            "split={train: 0.8, validation: 0.2}",
        )
        return self.scenes.config((*setting, *further))

    def _data(self, part: Config) -> Path:
        """Folder of a data set, which its identity names."""
        return self.folder / "data" / identity_hash(identity(part))[:24]

    def _build(self, part: Config) -> Path:
        """Make a data set, unless it is there; return its folder."""
        folder = self._data(part)
        if not (folder / DATASET).exists():
            build(part, folder, 1, QuietTraining(self.progress))
        return folder

    def _train_config(self, number: int) -> TrainConfig:
        epochs = self.sizes.epochs
        return TrainConfig(seed=number, epochs=epochs, warmup_epochs=min(1.0, epochs / 2))

    def _train(self, data: Path, settings: TrainConfig) -> Path:
        """Train a network on a data set, or find one that learned from the same images."""
        images = open_training_set(settings, data)
        content = content_hash(images, np.arange(len(images)))
        run = self.folder / "runs" / _digest(f"{content} {settings.model_dump_json()}")
        if not (run / run_files.METRICS).exists():
            train(settings, images, run, QuietTraining(self.progress))
        return run

    def _is_alike(self, setting: Overrides, number: int) -> bool:
        """Whether images of a setting have the map, size, classes and axes of the config's.

        Axes are alike where none of their ends differs by more than a pixel.
        """
        default, config = self.scenes.config(), self.scenes.config(setting)
        name, size = config.maps[0], default.image.size_px
        if name not in default.maps or config.image.size_px != size:
            return False
        if Rows.of(config).activities != Rows.of(default).activities:
            return False
        ends = [
            _axis_ends(self._build(self._part(each, number, True)), name)
            for each in (setting, (f"maps=[{name}]",))
        ]
        left, right, low, high = ends[1]
        pixel = np.array([(right - left) / size[1]] * 2 + [(high - low) / size[0]] * 2)
        return bool((np.abs(np.subtract(ends[0], ends[1])) <= np.abs(pixel)).all())


@cache
def _axis_ends(folder: Path, name: str) -> tuple[float, ...]:
    """Ends of the axes of a map: medians over the samples of a data set."""
    with open_dataset(folder) as data:
        return tuple(np.median(data.extents(name), axis=0).tolist())


def measure_share(run: Path, data: Path) -> float:
    """Share of the images of a data set whose class the network of a run finds."""
    metadata, model = load_best(run)
    device = choose_device("auto")
    images = open_for_model(metadata, data, None)
    rows = np.arange(len(images))
    predictions = predict_classes(model.to(device), metadata, images, rows, device, TEST_BATCH)
    return float((predictions.predicted == predictions.truth).mean())


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def measure_accuracies(
    study: AccuracyStudy, sweep: Sweep, seeds: int, budget: Budget, save: Callable[[], None]
) -> None:
    """Train networks on data of the config as it is, and of each setting that saves time.

    Args:
        study: the study, with its folder of networks.
        sweep: its rows receive the accuracies.
        seeds: number of networks of a setting.
        budget: time in which networks are begun.
        save: keeps the sweep as it is.
    """
    for number, row in enumerate(sweep.rows):
        is_wanted = row.is_default or row.saves(sweep.blur)
        if not is_wanted or (row.accuracy and len(row.accuracy.by_seed) >= seeds):
            continue
        accuracy = study.measure(row.overrides, seeds, budget)
        if accuracy is not None:
            sweep.rows[number] = replace(row, accuracy=accuracy)
            save()
        elif row.is_default:
            return
