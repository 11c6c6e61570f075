"""The YAML file of `radhar train`: what is learned, how, and on what machine."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from radhar_cli.config.schema import Section


def _auto_or(least: int) -> BeforeValidator:
    def check(value: object) -> object:
        whole = isinstance(value, int) and not isinstance(value, bool) and value >= least
        if value != "auto" and not whole:
            raise PydanticCustomError(
                "auto", "should be auto or a whole number of at least {least}", {"least": least}
            )
        return value

    return BeforeValidator(check)


Auto = Literal["auto"] | int
Count = Annotated[int, Field(ge=1, le=1_000_000, strict=True)]
Rate = Annotated[float, Field(gt=0, le=1e3, strict=True)]
Weight = Annotated[float, Field(ge=0, le=1000, strict=True)]
Share = Annotated[float, Field(gt=0, lt=1, strict=True)]


class ScheduleConfig(Section):
    """How the learning rate falls from its initial value after the warm-up.

    `step` multiplies it by `factor` every `every_epochs` epochs, `cosine` brings it smoothly to
    zero at the last step, `constant` leaves it.
    """

    kind: Literal["step", "cosine", "constant"] = "step"
    every_epochs: Count = 10
    factor: Annotated[float, Field(gt=0, le=1, strict=True)] = 0.1


Fraction = Annotated[float, Field(ge=0, le=1, strict=True)]


class AugmentConfig(Section):
    """How far training images are changed, anew in every epoch; all 0 changes nothing.

    Shifts are fractions of the image, either way; stretch and scale e^-x to e^x; contrast 1 - x to
    1 + x about the brightest level, as another SNR has it; noise the largest share of pixels that
    take the level of another place; morphology the probability of a dilation or an erosion by one
    pixel; bands the most that are blanked, each at most `band_width` of the image.
    """

    time_shift: Fraction = 0.0
    time_stretch: Fraction = 0.0
    doppler_shift: Fraction = 0.0
    doppler_scale: Fraction = 0.0
    contrast: Fraction = 0.0
    noise: Fraction = 0.0
    morphology: Fraction = 0.0
    time_bands: Annotated[int, Field(ge=0, le=16, strict=True)] = 0
    doppler_bands: Annotated[int, Field(ge=0, le=16, strict=True)] = 0
    band_width: Fraction = 0.1


class StreamConfig(Section):
    """Of `radhar train --stream`: what an epoch is, and what validates it.

    An epoch has as many samples as the config's data set would train with, if no number is given;
    without a data set to validate on, at most `validation_per_class` of its validation samples do.
    """

    samples_per_epoch: Annotated[Count, Field(ge=2)] | None = None
    validation_per_class: Count = 100


class TrainConfig(Section):
    """One training run; the defaults are the paper's Table II."""

    model: Annotated[str, Field(min_length=1)] = "fftnet"
    map: str | None = None
    input: Literal["rgb", "gray"] = "rgb"
    seed: Annotated[int, Field(ge=0, lt=2**63, strict=True)] = 1
    epochs: Count = 20
    batch_size: Annotated[int, Field(ge=2, le=1_000_000, strict=True)] = 128
    micro_batch: Annotated[Auto, _auto_or(2)] = "auto"
    optimiser: Literal["adam", "adamw", "sgd"] = "adam"
    learning_rate: Rate = 0.00147
    weight_decay: Annotated[float, Field(ge=0, le=1e3, strict=True)] = 1e-4
    label_smoothing: Annotated[float, Field(ge=0, lt=1, strict=True)] = 0.1
    schedule: ScheduleConfig = ScheduleConfig()
    warmup_epochs: Annotated[float, Field(ge=0, le=1e6, strict=True)] = 0.0
    gradient_clip_norm: Rate | None = None
    validation_share: Share = 0.2
    data_weights: tuple[Weight, ...] | None = None
    sampling: Literal["all", "balanced"] = "all"
    augment: AugmentConfig = AugmentConfig()
    stream: StreamConfig = StreamConfig()
    device: Literal["auto", "cpu", "cuda", "mps"] = "auto"
    precision: Literal["auto", "float32", "bfloat16"] = "auto"
    workers: Annotated[Auto, _auto_or(0)] = "auto"
    threads: Annotated[Auto, _auto_or(1)] = "auto"

    @model_validator(mode="after")
    def _fits(self) -> "TrainConfig":
        if self.warmup_epochs > self.epochs:
            raise PydanticCustomError("warmup", "should have warmup_epochs of at most epochs")
        if self.augment != AugmentConfig() and self.input != "gray":
            raise PydanticCustomError(
                "gray", "should have input: gray for augment, which changes grey levels"
            )
        return self
