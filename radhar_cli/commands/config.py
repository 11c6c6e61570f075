"""`radhar config`: the resolved config, and the schema of the file."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.options import Overrides

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
) -> None:
    """Print the config with every default filled in, as YAML.

    Example:

      radhar config show configs/quickstart.yaml --set snr_db=10
    """
    import yaml

    from radhar_cli.config import load_config, resolved

    values = resolved(load_config(config, set_ or []))
    typer.echo(
        yaml.safe_dump(values, sort_keys=False, default_flow_style=None, width=100), nl=False
    )


@app.command()
def schema() -> None:
    """Print the JSON Schema of the config file, for editors.

    Example:

      radhar config schema > radhar.schema.json
    """
    import json

    from radhar_cli.config import Config

    typer.echo(json.dumps(Config.model_json_schema(), indent=2))
