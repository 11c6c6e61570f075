"""Values of `model` and `target` of a training config: one line each.

A network or a task is a file of its own, which is imported when a config names it, so that a
config is read without PyTorch. A module of RADHAR_EXTENSIONS adds a line of its own:

    from radhar_cli.learning.registry import NETWORKS, TASKS, NetworkChoice, TaskChoice

    NETWORKS["mynet"] = NetworkChoice("my_radar.mynet:build")
    TASKS["height"] = TaskChoice("my_radar.height:Height")
"""

from dataclasses import dataclass
from importlib import import_module
from typing import Any, Literal

Kind = Literal["rgb", "gray", "frames", "clouds"]


@dataclass(frozen=True)
class NetworkChoice:
    """A network of radhar's own, or of an extension; all other names are those of timm."""

    place: str  # "module:function" of a `models.build.Builder`
    reads: Literal["frames", "clouds"] | None = None  # sequences that it takes; None takes images
    # channels that it takes of an image; one that is stored in gray is repeated on the device
    channels: int = 3


@dataclass(frozen=True)
class TaskChoice:
    """Task that a network may learn."""

    place: str  # "module:class" of a `tasks.task.Task`
    of_sequences: bool = False  # asks for a network of frames or clouds
    networks: tuple[str, ...] = ()  # that it asks for; none for any


NETWORKS = {
    "smallnet": NetworkChoice("radhar_cli.learning.models.smallnet:build"),
    "smallnet_bn": NetworkChoice("radhar_cli.learning.models.smallnet:build_with_batch_norm"),
    "fftnet": NetworkChoice("radhar_cli.learning.models.fftnet:build"),
    "tcn": NetworkChoice("radhar_cli.learning.models.tcn:build"),
    "cloudnet": NetworkChoice("radhar_cli.learning.models.cloudnet:build", reads="clouds"),
    "framenet": NetworkChoice("radhar_cli.learning.models.framenet:build", reads="frames"),
}
TASKS = {
    "classes": TaskChoice("radhar_cli.learning.tasks.classes:Classes"),
    "labels": TaskChoice("radhar_cli.learning.tasks.labels:Labels"),
    "count": TaskChoice("radhar_cli.learning.tasks.count:Count"),
    "person": TaskChoice("radhar_cli.learning.tasks.person:Persons"),
    "frames": TaskChoice("radhar_cli.learning.tasks.frames:FrameLabels", networks=("tcn",)),
    "skeleton": TaskChoice("radhar_cli.learning.tasks.skeleton:Skeleton", of_sequences=True),
}


def sequences_of(model: str) -> Literal["frames", "clouds"] | None:
    """Sequences that a network takes; None takes images, as all networks of timm do."""
    return NETWORKS[model].reads if model in NETWORKS else None


def image_channels_of(model: str) -> int:
    """Number of channels that a network takes of an image."""
    return NETWORKS[model].channels if model in NETWORKS else 3


def load_place(place: str) -> Any:
    """Import the object named "module:name"."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)
