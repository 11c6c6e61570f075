"""The files of a training run; reading them never runs code that they hold."""

import csv
import io
import json
import math
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import torch
from pydantic import Field, ValidationError, field_validator, model_validator
from safetensors import SafetensorError, safe_open
from safetensors.torch import save as safetensors_bytes
from torch import Tensor, nn
from typing_extensions import TypedDict

from radhar_cli.dataset.files import read_bytes, write_whole
from radhar_cli.dataset.folder import refuse_differences, refuse_foreign_files
from radhar_cli.errors import ModelError
from radhar_cli.files.table_text import csv_text
from radhar_cli.files.untrusted import regular_size
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.images.image_set import shape_in_words
from radhar_cli.learning.models.build import Cost, build_model, cost
from radhar_cli.learning.registry import Kind, image_channels_of
from radhar_cli.learning.run_files import (
    ABOUT,
    ALL,
    BEST,
    EVENTS,
    HISTORY,
    LAST,
    TENSORBOARD,
    TRAINED_ON,
    RunError,
)
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.task import Task, create_task
from radhar_cli.schema.number import require, value_error
from radhar_cli.schema.section import Section

MAX_CLASSES = 10_000
MAX_HEADER = 2**24  # bytes
MAX_TABLE = 2**28
Name = Annotated[str, Field(min_length=1, max_length=255)]
Side = Annotated[int, Field(ge=1, le=2**14)]
Spread = Annotated[float, Field(gt=0)]


class LearnedFrom(TypedDict):
    """Data set of a run: path, content hash, numbers of images that train and validate."""

    path: str
    hash: str
    train: Annotated[int, Field(ge=0)]
    val: Annotated[int, Field(ge=0)]


class RunMetadata(Section):
    """Description of a trained model, stored with its weights: task, inputs, data, settings."""

    model: Name
    classes: Annotated[
        tuple[Name, ...],
        Field(min_length=1, max_length=MAX_CLASSES),
        require(lambda value: len(set(value)) == len(value), "should name each class once"),
    ]
    size: tuple[Side, Side]  # (height, width)
    map: Annotated[Name, Field(pattern=r"^[^/\\]*[^/\\.][^/\\]*$")] | None
    channels: Annotated[int, Field(ge=1, le=2**14)] = 3
    input: Kind
    joints: Annotated[tuple[Name, ...], Field(max_length=256)] = ()  # of skeletons
    colours: Name | None = None  # colour map of its RGB pictures, where it was recognised
    mean: Annotated[tuple[float, ...], Field(min_length=1, max_length=3)]  # of the channels
    sd: Annotated[tuple[Spread, ...], Field(min_length=1, max_length=3)]
    config: dict[str, Any]  # resolved
    data: LearnedFrom
    versions: dict[str, str]  # of radhar, torch, numpy
    # what else the result depends on: precision, weights that it starts from, what it is adapted to
    work: dict[str, Any] = Field(default_factory=dict)
    epoch: Annotated[int, Field(ge=1)] | None = None  # with weights, after which they were kept

    @field_validator("config")
    @classmethod
    def _usable(cls, value: dict[str, Any]) -> dict[str, Any]:
        TrainConfig.model_validate(value)
        return value

    @model_validator(mode="after")
    def _fits(self) -> "RunMetadata":
        if self.input == "gray" and self.channels != 1:
            raise value_error(
                "should have one channel of input: gray; earlier versions had three, and their "
                "runs should be trained anew"
            )
        if not len(self.mean) == len(self.sd) in (1, self.channels):
            raise value_error("should have a mean and an sd for each channel")
        if self.model != self.settings.model or not self.task.names(self):
            raise value_error("should be that of its config")
        return self

    @cached_property
    def settings(self) -> TrainConfig:
        """Config of the run."""
        return TrainConfig.model_validate(self.config)

    @cached_property
    def task(self) -> Task:
        """Task that the network has learned."""
        return create_task(self.settings)

    @property
    def reads_pictures(self) -> bool:
        """Whether the network takes images, not sequences."""
        return self.input in ("rgb", "gray")

    @property
    def outputs_in_words(self) -> str:
        """Outputs of the network, in words."""
        return self.task.describe(self)

    @property
    def shape(self) -> str:
        """Size of an image or a sequence that the network takes, in words."""
        return shape_in_words(self.input, self.size, self.channels)

    def network(self) -> nn.Module:
        """Network with fresh weights.

        Raises:
            ModelError: it cannot be built.
        """
        return build_model(self.model, self.task.outputs(self), self.size)

    @property
    def cost(self) -> Cost:
        """Parameters and multiply-adds of the network."""
        return cost(self.model, self.task.outputs(self), self.size, self.channels)

    @property
    def normalisation(self) -> Normalisation:
        """Normalisation from levels to the network's input."""
        channels = image_channels_of(self.model) if self.reads_pictures else None
        return Normalisation(self.mean, self.sd, channels)


