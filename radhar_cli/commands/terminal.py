"""Progress bars of the commands, and what `generate` prints of its plan and its results."""

import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import fields
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from radhar_cli.commands.tell import counted, is_quiet, is_shown, report, tell
from radhar_cli.files.untrusted import Closing, escaped
from radhar_cli.processes import interrupts

if TYPE_CHECKING:
    from radhar_cli.config.data_set import AnyConfig, Config
    from radhar_cli.dataset.build import BuildOutcome
    from radhar_cli.dataset.estimate import BuildPlan
    from radhar_cli.dataset.layout import Rows
    from radhar_cli.learning.run_folder import Epoch


SMALL = 0.5  # share of a stage, %, that has no line of its own in a plan


class BarProgress(Closing):
    """Messages, and one bar at a time; no bar without a terminal, or with --quiet.

    Warnings name the radar, where it has a name.
    """

    def __init__(self, unit: str = "sample", radar: str | None = None) -> None:
        self._unit, self._radar = unit, radar
        self._bar: tqdm[Any] | None = None

    def stage(self, name: str, total: int, done: int = 0, unit: str | None = None) -> None:
        """Replace the bar by that of a new stage.

        Args:
            name: the stage, shown before the bar.
            total: number of units of the stage.
            done: number of them that are finished already.
            unit: what is counted, in the singular.
        """
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
        """Move the bar by `count` finished units; stop here if the user has interrupted."""
        interrupts.check()
        if self._bar is not None:
            self._bar.update(count)

    def say(self, message: str) -> None:
        """Print a line above the bar."""
        if self._radar is not None:
            message = message.replace("warning: ", f"warning: radar {self._radar}: ", 1)
        if is_shown(message):
            tqdm.write(escaped(message), file=sys.stderr)

    def close(self) -> None:
        """Remove the bar."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


class TrainingView(BarProgress):
    """Progress of a training: a bar for each epoch, and a line at its end."""

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
    """Number of samples by slug of the class."""
    return {
        activity.slug: count for activity, count in zip(rows.activities, rows.counts, strict=True)
    }


def print_outcome(config: "AnyConfig", outcome: "BuildOutcome") -> None:
    """Print what a build has written, and where."""
    from radhar_cli.config.data_set import Config
    from radhar_cli.dataset.layout import DATASET, SPLITS, Rows
    from radhar_cli.dataset.split import split_rows
    from radhar_cli.scene.products.acceleration import describe_acceleration

    folder, rows = outcome.folder, Rows.of(config)
    size = (folder / DATASET).stat().st_size
    counts = Counter(int(part) for part in split_rows(config))
    split = {SPLITS[part]: count for part, count in sorted(counts.items())}
    report(
        dataset=folder / DATASET,
        bytes=size,
        samples=outcome.samples,
        made=outcome.new_samples,
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
    tell(f"{folder / DATASET}: {samples}, {outcome.new_samples} new, {_mib(size)}")
    tell(f"  {rows.counts_text}; " + ", ".join(f"{count} {part}" for part, count in split.items()))
    if isinstance(config, Config) and (acceleration := describe_acceleration(config)):
        tell(f"  {acceleration}")
    tell(f"  check it: radhar verify {folder}")


def print_part(outcome: "BuildOutcome", out: Path, part: str) -> None:
    """Print what a part of a data set holds, and how to merge it.

    Args:
        outcome: that of the build of the part.
        out: folder of the data set.
        part: the part, as K/N.
    """
    report(folder=outcome.folder, part=part, samples=outcome.samples, made=outcome.new_samples)
    samples = counted(outcome.samples, "sample")
    tell(f"{outcome.folder}: part {part} is complete: {samples}, {outcome.new_samples} new")
    tell(f"  when all parts are: radhar merge {out}")


def print_plan(config: "AnyConfig", jobs: int | None) -> None:
    """Print stages, samples, bytes and time of a build, estimated within DRY_RUN_S; write nothing.

    Args:
        config: that of the data set.
        jobs: number of processes; None for as many as pay.
    """
    from radhar_cli.config.class_laws import laws_by_class
    from radhar_cli.config.data_set import MeasuredConfig
    from radhar_cli.dataset.estimate import CHECK_SHARE, DRY_RUN_S, AtLeast, Estimate, plan_build
    from radhar_cli.dataset.layout import Rows
    from radhar_cli.dataset.split import split_rows, split_warnings
    from radhar_cli.scene.products.acceleration import describe_acceleration
    from radhar_cli.scene.products.table import plan_images

    rows = Rows.of(config)
    samples = f"samples     {len(rows)} = {rows.counts_text}"
    if isinstance(config, MeasuredConfig):
        report(samples=len(rows), classes=_class_counts(rows), maps=config.maps)
        tell(f"{samples}\nnothing was written")
        return
    products = plan_images(config).products
    with BarProgress() as bars:
        build_plan = plan_build(config, jobs, bars, DRY_RUN_S)
    cost, warnings = build_plan.cost, split_warnings(config, split_rows(config))
    warnings += [*laws_by_class(config), *(one["message"] for one in build_plan.warnings)]
    report(
        stages=[product.name for product in products],
        classes=_class_counts(rows),
        maps=config.maps,
        jobs=build_plan.jobs,
        checked=build_plan.checked,
        redrawn=build_plan.redrawn,
        warnings=warnings,
        training_seconds=build_plan.training_seconds,
        **dict.fromkeys(field.name for field in fields(Estimate)) | vars(cost),
    )
    shares = {} if isinstance(cost, AtLeast) else cost.shares
    _tell_stages({product.name: product.does for product in products}, shares)
    short = f", then {CHECK_SHARE * DRY_RUN_S:g} s were over" if build_plan.cut_short else ""
    checked = f"{build_plan.checked} of {len(rows)} checked"
    tell(f"{samples}\nscenes      {checked}: {build_plan.redrawn} drawn again{short}")
    _tell_cost(build_plan)
    if acceleration := describe_acceleration(config):
        tell(f"            {acceleration}")
    _tell_training(config, build_plan.training_seconds)
    for message in warnings:
        tell(f"warning: {message}")
    tell("nothing was written")


def _tell_stages(products: Mapping[str, str], shares: Mapping[str, float]) -> None:
    """Print the stages of a build, and the share of its processor time that each takes.

    Args:
        products: what each product of a sample is, by name.
        shares: share of each stage, %; empty where no sample was timed.
    """
    from radhar_cli.dataset.estimate import STAGES

    small = 0
    for stage in shares or products:
        share, does = shares.get(stage, 0.0), STAGES.get(stage) or products[stage]
        if shares and share < SMALL:
            small += 1
            continue
        tell(f"stage       {f'{share:3.0f} %  ' if shares else ''}{stage}: {does}")
    if small:
        tell(f"stage        <1 %  {counted(small, 'stage')} more")


def _tell_cost(build_plan: "BuildPlan") -> None:
    """Print bytes and time of a build, and what the time rests on."""
    from radhar_cli.dataset.estimate import BUSY, AtLeast
    from radhar_cli.dataset.workers import cores

    cost, jobs = build_plan.cost, build_plan.jobs
    low, high = cost.seconds_range
    if isinstance(cost, AtLeast):
        tell(f"on disk     not known: no sample was finished within {build_plan.waited:.0f} s")
        tell(f"time        not known: more than {low:.0f} s with --jobs {jobs}")
        return
    tell(f"on disk     dataset.h5 {_mib(cost.hdf5_bytes)}, png {_mib(cost.png_bytes)}")
    timed = counted(cost.probes, "sample")
    tell(
        f"time        about {cost.seconds:.1f} s with --jobs {jobs} ({low:.0f} to {high:.0f}), "
        f"by {timed}"
    )
    if cost.core_share < BUSY and jobs <= cores():
        tell(
            f"            the machine is busy: a process had {100 * cost.core_share:.0f} % of a "
            f"core; with nothing else running about {cost.seconds_alone:.1f} s"
        )


def _tell_training(config: "Config", seconds: float) -> None:
    """Print the time of training on a map, and that with images of the radar's own size.

    Args:
        config: that of the data set.
        seconds: time of a core that training on a map takes, s.
    """
    from radhar_cli.config.first_level import size_of_frames
    from radhar_cli.dataset.estimate import EPOCHS
    from radhar_cli.schema.number import nominal

    height, width = config.image.size_px
    shape = f"{height} x {width} px"
    tell(f"training    some {_time(seconds)} of a core: {EPOCHS} epochs of a map's images, {shape}")
    cells = size_of_frames(config.radar, nominal(config.duration_s))
    if cells is not None and prod(cells) < height * width:
        smaller = _time(seconds * prod(cells) / (height * width))
        tell(f"            with image.size_px={[*cells]}, a pixel a cell of stft, some {smaller}")


def _time(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def _mib(count: int) -> str:
    return f"{count / 2**20:.1f} MiB"
