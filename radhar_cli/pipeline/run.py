"""Run a plan: make every product once, in its order, and release what is not needed any more."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from time import process_time
from typing import Any

import numpy as np

from radhar_cli.config.schema import AnyConfig
from radhar_cli.pipeline import physics
from radhar_cli.pipeline.plan import Plan, Product, plan
from radhar_cli.pipeline.products import products, products_of_signals
from radhar_cli.processing.signal import Signal
from radhar_cli.progress import NO_PROGRESS, Progress
from radhar_cli.scene import Scene


@dataclass
class Results:
    """What was made of one scene, or of one recorded signal."""

    products: dict[str, Any] = field(default_factory=dict)  # {name: product}, those asked for
    seconds: dict[str, float] = field(default_factory=dict)  # {name: processor time it took}

    def __getitem__(self, name: str) -> Any:
        return self.products[name]


def run(steps: Plan, given: Mapping[str, Any], progress: Progress = NO_PROGRESS) -> Results:
    """Make the products of a plan from those that are given.

    Args:
        progress: is told of every product that is made.
    """
    there, recording = dict(given), Results()
    progress.stage("synthesis", len(steps.products), 0, "step")
    for product in steps.products:
        start = process_time()
        there[product.name] = product.make(*(there[need] for need in product.needs))
        recording.seconds[product.name] = process_time() - start
        for name in steps.released_after[product.name]:
            del there[name]
        progress.advance(1)
    recording.products = {name: there[name] for name in steps.asked}
    return recording


def record(
    scene: Scene,
    asked: Iterable[str],
    more: Iterable[Product] = (),
    progress: Progress = NO_PROGRESS,
    **given: Any,
) -> Results:
    """Make products of a scene, by name (`radhar_cli.pipeline.products`).

    `more` are further products, or others in place of those of the same name. Given are products
    that are there already: `motions=`, `antennas=`, `paths=` and so on. Antennas other than the
    config's have noise of their own; equal ones have it by `channel=1`, `channel=2`, ...
    """
    table = products(scene.config) | {product.name: product for product in more}
    given = {"scene": scene, **given}
    return run(plan(table, asked, given), given, progress)


def process(
    signal: Signal,
    config: AnyConfig,
    asked: Iterable[str],
    more: Iterable[Product] = (),
    **given: Any,
) -> Results:
    """Make products of a recorded signal: a sum over range after the canceller, or range bins
    before it. Powers of its channels are added up.

    As `record`, without a scene. Compensated maps need `torso_track=`, its delay [M] in s, and so
    does a gate that follows the torso.

    Raises:
        RadharError: a product would need a scene.
    """
    table = products_of_signals(config) | {product.name: product for product in more}
    duration = signal.pulses / signal.prf
    given = {
        "frames": physics.frames_of(config, duration, signal.prf, signal.f0),
        "fsst_frames": physics.fsst_frames_of(config, duration, signal.prf, signal.f0),
        "canceller": physics.canceller_of(config, signal.prf),
        **given,
    }
    if config.image.kind == "cfar":
        given.setdefault("cfar", physics.cfar_of(config))
    if signal.ranges is None:
        given = {"signal": signal, **given}
    else:
        canceller, gated = given["canceller"], config.processing.range_sum == "gated"
        after, track = signal.cancelled(canceller), given.get("torso_track")
        if track is not None:
            later = after.t + canceller.lost / 2 / signal.prf
            given["torso_track"] = np.interp(later, signal.t, track)
            if gated:
                given["gate"] = physics.gate_in_windows(
                    config, after, given["frames"], signal.t, track
                )
        profiles = after.columns(config.image.size_px[1])
        made = {"signal": after.summed(), "range_signals": after, "range_profiles": profiles}
        given = {**made, "range_axis": signal.ranges, **given}
    return run(plan(table, asked, given), given)
