"""The YAML file of `radhar train`: model, optimisation, augmentation, machine."""

from math import log2
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import (
    BeforeValidator,
    Field,
    PlainSerializer,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from radhar_cli.extensions import load_extensions
from radhar_cli.learning.registry import NETWORKS, TASKS, Kind, sequences_of
from radhar_cli.schema.number import value_error
from radhar_cli.schema.section import Section


def _auto_or(least: int) -> BeforeValidator:
    """Validator of a key that is auto, or a whole number of at least `least`."""

    def check(value: object) -> object:
        is_whole_number = isinstance(value, int) and not isinstance(value, bool) and value >= least
        if value != "auto" and not is_whole_number:
            raise value_error(f"should be auto or a whole number of at least {least}")
        return value

    return BeforeValidator(check)


STEPS_AN_EPOCH, SMALLEST_BATCH, LARGEST_BATCH = 24, 4, 128  # of batch_size: auto

Auto = Literal["auto"] | int
Count = Annotated[int, Field(ge=1, le=1_000_000, strict=True)]
Rate = Annotated[float, Field(gt=0, le=1e3, strict=True)]
Weight = Annotated[float, Field(ge=0, le=1000, strict=True)]
Share = Annotated[float, Field(gt=0, lt=1, strict=True)]


if TYPE_CHECKING:
    TaskName: TypeAlias = str
else:
    TaskName = Literal[tuple(TASKS)]  # which messages, schemas and tables list


def _check_task(value: Any, check: ValidatorFunctionWrapHandler) -> Any:
    """Accept a task that an extension has added since; have any other value checked."""
    load_extensions()
    return value if isinstance(value, str) and value in TASKS else check(value)


# Its serializer knows no list of names: pydantic's own warns of one that an extension has added.
Target = Annotated[TaskName, WrapValidator(_check_task), PlainSerializer(str, return_type=str)]


class ScheduleConfig(Section):
    """Fall of the learning rate from its initial value after the warm-up.

    `step` multiplies it by `factor` every `every_epochs` epochs, `cosine` brings it smoothly to
    zero at the last step, `constant` leaves it.
    """

    kind: Literal["step", "cosine", "constant"] = "cosine"
    """Law by which the learning rate falls."""
    every_epochs: Count = 10
    """Epochs between two falls of a schedule of kind step."""
    factor: Annotated[float, Field(gt=0, le=1, strict=True)] = 0.1
    """Factor of each fall of a schedule of kind step."""


Fraction = Annotated[float, Field(ge=0, le=1, strict=True)]


class AugmentConfig(Section):
    """Largest changes of training images, drawn anew in every epoch; all 0 changes nothing."""

    time_shift: Fraction = 0.0
    """Largest shift in time either way, a fraction of the width."""
    time_stretch: Fraction = 0.0
    """x: the time axis is scaled by factors from e^-x to e^x about the middle."""
    doppler_shift: Fraction = 0.0
    """Largest shift of Doppler either way, a fraction of the height."""
    doppler_scale: Fraction = 0.0
    """x: the Doppler axis is scaled by factors from e^-x to e^x about the middle."""
    contrast: Fraction = 0.0
    """x: distances from the brightest level are scaled by 1 - x to 1 + x, as at another SNR."""
    noise: Fraction = 0.0
    """Largest share of pixels that take the level of another place."""
    morphology: Fraction = 0.0
    """Probability of a dilation or erosion by one pixel."""
    time_bands: Annotated[int, Field(ge=0, le=16, strict=True)] = 0
    """Largest number of bands of time that are blanked."""
    doppler_bands: Annotated[int, Field(ge=0, le=16, strict=True)] = 0
    """Largest number of bands of Doppler that are blanked."""
    band_width: Fraction = 0.1
    """Largest width of a blanked band, a fraction of that axis."""


class WindowConfig(Section):
    """Windows that streams are cut into, for training and for evaluation."""

    length_s: Annotated[float, Field(gt=0, le=1e4, strict=True)] = 3.0
    """Duration of a window."""
    hop_s: Annotated[float, Field(gt=0, le=1e4, strict=True)] = 0.5
    """Time from the start of a window to that of the next."""
    label: Literal["majority", "centre"] = "majority"
    """Class of a window: that of most of its columns, or of the one in its middle."""


class TrainConfig(Section):
    """One training run; the defaults learn from some dozens of images a class as from thousands.

    The paper's Table II is configs/train/paper.yaml.
    """

    model: Annotated[str, Field(min_length=1)] = "smallnet"
    """Network: smallnet, the paper's fftnet, any of timm's; of sequences framenet, cloudnet."""
    target: Target = "classes"
    """Target of learning. classes: the main person's class; labels: activities of everybody; count:
    number of people; person: identity; frames: the class of every column of a stream; skeleton, of
    sequences: the joints in every frame."""
    map: str | None = None
    """Map that is learned from; null is the first one of the data set."""
    input: Literal["rgb", "gray"] = "rgb"
    """Channels of images: the three colours of the PNGs, or the levels alone."""
    window: WindowConfig | None = None
    """Windows that streams are cut into; null takes each as a whole (docs/guide/streams.md)."""
    frames: Annotated[Auto, _auto_or(1)] = "auto"
    """Frames of a sequence, the middle ones of a longer sample; auto is as many as the longest."""
    points: Annotated[Count, Field(le=4096)] = 64
    """Largest number of points of a frame; of more, those of the highest SNR stay."""
    seed: Annotated[int, Field(ge=0, lt=2**63, strict=True)] = 1
    """Seed of first weights, order of the images and dropout."""
    epochs: Count = 30
    """Passes over the training images."""
    batch_size: Annotated[Auto, _auto_or(2)] = "auto"
    """Images a step; auto makes some 24 steps an epoch, of 4 to 128 images."""
    optimiser: Literal["adam", "adamw", "sgd"] = "adamw"
    """Rule of the steps; adamw has decoupled decay, sgd a momentum of 0.9."""
    learning_rate: Rate = 0.003
    """Learning rate after the warm-up, from which the schedule falls."""
    weight_decay: Annotated[float, Field(ge=0, le=1e3, strict=True)] = 0.01
    """Decay of weights, as L2 penalty or, with adamw, decoupled; biases and norms have none."""
    label_smoothing: Annotated[float, Field(ge=0, lt=1, strict=True)] = 0.1
    """Label smoothing zeta: the target of a class is y (1 - zeta) + zeta/K."""
    schedule: ScheduleConfig = ScheduleConfig()
    warmup_epochs: Annotated[float, Field(ge=0, le=1e6, strict=True)] = 1.0
    """Epochs of the linear rise of the rate, step by step; may be a fraction."""
    gradient_clip_norm: Rate | None = None
    """Largest norm of the gradient, which is scaled down to it; null leaves it."""
    average_last: Annotated[float, Field(ge=0, le=1, strict=True)] = 0.0
    """Share of the steps, at the end, whose weights are averaged; 0 keeps those of an epoch."""
    validation_share: Share = 0.2
    """Share of each class that validates, where images come without a split."""
    data_weights: tuple[Weight, ...] | None = None
    """Number of times an epoch shows an image of each of several data sets; null is once."""
    sampling: Literal["all", "balanced"] = "all"
    """Images of an epoch: all once, or balanced, every class equally often."""
    class_weights: Literal["equal", "inverse_root"] = "equal"
    """Weights of classes in the loss of target: frames: equal, or by 1/sqrt(share of columns)."""
    augment: AugmentConfig = AugmentConfig()
    device: Literal["auto", "cpu", "cuda", "mps"] = "auto"
    """Device of the network; auto takes cuda, mps, cpu in that order."""
    precision: Literal["auto", "float32", "bfloat16"] = "auto"
    """Precision of the passes; auto is bfloat16 where the device computes in it."""
    workers: Annotated[Auto, _auto_or(0)] = "auto"
    """Processes that read images; auto is none on the CPU."""
    threads: Annotated[Auto, _auto_or(1)] = "auto"
    """Threads of the CPU; auto leaves the choice to PyTorch."""

    def with_batch_size_for(self, count: int, frames: int = 1) -> "TrainConfig":
        """Copy of the config in which `batch_size` and `frames` are numbers where they were auto.

        Args:
            count: number of training images.
            frames: number of frames of a sequence; 1 for images.
        """
        update = {"frames": frames} if self.frames == "auto" else {}
        if self.batch_size == "auto":
            fitting = 2 ** round(log2(max(count, 1) / STEPS_AN_EPOCH))
            update["batch_size"] = min(max(fitting, SMALLEST_BATCH), LARGEST_BATCH)
        return self.model_copy(update=update)

    @property
    def images_a_step(self) -> int:
        """Batch size of a config that `with_batch_size_for` made."""
        assert self.batch_size != "auto"
        return self.batch_size

    @property
    def input_kind(self) -> Kind:
        """Kind of input of the model: frames or clouds for networks of sequences, else images."""
        return sequences_of(self.model) or self.input

    @model_validator(mode="after")
    def _fits(self) -> "TrainConfig":
        load_extensions()  # which may add the network
        if self.warmup_epochs > self.epochs:
            raise value_error("should have warmup_epochs of at most epochs")
        if TASKS[self.target].of_sequences and sequences_of(self.model) is None:
            networks = " or ".join(name for name in NETWORKS if sequences_of(name))
            raise value_error(f"should have model: {networks} for target: {self.target}")
        networks_of_task = TASKS[self.target].networks
        if networks_of_task and self.model not in networks_of_task:
            networks = " or ".join(networks_of_task)
            raise value_error(f"should have model: {networks} for target: {self.target}")
        if self.class_weights != "equal" and self.target != "frames":
            raise value_error(
                f"should have class_weights: equal for target: {self.target}; sampling: balanced "
                "shows rare classes more often"
            )
        if self.sampling == "balanced" and self.target == "frames":
            raise value_error(
                "should have sampling: all for target: frames, whose images have no class of their "
                "own; class_weights: inverse_root weighs their columns"
            )
        if self.augment != AugmentConfig() and sequences_of(self.model) is not None:
            raise value_error("should have no augment, which is of images")
        if self.augment != AugmentConfig() and self.input != "gray":
            raise value_error("should have input: gray for augment, which changes grey levels")
        return self
