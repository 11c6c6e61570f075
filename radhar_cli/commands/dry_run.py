"""`radhar generate --dry-run`: the plan, and what it will cost."""

from radhar_cli.activity import Activity
from radhar_cli.commands.tell import report, tell
from radhar_cli.commands.terminal import class_counts
from radhar_cli.config.schema import Config
from radhar_cli.dataset.batch import check_scenes
from radhar_cli.dataset.estimate import estimate
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.split import split_rows, split_warnings
from radhar_cli.pipeline.bodies import segment_paths
from radhar_cli.pipeline.physics import antennas_of, motion_of, waveform_of
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.run import record
from radhar_cli.scene import nominal_scene


def print_plan(config: Config, jobs: int) -> None:
    """Print stages with reasons, samples, bytes and time; write nothing."""
    rows = Rows.of(config)
    if config.recorded is not None:
        report(samples=len(rows), classes=class_counts(rows), maps=config.maps)
        tell(f"samples     {len(rows)} = {rows.counted}")
        tell("nothing was written")
        return
    plan = plan_images(config)
    checked, found = check_scenes(config)
    engine = config.engine
    tolerance = f", tolerance {engine.tolerance_db:g} dB" if engine.kind == "direct" else ""
    tell(f"stages of one sample ({engine.kind} engine{tolerance}):")
    width = max(len(product.name) for product in plan.products)
    for product in plan.products:
        readers = ", ".join(plan.consumers(product.name)) or "the data set"
        tell(f"  {product.name:<{width}}  {product.does}  [for {readers}]")
    if config.body.scatterers == "segments":
        tell("points a segment, in nominal scenes:")
        for activity in config.chosen_activities:
            tell(f"  {activity.label:<3} {_points(config, activity)}")
    if config.processing.range_sum == "gated":
        tell("range bins of the gate, in nominal scenes:")
        for activity in config.chosen_activities:
            tell(f"  {activity.label:<3} {_bins(config, activity)}")
    cost = estimate(config, jobs)
    tell(
        f"samples     {cost.samples} = {rows.counted}, "
        f"{len(config.maps)} map{'s' if len(config.maps) > 1 else ''} each"
    )
    redrawn = sum(scene.attempt > 0 for scene in checked)
    tell(f"scenes      {len(checked)} of {len(rows)} checked: {redrawn} drawn again")
    images = f" + png {_size(cost.png_bytes)}" if config.output.png else ""
    tell(f"on disk     dataset.h5 {_size(cost.hdf5_bytes)}{images}")
    tell(
        f"time        about {_duration(cost.seconds)} with {jobs} job{'s' if jobs > 1 else ''} "
        f"({cost.seconds_per_sample * 1e3:.1f} ms a sample, {cost.probes} samples timed just now)"
    )
    warnings = split_warnings(config, split_rows(config))
    warnings += [warning["message"] for warning in found]
    report(
        stages=[product.name for product in plan.products],
        classes=class_counts(rows),
        maps=config.maps,
        jobs=jobs,
        checked=len(checked),
        redrawn=redrawn,
        warnings=warnings,
        **vars(cost),
    )
    for message in warnings:
        tell(f"warning: {message}")
    tell("nothing was written")


def _points(config: Config, activity: Activity) -> str:
    """How many points the whole body has, and each of its segments."""
    scene = nominal_scene(config, activity)
    one, waveform = scene.config, waveform_of(scene.config)
    found = segment_paths(
        scene.people[0], motion_of(scene.people[0]), antennas_of(one), None, waveform
    )
    if found is None:
        return "none: no joints of a person"
    most = dict[str, int]()  # of the two sides
    for segment, points in zip(found.body.segments, found.points, strict=True):
        name = segment.name.removeprefix("right_").removeprefix("left_").replace("_", " ")
        most[name] = max(most.get(name, 0), points.share.size)
    total = sum(points.share.size for points in found.points)
    return f"{total:3d}: {', '.join(f'{name} {count}' for name, count in most.items())}"


def _bins(config: Config, activity: Activity) -> str:
    """How many bins the gate has, and how much of them frames show."""
    asked = ["gate", "frames", "waveform"]
    made = record(nominal_scene(config, activity), asked).products
    gate, pulses = made["gate"], made["waveform"].n_pulses
    low, high = gate.needed(made["frames"], pulses, 0)
    every = gate.bins.stop - gate.bins.start
    share = (high - low).clip(0).sum() / (every * pulses)
    return f"{gate.count} a frame, {every} in all; frames show {100 * share:.0f} % of their samples"


def _size(count: int) -> str:
    return f"{count / 2**20:.1f} MiB" if count < 2**30 else f"{count / 2**30:.2f} GiB"


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.1f} s"
    return f"{seconds / 60:.1f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