@dataclass(frozen=True)
class Epoch:
    """Result of an epoch, a row of history.csv; accuracies are scores of the target."""

    epoch: int
    learning_rate: float
    train_loss: float
    train_accuracy: float
    val_loss: float
    val_accuracy: float
    seconds: float


def best_epoch(history: Sequence[Epoch]) -> Epoch:
    """Epoch whose weights are kept: highest accuracy, then lowest loss, then earliest."""
    return min(history, key=lambda row: (-row.val_accuracy, row.val_loss, row.epoch))


def reserve_run(folder: Path, metadata: RunMetadata, overwrite: bool) -> None:
    """Take a locked folder for a run, which is new or the one that the folder holds.

    Args:
        folder: folder of the run; the caller holds its lock.
        metadata: description of the run.
        overwrite: remove another run's files.

    Raises:
        RunError: the folder holds another run, or something else.
    """
    holds_run = (folder / ABOUT).exists()
    if holds_run and (overwrite or not ((folder / LAST).exists() or (folder / BEST).exists())):
        for name in reversed(ALL):
            (folder / name).unlink(missing_ok=True)
        for path in (folder / TENSORBOARD).glob(EVENTS):
            path.unlink()
    if not (folder / ABOUT).exists():
        if not holds_run:
            refuse_foreign_files(folder, "training run", error=RunError)
        write_whole(folder, folder / ABOUT, (metadata.model_dump_json(indent=2) + "\n").encode())
        return
    refuse_differences(folder, "run", differences(read_metadata(folder), metadata), RunError)


def differences(old: RunMetadata, new: RunMetadata) -> list[str]:
    """Lines, one for each setting, version or hash in which two runs differ."""
    pairs = {key: (old.config.get(key), value) for key, value in new.config.items()}
    if old.data["hash"] != new.data["hash"]:
        old_value, new_value = ([data["path"], data["hash"]] for data in (old.data, new.data))
        pairs["data"] = (old_value, new_value)
    pairs |= {"classes": (list(old.classes), list(new.classes)), "map": (old.map, new.map)}
    pairs |= {k: (old.work.get(k), new.work.get(k)) for k in old.work | new.work}
    pairs |= {f"versions.{k}": (old.versions.get(k), v) for k, v in new.versions.items()}
    return [
        f"{key}: {json.dumps(old_value)} there, {json.dumps(new_value)} here"
        for key, (old_value, new_value) in pairs.items()
        if old_value != new_value
    ]


def read_metadata(folder: Path) -> RunMetadata:
    """Metadata of the run in a folder.

    Raises:
        RunError: the folder holds no run, or its description is damaged.
    """
    path = folder / ABOUT
    try:
        return RunMetadata.model_validate_json(read_bytes(path))
    except FileNotFoundError:
        raise RunError(f"{folder}: holds no training run ({ABOUT} is missing)") from None
    except ValidationError as error:
        raise RunError(
            f"{path}: is damaged, or is not from radhar ({_first_problem(error)})"
        ) from None


def _first_problem(error: ValidationError) -> str:
    item = error.errors(include_url=False)[0]
    return f"{'.'.join(map(str, item['loc']))}: {item['msg']}"


