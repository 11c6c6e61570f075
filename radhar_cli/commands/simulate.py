"""`radhar simulate`: one scene with maps, ground truth and figures."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from radhar_cli.commands.learning_options import needs
from radhar_cli.commands.options import (
    Activity,
    Figures,
    Maps,
    Nominal,
    Overrides,
    ReplaceResults,
    Tolerance,
    refuse_to_replace_results,
    with_tolerance,
)
from radhar_cli.commands.tell import report, tell

RECORDING = "recording.h5"
FROM_FILE = "from_file"  # the class of `--motion` without `--activity`

if TYPE_CHECKING:
    from radhar_cli.config.reading import Override
    from radhar_cli.single_scene.simulate import Simulation


def simulate(
    config: Annotated[Path, typer.Argument(help="YAML config that the scene is drawn from.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results.")],
    activity: Activity = None,
    index: Annotated[
        int, typer.Option(min=0, help="Number of the sample within its class, as in /sample_key.")
    ] = 0,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=2**63 - 1, help="Seed of the scene; overrides the config."),
    ] = None,
    nominal: Nominal = False,
    motion: Annotated[
        Path | None,
        typer.Option("--motion", help="Motion file that the person follows (.bvh, .amc, .npz)."),
    ] = None,
    up: Annotated[
        str | None, typer.Option(help="With --motion: axis that points up in the file, such as y.")
    ] = None,
    joints: Annotated[
        Path | None,
        typer.Option(
            help="With --motion: YAML file of radhar's joints and their names in the motion file."
        ),
    ] = None,
    skeleton: Annotated[
        Path | None, typer.Option(help="With --motion: .asf file of an .amc, if not beside it.")
    ] = None,
    set_: Overrides = None,
    tolerance: Tolerance = None,
    maps: Maps = None,
    joint: Annotated[
        str | None, typer.Option(help="Simulate only this scatterer, such as right_ankle.")
    ] = None,
    overlay: Annotated[
        bool, typer.Option("--overlay", help="Draw the true Doppler of every joint over the maps.")
    ] = False,
    raw: Annotated[
        bool,
        typer.Option("--raw", help="Also write recording.h5: the beat matrix with static echoes."),
    ] = False,
    html: Annotated[
        bool, typer.Option("--html", help="Also write view.html: skeleton, maps, clouds in motion.")
    ] = False,
    figures: Figures = True,
    overwrite: ReplaceResults = False,
) -> None:
    """Simulate one scene: maps, ground truth and an animation.

    Writes scene.h5, scene.json, maps.png and an animated stickman. The maps are those of the
    config; `--maps all` makes every map that its radar can make.

    Example:

      radhar simulate configs/quickstart.yaml --activity walking --seed 7 -o out/walk
    """
    if html:
        needs("view", ("plotly",))

    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.config import load_config
    from radhar_cli.dataset.files import refuse_links
    from radhar_cli.dataset.folder import refuse_file, refuse_foreign_files
    from radhar_cli.errors import ConfigError
    from radhar_cli.processes.worker_process import prepare_process
    from radhar_cli.single_scene import scene_file
    from radhar_cli.single_scene.simulate import map_names
    from radhar_cli.single_scene.simulate import simulate as simulate_scene

    prepare_process()
    overrides = with_tolerance(set_, tolerance)
    if motion is not None:
        activity = activity or FROM_FILE
        reading = _reader_overrides(activity, up, joints, skeleton)
        overrides = [*_motion_file_overrides(motion, activity), *reading, *overrides]
    else:
        for option, value in (("up", up), ("joints", joints), ("skeleton", skeleton)):
            if value is not None:
                raise ConfigError(
                    f"--{option} {value}: should go with --motion, whose file it reads"
                )
    loaded = load_config(config, overrides)
    chosen = None if maps is None else map_names(maps.split(","), loaded)
    refuse_file(out)
    if not any((out / name).exists() for name in scene_file.FILES):
        refuse_foreign_files(out, "scene of radhar's", allowed=())
    for name in (*scene_file.FILES, RECORDING):
        refuse_links(out, out / name)
    refuse_to_replace_results(out, (*scene_file.FILES, RECORDING), overwrite)
    sample: dict[str, Any] = {"index": index, "nominal": nominal, "joint": joint}
    with BarProgress() as bars:
        simulation = simulate_scene(
            loaded, activity, seed, **sample, maps=chosen, raw=raw, progress=bars
        )
    samples, warnings = loaded.samples_of(simulation.activity), list[str]()
    if index >= samples and not nominal:
        warnings.append(
            f"--index {index}: a data set of this config has the samples 0 to {samples - 1} of "
            f"{simulation.activity.slug}; this one is drawn from its own stream in the same way"
        )
    for warning in (*warnings, *simulation.warnings):
        tell(f"warning: {warning}", err=True)
    written = scene_file.write_all(simulation, out)
    (out / RECORDING).unlink(missing_ok=True)  # of an earlier scene
    if raw:
        written.append(_write_recording(simulation, out / RECORDING))
    if figures:
        written += _draw_figures(simulation, out, overlay)
    if html:
        from radhar_cli.figures.scene_page import of_simulation, write_page

        write_page([of_simulation(simulation)], out / scene_file.PAGE)
        written.append(out / scene_file.PAGE)
    _print_summary(simulation, written)


def _print_summary(simulation: "Simulation", written: list[Path]) -> None:
    """Print what was simulated, and where the files lie."""
    from radhar_cli.single_scene.scene_file import describe

    activity = simulation.activity
    elapsed_s = sum(simulation.seconds.values())
    tell(f"{activity.label} {activity.slug}: synthesised in {elapsed_s:.2f} s")
    file = describe(simulation)["motion_file"]
    if file is not None:
        loop = f", in a loop that starts at {file['start_s']:.2f} s" if file["loops"] else ""
        tell(
            f"  motion: {file['path']}, {file['begin_s']:.2f} to {file['end_s']:.2f} s of its "
            f"{file['lasts_s']:.2f} s{loop}; {file['up']} is up; "
            f"leg length of a person of {file['stature_m']:.2f} m"
        )
    report(
        activity=activity.slug,
        label=activity.label,
        seconds=elapsed_s,
        warnings=simulation.warnings,
        files=written,
    )


def _write_recording(simulation: "Simulation", path: Path) -> Path:
    """Write the beat matrix of a scene as a recording; return its path."""
    from radhar_cli.capture.importing import write_simulated
    from radhar_cli.capture.recording import Label

    label, board = Label(label=simulation.activity.slug), simulation.board
    if board is not None:
        cube = simulation.frames["cube"]  # [frame, loop, virtual, sample]
        beat = cube.reshape(-1, *cube.shape[2:]).transpose(1, 2, 0)
        delays = [k * board.slot for k, _ in board.pairs]
        write_simulated(path, beat, simulation.waveform, label, board.pulses, delays)
    else:
        assert simulation.beat is not None
        write_simulated(path, simulation.beat[None], simulation.waveform, label)
    return path


def _motion_file_overrides(motion: Path, slug: str) -> list["Override"]:
    """Overrides that give a class one motion file: from its start, at its speed, not mirrored."""
    import json

    from radhar_cli.config.reading import Override

    values = {
        f"classes.{slug}.files": json.dumps([str(motion.absolute())]),
        "activities": json.dumps([slug]),
        f"classes.{slug}.start": "0",
        f"classes.{slug}.playback_speed": "1",
        f"classes.{slug}.mirror": "0",
    }
    return [Override(key, value, "--motion") for key, value in values.items()]


def _reader_overrides(
    slug: str, up: str | None, joints: Path | None, skeleton: Path | None
) -> list["Override"]:
    """Overrides that tell how to read the motion file of a class: --up, --joints, --skeleton."""
    import json

    from radhar_cli.config.documents import read_document
    from radhar_cli.config.reading import Override

    options = (
        ("up", up),
        ("joints", None if joints is None else read_document(joints)[0]),
        ("skeleton", None if skeleton is None else str(skeleton.absolute())),
    )
    return [
        Override(f"classes.{slug}.{key}", json.dumps(value), f"--{key}")
        for key, value in options
        if value is not None
    ]


def _draw_figures(simulation: "Simulation", out: Path, overlay: bool) -> list[Path]:
    """Write maps.png, the animation, and a board's frames and cloud; return their paths."""
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.figures import maps_panel, stickman
    from radhar_cli.single_scene.scene_file import ANIMATION, CLOUD, FRAMES, MAPS

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
