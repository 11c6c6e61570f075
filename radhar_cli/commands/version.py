"""`radhar --version`: the versions that decide bytes."""

from typing import Annotated

import typer

from radhar_cli.commands.tell import tell

LIBRARIES = ("numpy", "scipy", "h5py", "Pillow", "isal", "numba", "pyfftw", "torch")


def _print_versions(requested: bool) -> None:
    """Print the versions and end the program, if it was requested."""
    if not requested:
        return
    import platform
    from importlib.metadata import PackageNotFoundError, version

    from radhar_cli.dataset.build_version import build_version

    versions = [f"Python {platform.python_version()}"]
    for library in LIBRARIES:
        try:
            versions.append(f"{library} {version(library)}")
        except PackageNotFoundError:
            versions.append(f"no {library}")
    tell(f"radhar {build_version()}\n{', '.join(versions)}")
    raise typer.Exit


def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_versions,
            is_eager=True,
            help="Print the versions of radhar and its libraries, and exit.",
        ),
    ] = False,
) -> None:
    """Options of the program itself, before any command."""
