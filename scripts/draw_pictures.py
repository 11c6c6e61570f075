"""Save pictures of the documentation, and the commit that each was drawn at.

    python scripts/draw_pictures.py                       # print the pictures, oldest first
    python scripts/draw_pictures.py confusion.png --by 'radhar eval ...' [--commit HASH]

Scripts that draw call `save_picture` or `record_pictures`; pictures that a command or a person
made are recorded by the second line. docs/images/pictures.json has the digest, the commit and the
maker of each; tests/scripts/test_draw_pictures.py keeps it true. Draw with a clean working tree.
"""

import argparse
import json
import subprocess
from hashlib import sha256
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "docs/images"
RECORD = PICTURES / "pictures.json"
ENDS = (".png", ".gif")
# Letters of figures that are twice as wide as a page.
LARGE = {
    "font.size": 14,
    "axes.titlesize": 14,
    "axes.labelsize": 14,
    "xtick.labelsize": 12,
    "ytick.labelsize": 12,
    "legend.fontsize": 12,
}


def save_picture(figure: Figure, path: Path, dpi: float, by: str = "") -> None:
    """Save a figure as RGB of all its colours, and record it; `by` is the command that draws it."""
    figure.savefig(path, dpi=dpi)
    save_as_rgb(path, by)


def save_as_rgb(path: Path, by: str) -> None:
    """Save a picture anew as RGB of all its colours, and record it."""
    with Image.open(path) as picture:
        pixels = picture.convert("RGB")
    pixels.save(path, optimize=True)
    record_pictures([path], by)
    print(path)


def record_pictures(paths: list[Path], by: str, commit: str = "") -> None:
    """Record pictures of docs/images at a commit, that of the working tree; leave others alone."""
    pictures, commit = read_record(), commit or git("rev-parse", "--short=8", "HEAD")
    for path in paths:
        if PICTURES in path.resolve().parents:
            entry = {"sha256": digest(path), "commit": commit, "by": by}
            pictures[str(path.resolve().relative_to(PICTURES))] = entry
    text = json.dumps(dict(sorted(pictures.items())), indent=1)
    RECORD.write_text(text + "\n", encoding="utf-8")


def read_record() -> dict[str, dict[str, str]]:
    """Read {picture: its sha256, commit, and by what it was drawn}."""
    record_: dict[str, dict[str, str]] = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    return record_


def digest(path: Path) -> str:
    """SHA-256 of a file, the first 16 digits."""
    return sha256(path.read_bytes()).hexdigest()[:16]


def all_pictures() -> list[Path]:
    """Every picture below docs/images."""
    return sorted(path for path in PICTURES.rglob("*") if path.suffix in ENDS)


def git(*arguments: str) -> str:
    """Output of a git command in the repository."""
    done: Any = subprocess.run(
        ["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True
    )
    return str(done.stdout).strip()


def main(arguments: list[str] | None = None) -> None:
    """Record pictures, or print all."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="PICTURE", help="below docs/images")
    parser.add_argument("--by", default="", help="what made them")
    parser.add_argument("--commit", default="", help="at which; the default is that of the tree")
    options = parser.parse_args(arguments)
    if options.names:
        record_pictures([PICTURES / name for name in options.names], options.by, options.commit)
        return
    lines = []
    for name, entry in read_record().items():
        date = git("log", "-1", "--format=%ad", "--date=format:%Y-%m-%d %H:%M", entry["commit"])
        lines.append(f"{date}  {entry['commit']}  {name:40}  {entry['by']}")
    print("\n".join(sorted(lines)))


if __name__ == "__main__":
    main()
