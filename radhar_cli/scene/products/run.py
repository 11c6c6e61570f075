"""Run a plan: make every product once, in its order, and release what is not needed any more."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from time import process_time
from typing import Any

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processing.signal import Signal
from radhar_cli.scene.products.gated import gate_in_windows
from radhar_cli.scene.products.images import level_scale_of, scale_of
from radhar_cli.scene.products.plan import Plan, Product, plan
from radhar_cli.scene.products.table import products, products_of_signals
from radhar_cli.scene.scene import Scene


@dataclass
class Results:
    """Products of one scene, or of one recorded signal.

    Attributes:
        products: {name: product} of those asked for.
        seconds: {name: processor time, s} of every product that was made.
    """

    products: dict[str, Any] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Any:
        return self.products[name]


def run(steps: Plan, inputs: Mapping[str, Any], progress: Progress = NO_PROGRESS) -> Results:
    """Make the products of a plan.

    Args:
        inputs: products that exist already, {name: product}.
        progress: is told of every product that is made.
    """
    available = dict(inputs)
    results = Results()
    progress.stage("synthesis", len(steps.products), 0, "step")
    for product in steps.products:
        start = process_time()
        available[product.name] = product.make(*(available[need] for need in product.needs))
        results.seconds[product.name] = process_time() - start
        for name in steps.released_after[product.name]:
            del available[name]
        progress.advance(1)
    results.products = {name: available[name] for name in steps.requested}
    return results


def record(
    scene: Scene,
    requested: Iterable[str],
    more: Iterable[Product] = (),
    progress: Progress = NO_PROGRESS,
    **inputs: Any,
) -> Results:
    """Make products of a scene, by name (`radhar_cli.scene.products.table`).

    Args:
        requested: names of the products.
        more: further products, or others in place of those of the same name.
        progress: is told of every product that is made.
        inputs: products that exist already: `motions=`, `antennas=`, `paths=` and so on.
            Antennas other than the config's have noise of their own; equal ones have it by
            `channel=1`, `channel=2`, ...

    Raises:
        RadharError: there is no product of a name.
        SceneError: the scene cannot be simulated, as the message says.
    """
    table = products(scene.config) | {product.name: product for product in more}
    inputs = {"scene": scene, **inputs}
    return run(plan(table, requested, inputs), inputs, progress)


def process(
    signal: Signal,
    config: AnyConfig,
    requested: Iterable[str],
    more: Iterable[Product] = (),
    **inputs: Any,
) -> Results:
    """Make products of a recorded signal, by name; powers of its channels are added up.

    Args:
        signal: sum over range after the canceller, or range bins before it.
        config: processing, image and maps.
        requested: names of the products.
        more: further products, or others in place of those of the same name.
        inputs: products that exist already. Compensated maps, and a gate that follows the torso,
            need `torso_track=`, its `Track`.

    Raises:
        RadharError: a product would need a scene.
    """
    table = products_of_signals(config) | {product.name: product for product in more}
    processing, timing = config.processing, (signal.pulses / signal.prf, signal.prf, signal.f0)
    inputs = {
        "frames": processing.make_frames(*timing),
        "fsst_frames": processing.make_fsst_frames(*timing),
        "canceller": processing.make_canceller(signal.prf),
        "image_scale": scale_of(config),
        "level_scale": level_scale_of(config),
        **inputs,
    }
    canceller, track = inputs["canceller"], inputs.get("torso_track")
    after = signal if signal.ranges is None else signal.cancelled(canceller)
    if track is not None:
        inputs["torso_track"] = track.delay_at(after.t + canceller.lost / 2 / signal.prf)
    if signal.ranges is None:
        inputs = {"signal": signal, **inputs}
    else:
        if track is not None and processing.range_sum == "gated":
            gate = gate_in_windows(after, inputs["frames"], track, processing.gate_m)
            inputs["gate"] = gate
        profiles = after.columns(config.image.size_px[1])
        signals = {"signal": after.summed(), "range_signals": after, "range_profiles": profiles}
        inputs = {**signals, "range_axis": signal.ranges, **inputs}
    return run(plan(table, requested, inputs), inputs)
