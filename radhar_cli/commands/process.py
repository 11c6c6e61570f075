"""`radhar process`: the maps of a recording, processed as a config describes."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import (
    Figures,
    Maps,
    Overrides,
    ReplaceResults,
    refuse_to_replace_results,
)
from radhar_cli.commands.tell import counted, report, tell
from radhar_cli.errors import FolderError

if TYPE_CHECKING:
    from radhar_cli.capture.recording import RecordingInfo
    from radhar_cli.capture.tracking import TorsoTrack
    from radhar_cli.config import Config

# A track that stays within these, m and m/s, moves less than somebody who breathes.
RESTING_M, RESTING_MPS = 0.01, 0.01


def process(
    recording: Annotated[
        Path, typer.Argument(help="Recording written by import or simulate --raw.")
    ],
    config: Annotated[
        Path | None,
        typer.Option(
            help="YAML config, whose processing, image and maps are used; slow time needs none."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Folder for the results.")] = None,
    set_: Overrides = None,
    maps: Maps = None,
    start: Annotated[
        float | None, typer.Option(min=0, help="Start of the part to process, in s.")
    ] = None,
    stop: Annotated[
        float | None, typer.Option(min=0, help="End of the part to process, in s.")
    ] = None,
    receiver: Annotated[
        int | None,
        typer.Option(
            min=0, help="Number of the receiver to use. The default is the sum of all powers."
        ),
    ] = None,
    figures: Figures = True,
    overwrite: ReplaceResults = False,
) -> None:
    """Compute the maps of a recording, and track the torso.

    Writes maps.h5 and maps.png.

    Example:

      radhar process walk.h5 --config paper/free_space --maps rtm,stft -o out/walk
    """
    from radhar_cli.capture import maps_file
    from radhar_cli.capture.board_frames import OF_FRAMES, frames_of_recording
    from radhar_cli.capture.chain import maps_of, part_of
    from radhar_cli.capture.content import radar_section
    from radhar_cli.capture.recording import Recording
    from radhar_cli.capture.usual_config import has_usual_config
    from radhar_cli.config import resolved
    from radhar_cli.config.checks.unused_keys import unused_keys
    from radhar_cli.config.data_set import ProcessedConfig
    from radhar_cli.config.reading import validated
    from radhar_cli.scene.scene import nominal_scene
    from radhar_cli.scene.single.request import map_names

    if out is None or (config is None and not has_usual_config(recording)):
        raise _describe_missing(recording, config, out)
    loaded = _load_config(recording, config, set_ or [])
    fixed = nominal_scene(loaded, loaded.every_class[0]).config
    names = loaded.maps if maps is None else map_names(maps.split(","), loaded)
    _require_folder(out, overwrite)
    frames = [product for name in names for product in OF_FRAMES.get(name, ())]
    signals = tuple(name for name in names if name not in OF_FRAMES)
    with Recording(recording) as opened:
        info, gaps = opened.info, len(opened.segments) - 1
        part = part_of(opened, start, stop, receiver)
        document = resolved(fixed) | {"duration_s": part.pulses / info.prf_hz}
        radar = radar_section(document["radar"], info.content)
        document |= {"maps": signals or ("rtm",), "radar": radar}
        if signals or fixed.radar.has_range:  # else no map but those of frames
            validated(ProcessedConfig, document, str(config or "--set"), *loaded._places)
        results = maps_of(opened, fixed, signals, start, stop, receiver)
        if frames:
            products, results.board = frames_of_recording(opened, fixed, frames, start, stop)
            results.add_products_of_frames(products)
    if gaps:
        tell(f"{counted(gaps, 'gap')}: the stretches between are processed separately")
    if results.track is not None and not results.track.is_reliable:
        results.notes.append(_describe_doubt(results.track))
    for note in [*unused_keys(loaded.model_copy(update={"maps": names})), *results.notes]:
        tell(f"warning: {note}", err=True)
    written = maps_file.write_maps(results, loaded, info, out)
    if figures:
        written += maps_file.draw(results, loaded, _title(recording, info), out)
    if results.track is not None:
        tell(_describe_track(results.track))
    report(files=written, gaps=gaps, warnings=results.notes, maps=names)


def _load_config(recording: Path, config: Path | None, overrides: Sequence[str]) -> "Config":
    """Read the config, or take the usual one of slow time, which is said."""
    from radhar_cli.capture.usual_config import usual_config
    from radhar_cli.config.data_set import ConfigOfRecordings
    from radhar_cli.config.reading import load_config

    if config is not None:
        return load_config(config, overrides, ConfigOfRecordings)
    tell("slow time without --config: maps stft, without what stands (processing.clutter mean)")
    return usual_config(recording, overrides)


def _describe_missing(recording: Path, config: Path | None, out: Path | None) -> FolderError:
    """Describe which of --config and -o are missing, with a command line that has both."""
    if not recording.exists():
        return FolderError(f"{recording}: no such file")
    values = {"--config": config, "-o": out}
    missing = [option for option, value in values.items() if value is None]
    fitting = shlex.join(["radhar", "fit", str(recording), "-o", "measured.yaml"])
    words = ["radhar", "process", str(recording), "--config", str(config or "measured.yaml")]
    command = shlex.join([*words, "-o", str(out or Path("out", recording.stem))])
    remark = "" if config else f"; `{fitting}` writes such a config, and any with `maps` will do"
    are = "are" if len(missing) > 1 else "is"
    return FolderError(f"{' and '.join(missing)} {are} missing: {command}{remark}")


def _require_folder(out: Path, overwrite: bool) -> None:
    """Refuse a file, links, or earlier results that are not to be replaced, for a folder.

    Raises:
        FolderError: it is refused.
    """
    from radhar_cli.capture.maps_file import FILES
    from radhar_cli.dataset.folder import refuse_file
    from radhar_cli.files.replacing import refuse_links

    refuse_file(out)
    for name in FILES:
        refuse_links(out, out / name)
    refuse_to_replace_results(out, FILES, overwrite)


def _title(recording: Path, info: "RecordingInfo") -> str:
    """Title of the figures of a recording: its file, labels, carrier and PRF."""
    labels = ", ".join(label.label for label in info.labels) or "no label"
    carrier = f"{info.carrier_hz / 1e9:g} GHz, PRF {info.prf_hz:.6g} Hz"
    return f"{recording.name}   |   {labels}   |   {carrier}"


def _describe_doubt(track: "TorsoTrack") -> str:
    """Describe where the track of the torso may be lost: in its last frames, or here and there."""
    unsure = (~track.is_sure).nonzero()[0]
    from_last_sure = track.is_sure.nonzero()[0].max(initial=-1) + 1
    lost = f"is unsure in {unsure.size} of {track.time.size} frames"
    if 2 * (track.time.size - from_last_sure) > unsure.size:
        lost = f"may be lost from {track.time[from_last_sure]:.2f} s on: it {lost}"
    return (
        f"the torso's track {lost}; maps that follow it (range_sum: gated, compensated) "
        "may miss the person"
    )


def _describe_track(track: "TorsoTrack") -> str:
    """Describe the range and the speed of the torso's track, with its confidence.

    What never moves need be no person, and is not called one.
    """
    nearest, farthest = track.range.min(), track.range.max()
    speed, confidence = abs(track.velocity).max(), track.confidence.mean()
    if speed < RESTING_MPS and farthest - nearest < RESTING_M:
        return f"something at rest at {nearest:.2f} m, confidence {confidence:.2f}"
    return (
        f"torso from {nearest:.2f} to {farthest:.2f} m, up to {speed:.2f} m/s, "
        f"confidence {confidence:.2f}"
    )