class TrainedOn(NamedTuple):
    """Fingerprints of samples that a run has seen; empty where the run has none."""

    pixels: frozenset[str]  # of the images that it learned from
    scenes: frozenset[str]  # of the person and motion behind these
    validation: frozenset[str]  # of the images that chose its epoch


def write_trained_on(folder: Path, images: Sequence[tuple[str, str, str, str]]) -> None:
    """Write (name, fingerprint, scene's fingerprint, part) of every image that a run sees."""
    text = csv_text(("image", "pixels", "scene", "part"), images)
    write_whole(folder, folder / TRAINED_ON, text.encode("utf-8", "surrogateescape"))


def read_trained_on(folder: Path) -> TrainedOn:
    """Fingerprints of the images that a run has seen; empty sets without the file.

    Raises:
        RunError: the file is damaged.
    """
    path = folder / TRAINED_ON
    if not path.exists():
        return TrainedOn(frozenset(), frozenset(), frozenset())
    try:
        rows = csv.DictReader(io.StringIO(_text(path), newline=""))
        fingerprints = {(row["pixels"], row["scene"], row.get("part") or "train") for row in rows}
        learned = [row for row in fingerprints if row[2] == "train"]
        if not learned:
            raise ValueError("names no image")
        return TrainedOn(
            frozenset(pixels for pixels, _, _ in learned),
            frozenset(scene for _, scene, _ in learned if scene),
            frozenset(pixels for pixels, _, part in fingerprints if part == "val"),
        )
    except (KeyError, ValueError, csv.Error) as error:
        raise RunError(f"{path}: is damaged ({error})") from None


def _text(path: Path) -> str:
    return read_bytes(path, MAX_TABLE).decode("utf-8", "surrogateescape")


def write_history(folder: Path, history: Sequence[Epoch]) -> None:
    """Write history.csv, a row for each epoch."""
    text = csv_text(list(Epoch.__dataclass_fields__), (vars(row).values() for row in history))
    write_whole(folder, folder / HISTORY, text.encode())


def read_history(folder: Path) -> list[Epoch]:
    """Epochs of a run, from history.csv.

    Raises:
        RunError: no epoch is finished, or the file is damaged.
    """
    path = folder / HISTORY
    try:
        rows = csv.DictReader(io.StringIO(_text(path), newline=""))
        return require_valid_history(
            [Epoch(int(r.pop("epoch")), **{k: float(v) for k, v in r.items()}) for r in rows]
        )
    except FileNotFoundError:
        raise RunError(f"{folder}: holds no finished epoch ({HISTORY} is missing)") from None
    except (ValueError, TypeError, KeyError, csv.Error) as error:
        raise RunError(f"{path}: is damaged ({error})") from None


def require_valid_history(history: list[Epoch]) -> list[Epoch]:
    """Epochs of a history that was read, unchanged, if they can be those of a run.

    Raises:
        ValueError: epochs are not numbered 1, 2, 3, or hold a value that is not finite.
    """
    for number, row in enumerate(history, start=1):
        if row.epoch != number or not all(map(math.isfinite, vars(row).values())):
            raise ValueError(f"row {number}: should be epoch {number}, in finite numbers")
    return history


def write_best(
    folder: Path, metadata: RunMetadata, epoch: Epoch, weights: Mapping[str, Tensor]
) -> None:
    """Write best.safetensors: weights and, as metadata, all that is needed to use them.

    Args:
        folder: folder of the run.
        metadata: description of the run.
        epoch: epoch after which the weights were kept.
        weights: {name: tensor} of the network.
    """
    with_epoch = metadata.model_copy(update={"epoch": epoch.epoch})
    header = {
        "radhar": with_epoch.model_dump_json()
    }  # one key: safetensors writes several in any order
    tensors = {name: tensor.detach().cpu().contiguous() for name, tensor in weights.items()}
    write_whole(folder, folder / BEST, safetensors_bytes(tensors, header))


