"""Movement or class at the time of each column of an image (`output.column_labels`)."""

from collections.abc import Sequence

import numpy as np

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.motion.phases import PHASES, phase_numbers
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Levels
from radhar_cli.processing.power_map import MapImage
from radhar_cli.scene.scene import Scene


def label_names(config: AnyConfig) -> tuple[str, ...]:
    """Name the numbers of column labels: PHASES, then every class beyond the twelve by its slug."""
    return (*PHASES, *(activity.slug for activity in config.every_class if activity.number > 12))


def label_columns(scene: Scene, motion: Motion, image: MapImage, names: Sequence[str]) -> Levels:
    """Label each column of an image with the movement under way at the time of its middle.

    A motion that names no phases, or others than PHASES, is labelled with its class.

    Args:
        scene: the scene, whose main person is labelled.
        motion: that person's motion.
        image: image of a map over time.
        names: the `label_names` of the data set.

    Returns:
        Index into `names` of each column [width].
    """
    left, right, *_ = image.extent
    width = image.levels.shape[1]
    t = left + (np.arange(width) + 0.5) * (right - left) / width
    slug = scene.activity.slug
    phases = () if scene.is_empty else motion.phases
    return phase_numbers(phases, t, names, names.index(slug) if slug in names else 0)
