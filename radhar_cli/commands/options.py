"""Options that several commands share."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from radhar_cli.commands.tell import tell
from radhar_cli.errors import INTERRUPTED, FolderError
from radhar_cli.processes import interrupts

if TYPE_CHECKING:
    from radhar_cli.config.data_set import Config
    from radhar_cli.config.reading import Override
    from radhar_cli.motion.activities.activity import Activity as ActivityOfPeople

Overrides: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Override a config key, as in radar.prf_hz=128; may be repeated.",
    ),
]
Activity: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--activity",
        "-a",
        help="Activity or movement, by name or label; optional if there is only one.",
    ),
]
Nominal: TypeAlias = Annotated[
    bool, typer.Option("--nominal", help="Use the middle of every range instead of random values.")
]
Maps: TypeAlias = Annotated[
    str | None,
    typer.Option(
        help="Comma-separated names of maps, or `all` for every map that the radar makes; "
        "overrides the config."
    ),
]
Figures: TypeAlias = Annotated[
    bool, typer.Option("--figures/--no-figures", help="Whether to draw figures.")
]
StartOver: TypeAlias = Annotated[
    bool, typer.Option("--overwrite", help="Start over in a folder that holds earlier results.")
]
Replace: TypeAlias = Annotated[bool, typer.Option("--overwrite", help="Replace an existing file.")]
ReplaceResults: TypeAlias = Annotated[
    bool, typer.Option("--overwrite", help="Replace the results of an earlier run.")
]
Tolerance: TypeAlias = Annotated[
    float | None,
    typer.Option(
        metavar="DB",
        help="Largest relative error of the direct engine's signal, in dB; overrides "
        "engine.tolerance_db.",
    ),
]


def jobs_option(text: str) -> Any:
    """Return the option --jobs of a command.

    Args:
        text: Help: processes that are counted, and their number without the option.
    """
    return typer.Option("--jobs", "-j", min=1, help=text)


def find_activity(name: str | None, config: "Config", says_word: bool = True) -> "ActivityOfPeople":
    """Find the activity that --activity names.

    One of the twelve has the name of another word for it, as in `activities` of a config; of other
    classes it is said which is taken.

    Args:
        name: value of --activity, or None.
        config: config whose activities are known.
        says_word: whether it is said.

    Raises:
        ConfigError: there is no such activity, or none is named and the config has several.
    """
    from radhar_cli.errors import ConfigError
    from radhar_cli.motion.activities.activity import class_called
    from radhar_cli.motion.activities.vocabulary import is_other_word
    from radhar_cli.scene.single.request import activity_of

    try:
        activity = activity_of(name, config)
    except ConfigError as error:
        raise ConfigError(f"--activity: {error}") from None
    if name is None or not is_other_word(name, activity.slug):
        return activity
    classes = {known.slug: known for known in config.every_class if known.slug in config.classes}
    called = class_called(name, classes)
    if called.slug != activity.slug and called.number == activity.number:
        return called
    if says_word:
        tell(f"--activity: {name} is taken for {activity.slug}", err=True)
    return activity


@contextmanager
def resumable(work: str) -> Iterator[None]:
    """Context of work that Ctrl-C (status 130) or SIGTERM (status 143) may end.

    Args:
        work: work that is kept then, for the message.

    Raises:
        typer.Exit: the work was ended so, with that status.
    """
    try:
        yield
        interrupts.check()
    except BaseException as error:
        by_hand = isinstance(error, KeyboardInterrupt)
        status = interrupts.status() or (INTERRUPTED if by_hand else None)
        if status is None:
            raise
        if interrupts.tell_once():
            how = "interrupted" if status == INTERRUPTED else "terminated"
            tell(f"\n{how}: {work} is kept; the same command resumes", err=True)
        raise typer.Exit(status) from None


def refuse_to_replace(path: Path, replace: bool, example: str) -> None:
    """Refuse an output file that exists, or that is a folder.

    Args:
        path: the file.
        replace: whether an existing file may be replaced.
        example: a file name, for the message.

    Raises:
        FolderError: it is refused.
    """
    if path.is_dir():
        raise FolderError(f"{path}: is a folder; -o should name a file, such as {example}")
    if path.exists() and not replace:
        raise FolderError(f"{path}: already exists; --overwrite replaces it")


def refuse_to_replace_results(out: Path, names: Iterable[str], replace: bool) -> None:
    """Refuse an output folder that holds results of an earlier run: files of these names.

    Raises:
        FolderError: there are some, and they are not to be replaced.
    """
    results = [name for name in names if (out / name).exists()]
    if results and not replace:
        raise FolderError(
            f"{out}: holds {', '.join(results[:3])}{', ...' if len(results) > 3 else ''} of an "
            "earlier run; --overwrite replaces them, another folder keeps them"
        )


def with_tolerance(overrides: list[str] | None, tolerance: float | None) -> list["str | Override"]:
    """Overrides of the config, with --tolerance, where it is given, as the last."""
    from radhar_cli.config.reading import Override

    named = (
        []
        if tolerance is None
        else [Override("engine.tolerance_db", repr(tolerance), "--tolerance")]
    )
    return [*(overrides or []), *named]
