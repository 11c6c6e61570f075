"""What commands say; nothing else in them writes to the terminal, but for bars and tables."""

import typer

from radhar_cli.untrusted import shown


def tell(message: object, *, err: bool = False, nl: bool = True) -> None:
    """Print a line; what in it could steer a terminal is escaped."""
    typer.echo(shown(message), err=err, nl=nl)
