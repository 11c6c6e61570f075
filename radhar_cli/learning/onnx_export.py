"""A trained network as an ONNX file that needs neither PyTorch nor radhar."""

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import interpolate

from radhar_cli.files.replacing import write_output
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.images.sequences import COLUMNS
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.run_folder import RunMetadata, first_line, load_best

TOLERANCE = 1e-4
INPUTS = {"rgb": "pixels", "gray": "pixels", "frames": "frames", "clouds": "clouds"}


class _FromInputs(nn.Module):
    """Network with its normalisation in front: pixels as in a PNG, frames, or clouds."""

    def __init__(self, model: nn.Module, normalisation: Normalisation) -> None:
        super().__init__()
        self.model, self.normalisation = model, normalisation

    def forward(self, inputs: Tensor) -> Tensor:
        outputs: Tensor = self.model(self.normalisation(inputs))
        return outputs


def export(run: Path, path: Path) -> float:
    """Write the best epoch's network as ONNX and compare the two on random inputs.

    The input is `pixels` uint8 [batch, 3, H, W], RGB, or [batch, 1, H, W] of gray; or `frames`
    uint8 [batch, T, H, W]; or `clouds` float32 [batch, 6, T, points], the columns of `Sequences`
    first. The output is `logits` float32 [batch, classes], or `joints` float32 [batch, T, joint, 3]
    in m. The file's metadata names the classes or the joints.

    Args:
        run: folder of the run.
        path: ONNX file that is written.

    Returns:
        Largest difference of an output, over the largest output where that is above 1.

    Raises:
        RunError: PyTorch cannot write the network, or the two differ by more than TOLERANCE.
        FolderError: the file cannot be written.
    """
    import onnxruntime

    metadata, network = load_best(run)
    model = _FromInputs(network, metadata.normalisation).eval()
    try:
        content = _onnx_of(model, metadata)
    except torch.onnx.errors.OnnxExporterError as error:
        raise RunError(
            f"{run}: PyTorch cannot write {metadata.model} as ONNX ({first_line(error)})"
        ) from None
    session = onnxruntime.InferenceSession(content, providers=["CPUExecutionProvider"])
    difference = _largest_difference(model, session, metadata)
    if not difference <= TOLERANCE:
        raise RunError(
            f"{run}: ONNX Runtime's {metadata.task.outputs_name} differ from PyTorch's by "
            f"{difference:.2g}, more than {TOLERANCE:g}; {path} was not written"
        )
    write_output(path, content)
    return difference


def _onnx_of(model: nn.Module, metadata: RunMetadata) -> bytes:
    """Content of the ONNX file of a network, its metadata included.

    Args:
        model: network with its normalisation, in evaluation mode.
        metadata: description of the network.

    Raises:
        OnnxExporterError: PyTorch cannot write it.
    """
    import onnx

    with warnings.catch_warnings(), torch.no_grad():
        warnings.simplefilter("ignore")
        program: Any = torch.onnx.export(
            model,
            (_random_inputs(2, metadata),),
            dynamo=True,
            dynamic_shapes={"inputs": {0: torch.export.Dim("batch")}},
            input_names=[INPUTS[metadata.input]],
            output_names=[metadata.task.outputs_name],
            verbose=False,
        )
    onnx_model = program.model_proto
    onnx.helper.set_model_props(
        onnx_model,
        {
            **{key: json.dumps(value) for key, value in _names(metadata).items()},
            "model": metadata.model,
            "input": metadata.input,
        },
    )
    onnx.checker.check_model(onnx_model)
    content: bytes = onnx_model.SerializeToString()
    return content


def _largest_difference(model: nn.Module, session: Any, metadata: RunMetadata) -> float:
    """Largest difference of an output in ONNX Runtime, over the largest output if above 1.

    Args:
        model: network in PyTorch.
        session: the same network in ONNX Runtime.
        metadata: its description.
    """
    largest = 0.0
    for count in (1, 3):
        inputs = _random_inputs(count, metadata)
        with torch.inference_mode():
            expected = model(inputs).numpy()
        feed = {INPUTS[metadata.input]: inputs.numpy()}
        outputs = session.run([metadata.task.outputs_name], feed)[0]
        scale = max(1.0, float(np.abs(expected).max()))
        largest = max(largest, float(np.abs(outputs - expected).max()) / scale)
    return largest


def _names(metadata: RunMetadata) -> dict[str, tuple[str, ...]]:
    """Meanings of the outputs of a network: names of joints, or classes."""
    return {metadata.task.names_key: metadata.task.names(metadata)}


def _random_inputs(count: int, metadata: RunMetadata) -> Tensor:
    """Random inputs of a network, like those of its training."""
    return _clouds(count, metadata) if metadata.input == "clouds" else _pixels(count, metadata)


def _clouds(count: int, metadata: RunMetadata) -> Tensor:
    """Random clouds [count, 6, T, points], in which a third of the points is missing."""
    generator = torch.Generator().manual_seed(0)
    clouds = torch.randn(count, len(COLUMNS), *metadata.size, generator=generator)
    present = torch.rand(count, 1, *metadata.size, generator=generator) < 2 / 3
    clouds[:, -1:] = 1
    return clouds * present


def _pixels(images: int, metadata: RunMetadata) -> Tensor:
    """Smooth random images, uint8 [images, C, H, W], with the mean and spread of the training data.

    White noise would not do: far from what it was trained on, the network's products of branches
    grow without bound, and rounding errors with them.
    """
    generator = torch.Generator().manual_seed(0)
    depth = 1 if metadata.reads_pictures else metadata.channels
    coarse = torch.randn(images, depth, 8, 8, generator=generator)
    smooth = interpolate(coarse, size=metadata.size, mode="bilinear", align_corners=False)
    mean, sd = (torch.tensor(numbers).view(1, -1, 1, 1) for numbers in (metadata.mean, metadata.sd))
    return (255 * (mean + sd * smooth)).clamp(0, 255).to(torch.uint8)
