"""One sample of a data set: the image of every map, and how exact they are."""

from math import isfinite, nan
from typing import NamedTuple

from radhar_cli.pipeline.plan import Plan
from radhar_cli.pipeline.products import EchoAccuracy, Fallback
from radhar_cli.pipeline.run import run
from radhar_cli.processing.power_map import MapImage
from radhar_cli.scene import Scene


class Sample(NamedTuple):
    """What is made of a scene.

    Attributes:
        images: {map name: image}, in the order of the config.
        error_db: measured error of the direct engine; NaN where it made nothing that could err.
        fell_back: the cube made the signal, as the direct engine could not (`engine.fallback`).
    """

    images: dict[str, MapImage]
    error_db: float
    fell_back: bool


def synthesise(scene: Scene, plan: Plan) -> Sample:
    """Run the plan of a data set on one scene."""
    recording = run(plan, {"scene": scene})
    images: dict[str, MapImage] = {name: recording[f"image:{name}"] for name in scene.config.maps}
    accuracy: EchoAccuracy | None = recording.products.get("accuracy")
    if accuracy is None or isinstance(accuracy, Fallback):
        return Sample(images, nan, isinstance(accuracy, Fallback))
    return Sample(images, accuracy.error_db if isfinite(accuracy.error_db) else nan, False)
