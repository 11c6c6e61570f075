"""Section of a data card with the results of its audit, once one has been made."""

from math import isfinite
from pathlib import Path

from radhar_cli.dataset.audited import (
    AUDIT,
    AUDIT_FIGURE,
    AuditedLine,
    StoredAudit,
    audit_folder,
    read_audit,
)
from radhar_cli.dataset.files import read_bytes
from radhar_cli.dataset.layout import CARD
from radhar_cli.files.replacing import refuse_links, write_result
from radhar_cli.files.table_text import markdown_table

BEGIN, END = "<!-- radhar audit -->", "<!-- end of radhar audit -->"
BEFORE = "## Known biases and limits"
TOO_FEW = "too few samples to tell"
MAX_CARD = 2**22  # bytes


def add_to_card(data: Path, folder: Path) -> Path | None:
    """Put the audit beside a data set into its card, in place of an earlier one.

    Args:
        data: the data set.
        folder: folder of the audit.

    Returns:
        Path of the card; None where there is none, or the audit lies elsewhere.
    """
    beside = audit_folder(data)
    if beside is None or folder.resolve() != beside.resolve():
        return None
    card = beside.parent / CARD
    if not card.is_file():
        return None
    refuse_links(beside.parent, card)
    text = read_bytes(card, MAX_CARD).decode(errors="surrogateescape")
    stored = read_audit(data)
    assert stored is not None
    text = with_section(text, audit_section(stored))
    write_result(beside.parent, card, text.encode(errors="surrogateescape"))
    return card


def with_section(text: str, section: str) -> str:
    """Card with a section of an audit in place of an earlier one, else before the known limits."""
    section = f"{BEGIN}\n{section}\n{END}"
    start, stop = text.find(BEGIN), text.find(END)
    if 0 <= start < stop:
        return text[:start] + section + text[stop + len(END) :]
    place = text.find(f"\n{BEFORE}")
    if place < 0:
        return f"{text.rstrip()}\n\n{section}\n"
    return f"{text[: place + 1]}{section}\n\n{text[place + 1 :]}"


def audit_section(stored: StoredAudit) -> str:
    """Markdown of the section: a table of what tells the class, and a figure."""
    told_lines = [line for line in stored.lines if line.cure]
    head = (
        f"A small forest guessed the class of {stored.samples} samples ({stored.classes} classes, "
        f"{stored.held_out}s held out) from what is not the movement, by `radhar audit`."
    )
    parts = ["## Who is told apart by what", head]
    if told_lines:
        header = ("from", "right, % (95 %)", "chance, %", "instead")
        parts.append(markdown_table(header, map(_row, told_lines)))
    verdicts = [line.verdict for line in stored.lines]
    chance, few = (
        sum(begin in verdict for verdict in verdicts) for begin in ("at chance", TOO_FEW)
    )
    others = "of the others " if told_lines else ""
    unsure = f", {few} with too few samples to tell" if few else ""
    parts.append(f"At chance: {chance} {others}of {len(stored.lines)} lines{unsure}.")
    if stored.sentences:
        parts.append("\n".join(f"- {sentence}" for sentence in stored.sentences))
    parts.append(f"![how often the class is told, beside chance]({AUDIT}/{AUDIT_FIGURE})")
    return "\n\n".join(parts)


def _row(line: AuditedLine) -> tuple[str, str, str, str]:
    """Row of the table."""
    if not isfinite(line.share):
        return line.name, "not tested", "", line.cure
    share, low, high, chance = (f"{100 * value:.1f}" for value in line[2:6])
    return line.name, f"{share} ({low} to {high})", chance, line.cure
