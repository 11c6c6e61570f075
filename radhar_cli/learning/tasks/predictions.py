"""Predictions of a network for the rows of a set, and options of its evaluation."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from radhar_cli.learning.event_metrics import AlarmRules
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.numerics.arrays import Float, Index


@dataclass(frozen=True)
class Predictions:
    """Predictions of a network for N rows of a set."""

    images: ImageSet
    rows: Index  # [N] rows of the set
    names: tuple[str, ...]  # of what the outputs stand for: classes, labels, joints
    values: Float  # [N, ...] as the task predicts: probabilities, or joints in m


@dataclass(frozen=True)
class ClassPredictions(Predictions):
    """Probabilities [N, classes] of N rows of a set, and their true classes."""

    @property
    def probabilities(self) -> Float:
        """Probability of each class [N, classes]; of labels each by itself, else they add to 1."""
        return self.values

    @property
    def truth(self) -> Index:
        """True class of each row [N], in the network's numbering."""
        labels: Index = labels_for(self.images, self.names)[self.rows]
        return labels

    @property
    def predicted(self) -> Index:
        """Likeliest class of each row [N], in the network's numbering."""
        winners: Index = self.values.argmax(1)
        return winners


@dataclass(frozen=True)
class EvalOptions:
    """Options of `radhar eval`."""

    split: str | None = None  # train, val, test or all; None is test where there is one, else val
    map: str | None = None  # of a data set; None is the one of the training
    tsne: bool = False  # draw t-SNE of maps and features
    in_place_vs_moving: bool = False  # confusion matrix of the paper's two groups
    batch: int = 32  # images at a time
    resize: bool = False  # bring images to the model's size
    # {class of the data: class of the model, or None to leave it out}
    names: Mapping[str, str | None] = field(default_factory=dict)
    filters: bool = False  # draw the weights of global filters
    events: tuple[str, ...] = ()  # classes of frames that are one kind of event, such as falls
    event_threshold: float = 0.5  # score from which on there is an alarm
    alarms: AlarmRules = field(default_factory=AlarmRules)
