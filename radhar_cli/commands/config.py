"""`radhar config`: the resolved config, and the schema of the file."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.options import Overrides

if TYPE_CHECKING:
    from radhar_cli.config import Config
    from radhar_cli.learning.settings import TrainConfig

Training = Annotated[bool, typer.Option("--train", help="The file of train, not of generate.")]

app = typer.Typer(
    help="""Show a resolved config, or the JSON Schema of the file.

    Example:

      radhar config show configs/quickstart.yaml
    """
)


@app.command()
def show(
    config: Annotated[Path, typer.Argument(help="YAML file.")],
    set_: Overrides = None,
    train: Training = False,
) -> None:
    """Print the config with every default filled in, as YAML.

    Example:

      radhar config show configs/quickstart.yaml --set snr_db=10
    """
    from radhar_cli.config.identity import as_yaml
    from radhar_cli.config.reading import load_section

    typer.echo(as_yaml(load_section(_kind(train), config, set_ or [])), nl=False)


@app.command()
def schema(train: Training = False) -> None:
    """Print the JSON Schema of the config file, for editors.

    Example:

      radhar config schema > radhar.schema.json
    """
    import json

    typer.echo(json.dumps(_kind(train).model_json_schema(), indent=2))


def _kind(train: bool) -> "type[Config] | type[TrainConfig]":
    if train:
        from radhar_cli.learning.settings import TrainConfig

        return TrainConfig
    from radhar_cli.config import Config

    return Config
