"""A trained network as an ONNX file that needs neither PyTorch nor radhar."""

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import interpolate

from radhar_cli.errors import FolderError
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.run_folder import RunError, RunMetadata, first_line, load_best
from radhar_cli.replacing import replacing

TOLERANCE = 1e-4


class _FromPixels(nn.Module):
    """The network with its normalisation in front: pixels as they come out of a PNG."""

    def __init__(self, model: nn.Module, normalisation: Normalisation) -> None:
        super().__init__()
        self.model, self.normalisation = model, normalisation

    def forward(self, pixels: Tensor) -> Tensor:
        logits: Tensor = self.model(self.normalisation(pixels))
        return logits


def export(run: Path, path: Path) -> float:
    """Write the best epoch's network as ONNX and compare the two on random images.

    The input `pixels` is uint8 [batch, 3, H, W], RGB; the output `logits` is float32 [batch,
    classes]. The file's metadata names the classes.

    Returns:
        The largest difference of a logit; relative to the largest logit where that is above 1.
    """
    import onnx
    import onnxruntime

    metadata, network = load_best(run)
    if metadata.input not in ("rgb", "gray"):
        raise RunError(f"{run}: {metadata.model} reads {metadata.input}; only images are exported")
    model = _FromPixels(network, metadata.normalisation).eval()
    pixels = _pixels(2, metadata)
    try:
        with warnings.catch_warnings(), torch.no_grad():
            warnings.simplefilter("ignore")
            program: Any = torch.onnx.export(
                model,
                (pixels,),
                dynamo=True,
                dynamic_shapes={"pixels": {0: torch.export.Dim("batch")}},
                input_names=["pixels"],
                output_names=["logits"],
                verbose=False,
            )
    except torch.onnx.errors.OnnxExporterError as error:
        raise RunError(
            f"{run}: PyTorch cannot write {metadata.model} as ONNX ({first_line(error)})"
        ) from None
    written = program.model_proto
    onnx.helper.set_model_props(
        written,
        {"classes": json.dumps(metadata.classes), "model": metadata.model, "input": metadata.input},
    )
    onnx.checker.check_model(written)
    content = written.SerializeToString()
    session = onnxruntime.InferenceSession(content, providers=["CPUExecutionProvider"])
    worst = 0.0
    for images in (1, 3):
        trial = _pixels(images, metadata)
        with torch.inference_mode():
            expected = model(trial).numpy()
        logits = session.run(["logits"], {"pixels": trial.numpy()})[0]
        scale = max(1.0, float(np.abs(expected).max()))
        worst = max(worst, float(np.abs(logits - expected).max()) / scale)
    if not worst <= TOLERANCE:
        raise RunError(
            f"{run}: ONNX Runtime's logits differ from PyTorch's by {worst:.2g}, more than "
            f"{TOLERANCE:g}; {path} was not written"
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as unfinished:
            unfinished.write_bytes(content)
    except OSError as error:
        raise FolderError(f"{path}: cannot be written ({error.strerror})") from None
    return worst


def _pixels(images: int, metadata: RunMetadata) -> Tensor:
    """Smooth random images, uint8 [images, 3, H, W], with the mean and spread of the training data.

    White noise would not do: far from what it was trained on, the network's products of branches
    grow without bound, and rounding errors with them.
    """
    generator = torch.Generator().manual_seed(0)
    coarse = torch.randn(images, 1, 8, 8, generator=generator)
    smooth = interpolate(coarse, size=metadata.size, mode="bilinear", align_corners=False)
    mean, sd = (torch.tensor(numbers).view(1, 3, 1, 1) for numbers in (metadata.mean, metadata.sd))
    return (255 * (mean + sd * smooth)).clamp(0, 255).to(torch.uint8)
