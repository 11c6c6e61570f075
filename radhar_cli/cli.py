"""The `radhar` program: registers the commands, turns our errors into one message and a status."""

import sys

import typer

from radhar_cli.commands import config, generate, verify
from radhar_cli.errors import RadharError

app = typer.Typer(
    help="Labelled FMCW radar data sets for human activity recognition, from a YAML file.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command()(generate.generate)
app.command()(verify.verify)
app.add_typer(config.app, name="config", no_args_is_help=True)


@app.callback()
def _program() -> None:
    """Labelled FMCW radar data sets for human activity recognition, from a YAML file."""


def main() -> None:
    """Run the program; bad input ends with its message and status 2."""
    try:
        app()
    except RadharError as error:
        print(f"radhar: {error}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:
        sys.stderr.close()
        sys.exit(1)
