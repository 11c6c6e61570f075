"""Tasks that a network learns: outputs, targets, loss, score and report."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from torch import Tensor

from radhar_cli.figures.report.parts import ReportFigure, ReportTable
from radhar_cli.figures.report.report import Report
from radhar_cli.learning.batches import Targets
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.intervals import Groups, numbers_of_share
from radhar_cli.learning.models.outputs import Outputs
from radhar_cli.learning.registry import TASKS, load_place
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.predictions import EvalOptions, Predictions
from radhar_cli.numerics.arrays import Float, Index


class Names(Protocol):
    """Names that images, and a trained network, have."""

    @property
    def classes(self) -> tuple[str, ...]:
        """Names of the classes."""

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints of skeletons; empty without them."""


@dataclass(frozen=True)
class Evaluation:
    """One network on one data set, as a task reports on it."""

    report: Report  # receives figures and tables
    stem: str  # end of the names of its files
    title: str  # of its figures
    predictions: Predictions
    groups: Groups  # of the rows of the predictions
    options: EvalOptions
    features: Callable[[Index], Float]  # input [n, F] of the network's last layer, of n rows

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure: name without its end, caption, and content of the PNG."""
        self.report.add(ReportFigure(f"{name}{self.stem}.png", caption, png))

    def table(
        self,
        name: str,
        header: Sequence[object],
        rows: Iterable[Sequence[object]],
        title: str | None = None,
    ) -> None:
        """Add a table.

        Args:
            name: name of its file, without its end.
            header: names of the columns.
            rows: cells, row by row.
            title: title on the page; None leaves the table to its file.
        """
        file = f"{name}{self.stem}.csv"
        self.report.add(ReportTable(header, [*rows], title or "", file, title is not None))


@dataclass(frozen=True)
class Task(ABC):
    """Task that a network learns of an input; B inputs in a batch, N in a data set.

    A task of one's own is a subclass in a file of its own and a line of `choices.TASKS`.
    """

    settings: TrainConfig  # of the training

    score_name: ClassVar[str]  # for tables and curves, such as "accuracy"
    score_key: ClassVar[str]  # of the score of validation in metrics.json
    loss_name: ClassVar[str]
    finds: ClassVar[str]  # what its networks find, in words, such as "joints"
    outputs_name: ClassVar[str] = "logits"  # of what an ONNX file gives
    names_key: ClassVar[str] = "classes"  # of the names of its outputs in its metadata
    main_number: ClassVar[str]  # key of the number that a report is summed up by
    values_name: ClassVar[str] = "values"  # key of its predictions in files
    # names of the axes of a prediction but the last, such as the frame
    axes: ClassVar[tuple[str, ...]] = ()
    # names along the last axis, where the axis before it has the names of the outputs
    coordinates: ClassVar[tuple[str, ...]] = ()

    # The data: what of a set is learned.

    def relabel(self, images: ImageSet) -> ImageSet:
        """Give images the classes of the task; those of the source unless it has others."""
        return images

    def split_as_learned(self, images: ImageSet) -> ImageSet:
        """Images with the split that the task learns with; their own unless it makes another.

        Args:
            images: the set, as it was opened.
        """
        return images

    def check_training(self, images: ImageSet, path: str) -> None:
        """Make sure that a set with a split can be learned from.

        Args:
            images: the set, as `relabel` gives it.
            path: its data sets, for messages.

        Raises:
            FolderError: it has nothing to train or validate with.
        """
        for split in ("train", "val"):
            images.rows(split)

    def match(self, images: ImageSet, known: Names, names: Mapping[str, str | None]) -> ImageSet:
        """Bring labelled images to the names that a trained network knows.

        Args:
            images: the set, as it was opened.
            known: names that the network knows.
            names: {class of the data: class of the network, or None to leave it out}.

        Raises:
            FolderError: the network knows nothing of it.
            ConfigError: `names` leads to an unknown class.
        """
        return images.renamed(names)

    @abstractmethod
    def targets(self, images: ImageSet) -> Targets:
        """Targets [N, ...] of a set."""

    def weighted_for(self, images: ImageSet) -> "Task":
        """Task with the weights of classes that its settings ask for; itself where they are equal.

        Args:
            images: the set that is learned from, as `relabel` gives it.
        """
        return self

    def training_warnings(self, images: ImageSet) -> list[str]:
        """Warnings of a set that is learned from, in words."""
        return []

    # The network: what it gives, and how good that is.

    def names(self, known: Names) -> tuple[str, ...]:
        """Meanings of the outputs of the network, by name."""
        return known.classes

    def outputs(self, known: Names) -> Outputs:
        """Number and shape of the network's outputs: one a name."""
        return Outputs(len(self.names(known)))

    def describe(self, known: Names) -> str:
        """Outputs of a network in words, such as "12 classes"."""
        return f"{len(self.names(known))} {self.names_key}"

    @abstractmethod
    def loss(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Loss of each input [B]."""

    @abstractmethod
    def score(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Score of each input [B], from 0 to 1; the best epoch has the highest mean."""

    @abstractmethod
    def predict(self, outputs: Tensor) -> Tensor:
        """Predictions [B, ...] of outputs [B, ...], such as probabilities."""

    def describe_values(self, values: Float, names: tuple[str, ...], first: int, top: int) -> str:
        """Prediction of one input, in words.

        Args:
            values: as `predict` gives them.
            names: names of the outputs.
            first: number of the first frame in its sample.
            top: number of classes that are named.
        """
        return ", ".join(f"{name} {x:.4g}" for name, x in zip(names, values, strict=True))

    # Results.

    def groups(self, images: ImageSet, rows: Index) -> Groups:
        """Persons, recordings or samples of some rows, over which scores vary."""
        return images.samples.groups(rows)

    def validation_numbers(self, scores: Float, groups: Groups) -> dict[str, Any]:
        """Mean score of the validation images and its interval, by their keys in metrics.json.

        Args:
            scores: [N] score of each image, 0 to 1.
            groups: of these images.
        """
        score = {self.score_key: float(scores.mean())}
        return score | numbers_of_share(self.score_key, scores, groups)

    def check_options(self, run: str, options: EvalOptions, known: Names) -> None:
        """Refuse figures of `radhar eval` that cannot be drawn of such a network.

        Args:
            run: name of the run, for messages.
            options: choice of figures; t-SNE and the paper's groups are of classes.
            known: names that the network knows.

        Raises:
            RunError: one cannot be drawn.
        """
        if options.tsne or options.in_place_vs_moving:
            raise RunError(f"{run} finds {self.finds}; that figure is of classes")

    @abstractmethod
    def report(self, evaluation: Evaluation) -> dict[str, Any]:
        """Add figures and tables to a page; return plain numbers by their keys in report.json.

        `images` is the number of inputs, `main_number` that by which the result is summed up.
        """

    @abstractmethod
    def summarise(self, numbers: Mapping[str, Any]) -> str:
        """Numbers of `report` as a line for people."""

    def evaluation_warnings(self, images: ImageSet, name: str) -> list[str]:
        """Warnings of a data set of that name that is evaluated, in words."""
        return []


def create_task(settings: TrainConfig) -> Task:
    """Task that a training config names."""
    task: Task = load_place(TASKS[settings.target].place)(settings)
    return task
