"""Errors that a user can mend; the program prints their text alone and exits with their status."""

import difflib
import sys
from collections.abc import Iterable

INTERRUPTED, TERMINATED = 130, 143  # exit status after Ctrl-C and SIGTERM, as shells count them


def did_you_mean(name: str, known: Iterable[str], otherwise: str, similar: float = 0.6) -> str:
    """Suggest the nearest known name.

    Args:
        name: as somebody wrote it.
        known: names that could be meant.
        otherwise: text that is returned where no name is similar.
        similar: least ratio of `difflib` from which a name is suggested, 0 to 1.
    """
    near = difflib.get_close_matches(name, list(known), n=1, cutoff=similar)
    return f"did you mean {near[0]!r}?" if near else otherwise


# {module: package that has it}, where these differ.
PACKAGES = {"sklearn": "scikit-learn", "skimage": "scikit-image"}


# Index of PyTorch without CUDA, which Linux gets otherwise: gigabytes.
CPU_INDEX = "https://download.pytorch.org/whl/cpu"


def how_to_install(*modules: str) -> str:
    """Command that installs the packages of modules beside this radhar, however it was installed.

    It names packages, not extras of radhar, which no package index has, and the Python that runs:
    `pip` alone may be another one's.
    """
    import shlex
    from importlib.util import find_spec
    from pathlib import Path

    python = Path(sys.executable)
    if python.is_relative_to(Path.cwd()):
        python = python.relative_to(Path.cwd())
    path = shlex.quote(str(python))
    pip = f"{path} -m pip install" if find_spec("pip") else f"uv pip install --python {path}"
    index = ["--extra-index-url", CPU_INDEX] * ("torch" in modules and sys.platform == "linux")
    return " ".join([pip, *index, *(PACKAGES.get(module, module) for module in modules)])


def describe_schema(version: int, known: int, otherwise: str = "") -> str:
    """Describe the problem with the version of a file's layout, and the version that is right.

    Args:
        version: the file's.
        known: the one that this radhar reads and writes.
        otherwise: advice on a file of an earlier version.
    """
    if version > known:
        return (
            f"schema_version = {version}: is written by a newer radhar, this one reads {known}: "
            "update radhar"
        )
    return f"schema_version = {version}: should be {known}{otherwise}"


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
