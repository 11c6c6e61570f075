"""What `generate` prints while it works and when it is done."""

import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from radhar_cli.commands.tell import tell
from radhar_cli.config.schema import Config
from radhar_cli.dataset.layout import DATASET, PNG, SPLITS, Rows
from radhar_cli.dataset.split import split_rows
from radhar_cli.untrusted import shown

if TYPE_CHECKING:
    from radhar_cli.dataset.build import Outcome


class BarProgress:
    """A tqdm bar per stage on a terminal; messages alone elsewhere."""

    def __init__(self, unit: str = "sample") -> None:
        self._unit = unit
        self._bar: tqdm[Any] | None = None

    def stage(self, name: str, total: int, done: int) -> None:
        self.close()
        if done and done < total:
            self.say(f"resuming: {done} of {total} {self._unit}s are finished")
        self._bar = tqdm(
            total=total, initial=done, desc=name, unit=self._unit, disable=None, file=sys.stderr
        )

    def advance(self, count: int) -> None:
        if self._bar is not None:
            self._bar.update(count)

    def say(self, message: str) -> None:
        tqdm.write(shown(message), file=sys.stderr)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def print_outcome(config: Config, outcome: "Outcome") -> None:
    """Say what lies where."""
    folder = outcome.folder
    if outcome.already_complete:
        tell(f"{folder} is complete: {outcome.samples} samples; nothing to do")
        return
    rows, split = Rows.of(config), Counter(int(part) for part in split_rows(config))
    size = (folder / DATASET).stat().st_size / 2**20
    tell(f"{folder / DATASET}: {outcome.samples} samples, {size:.1f} MiB")
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


def print_part(outcome: "Outcome", out: Path, part: str) -> None:
    """Say what a part holds and what to do with it."""
    tell(
        f"{outcome.folder}: part {part} is complete: {outcome.samples} samples, {outcome.made} new"
    )
    tell(f"  when all parts are: radhar merge {out}")
