"""The `radhar` program: registers the commands, turns our errors into one message and a status."""

import os
import signal
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from radhar_cli.errors import INTERRUPTED, TERMINATED, RadharError
from radhar_cli.untrusted import shown

if TYPE_CHECKING:
    import typer

DATA_SETS = "Data sets"
STATUSES = (
    "Exit status: 0 done; 1 something differs or is missing, or the machine failed the run; 2 what "
    "was given cannot be used; 130 after Ctrl-C, 143 after SIGTERM: what is finished is kept."
)


def program() -> "typer.Typer":
    """The program and its commands."""
    import typer

    from radhar_cli.commands import (
        adapt,
        compare,
        config,
        convert,
        evaluate,
        export,
        fit,
        generate,
        import_,
        inspect,
        merge,
        models,
        motion,
        predict,
        preview,
        process,
        simulate,
        tradeoff,
        train,
        verify,
        version,
    )
    from radhar_cli.commands.headings import Headings

    app = typer.Typer(
        cls=Headings,
        help="Labelled FMCW radar data sets for human activity recognition, from a YAML file.",
        epilog=STATUSES,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
    )
    app.callback()(version.options)
    groups: dict[str, list[Callable[..., None]]] = {
        DATA_SETS: [generate.generate, verify.verify, merge.merge, convert.convert],
        "Look": [simulate.simulate, motion.motion, preview.preview, inspect.inspect],
        "Real radars": [import_.import_, process.process, fit.fit, compare.compare],
        "Learn": [train.train, evaluate.evaluate, predict.predict, adapt.adapt],
        "Networks and settings": [models.models, export.export, tradeoff.tradeoff],
    }
    names = {import_.import_: "import", evaluate.evaluate: "eval"}
    for heading, commands in groups.items():
        for one in commands:
            app.command(names.get(one), rich_help_panel=heading)(one)
    app.add_typer(config.group(), name="config", no_args_is_help=True, rich_help_panel=DATA_SETS)
    _with_output_options(app)
    return app


def _with_output_options(app: "typer.Typer") -> None:
    """Give --json, --quiet and the completion of values to every command."""
    from radhar_cli.commands.completion import complete_options
    from radhar_cli.commands.tell import with_output_options

    for command in app.registered_commands:
        assert command.callback is not None
        complete_options(command.callback)
        command.callback = with_output_options(command.callback)
    for group in app.registered_groups:
        assert group.typer_instance is not None
        _with_output_options(group.typer_instance)


def main() -> None:
    """Run the program; our errors end with their message and status."""
    signal.signal(signal.SIGTERM, _terminate)
    try:
        sys.exit(_run(sys.argv[1:]))
    except RadharError as error:
        if os.environ.get("RANK", "0") == "0":  # under torchrun all fail, and one reports it
            print(f"radhar: {shown(error)}", file=sys.stderr)
        sys.exit(error.status)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except OSError as error:
        if isinstance(error, BrokenPipeError):
            sys.stderr.close()
        elif error.filename is None:
            raise
        else:
            print(f"radhar: {shown(error.filename)}: {error.strerror or error}", file=sys.stderr)
        sys.exit(1)
    finally:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)  # the work is done; leave quietly


def _run(arguments: list[str]) -> int | None:
    """Run the program and return its status.

    Raises:
        RadharError: an option or argument is mistaken; one line, as of all our errors.
    """
    import typer

    from radhar_cli.commands.generate import shard_named

    usage_error = typer.BadParameter.__mro__[1]  # of click, or of the copy that newer typers hold
    try:
        return program()(shard_named(arguments), prog_name="radhar", standalone_mode=False)  # type: ignore[no-any-return]
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


def _terminate(number: int, frame: object) -> None:
    """Unwind as Ctrl-C does, so that whatever is open is closed and workers end."""
    raise SystemExit(TERMINATED)
