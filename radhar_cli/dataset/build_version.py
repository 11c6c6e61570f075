"""Which build of radhar this is."""

import hashlib
from functools import cache
from pathlib import Path

from radhar_cli import __version__

PACKAGE = Path(__file__).resolve().parents[1]
# Of the package, what no byte of a data set goes through.
ELSEWHERE = ("commands", "figures", "learning", "study")


@cache
def build_version() -> str:
    """The version of radhar and a digest of its sources: two commits may share a version."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*")):
        place = path.relative_to(PACKAGE)
        if path.suffix in (".py", ".rgb") and place.parts[0] not in ELSEWHERE:
            digest.update(f"{place.as_posix()}\0{path.stat().st_size}\0".encode())
            digest.update(path.read_bytes())
    return f"{__version__}+{digest.hexdigest()[:12]}"
