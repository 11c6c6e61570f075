"""Results of `radhar audit` that lie beside a data set, read for cards and reports."""

from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from radhar_cli.dataset.layout import DATASET
from radhar_cli.errors import FolderError
from radhar_cli.files.untrusted import read_json

AUDIT = "audit"  # folder in that of a data set
AUDIT_NUMBERS, AUDIT_TABLE, AUDIT_FIGURE = "audit.json", "audit.csv", "audit.png"
AUDIT_KIND = "radhar audit"
MAX_LINES = 1000
MAX_WORDS = 1000  # characters


class AuditedLine(NamedTuple):
    """Share of samples whose class is told from something that is not the movement."""

    part: str  # numbers, recordings, margins, noise, clouds
    name: str
    share: float  # mean over classes, of samples held out; NaN where it was not tested
    low: float  # of 95 %
    high: float
    chance: float
    verdict: str
    cure: str  # what to draw or record instead; empty where there is nothing to do


class StoredAudit(NamedTuple):
    """An audit that was read from a file."""

    samples: int
    classes: int
    held_out: str  # person, recording or sample
    lines: tuple[AuditedLine, ...]
    sentences: tuple[str, ...]  # duplicates, persons in several splits, onsets on cue


def audit_folder(data: Path) -> Path | None:
    """Folder of the audit of a data set of radhar, made or not; None beside other data."""
    folder = data if data.is_dir() else data.parent
    return folder / AUDIT if (folder / DATASET).is_file() else None


def read_audit(data: Path) -> StoredAudit | None:
    """Read the audit that lies beside a data set; None where there is none, or of another build.

    Raises:
        FolderError: the file is damaged.
    """
    folder = audit_folder(data)
    if folder is None or not (folder / AUDIT_NUMBERS).is_file():
        return None
    path = folder / AUDIT_NUMBERS
    document = read_json(path)
    try:
        if document["kind"] != AUDIT_KIND or len(document["lines"]) > MAX_LINES:
            raise ValueError("is no audit")
        if document.get("bytes") not in (None, (folder.parent / DATASET).stat().st_size):
            return None
        lines = tuple(_line(line) for line in document["lines"])
        sentences = tuple(_words(text) for text in document["sentences"][:MAX_LINES])
        held_out, classes = _words(document["held_out"]), len(document["classes"])
        return StoredAudit(int(document["samples"]), classes, held_out, lines, sentences)
    except (KeyError, TypeError, ValueError) as error:
        raise FolderError(f"{path}: is damaged ({error}); `radhar audit` makes it anew") from None


def _line(line: Any) -> AuditedLine:
    """Check a line of the file."""
    share, low, high, chance = shares = [
        float("nan") if line[key] is None else float(line[key]) for key in _SHARES
    ]
    if any(isfinite(value) and not 0 <= value <= 1 for value in shares):
        raise ValueError("a share is not from 0 to 1")
    part, name, verdict, cure = (_words(line[key]) for key in ("part", "name", "verdict", "cure"))
    return AuditedLine(part, name, share, low, high, chance, verdict, cure)


_SHARES = ("share", "low", "high", "chance")


def _words(value: Any) -> str:
    """Check a text of the file: no line breaks or control characters, of bounded length."""
    if not isinstance(value, str) or len(value) > MAX_WORDS or not value.isprintable():
        raise ValueError(f"{str(value)[:40]!r} is not a line of text")
    return value
