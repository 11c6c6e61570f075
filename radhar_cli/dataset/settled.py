"""Outcomes of the survey, kept with an unfinished build so that going on starts at once."""

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path

from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import WORK
from radhar_cli.pipeline.survey import Drawn

SETTLED = "settled"


def store_settled(folder: Path, identity_hash: str, start: int, outcomes: list[Drawn]) -> None:
    """Keep the outcomes of the rows from `start` on, with a checksum."""
    text = json.dumps([[outcome.attempt, outcome.kinds] for outcome in outcomes])
    kept = f"{_checksum(identity_hash, start, text)}\n{text}"
    write_whole(folder, _path(folder, start), kept.encode())


def settled_rows(folder: Path, identity_hash: str, starts: Iterable[int]) -> dict[int, list[Drawn]]:
    """Of `starts`, what is kept whole: {first row: outcomes of it and the rows after it}."""
    found = {}
    for start in starts:
        try:
            checksum, _, text = _path(folder, start).read_text().partition("\n")
        except (OSError, UnicodeDecodeError):
            continue
        if checksum == _checksum(identity_hash, start, text):
            found[start] = [Drawn(attempt, kinds) for attempt, kinds in json.loads(text)]
    return found


def _path(folder: Path, start: int) -> Path:
    return folder / WORK / SETTLED / f"{start:09d}.json"


def _checksum(identity_hash: str, start: int, text: str) -> str:
    return hashlib.sha256(f"{identity_hash} {start}\n{text}".encode()).hexdigest()
