"""One sample of a data set: levels, entropy, checksum and extent of every map."""

import hashlib
from dataclasses import dataclass

from radhar_cli.arrays import Levels
from radhar_cli.config.experiment import Config
from radhar_cli.pipeline.axes import axes_of
from radhar_cli.pipeline.plan import Plan
from radhar_cli.pipeline.run import run
from radhar_cli.scenario import Scene


@dataclass(frozen=True)
class MapImage:
    """One map of one sample.

    Attributes:
        levels: grey levels [H, W], row 0 at the top.
        entropy: of the power map, bits.
        extent: outer edges (time start, time stop, vertical low, vertical high) in s and Hz or m.
        fell_back: the cube made the sample's signal, as the direct engine could not.
    """

    levels: Levels
    entropy: float
    extent: tuple[float, float, float, float]
    fell_back: bool = False

    @property
    def sha256(self) -> str:
        """Checksum of the levels, row by row, in hex."""
        return hashlib.sha256(self.levels.tobytes()).hexdigest()


def synthesise(scene: Scene, config: Config, plan: Plan) -> dict[str, MapImage]:
    """Run the plan of a data set on one scene: {map name: image}."""
    recording = run(plan, scene, config)
    return {
        name: MapImage(
            recording.products[f"levels:{name}"],
            recording.products[f"entropy:{name}"],
            axes_of(name, recording).extent,
            recording.fell_back,
        )
        for name in config.maps
    }
