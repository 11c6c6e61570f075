"""`import radhar`: the Python interface of radhar, which the package `radhar_cli` holds."""

from typing import TYPE_CHECKING

import radhar_cli
from radhar_cli import __version__ as __version__

if TYPE_CHECKING:
    from radhar_cli import Samples as Samples
    from radhar_cli import Sequences as Sequences
    from radhar_cli import audit as audit
    from radhar_cli import evaluate as evaluate
    from radhar_cli import generate as generate
    from radhar_cli import load_config as load_config
    from radhar_cli import load_radars as load_radars
    from radhar_cli import load_run as load_run
    from radhar_cli import open_dataset as open_dataset
    from radhar_cli import sample as sample
    from radhar_cli import simulate as simulate
    from radhar_cli import torch_dataset as torch_dataset
    from radhar_cli import train as train


def __getattr__(name: str) -> object:
    """Import a part of the interface on first use."""
    if name not in dir(radhar_cli):
        raise AttributeError(f"module 'radhar' has no attribute {name!r}")
    return getattr(radhar_cli, name)


def __dir__() -> list[str]:
    return dir(radhar_cli)
