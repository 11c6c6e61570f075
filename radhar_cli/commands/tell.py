"""Output of the commands, with --json and --quiet; they write to the terminal only through it.

A command tells people lines (`tell`) and programs values (`report`); the program gives the two
options to every command (`with_output_options`).
"""

import inspect
import json
from collections.abc import Callable, Mapping
from functools import wraps
from types import SimpleNamespace
from typing import Annotated, Any, TypeVar

import typer

from radhar_cli.files.plain_json import plain
from radhar_cli.files.untrusted import escaped
from radhar_cli.processes import interrupts

T = TypeVar("T")
Json = Annotated[bool, typer.Option("--json", help="Print the results as JSON, for programs.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print warnings and errors only.")]


_output = SimpleNamespace(json=False, quiet=False, parts=None)


def is_quiet() -> bool:
    """Whether --quiet is given: no progress is shown."""
    return bool(_output.quiet)


def tell(message: object, *, err: bool = False, nl: bool = True) -> None:
    """Print a line of text, unless --json or --quiet is given; control characters are escaped.

    Args:
        message: the line.
        err: print to standard error, also with --json and --quiet.
        nl: end the line.
    """
    if err or not (_output.json or _output.quiet):
        typer.echo(escaped(message), err=err, nl=nl)


def is_shown(message: str) -> bool:
    """Whether a message of progress is shown; with --quiet only warnings are."""
    return not _output.quiet or message.lstrip().startswith("warning")


def counted(count: int, noun: str) -> str:
    """A number and its noun, in the plural where it is not one: 1 sample, 2 samples."""
    return f"{count} {noun}{'s' * (count != 1)}"


def report(**values: Any) -> None:
    """Report the results of a command: with --json an object on a line, else a line for each file.

    Args:
        values: results by key (docs/reference/output.md); `files` are the paths that were written.
    """
    interrupts.check()  # before it is called done
    for path in values.get("files", ()):
        tell(f"  {path}")
    if _output.parts is not None:
        _output.parts |= values
    elif _output.json:
        typer.echo(json.dumps(plain(values), allow_nan=False))


def for_each_radar(work: Mapping[str, T], do: Callable[[str, T], None], **values: Any) -> None:
    """Do a command's work for each of several radars, and report the results of all together.

    Args:
        work: {name of the radar: what is done for it}; {"": ...} of one that has no name.
        do: does it, of (name, what), and reports.
        values: further results, with several radars.
    """
    if [*work] == [""]:
        do("", work[""])
        return
    results = dict[str, dict[str, Any]]()
    for name, part in work.items():
        tell(f"radar {name}")
        results[name] = _output.parts = {}
        try:
            do(name, part)
        finally:
            _output.parts = None
    report(radars=results, **values)


def with_output_options(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options --json and --quiet to a command."""

    @wraps(command)
    def run(*, json_: bool, quiet: bool, **arguments: Any) -> None:
        _output.json, _output.quiet = json_, quiet
        try:
            command(**arguments)
        finally:
            _output.json = _output.quiet = False

    signature = inspect.signature(command)
    options = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=kind)
        for name, kind in (("json_", Json), ("quiet", Quiet))
    ]
    run.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=[*signature.parameters.values(), *options]
    )
    return run
