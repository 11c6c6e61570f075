"""`radhar generate --dry-run`: the plan, and what it will cost."""

from radhar_cli.config.schema import Config
from radhar_cli.dataset.estimate import estimate
from radhar_cli.dataset.layout import Rows
from radhar_cli.pipeline.products import plan_images


def print_plan(config: Config, jobs: int) -> None:
    """Print stages with reasons, samples, bytes and time; write nothing."""
    plan, rows = plan_images(config), Rows.of(config)
    engine = config.engine
    budget = f", error budget {engine.tolerance_db:g} dB" if engine.kind == "direct" else ""
    print(f"stages of one sample ({engine.kind} engine{budget}):")
    width = max(len(product.name) for product in plan.products)
    for product in plan.products:
        readers = ", ".join(plan.consumers(product.name)) or "the data set"
        print(f"  {product.name:<{width}}  {product.does}  [for {readers}]")
    found = estimate(config, jobs)
    print(
        f"samples     {found.samples} = {len(rows.activities)} classes x {rows.per_class}, "
        f"{len(config.maps)} map{'s' if len(config.maps) > 1 else ''} each"
    )
    images = f" + png {_size(found.png_bytes)}" if config.output.png else ""
    print(f"on disk     dataset.h5 {_size(found.hdf5_bytes)}{images}")
    print(
        f"time        about {_duration(found.seconds)} with {jobs} job{'s' if jobs > 1 else ''} "
        f"({found.seconds_per_sample * 1e3:.1f} ms a sample, {found.probes} samples timed just now)"
    )
    print("nothing was written")


def _size(count: int) -> str:
    return f"{count / 2**20:.1f} MiB" if count < 2**30 else f"{count / 2**30:.2f} GiB"


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.1f} s"
    return f"{seconds / 60:.1f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
