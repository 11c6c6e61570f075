"""The folder of one scene: its files, checks before they are written, and their summary."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from radhar_cli.commands.options import refuse_to_replace_results
from radhar_cli.commands.tell import report, tell

if TYPE_CHECKING:
    from radhar_cli.scene.single.simulate import Simulation

RECORDING = "recording{}.h5"
RECORDINGS = [RECORDING.format(end) for end in ("", "_sf1", "_sf2", "_sf3")]  # of subframes


@dataclass(frozen=True)
class SceneOutputs:
    """Files of a scene to write besides its data."""

    recording: bool  # recording.h5, of a scene that was simulated with its raw echo
    panels: bool  # maps, animation, a board's frames and points
    overlay: bool  # the true Doppler of every joint over the maps
    page: bool  # view.html


def require_scene_folder(out: Path, overwrite: bool) -> None:
    """Require that a folder can take the files of a scene.

    Args:
        out: the folder, which need not exist.
        overwrite: whether the files of an earlier scene may be replaced.

    Raises:
        FolderError: it is a file, holds other files or an earlier scene, or has links in it.
    """
    from radhar_cli.dataset.folder import refuse_file, refuse_foreign_files
    from radhar_cli.files.replacing import refuse_links
    from radhar_cli.scene.single import scene_file

    refuse_file(out)
    if not any((out / name).exists() for name in scene_file.FILES):
        refuse_foreign_files(out, "scene of radhar's", allowed=())
    for name in (*scene_file.FILES, *RECORDINGS):
        refuse_links(out, out / name)
    refuse_to_replace_results(out, (*scene_file.FILES, *RECORDINGS), overwrite)


def write_scene_folder(simulation: "Simulation", out: Path, outputs: SceneOutputs) -> list[Path]:
    """Write the files of a scene: its data, and the figures that are asked for.

    Args:
        simulation: the scene.
        out: folder of the files; those of an earlier scene are replaced or removed.
        outputs: files to write besides the data.

    Returns:
        Paths of the files.
    """
    from radhar_cli.scene.single import scene_file

    files = scene_file.write_all(simulation, out)
    for name in RECORDINGS:
        (out / name).unlink(missing_ok=True)  # of an earlier scene
    if outputs.recording:
        files += _write_recordings(simulation, out)
    if outputs.panels:
        files += _draw_figures(simulation, out, outputs.overlay)
    if outputs.page:
        from radhar_cli.figures.scene_page import of_simulation, write_page

        write_page([of_simulation(simulation)], out / scene_file.PAGE)
        files.append(out / scene_file.PAGE)
    return files


def _write_recordings(simulation: "Simulation", out: Path) -> list[Path]:
    """Write the samples of a scene as a recording, of a board one a subframe; return the paths."""
    from radhar_cli.capture.config_header import radar_note
    from radhar_cli.capture.importing import SimulatedPulses, write_simulated
    from radhar_cli.capture.recording import Label

    label, paths = Label(label=simulation.activity.slug), list[Path]()
    radar = radar_note(simulation.config)
    for end, (board, frames) in simulation.all_subframes.items():
        cube = frames["cube"]  # [frame, loop, virtual, sample]
        beat = cube.reshape(-1, *cube.shape[2:]).transpose(1, 2, 0)
        delays = board.delays[[k for k, _ in board.pairs]].tolist()
        paths.append(out / RECORDING.format(end))
        note = radar | ({"subframe": board.subframe} if board.subframe else {})
        pulses = SimulatedPulses(board.pulses, delays, board.bpm)
        write_simulated(paths[-1], beat, board.waveform, label, pulses, note)
    if simulation.board is None:
        assert simulation.beat is not None
        paths.append(out / RECORDING.format(""))
        beat, waveform = simulation.beat[None], simulation.waveform
        write_simulated(paths[-1], beat, waveform, label, radar=radar)
    return paths


def _draw_figures(simulation: "Simulation", out: Path, overlay: bool) -> list[Path]:
    """Write maps.png, the animation, and a board's frames and points; return their paths."""
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.figures import maps_panel, stickman
    from radhar_cli.scene.single.scene_file import ANIMATION, CLOUD, FRAMES, MAPS

    if simulation.maps:
        maps_panel.draw_maps(maps_panel.of_simulation(simulation, overlay), out / MAPS)
    with BarProgress() as bars:
        bars.stage(ANIMATION, stickman.frame_count(simulation), unit="frame")
        stickman.draw_stickman(simulation, out / ANIMATION, bars.advance)
        if simulation.board is not None and simulation.frames.keys() - {"cube"}:
            from radhar_cli.figures import frames_panel

            frames = frames_panel.of_simulation(simulation)
            frames_panel.draw_frames(frames, out / FRAMES)
            if "cloud" in simulation.frames:
                bars.stage(CLOUD, simulation.board.frames, unit="frame")
                frames_panel.draw_cloud(frames, out / CLOUD, bars.advance)
    return [out / name for name in (MAPS, ANIMATION, FRAMES, CLOUD) if (out / name).exists()]


def print_summary(simulation: "Simulation", files: list[Path]) -> None:
    """Print a summary of the scene, and its folder."""
    from radhar_cli.scene.single.scene_file import describe

    activity = simulation.activity
    elapsed_s = sum(simulation.seconds.values())
    tell(f"{activity.label} {activity.slug}: synthesised in {elapsed_s:.2f} s")
    clip = describe(simulation)["motion_file"]
    if clip is not None:
        loop = f", in a loop that starts at {clip['start_s']:.2f} s" if clip["loops"] else ""
        tell(
            f"  motion: {clip['path']}, {clip['begin_s']:.2f} to {clip['end_s']:.2f} s of its "
            f"{clip['lasts_s']:.2f} s{loop}; {clip['up']} is up, a unit is "
            f"{clip['unit_m']:.4g} m, {clip['rate_hz']:.4g} frames/s; "
            f"leg length of a person of {clip['stature_m']:.2f} m"
        )
    report(
        activity=activity.slug,
        label=activity.label,
        seconds=elapsed_s,
        warnings=simulation.warnings,
        files=files,
    )
