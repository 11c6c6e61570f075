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

    def stage(self, name: str, total: int, done: int = 0) -> None:
        """Show a bar instead of the one before."""
        self.close()
        if 0 < done < total:
            self.say(f"resuming: {done} of {total} {self._unit}s are finished")
        self._bar = tqdm(
            total=total,
            initial=done,
            desc=name,
            unit=self._unit,
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
        self.stage(f"epoch {number}/{epochs}", steps)

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


def print_plan(config: "AnyConfig", jobs: int) -> None:
    """Print stages, samples, bytes and time; write nothing."""
    from radhar_cli.config.schema import MeasuredConfig
    from radhar_cli.dataset.batch import check_scenes
    from radhar_cli.dataset.estimate import estimate
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
    checked, found = check_scenes(config)
    cost = estimate(config, jobs)
    redrawn = sum(scene.attempt > 0 for scene in checked)
    warnings = split_warnings(config, split_rows(config))
    warnings += [one["message"] for one in found]
    report(
        stages=[product.name for product in products],
        classes=_class_counts(rows),
        maps=config.maps,
        jobs=jobs,
        checked=len(checked),
        redrawn=redrawn,
        warnings=warnings,
        **vars(cost),
    )
    for product in products:
        tell(f"stage       {product.name}: {product.does}")
    tell(samples)
    tell(f"scenes      {len(checked)} of {len(rows)} checked: {redrawn} drawn again")
    tell(f"on disk     dataset.h5 {_mib(cost.hdf5_bytes)}, png {_mib(cost.png_bytes)}")
    tell(f"time        about {cost.seconds:.1f} s with --jobs {jobs}")
    for message in warnings:
        tell(f"warning: {message}")
    tell("nothing was written")


def _mib(count: int) -> str:
    return f"{count / 2**20:.1f} MiB"
