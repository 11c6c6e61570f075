"""Outcomes of the survey, kept with an unfinished build so that going on starts at once."""

import hashlib
import json
from pathlib import Path

from pydantic import TypeAdapter

from radhar_cli.dataset.files import read_bytes, write_whole
from radhar_cli.dataset.layout import WORK
from radhar_cli.errors import FolderError
from radhar_cli.pipeline.survey import KINDS, MOST_ATTEMPTS, Drawn

SETTLED = "settled"
_KEPT = TypeAdapter(list[tuple[int, dict[str, bool]]])


def store_settled(folder: Path, identity_hash: str, start: int, outcomes: list[Drawn]) -> None:
    """Keep the outcomes of the rows from `start` on, with a checksum."""
    text = json.dumps([[outcome.attempt, outcome.kinds] for outcome in outcomes])
    kept = f"{_checksum(identity_hash, start, text)}\n{text}"
    write_whole(folder, _path(folder, start), kept.encode())


def settled_rows(folder: Path, identity_hash: str, starts: range) -> dict[int, list[Drawn]]:
    """Of `starts`, what is kept whole: {first row: outcomes of it and the rows before the next}."""
    found = {}
    for start in starts:
        try:
            checksum, _, text = read_bytes(_path(folder, start)).decode().partition("\n")
            kept = _KEPT.validate_json(text)
        except (FolderError, FileNotFoundError, ValueError):
            continue
        whole = len(kept) == min(starts.step, starts.stop - start) and all(
            0 <= attempt < MOST_ATTEMPTS and kinds.keys() == set(KINDS) for attempt, kinds in kept
        )
        if whole and checksum == _checksum(identity_hash, start, text):
            found[start] = [Drawn(attempt, kinds) for attempt, kinds in kept]
    return found


def _path(folder: Path, start: int) -> Path:
    return folder / WORK / SETTLED / f"{start:09d}.json"


def _checksum(identity_hash: str, start: int, text: str) -> str:
    return hashlib.sha256(f"{identity_hash} {start}\n{text}".encode()).hexdigest()
