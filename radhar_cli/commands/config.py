"""`radhar config`: start a config, or show it resolved."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import Overrides
from radhar_cli.commands.tell import report, tell

if TYPE_CHECKING:
    from radhar_cli.config import Config
    from radhar_cli.learning.settings import TrainConfig

Training = Annotated[
    bool, typer.Option("--train", help="A training config instead of a data set's.")
]


def group() -> typer.Typer:
    """The subcommands."""
    app = typer.Typer(
        help="""Write or show configs.

        Example:

          radhar config show quickstart
        """
    )
    for command in (init, show, schema):
        app.command()(command)
    app.command("list")(list_configs)
    return app


def init(
    out: Annotated[Path, typer.Argument(help="YAML file to write.")] = Path("radhar.yaml"),
    train: Training = False,
    radar: Annotated[
        str | None,
        typer.Option(
            "--radar",
            help="Write a short config for a radar, given by its name, such as bgt60tr13c or "
            "iwr6843isk_people, or by the .cfg file of a TI board; `list` lists them.",
        ),
    ] = None,
    minimal: Annotated[
        bool, typer.Option("--minimal", help="Write about 15 lines instead of every key.")
    ] = False,
    preset: Annotated[
        str | None,
        typer.Option(
            "--preset",
            metavar="NAME",
            help="Write a config that radhar comes with, such as quickstart, human/room or "
            "train/paper; `list` lists them.",
        ),
    ] = None,
) -> None:
    """Write a config to start from: short, complete, or a preset.

    Example:

      radhar config init mine.yaml --minimal

      radhar config init room.yaml --preset human/room

      radhar config init --radar list
    """
    from radhar_cli.config.documents import find_preset, name_of_written
    from radhar_cli.config.starting_file import (
        MINIMAL,
        as_commented_yaml,
        of_board,
        of_preset,
        starting_notes,
    )
    from radhar_cli.errors import FolderError, RadharError
    from radhar_cli.files.replacing import write_text

    if radar == "list":
        _list_radars()
        return
    if preset == "list":
        list_configs()
        return
    if out.exists() or out.is_symlink() or not out.parent.is_dir():
        why = "exists already" if out.parent.is_dir() else "there is no such folder"
        raise FolderError(f"{out}: {why}; should be a new file")
    if (radar is not None) + train + minimal + (preset is not None) > 1:
        raise RadharError("--radar, --train, --minimal and --preset: should be only one of them")
    if radar is not None:
        text = of_board(radar, out.parent)
        write_text(out, text)
        report(file=out)
        device = "; radar.device should be the one that runs it"
        tell(f"{out}: the radar of {radar}{device * (name_of_written(radar) is None)}")
        for note in starting_notes(text) if name_of_written(radar) is None else ():
            tell(f"  {note}")
        tell(f"  then        radhar simulate {out} --activity punching -o OUT")
        return
    if preset is not None:
        write_text(out, of_preset(preset))
        report(file=out)
        train = (find_preset(preset) or "").startswith("train/")
        tell(f"  then        radhar {'train DATA --config' if train else 'generate'} {out} -o OUT")
        return
    write_text(out, MINIMAL if minimal else as_commented_yaml(_kind(train)))
    report(file=out)
    if not minimal:
        tell(f"{out}: every key with its default; delete those that should keep it")
    tell(f"  then        radhar {'train DATA --config' if train else 'generate'} {out} -o OUT")


def _list_radars() -> None:
    """Print the radars that radhar comes with, one a line."""
    from radhar_cli.config.built_in_radars import read_radars
    from radhar_cli.config.documents import WRITTEN_RADARS

    radars = {radar.name: radar.description for radar in read_radars()}
    radars |= {name: _describe_written(name) for name in WRITTEN_RADARS}
    report(radars=radars)
    width = max(map(len, radars))
    for name, description in radars.items():
        tell(f"{name:{width}}  {description}")


def list_configs() -> None:
    """List the configs that radhar comes with.

    Their names go where a config is asked for: `radhar generate human/room -o datasets/room`.

    Example:

      radhar config list
    """
    from radhar_cli.config.documents import PRESETS
    from radhar_cli.config.starting_file import describe_preset

    presets = {name: describe_preset(name) for name in PRESETS}
    report(presets=presets)
    width = max(map(len, presets))
    for name, description in presets.items():
        tell(f"{name:{width}}  {description}")


def _describe_written(name: str) -> str:
    """Describe a radar whose numbers stand in its config, with its resolutions."""
    from radhar_cli.config import load_config
    from radhar_cli.config.documents import PRESETS
    from radhar_cli.config.starting_file import describe_written
    from radhar_cli.scene.radar_figures import describe_figures, figures_of
    from radhar_cli.scene.scene import draw_scene

    config = load_config(PRESETS[f"boards/{name}"])
    scene = draw_scene(config, config.chosen_activities[0], 0)
    return f"{describe_written(name)}; {describe_figures(figures_of(scene))}"


def show(
    config: Annotated[Path, typer.Argument(help="YAML file.")],
    set_: Overrides = None,
    train: Training = False,
) -> None:
    """Print a config with its defaults and bases filled in.

    Example:

      radhar config show quickstart --set snr_db=10
    """
    from radhar_cli.config.identity import resolved, resolved_together, yaml_text
    from radhar_cli.config.reading import load_section, load_sections

    if train:
        document = resolved(load_section(_kind(train), config, set_ or []))
    else:
        document = resolved_together(load_sections(config, set_ or []))
    report(**document)
    tell(yaml_text(document), nl=False)


def schema(
    out: Annotated[
        Path | None, typer.Argument(help="File to write. The default is standard output.")
    ] = None,
    train: Training = False,
) -> None:
    """Print the JSON schema of configs, for editors that complete keys.

    Example:

      radhar config schema radhar.schema.json
    """
    import json

    from radhar_cli.config.json_schema import json_schema
    from radhar_cli.files.replacing import write_text

    text = json.dumps(json_schema(_kind(train)), indent=1)
    if out is None:
        tell(text)
        return
    write_text(out, f"{text}\n")
    report(file=out)
    tell(f"{out}: a config whose first line is the next one is completed by editors")
    tell(f"  # yaml-language-server: $schema={out}")


def _kind(train: bool) -> "type[Config] | type[TrainConfig]":
    if train:
        from radhar_cli.learning.settings import TrainConfig

        return TrainConfig
    from radhar_cli.config import Config

    return Config
