"""`radhar export`: a trained network as ONNX."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Run
from radhar_cli.commands.options import Replace, refuse_to_replace
from radhar_cli.commands.tell import report, tell


def export(
    run: Run,
    out: Annotated[Path, typer.Option("-o", "--out", help="File to write, such as model.onnx.")],
    overwrite: Replace = False,
) -> None:
    """Export a network as ONNX, checked with ONNX Runtime.

    Example:

      radhar export runs/quickstart -o quickstart.onnx
    """
    from radhar_cli.commands.learning_options import needs, needs_torch

    needs_torch()
    needs("onnx", "onnxscript", "onnxruntime")
    from radhar_cli.learning.onnx_export import TOLERANCE, export

    refuse_to_replace(out, overwrite, "model.onnx")
    worst = export(run, out)
    size = out.stat().st_size
    report(file=out, bytes=size, largest_difference=float(worst), allowed=TOLERANCE)
    tell(
        f"{out}: {size / 2**20:.1f} MiB; ONNX Runtime agrees with PyTorch to {worst:.1e} (allowed "
        f"{TOLERANCE:g})"
    )
