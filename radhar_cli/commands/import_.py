"""`radhar import`: a capture of a real radar becomes a recording."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import Replace, refuse_to_replace
from radhar_cli.commands.tell import counted, report, tell


def import_(
    captures: Annotated[
        list[Path],
        typer.Argument(
            metavar="CAPTURE...",
            help="Capture: .bin of a DCA1000 (name only the first), .npy, .npz, .mat, HDF5, .wav, "
            "text; points: a dump of a TI demo's data port, or its visualizer's JSON.",
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Recording to write, such as walk.h5.")],
    radar: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Header: mmWave Studio's JSON or .lua, TI's .cfg, or YAML of radhar's keys.",
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="KEY=VALUE", help="Override a header field; may be repeated."
        ),
    ] = None,
    label: Annotated[str | None, typer.Option(help="Activity that was recorded.")] = None,
    person: Annotated[str | None, typer.Option(help="Person who was recorded.")] = None,
    overwrite: Replace = False,
) -> None:
    """Convert a capture of a real radar into a recording file, of samples or of points.

    Example:

      radhar import adc_data_Raw_0.bin --radar setup.mmwave.json --label walking -o walk.h5

    Prints what is found in the samples: offset binary, sign of the beat, gaps, losses, saturation.
    --set coding=signed and --set beat=positive override it. All keys: docs/guide/measured.md
    """
    import json

    from radhar_cli.capture.importing_points import is_point_capture
    from radhar_cli.errors import FolderError

    named = {"label": label, "person": person}
    overrides = [f"{key}={json.dumps(value)}" for key, value in named.items() if value is not None]
    if missing := [str(path) for path in captures if not path.exists()]:
        raise FolderError(f"{missing[0]}: no such file")
    if out.resolve() in {path.resolve() for path in captures}:
        raise FolderError(f"{out}: is the capture itself; -o should name another file")
    refuse_to_replace(out, overwrite, "walk.h5")
    values = [*(set_ or []), *overrides]
    if is_point_capture(captures[0]):
        _import_points(captures, out, radar, values, overwrite)
    else:
        _import_samples(captures, out, radar, values, overwrite)


def _import_samples(
    captures: Sequence[Path], out: Path, radar: Path | None, values: Sequence[str], overwrite: bool
) -> None:
    """Import a capture of samples, and say what was found."""
    from radhar_cli.capture.content import SlowTime
    from radhar_cli.capture.importing import import_capture, read_settings

    settings = read_settings(radar, values)
    info = import_capture(captures, out, settings, str(radar) if radar else "--set", overwrite)
    for line in info.source.findings:
        tell(f"  {line}")
    samples = None if isinstance(info.content, SlowTime) else info.content.samples
    shape = f"{counted(info.receivers, 'receiver')}, {samples or 'no'} samples a chirp, "
    tell(f"{info.pulses} pulses at {info.prf_hz:.6g} Hz: {shape}{info.carrier_hz / 1e9:.6g} GHz")
    report(
        files=[out],
        found=info.source.findings,
        receivers=info.receivers,
        samples_per_chirp=samples,
        pulses=info.pulses,
        prf_hz=info.prf_hz,
        carrier_hz=info.carrier_hz,
    )


def _import_points(
    captures: Sequence[Path], out: Path, radar: Path | None, values: Sequence[str], overwrite: bool
) -> None:
    """Import a dump of points, or replay files, and say what was found."""
    from radhar_cli.capture.importing_points import import_points, read_point_header

    info = import_points(captures, out, read_point_header(radar, values), overwrite)
    for line in info.source.findings:
        tell(f"warning: {line}", err=True)
    total = f"{counted(info.points, 'point')}, {info.points / info.frames:.1f} a frame"
    targets = f", {counted(info.targets, 'target')}" if info.targets else ""
    tell(f"{info.frames} frames every {info.frame_s * 1e3:.6g} ms: {total}{targets}; {info.demo}")
    report(
        files=[out],
        found=info.source.findings,
        frames=info.frames,
        lost_frames=info.lost_frames,
        points=info.points,
        targets=info.targets,
        frame_s=info.frame_s,
    )
