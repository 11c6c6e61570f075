"""What `generate` prints while it works and when it is done."""

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from radhar_cli.commands.bars import Bars
from radhar_cli.commands.tell import report, tell
from radhar_cli.config.schema import Config
from radhar_cli.dataset.layout import DATASET, PNG, SPLITS, Rows
from radhar_cli.dataset.split import split_rows

if TYPE_CHECKING:
    from radhar_cli.dataset.build import BuildOutcome


class BarProgress(Bars):
    """A bar per stage on a terminal; messages alone elsewhere."""

    def __init__(self, unit: str = "sample") -> None:
        super().__init__()
        self._unit = unit

    def stage(self, name: str, total: int, done: int) -> None:
        if done and done < total:
            self.close()
            self.say(f"resuming: {done} of {total} {self._unit}s are finished")
        self.open(name, total, self._unit, done)


def class_counts(rows: Rows) -> dict[str, int]:
    """{class: samples}."""
    return {one.slug: count for one, count in zip(rows.activities, rows.counts, strict=True)}


def print_outcome(config: Config, outcome: "BuildOutcome") -> None:
    """Print what was written and where."""
    folder = outcome.folder
    rows, split = Rows.of(config), Counter(int(part) for part in split_rows(config))
    size = (folder / DATASET).stat().st_size
    report(
        dataset=folder / DATASET,
        bytes=size,
        samples=outcome.samples,
        made=outcome.made,
        pngs=outcome.pngs,
        classes=class_counts(rows),
        split={SPLITS[part]: count for part, count in sorted(split.items())},
        maps=config.maps,
        warnings=[warning["message"] for warning in outcome.warnings],
    )
    if outcome.already_complete:
        tell(f"{folder} is complete: {outcome.samples} samples; nothing to do")
        return
    tell(f"{folder / DATASET}: {outcome.samples} samples, {size / 2**20:.1f} MiB")
    tell(f"  classes     {rows.counted}")
    tell("  split       " + ", ".join(f"{n} {SPLITS[part]}" for part, n in sorted(split.items())))
    tell(f"  maps        {', '.join(config.maps)}")
    if config.output.png:
        tell(f"  images      {folder / PNG}/<map>/<train|val|test>/<class>/<index>.png")
    if outcome.made < outcome.samples:
        tell(
            f"  this run    made {outcome.made} samples, and {outcome.pngs} PNGs that were missing"
        )
    tell(f"  check it    radhar verify {folder}")


def print_part(outcome: "BuildOutcome", out: Path, part: str) -> None:
    """Print what a part holds and how to merge it."""
    report(folder=outcome.folder, part=part, samples=outcome.samples, made=outcome.made)
    tell(
        f"{outcome.folder}: part {part} is complete: {outcome.samples} samples, {outcome.made} new"
    )
    tell(f"  when all parts are: radhar merge {out}")
