"""The `radhar` program: registers the commands, and turns errors into a message and a status."""

import io
import os
import sys
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any

from radhar_cli.errors import INTERRUPTED, RadharError
from radhar_cli.files.untrusted import escaped
from radhar_cli.processes import interrupts

if TYPE_CHECKING:
    import typer

DATA_SETS = "Data sets"
COMMANDS = {
    DATA_SETS: ("demo", "generate", "verify", "audit", "merge", "convert"),
    "Look": ("simulate", "motion", "preview", "view", "inspect"),
    "Real radars": ("prepare", "import", "process", "fit", "compare"),
    "Learn": ("train", "eval", "predict", "adapt", "export", "benchmark"),
    "Settings": ("tradeoff", "limits"),
}
MODULES = {"import": "import_", "eval": "evaluate"}  # and functions; of the others as the command
STATUSES = (
    "Exit status: 0 done; 1 something differs or is missing, or the machine failed the run; 2 what "
    "was given cannot be used; 130 after Ctrl-C, 143 after SIGTERM: what is finished is kept."
)


def program() -> "typer.Typer":
    """Make the program with all its commands."""
    import typer

    from radhar_cli.commands import config, version
    from radhar_cli.commands.headings import Headings

    app = typer.Typer(
        cls=Headings,
        help="Labelled radar data sets for human activity recognition, from a YAML file.",
        epilog=STATUSES,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )
    app.callback()(version.options)
    for heading, names in COMMANDS.items():
        for name in names:
            module = MODULES.get(name, name)
            command = getattr(import_module(f"radhar_cli.commands.{module}"), module)
            app.command(name, rich_help_panel=heading)(command)
    app.add_typer(config.group(), name="config", no_args_is_help=True, rich_help_panel=DATA_SETS)
    _add_output_options(app)
    return app


def _add_output_options(app: "typer.Typer") -> None:
    """Give --json and --quiet to every command."""
    from radhar_cli.commands.tell import with_output_options

    for command in app.registered_commands:
        assert command.callback is not None
        command.callback = with_output_options(command.callback)
    for group in app.registered_groups:
        assert group.typer_instance is not None
        _add_output_options(group.typer_instance)


def main() -> None:
    """Run the program and exit with its status; errors of radhar end with one message."""
    status: int | None = None
    with interrupts.handled():
        try:
            _open_standard_streams()
            status = _run(sys.argv[1:])
            sys.stdout.flush()
        except BaseException as error:
            if interrupts.status() is None:
                status = _report_error(error)
        how = "interrupted" if interrupts.received() == INTERRUPTED else "terminated"
        if interrupts.status() is not None and interrupts.tell_once():
            print(f"{how}: what was not finished is not kept", file=sys.stderr)
        if (result := interrupts.outlived()) is not None:
            print(f"{how} after the end: {escaped(result)} is complete", file=sys.stderr)
        sys.exit(interrupts.status() or status)


def _report_error(error: BaseException) -> int:
    """Print in a line what ended the program, and return the status.

    Raises:
        BaseException: the error itself, where it is a mistake of radhar.
    """
    status, message = 1, ""
    if isinstance(error, RadharError):
        status, message = error.status, str(error)
    elif isinstance(error, KeyboardInterrupt):
        return INTERRUPTED
    elif isinstance(error, MemoryError):
        why = f" ({error})" if str(error) else ""
        message = f"out of memory{why}; smaller images or fewer --jobs need less"
    elif isinstance(error, OSError) and error.errno is not None:
        with suppress(OSError, ValueError):  # or Python would write what it holds again at its end
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            message = f"{error.filename or 'output'}: {error.strerror}"
    else:
        raise error
    if message:
        print(f"radhar: {escaped(message)}", file=sys.stderr)
    return status


def _open_standard_streams() -> None:
    """Open streams that the shell closed to nothing, or our pipes take their numbers.

    Characters that standard output cannot encode are printed escaped.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # takes the lowest number
            setattr(sys, name, os.fdopen(number, "w" if number else "r", closefd=False))
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def _run(arguments: list[str]) -> int | None:
    """Run the program with arguments and return its status.

    Raises:
        RadharError: the arguments cannot be used.
    """
    import typer

    usage_error = typer.BadParameter.__mro__[1]  # of click, or of the copy that newer typers hold
    try:
        return program()(arguments, prog_name="radhar", standalone_mode=False)  # type: ignore[no-any-return]
    except Exception as error:
        if not isinstance(error, usage_error):
            raise
        message: str = error.format_message()  # type: ignore[attr-defined]
        if "\n" in message:  # the help of a group that was called alone
            error.show()  # type: ignore[attr-defined]
            return RadharError.status
        of_pydantic: list[Any] = getattr(error.__cause__, "errors", list)()  # knows the value
        if of_pydantic and isinstance(error, typer.BadParameter) and error.param is not None:
            name, said = max(error.param.opts, key=len), of_pydantic[0]
            message = f"{name} {said['input']}: {said['msg'].removeprefix('Input ')}"
        context = error.ctx  # type: ignore[attr-defined]
        path = context.command_path if context else "radhar"
        raise RadharError(f"{message.rstrip('.')} ({path} --help)") from None