def load_best(folder: Path) -> tuple[RunMetadata, nn.Module]:
    """Metadata of a run and the network of its best epoch, in evaluation mode on the CPU.

    Args:
        folder: folder of the run, or a .safetensors file; it is not trusted.

    Raises:
        RunError: there are no weights, or they are damaged or do not fit their description.
    """
    path = folder / BEST if folder.is_dir() else folder
    if not path.exists():
        hint = (
            "no epoch is finished yet; run `radhar train` again"
            if (folder / ABOUT).exists()
            else "should be a folder that `radhar train` wrote"
        )
        raise RunError(f"{folder}: holds no {BEST}; {hint}")
    try:
        size = regular_size(path)
        with path.open("rb") as stream:
            header = int.from_bytes(stream.read(8), "little")
        if header > min(MAX_HEADER, size):
            raise ValueError(f"it claims a header of {header} bytes")
        with safe_open(path, framework="pt") as file:
            return _load_network(path, file)
    except OSError as error:
        raise RunError(f"{path}: {error.strerror or error}") from None
    except (SafetensorError, ValueError, MemoryError, RuntimeError) as error:
        raise RunError(f"{path}: is not a safetensors file, or is truncated ({error})") from None


def _load_network(path: Path, file: Any) -> tuple[RunMetadata, nn.Module]:
    """Network with weights whose names, types and shapes are those of its description."""
    header = file.metadata() or {}
    if "radhar" not in header:
        raise RunError(f"{path}: was not written by `radhar train`")
    try:
        metadata = RunMetadata.model_validate_json(header["radhar"])
        with torch.device("meta"):
            expected_tensors = metadata.network().state_dict()
        weights = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        for name in expected_tensors.keys() | weights.keys():
            actual, expected = (
                (tuple(tensors[name].shape), tensors[name].dtype) if name in tensors else "missing"
                for tensors in (weights, expected_tensors)
            )
            if actual != expected:
                raise RuntimeError(f"{name} is {actual}, should be {expected}")
            if not weights[name].isfinite().all():
                raise RuntimeError(f"{name} holds a number that is not finite")
        model = metadata.network()
        model.load_state_dict(weights)
    except ValidationError as error:
        raise RunError(f"{path}: its description is damaged ({_first_problem(error)})") from None
    except ModelError as error:
        raise RunError(f"{path}: {error}") from None
    except RuntimeError as error:
        lines = str(error).strip().splitlines() or ["no more is known"]
        raise RunError(
            f"{path}: its weights do not fit its description ({lines[-1].strip()})"
        ) from None
    return metadata, model.eval()


def write_last(folder: Path, checkpoint: dict[str, Any]) -> None:
    """Write last.ckpt, from which a stopped run resumes."""
    buffer = io.BytesIO()
    torch.save(checkpoint, buffer)
    write_whole(folder, folder / LAST, buffer.getvalue())


def read_last(folder: Path) -> dict[str, Any] | None:
    """Checkpoint of the last epoch, None before the first; tensors and plain values only.

    Raises:
        RunError: the file is damaged.
    """
    path = folder / LAST
    if not path.exists():
        return None
    try:
        _refuse_inflation(path)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            checkpoint: dict[str, Any] = torch.load(path, map_location="cpu", weights_only=True)
        return {
            key: checkpoint[key] for key in ("model", "average", "optimiser", "history", "metadata")
        }
    except MemoryError:
        raise
    except Exception as error:  # PyTorch raises whatever its parsers meet
        raise RunError(
            f"{path}: is damaged, or not a checkpoint of radhar ({first_line(error)}); {BEST} is "
            "untouched; --overwrite starts the run over"
        ) from None


def _refuse_inflation(path: Path) -> None:
    """Refuse a compressed checkpoint, which could inflate to any size; PyTorch does not compress.

    Raises:
        ValueError, BadZipFile: it is compressed, or not a file of PyTorch.
    """
    size = regular_size(path)
    with zipfile.ZipFile(path) as file:
        entries = file.infolist()
    is_compressed = any(entry.compress_type != zipfile.ZIP_STORED for entry in entries)
    if is_compressed or sum(entry.file_size for entry in entries) > size:
        raise ValueError("it holds more than its own size")


def first_line(error: Exception) -> str:
    """First line of an error's text, or its type where it has none."""
    lines = str(error).strip().splitlines()
    return lines[0].split(". ")[0] if lines else type(error).__name__
