"""`radhar simulate`: one scene with maps, ground truth and figures."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

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
    find_activity,
    with_tolerance,
)
from radhar_cli.commands.scene_folder import (
    SceneOutputs,
    print_summary,
    require_scene_folder,
    write_scene_folder,
)
from radhar_cli.commands.tell import for_each_radar, tell

FROM_FILE = "from_file"  # the class of `--motion` without `--activity`

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from radhar_cli.config.reading import Override
    from radhar_cli.scene.single.request import SceneRequest
    from radhar_cli.scene.single.simulate import Simulation


def simulate(
    config: Annotated[Path, typer.Argument(help="YAML config that the scene is drawn from.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the results.")],
    activity: Activity = None,
    index: Annotated[
        int, typer.Option(min=0, help="Number of the sample within its class, from 0.")
    ] = 0,
    seed: Annotated[
        int | None,
        typer.Option(min=0, max=2**63 - 1, help="Seed of the scene; overrides the config."),
    ] = None,
    nominal: Nominal = False,
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion",
            help="Motion file that the person follows: .bvh, .npz, ...; or a folder of JSON.",
        ),
    ] = None,
    up: Annotated[
        str | None, typer.Option(help="With --motion: axis that points up in the file, such as y.")
    ] = None,
    joints: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|SET",
            help="With --motion: YAML file of radhar's joints and their names in the motion file, "
            "or the joint set in whose order its joints are, such as coco17.",
        ),
    ] = None,
    rate: Annotated[
        float | None, typer.Option(help="With --motion: frames per second of the file.")
    ] = None,
    unit: Annotated[
        float | None, typer.Option(help="With --motion: metres per unit of the file.")
    ] = None,
    section: Annotated[
        str | None,
        typer.Option(
            metavar="FROM,TO", help="With --motion: seconds of the file that are used, such as 2,5."
        ),
    ] = None,
    travel: Annotated[
        str | None,
        typer.Option(
            metavar="file|feet",
            help="With --motion: whether the hips go as the file says, or as the feet tell.",
        ),
    ] = None,
    left_handed: Annotated[
        bool,
        typer.Option(
            "--left-handed",
            help="With --motion: its axes are left-handed, or its camera mirrors.",
        ),
    ] = False,
    skeleton: Annotated[
        Path | None,
        typer.Option(help="With --motion: .asf file of an .amc. The default is the one beside it."),
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
        bool,
        typer.Option(
            "--html", help="Also write view.html, a page that plays skeleton, maps and points."
        ),
    ] = False,
    figures: Figures = True,
    overwrite: ReplaceResults = False,
) -> None:
    """Simulate one scene: maps, ground truth and an animation.

    Writes scene.h5, scene.json, scene.yaml, maps.png and stickman.gif. The maps are those of the
    config; `--maps all` makes every map that its radar can make.

    Example:

      radhar simulate quickstart --activity walking --seed 7 -o out/walk
    """
    if html:
        needs("plotly")

    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.config.reading import load_radars
    from radhar_cli.processes.worker_process import prepare_process
    from radhar_cli.scene.single.request import SceneRequest, map_names
    from radhar_cli.scene.single.simulate import simulate_scene

    prepare_process()
    if motion is not None:
        activity = activity or FROM_FILE
    reading = {
        "up": up,
        "joints": joints,
        "skeleton": skeleton,
        "rate": rate,
        "unit": unit,
        "section": section,
        "travel": travel,
        "left-handed": left_handed or None,
    }
    overrides = _motion_overrides(activity or FROM_FILE, motion, reading)
    configs = load_radars(config, [*overrides, *with_tolerance(set_, tolerance)])
    requests = dict[str, SceneRequest]()
    for name, loaded in configs.items():
        chosen_maps = None if maps is None else map_names(maps.split(","), loaded)
        person = find_activity(activity, loaded, says_word=not requests)
        scene = person, seed, index, nominal, joint
        requests[name] = SceneRequest(loaded, *scene, chosen_maps, raw)
    folders = _reserve_folders(out, configs, overwrite)
    outputs = SceneOutputs(raw, figures, overlay, html)

    def simulate_radar(name: str, request: "SceneRequest") -> None:
        with BarProgress() as bars:
            simulation = simulate_scene(request, bars)
        for warning in (*_index_warnings(request, simulation), *simulation.warnings):
            tell(f"warning: {f'radar {name}: ' if name else ''}{warning}", err=True)
        print_summary(simulation, write_scene_folder(simulation, folders[name], outputs))

    for_each_radar(requests, simulate_radar)


def _reserve_folders(out: Path, names: "Iterable[str]", overwrite: bool) -> dict[str, Path]:
    """Take the folder of each radar of a scene: {"": out} of one that has no name.

    Raises:
        FolderError: one of them cannot take the files of a scene.
    """
    from radhar_cli.dataset.radar_folders import reserve_radars

    listed = [*names]
    folders = {"": out} if listed == [""] else reserve_radars(out, listed)
    for folder in folders.values():
        require_scene_folder(folder, overwrite)
    return folders


def _index_warnings(request: "SceneRequest", simulation: "Simulation") -> list[str]:
    """Warn of a sample that no data set of the config has."""
    activity = simulation.activity
    samples = request.config.samples_of(activity)
    if request.nominal or request.index < samples:
        return []
    return [
        f"--index {request.index}: a data set of this config has the samples 0 to {samples - 1} of "
        f"{activity.slug}; this one is drawn from its own stream in the same way"
    ]


def _motion_overrides(
    slug: str, motion: Path | None, reading: "Mapping[str, str | float | Path | None]"
) -> list["Override"]:
    """Overrides that make a class follow a motion file, and say how to read it.

    Args:
        slug: slug of the class.
        motion: value of --motion, the file; None without it.
        reading: {option: value} of those that say how to read it; None where it is not given.

    Raises:
        ConfigError: one of the latter is given without the first.
    """
    from radhar_cli.errors import ConfigError

    values = {option: value for option, value in reading.items() if value is not None}
    if motion is not None:
        return [*_motion_file_overrides(motion, slug), *_reader_overrides(slug, values)]
    for option, value in values.items():
        raise ConfigError(f"--{option} {value}: should go with --motion, whose file it reads")
    return []


def _motion_file_overrides(motion: Path, slug: str) -> list["Override"]:
    """Overrides that give a class one motion file: from its start, at its speed, not mirrored."""
    import json

    from radhar_cli.config.reading import Override
    from radhar_cli.errors import ConfigError
    from radhar_cli.readers.motion.reading import describe_unknown, may_be_motion

    is_folder = motion.is_dir()
    if not (may_be_motion(str(motion)) or is_folder):
        raise ConfigError(f"--motion {motion}: {describe_unknown(motion)}")
    values = {
        f"classes.{slug}.files": json.dumps([str(motion.absolute()) + "/" * is_folder]),
        "activities": json.dumps([slug]),
        f"classes.{slug}.start": "0",
        f"classes.{slug}.playback_speed": "1",
        f"classes.{slug}.mirror": "0",
    }
    return [Override(key, value, "--motion") for key, value in values.items()]


def _reader_overrides(slug: str, reading: "Mapping[str, str | float | Path]") -> list["Override"]:
    """Overrides that tell how to read the motion file of a class: --up, --joints and so on."""
    import json

    from radhar_cli.config.reading import Override

    values: dict[str, object] = {**reading}
    if "joints" in reading:
        values["joints"] = _joints_of(str(reading["joints"]))
    if "skeleton" in reading:
        values["skeleton"] = str(Path(str(reading["skeleton"])).absolute())
    if "section" in reading:
        values["section"] = _section_of(str(reading["section"]))
    keys = {
        "rate": "rate_hz",
        "unit": "unit_m",
        "section": "section_s",
        "left-handed": "left_handed",
    }
    return [
        Override(f"classes.{slug}.{keys.get(option, option)}", json.dumps(value), f"--{option}")
        for option, value in values.items()
    ]


def _joints_of(text: str) -> object:
    """Joints that --joints says: a joint set, or what a YAML file has."""
    from radhar_cli.config.documents import read_document
    from radhar_cli.motion.recorded.joint_sets import JOINT_SETS

    is_set = text in JOINT_SETS or not (Path(text).suffix or Path(text).exists())
    return text if is_set else read_document(Path(text))[0]


def _section_of(text: str) -> list[float]:
    """Seconds [from, to] that --section says.

    Raises:
        ConfigError: it is not two numbers.
    """
    from radhar_cli.errors import ConfigError

    try:
        begin, end = map(float, text.split(","))
    except ValueError:
        raise ConfigError(
            f"--section {text}: should be FROM,TO in seconds of the file, such as 2,5"
        ) from None
    return [begin, end]
