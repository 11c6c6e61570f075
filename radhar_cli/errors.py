"""Errors that a user can mend; the program prints their text alone and exits with their status."""

import difflib
from collections.abc import Iterable

INTERRUPTED, TERMINATED = 130, 143  # exit status after Ctrl-C and SIGTERM, as shells count them


def did_you_mean(name: str, known: Iterable[str], otherwise: str, similar: float = 0.6) -> str:
    """Suggest the nearest known name.

    Args:
        name: as somebody wrote it.
        known: names that could be meant.
        otherwise: what is returned where no name is similar.
        similar: least ratio of `difflib` from which a name is suggested, 0 to 1.
    """
    near = difflib.get_close_matches(name, list(known), n=1, cutoff=similar)
    return f"did you mean {near[0]!r}?" if near else otherwise


class RadharError(Exception):
    """Something is wrong with what the user gave: one clear message, no traceback."""

    status = 2


class ConfigError(RadharError):
    """A config that cannot be used; names file, key, value and what would be right."""


class SceneError(RadharError):
    """A drawn scene outside the model; names sample, joint, time and distance."""


class MotionFileError(RadharError):
    """A motion file that cannot be used; names file, line and what is missing or odd."""


class FolderError(RadharError):
    """An output folder that cannot be used or continued."""


class UnfinishedError(RadharError):
    """The machine failed the run (full disk, killed worker); what was finished is kept."""

    status = 1


class ModelError(RadharError):
    """A network that cannot be built."""


class MachineError(RadharError):
    """A device that this machine does not have, or a package that is not installed."""


class CaptureError(RadharError):
    """A capture that cannot be read; names file, field, value and what would fit."""
