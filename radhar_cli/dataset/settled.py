"""Outcomes of the survey, kept with an unfinished build so that going on starts at once."""

import json
from pathlib import Path

from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import WORK

SETTLED = "settled"


def store_settled(folder: Path, start: int, outcomes: list[tuple[int, int]]) -> None:
    """Keep the outcomes of the rows from `start` on."""
    text = json.dumps(outcomes)
    write_whole(folder, folder / WORK / SETTLED / f"{start:09d}.json", text.encode())


def settled_rows(folder: Path) -> dict[int, list[tuple[int, int]]]:
    """What is kept: {first row: outcomes of it and the rows after it}."""
    place = folder / WORK / SETTLED
    return {
        int(path.stem): [(attempt, flags) for attempt, flags in json.loads(path.read_text())]
        for path in (sorted(place.iterdir()) if place.is_dir() else ())
    }
