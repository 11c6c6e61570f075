"""Findings of a network in images and sequences, and the files that `predict` writes of them."""

import io
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.errors import ConfigError
from radhar_cli.files.replacing import write_output
from radhar_cli.files.table_text import csv_text
from radhar_cli.learning.tasks.task import Task
from radhar_cli.numerics.arrays import Float, Index

SUFFIXES = (".npz", ".csv", ".json")


@dataclass(frozen=True)
class RunEstimates:
    """Predictions of a network for N images or sequences.

    Attributes:
        samples: name of each image or sequence [N].
        names: names of the classes, or of the joints.
        values: probabilities [N, classes] of classes, each by itself of labels; [N, columns,
            classes] of frames of streams; joints [N, T, joint, 3] in m (x ahead of the radar, y to
            its left, z up; NaN after the end of a sample).
        first_frame: number of the first frame, or column, in its sample [N].
        task: what the network has learned.
    """

    samples: tuple[str, ...]
    names: tuple[str, ...]
    values: Float
    first_frame: Index
    task: Task

    def __len__(self) -> int:
        return len(self.samples)

    @property
    def probabilities(self) -> Float:
        """Probabilities, of a network that names classes, labels or a count.

        Raises:
            ValueError: the network finds joints.
        """
        if self.task.coordinates:
            raise ValueError("joints have no probabilities; see joints")
        return self.values

    @property
    def joints(self) -> Float:
        """Joints [N, T, joint, 3], m, of a network that finds them.

        Raises:
            ValueError: the network finds none.
        """
        if not self.task.coordinates:
            raise ValueError("the network finds no joints; see probabilities")
        return self.values

    @property
    def classes(self) -> tuple[str, ...]:
        """Names of the classes."""
        return self.names

    @property
    def likeliest(self) -> list[Any]:
        """Likeliest class of each image [N], or of each column [N][columns]."""
        likeliest: list[Any] = np.array(self.names)[self.probabilities.argmax(-1)].tolist()
        return likeliest

    def documents(self) -> Iterator[dict[str, Any]]:
        """Yield what is found in each sample as plain values, by their keys in JSON."""
        for values, first_frame in zip(self.values, self.first_frame.tolist(), strict=True):
            document = dict[str, Any]()
            if self._are_probabilities:
                document["class"] = np.array(self.names)[values.argmax(-1)].tolist()
            if self.task.axes:
                document["first_frame"] = first_frame
            if self.task.coordinates:
                known = np.isfinite(values).all((1, 2))  # [T]
                by_name = values[known].swapaxes(0, 1).tolist()
            else:
                by_name = np.moveaxis(values, -1, 0).tolist()
            yield {
                **document,
                self.task.values_name: dict(zip(self.names, by_name, strict=True)),
            }

    @property
    def _are_probabilities(self) -> bool:
        """Whether the names are of classes, of which one is the likeliest."""
        return self.task.values_name == "probabilities"

    def lines(self, top: int = 3) -> Iterator[str]:
        """Yield what is found in each sample, in words.

        Args:
            top: number of classes that are named, most likely first.
        """
        for values, first in zip(self.values, self.first_frame.tolist(), strict=True):
            yield self.task.describe_values(values, self.names, first, top)

    def write(self, path: str | Path) -> None:
        """Write what is found as NumPy arrays, as CSV, or as JSON, a document a sample.

        CSV has a row for each sample; of frames for each column, of joints for each joint of
        each frame.

        Args:
            path: file that ends in .npz, .csv or .json.

        Raises:
            ConfigError: it ends in something else.
            FolderError: the file cannot be written.
        """
        path = Path(path)
        check_file_name(path)
        if path.suffix == ".csv":
            columns = ("class",) * self._are_probabilities + (self.task.coordinates or self.names)
            content = csv_text(("sample", *self.task.axes, *columns), self._rows())
            write_output(path, content.encode("utf-8", "surrogateescape"))
        elif path.suffix == ".json":
            documents = [
                {"sample": sample, **document}
                for sample, document in zip(self.samples, self.documents(), strict=True)
            ]
            write_output(path, (json.dumps(documents, indent=1) + "\n").encode())
        else:
            buffer = io.BytesIO()
            names_key = "joint_names" if self.task.coordinates else self.task.names_key
            arrays: dict[str, Any] = {
                self.task.values_name: self.values.astype(np.float32),
                "first_frame": self.first_frame,
                "samples": np.array(self.samples),
                names_key: np.array(self.names),
            }
            np.savez(buffer, **arrays)
            write_output(path, buffer.getvalue())

    def _rows(self) -> Iterator[tuple[object, ...]]:
        """Rows of the CSV file; frames after the end of a sample have none."""
        task, names = self.task, np.array(self.names)
        for sample, values, first in zip(
            self.samples, self.values, self.first_frame.tolist(), strict=True
        ):
            for place in np.ndindex(*values.shape[:-1]):
                numbers = values[place]
                if np.isnan(numbers).any():
                    continue
                index: list[object] = [first + place[0]] if place else []
                index += [names[number] for number in place[1:]]
                cells = [f"{x:.4f}" if task.coordinates else f"{x:.6f}" for x in numbers.tolist()]
                if self._are_probabilities:
                    cells.insert(0, names[numbers.argmax()])
                yield (sample, *index, *cells)


def joined_estimates(parts: Sequence[RunEstimates]) -> RunEstimates:
    """RunEstimates of one network, one after the other."""
    first = parts[0]
    return RunEstimates(
        tuple(sample for part in parts for sample in part.samples),
        first.names,
        np.concatenate([part.values for part in parts]),
        np.concatenate([part.first_frame for part in parts]),
        first.task,
    )


def check_file_name(path: Path) -> None:
    """Refuse a file name that says no format.

    Raises:
        ConfigError: it ends in none of .npz, .csv, .json.
    """
    if path.suffix not in SUFFIXES:
        raise ConfigError(f"-o {path}: should end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
