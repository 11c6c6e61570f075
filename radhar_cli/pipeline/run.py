"""Run a plan: make every product once, in its order, and release what nobody needs any more."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

from radhar_cli.config.schema import Config
from radhar_cli.pipeline.physics import frames_of, fsst_frames_of
from radhar_cli.pipeline.plan import Plan, Product, plan
from radhar_cli.pipeline.products import products
from radhar_cli.processing.signal import Signal
from radhar_cli.scene import Scene


@dataclass
class Recording:
    """What was made of one scene, or of one recorded signal.

    Attributes:
        products: {name: product}, those asked for.
        seconds: {name: time it took}.
    """

    products: dict[str, Any] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Any:
        return self.products[name]


def run(steps: Plan, given: Mapping[str, Any]) -> Recording:
    """Make the products of a plan from those that are given."""
    there, recording = dict(given), Recording()
    for product in steps.products:
        start = perf_counter()
        there[product.name] = product.make(*(there[need] for need in product.needs))
        recording.seconds[product.name] = perf_counter() - start
        for name in steps.released_after[product.name]:
            del there[name]
    recording.products = {name: there[name] for name in steps.asked}
    return recording


def record(
    scene: Scene, asked: Iterable[str], more: Iterable[Product] = (), **given: Any
) -> Recording:
    """Make products of a scene.

    Args:
        scene: what is simulated, by the settings in its config.
        asked: names of products (`radhar_cli.pipeline.products`).
        more: further products, or others in place of those of the same name.
        given: products that are there already, instead of the scene's own: `motions=`, `antennas=`,
            `paths=` and so on.
    """
    return _made(scene.config, asked, more, {"scene": scene, **given})


def process(
    signal: Signal,
    config: Config,
    asked: Iterable[str],
    more: Iterable[Product] = (),
    **given: Any,
) -> Recording:
    """Make products of a signal after the canceller that somebody recorded.

    As `record`, without a scene. Compensated maps need `torso_track=`, its delay [M] in s.

    Raises:
        KeyError: a product would need a scene.
    """
    duration = signal.x.size / signal.prf
    frames = {
        "frames": frames_of(config, duration, signal.prf),
        "fsst_frames": fsst_frames_of(config, duration, signal.prf),
    }
    return _made(config, asked, more, {"signal": signal, **frames, **given})


def _made(
    config: Config, asked: Iterable[str], more: Iterable[Product], given: Mapping[str, Any]
) -> Recording:
    table = products(config) | {product.name: product for product in more}
    return run(plan(table, asked, given), given)
