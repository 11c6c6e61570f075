"""Captures that are compressed as a whole: .xz, .gz, .bz2 and .zip, unpacked into a folder."""

import bz2
import gzip
import lzma
import re
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any

from radhar_cli.errors import CaptureError

OPENERS: dict[bytes, Any] = {b"\xfd7zXZ\0": lzma.open, b"\x1f\x8b": gzip.open, b"BZh": bz2.open}
SUFFIXES = (".xz", ".gz", ".bz2", ".tgz")
MAX_PACKING = 200  # growth of a file when it is unpacked
LEAST = 2**20  # bytes that any file may unpack to
BLOCK = 2**20
MAX_MEMBERS = 2**16


def unpack_file(path: Path, head: bytes, scratch: Path) -> Path:
    """Unpack a file into a scratch folder, unless it is not compressed as a whole.

    Args:
        path: the file.
        head: its first bytes.
        scratch: folder for what is unpacked, which is made.

    Returns:
        Path of the unpacked content; of a file that is not compressed its own.

    Raises:
        CaptureError: it is damaged, or unpacks to far more than it has.
    """
    opener = next((OPENERS[magic] for magic in OPENERS if head.startswith(magic)), None)
    if opener is None or path.suffix.lower() not in SUFFIXES:
        return path
    if Path(path.stem).suffix.lower() == ".tar" or path.suffix.lower() == ".tgz":
        raise CaptureError(f"{path}: holds several files; unpack it first (tar -xf {path})")
    limit = max(MAX_PACKING * path.stat().st_size, LEAST)
    scratch.mkdir(exist_ok=True)
    target = scratch / path.stem
    try:
        with opener(path, "rb") as packed, target.open("wb") as file:
            copy_up_to(packed, file, limit, path)
    except (EOFError, lzma.LZMAError, zlib.error, OSError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CaptureError(f"{path}: cannot be unpacked ({reason})") from None
    return target


def unpack_zip(path: Path, scratch: Path) -> list[Path]:
    """Unpack the files of a .zip, all of one kind, into a folder.

    Args:
        path: the .zip.
        scratch: folder for its files, which is made.

    Returns:
        Their paths, in the order of the numbers in their names.

    Raises:
        CaptureError: it is damaged, unpacks to far more than it has, or holds files of several
            kinds.
    """
    from radhar_cli.readers.captures.parser_errors import parser_errors_as_capture_errors

    scratch.mkdir(exist_ok=True)
    with parser_errors_as_capture_errors(str(path)), zipfile.ZipFile(path) as archive:
        members = [m for m in archive.infolist() if not m.is_dir() and _is_data(m.filename)]
        suffixes = sorted({Path(member.filename).suffix.lower() for member in members})
        if len(suffixes) != 1 or len(members) > MAX_MEMBERS:
            raise CaptureError(
                f"{path}: holds {len(members)} files ({', '.join(suffixes) or 'none'}); should "
                "hold those of a capture alone; unpack it first"
            )
        limit = max(MAX_PACKING * path.stat().st_size, LEAST)
        if sum(member.file_size for member in members) > limit:
            raise CaptureError(f"{path}: is compressed {MAX_PACKING}-fold or more")
        paths = []
        for number, member in enumerate(sorted(members, key=lambda m: order_by_number(m.filename))):
            target = scratch / f"{number}" / Path(member.filename).name
            target.parent.mkdir()
            with archive.open(member) as packed, target.open("wb") as file:
                copy_up_to(packed, file, limit, path)
            paths.append(target)
    return paths


def _is_data(name: str) -> bool:
    """Whether a file of an archive may be data: not hidden, of a Mac, or a text about them."""
    parts = Path(name).parts
    is_about = Path(name).stem.lower() in ("readme", "license")
    return not is_about and not any(part.startswith((".", "__")) for part in parts)


def order_by_number(name: str) -> list[tuple[int, str]]:
    """Key that sorts names by the numbers in them."""
    return [(int(p), "") if p.isdigit() else (-1, p) for p in re.split(r"(\d+)", name)]


def copy_up_to(packed: IO[bytes], file: IO[bytes], limit: int, path: Path) -> None:
    """Copy what a packed file holds, block by block.

    Raises:
        CaptureError: it holds more bytes than a limit.
    """
    size = 0
    while block := packed.read(BLOCK):
        size += len(block)
        if size > limit:
            raise CaptureError(f"{path}: is compressed {MAX_PACKING}-fold or more")
        file.write(block)
