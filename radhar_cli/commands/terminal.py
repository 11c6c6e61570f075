"""What commands show while they work, and what `generate` prints of its plan and its end."""

import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from radhar_cli import interrupts
from radhar_cli.commands.tell import counted, is_quiet, report, tell, wanted
from radhar_cli.untrusted import Closing, shown

if TYPE_CHECKING:
    from radhar_cli.config.schema import AnyConfig
    from radhar_cli.dataset.build import BuildOutcome
    from radhar_cli.dataset.layout import Rows
    from radhar_cli.learning.run_folder import Epoch


class BarProgress(Closing):
    """Messages, and one bar at a time; no bar without a terminal, or with --quiet."""

    def __init__(self, unit: str = "sample") -> None:
        self._unit = unit
        self._bar: tqdm[Any] | None = None

    def stage(self, name: str, total: int, done: int = 0, unit: str | None = None) -> None:
        """Show a bar instead of the one before."""
        self.close()
        unit = unit or self._unit
        if 0 < done < total:
            self.say(f"resuming: {done} of {total} {unit}s are finished")
        self._bar = tqdm(
            total=total,
            initial=done,
            desc=name,
            unit=unit,
            leave=False,
            disable=is_quiet() or None,
            file=sys.stderr,
        )

    def advance(self, count: int) -> None:
        """Some units are done."""
        interrupts.check()
        if self._bar is not None:
            self._bar.update(count)

    def say(self, message: str) -> None:
        """A line above the bar."""
        if wanted(message):
            tqdm.write(shown(message), file=sys.stderr)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


class TrainingView(BarProgress):
    """A bar and a line per epoch."""

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        self._epochs = epochs
        self.stage(f"epoch {number}/{epochs}", steps, unit="batch")

    def step(self, loss: float, accuracy: float) -> None:
        self.advance(1)

    def epoch_done(self, row: "Epoch", best: bool) -> None:
        self.close()
        self.say(
            f"epoch {row.epoch}/{self._epochs}  training {100 * row.train_accuracy:6.2f} % loss "
            f"{row.train_loss:.4f}  validation {100 * row.val_accuracy:6.2f} % loss "
            f"{row.val_loss:.4f}  rate {row.learning_rate:.2e}  {row.seconds:.0f} s"
            + ("  best so far" if best else "")
        )


def _class_counts(rows: "Rows") -> dict[str, int]:
    """{class: samples}."""
    return {one.slug: count for one, count in zip(rows.activities, rows.counts, strict=True)}


def print_outcome(config: "AnyConfig", outcome: "BuildOutcome") -> None:
    """Print what was written and where."""
    from radhar_cli.dataset.layout import DATASET, SPLITS, Rows
    from radhar_cli.dataset.split import split_rows

    folder, rows = outcome.folder, Rows.of(config)
    size = (folder / DATASET).stat().st_size
    counts = Counter(int(part) for part in split_rows(config))
    split = {SPLITS[part]: count for part, count in sorted(counts.items())}
    report(
        dataset=folder / DATASET,
        bytes=size,
        samples=outcome.samples,
        made=outcome.made,
        pngs=outcome.pngs,
        classes=_class_counts(rows),
        split=split,
        maps=config.maps,
        warnings=[warning["message"] for warning in outcome.warnings],
    )
    if outcome.already_complete:
        tell(f"{folder} is complete: {counted(outcome.samples, 'sample')}; nothing to do")
        return
    samples = counted(outcome.samples, "sample")
    tell(f"{folder / DATASET}: {samples}, {outcome.made} new, {_mib(size)}")
    tell(f"  {rows.counted}; " + ", ".join(f"{count} {part}" for part, count in split.items()))
    tell(f"  check it: radhar verify {folder}")


def print_part(outcome: "BuildOutcome", out: Path, part: str) -> None:
    """Print what a part holds and how to merge it."""
    report(folder=outcome.folder, part=part, samples=outcome.samples, made=outcome.made)
    samples = counted(outcome.samples, "sample")
    tell(f"{outcome.folder}: part {part} is complete: {samples}, {outcome.made} new")
    tell(f"  when all parts are: radhar merge {out}")


def print_plan(config: "AnyConfig", jobs: int | None) -> None:
    """Print stages, samples, bytes and time, found within DRY_RUN_S; write nothing.

    Args:
        jobs: processes; None for as many as pay.
    """
    from radhar_cli.config.schema import MeasuredConfig
    from radhar_cli.dataset.estimate import DRY_RUN_S, plan_build
    from radhar_cli.dataset.layout import Rows
    from radhar_cli.dataset.split import split_rows, split_warnings
    from radhar_cli.pipeline.products import plan_images

    rows = Rows.of(config)
    samples = f"samples     {len(rows)} = {rows.counted}"
    if isinstance(config, MeasuredConfig):
        report(samples=len(rows), classes=_class_counts(rows), maps=config.maps)
        tell(f"{samples}\nnothing was written")
        return
    products = plan_images(config).products
    with BarProgress() as bars:
        found = plan_build(config, jobs, bars, DRY_RUN_S)
    cost, warnings = found.cost, split_warnings(config, split_rows(config))
    warnings += [one["message"] for one in found.warnings]
    report(
        stages=[product.name for product in products],
        classes=_class_counts(rows),
        maps=config.maps,
        jobs=found.jobs,
        checked=found.checked,
        redrawn=found.redrawn,
        warnings=warnings,
        **vars(cost),
    )
    for product in products:
        tell(f"stage       {product.name}: {product.does}")
    tell(samples)
    short = f", then {DRY_RUN_S:g} s were over" if found.cut_short else ""
    tell(f"scenes      {found.checked} of {len(rows)} checked: {found.redrawn} drawn again{short}")
    if cost.seconds is None or cost.hdf5_bytes is None or cost.png_bytes is None:
        tell(f"on disk     not known: no sample was made within {found.waited:.0f} s")
        tell("time        not known")
    else:
        tell(f"on disk     dataset.h5 {_mib(cost.hdf5_bytes)}, png {_mib(cost.png_bytes)}")
        timed = f", by {counted(cost.probes, 'sample')}" if found.cut_short else ""
        tell(f"time        about {cost.seconds:.1f} s with --jobs {found.jobs}{timed}")
    for message in warnings:
        tell(f"warning: {message}")
    tell("nothing was written")


def _mib(count: int) -> str:
    return f"{count / 2**20:.1f} MiB"
