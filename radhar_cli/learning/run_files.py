"""The files of a training run, and how to tell one from data."""

from pathlib import Path

from radhar_cli.errors import RadharError

ABOUT = "run.json"
BEST = "best.safetensors"
LAST = "last.ckpt"
HISTORY = "history.csv"
CURVES = "curves.png"
METRICS = "metrics.json"
TRAINED_ON = "trained_on.csv"
TENSORBOARD, EVENTS = "tensorboard", "events.out.tfevents.*"  # folder, and files in it
ALL = (ABOUT, BEST, LAST, HISTORY, CURVES, METRICS, TRAINED_ON)


class RunError(RadharError):
    """A run folder, or a file of it, that cannot be used."""


def is_run(path: Path) -> bool:
    """Whether a path is a training run, or the weights of one."""
    if path.is_dir():
        return (path / BEST).exists() or (path / ABOUT).exists()
    return path.suffix == ".safetensors"
