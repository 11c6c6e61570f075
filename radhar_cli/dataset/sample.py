"""One sample of a data set: the image of every map."""

from radhar_cli.pipeline.plan import Plan
from radhar_cli.pipeline.run import run
from radhar_cli.processing.power_map import MapImage
from radhar_cli.scene import Scene


def synthesise(scene: Scene, plan: Plan) -> dict[str, MapImage]:
    """Run the plan of a data set on one scene: {map name: image}, in the order of the config."""
    recording = run(plan, {"scene": scene})
    return {name: recording[f"image:{name}"] for name in scene.config.maps}
