"""`radhar import`: a capture of a real radar becomes a recording."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import Replace, refuse_to_replace
from radhar_cli.commands.tell import counted, report, tell
from radhar_cli.errors import FolderError

if TYPE_CHECKING:
    from radhar_cli.capture.recording import RecordingInfo


def import_(
    captures: Annotated[
        list[Path],
        typer.Argument(
            metavar="CAPTURE...",
            help="Capture: .bin of a DCA1000 (name only the first), .npy, .npz, .mat, HDF5, .wav, "
            "text, .dat of XeThru, .zip, or a folder of a file a frame; points: a dump "
            "of a TI demo's data port, or its visualizer's JSON.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Recording to write, such as walk.h5.")
    ] = None,
    radar: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Header: mmWave Studio's JSON or .lua, TI's .cfg, Infineon's JSON, a built-in "
            "radar's name, YAML of radhar's keys, or a config.",
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
    """Convert a capture of a real radar into a recording file.

    Example:

      radhar import adc_data_Raw_0.bin --radar setup.mmwave.json --label walking -o walk.h5

    The recording is of samples, or of points that a board has sent.

    Prints what is found in the samples: offset binary, sign of the beat, gaps, losses, saturation.
    --set coding=signed and --set beat=positive override it. All keys: docs/guide/measured.md
    """
    import json

    from radhar_cli.capture.importing_points import is_point_capture

    named = {"label": label, "person": person}
    overrides = [f"{key}={json.dumps(value)}" for key, value in named.items() if value is not None]
    if missing := [str(path) for path in captures if not path.exists()]:
        raise FolderError(f"{missing[0]}: no such file")
    captures = [path for capture in captures for path in _files_of(capture)]
    if out is not None:
        _require_new(out, captures, overwrite)
    if empty := [str(path) for path in captures if path.is_file() and not path.stat().st_size]:
        raise FolderError(f"{empty[0]}: is empty")
    options = [] if radar is None else ["--radar", str(radar)]
    options += [word for text in set_ or [] for word in ("--set", text)]
    options += [
        word for key, text in named.items() if text is not None for word in (f"--{key}", text)
    ]
    if radar is not None and not radar.exists():
        radar = _built_in_header(str(radar))
    values = [*(set_ or []), *overrides]
    is_of_points = is_point_capture(captures[0])
    if out is None:
        _refuse_without_out(captures, radar, values, options, is_of_points)
    elif is_of_points:
        _import_points(captures, out, radar, values, overwrite)
    else:
        _import_samples(captures, out, radar, values, overwrite)


def _refuse_without_out(
    captures: Sequence[Path],
    radar: Path | None,
    values: Sequence[str],
    options: Sequence[str],
    is_of_points: bool,
) -> None:
    """Refuse an import without -o, and name the other missing options, with a command line.

    Args:
        captures: files of the capture.
        radar: file of the header.
        values: overrides of the header.
        options: words of the options of the command.
        is_of_points: whether the capture is of points.

    Raises:
        CaptureError: keys are missing, too.
        FolderError: all else is there.
    """
    from radhar_cli.capture.importing import require_header
    from radhar_cli.capture.subframes import read_subframes
    from radhar_cli.errors import CaptureError

    if not is_of_points:
        subframes = read_subframes(radar, values).values()
        try:
            require_header(captures, subframes, str(radar) if radar else "--set")
        except CaptureError as error:
            raise CaptureError(f"-o, the recording to write, is missing; {error}") from None
    files = shlex.join(map(str, captures[:3])) + " ..." * (len(captures) > 3)
    name = captures[0].name.partition(".")[0]
    more = shlex.join([*options, "-o", f"{name}.h5"])
    raise FolderError(f"-o, the recording to write, is missing: radhar import {files} {more}")


def _require_new(out: Path, captures: Sequence[Path], overwrite: bool) -> None:
    """Refuse a recording that is the capture itself, or that exists and is not to be replaced.

    Raises:
        FolderError: it is refused.
    """
    if out.resolve() in {path.resolve() for path in captures}:
        raise FolderError(f"{out}: is the capture itself; -o should name another file")
    refuse_to_replace(out, overwrite, "walk.h5")


def _files_of(capture: Path) -> list[Path]:
    """Files of a capture: itself, or those of a folder in the order of the numbers in their names.

    Raises:
        FolderError: a folder has no files, or those of several kinds.
    """
    from radhar_cli.readers.captures.packed_files import order_by_number

    if not capture.is_dir():
        return [capture]
    files = [path for path in capture.iterdir() if path.is_file() and path.name[0] != "."]
    suffixes = sorted({path.suffix.lower() for path in files})
    if len(suffixes) != 1:
        raise FolderError(
            f"{capture}: is a folder of {len(files)} files ({', '.join(suffixes) or 'none'}); "
            "should hold those of a capture alone, a file a frame, or name the files"
        )

    return sorted(files, key=lambda path: order_by_number(path.name))


def _built_in_header(name: str) -> Path:
    """Path of the .cfg, or of the preset, of a built-in radar that a name stands for.

    Raises:
        FolderError: there is no such radar; lists them.
    """
    from radhar_cli.config.documents import PRESETS, RADARS, WRITTEN_RADARS, name_of_radar
    from radhar_cli.errors import did_you_mean

    known = name_of_radar(name)
    if known is not None:
        return RADARS[known]
    if name in WRITTEN_RADARS:
        return PRESETS[f"boards/{name}"]
    names = [*RADARS, *WRITTEN_RADARS]
    hint = did_you_mean(name, names, "")
    raise FolderError(
        f"--radar {name}: no such file, and no radar that radhar comes with; "
        f"{hint}{' ' * bool(hint)}there are {', '.join(names)}"
    )


def _import_samples(
    captures: Sequence[Path], out: Path, radar: Path | None, values: Sequence[str], overwrite: bool
) -> None:
    """Import a capture of samples, a recording a subframe, and print the findings."""
    from radhar_cli.capture.importing import import_subframes
    from radhar_cli.capture.subframes import read_subframes, recording_of_subframe

    subframes = read_subframes(radar, values)
    if len(subframes) == 1:
        recordings = dict.fromkeys([out], *subframes.values())
    else:
        recordings = {recording_of_subframe(out, n): s for n, s in subframes.items()}
    for path in recordings:
        _require_new(path, captures, overwrite)
    where = str(radar) if radar else "--set"
    infos = import_subframes(captures, recordings, where, overwrite)
    results = list[dict[str, object]]()
    for number, info in zip(subframes, infos, strict=True):
        if len(infos) > 1:
            tell(f"subframe {number}:")
        results.append(_tell_recording(info))
    more = {"subframes": results} if len(results) > 1 else {}
    report(files=[*recordings], **results[0], **more)


def _tell_recording(info: "RecordingInfo") -> dict[str, object]:
    """Print the findings in the samples of a recording; return them by key."""
    from radhar_cli.capture.content import SlowTime

    for line in info.source.findings:
        tell(f"  {line}")
    samples = None if isinstance(info.content, SlowTime) else info.content.samples
    shape = f"{counted(info.receivers, 'receiver')}, {samples or 'no'} samples a chirp, "
    tell(f"{info.pulses} pulses at {info.prf_hz:.6g} Hz: {shape}{info.carrier_hz / 1e9:.6g} GHz")
    return {
        "found": info.source.findings,
        "receivers": info.receivers,
        "samples_per_chirp": samples,
        "pulses": info.pulses,
        "prf_hz": info.prf_hz,
        "carrier_hz": info.carrier_hz,
    }


def _import_points(
    captures: Sequence[Path], out: Path, radar: Path | None, values: Sequence[str], overwrite: bool
) -> None:
    """Import a dump of points, or replay files, and print the findings."""
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
