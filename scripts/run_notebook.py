"""Run the notebooks, each in an empty folder, and store what they show.

    python scripts/run_notebook.py                           # all of them
    python scripts/run_notebook.py own_board                 # one
    python scripts/run_notebook.py --repository OWNER/radhar # only the address of badge and install

Colab opens and installs what lies on GitHub, and nothing in the repository knows where that is:
`--repository` writes it into the notebooks and the page that lists them.
"""

import argparse
import base64
import io
import os
import re
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
PAGE = ROOT / "docs/guide/notebooks.md"
ADDRESS = re.compile(
    r"((?:colab\.research\.google\.com/github/|git\+https://github\.com/))[\w.-]+/[\w.-]+"
)


def execute_notebook(path: Path, folder: Path, **sizes: int) -> Any:
    """Return a notebook with its outputs; `radhar` is this Python's.

    Args:
        path: The notebook.
        folder: Empty folder that it runs in.
        sizes: Other values of names that its cell with the tag `sizes` sets.

    Raises:
        CellExecutionError: A cell fails.
    """
    search = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    notebook = nbformat.read(path, 4)
    for cell in notebook.cells:
        if "sizes" in cell.metadata.get("tags", ()):
            cell.source += "".join(f"\n{name} = {value}" for name, value in sizes.items())
    place = {"metadata": {"path": str(folder)}}
    client = NotebookClient(notebook, resources=place, record_timing=False, coalesce_streams=True)
    client.execute(env={**os.environ, "PATH": search, "PYTHONPATH": str(ROOT)})
    notebook.metadata["language_info"] = {"name": "python"}
    return notebook


def store_as_jpeg(notebook: Any) -> None:
    """Make the PNGs that a notebook shows JPEGs of at most 800 pixels in width."""
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            if png := output.get("data", {}).pop("image/png", None):
                with Image.open(io.BytesIO(base64.b64decode(png))) as picture:
                    small = picture.convert("RGB")
                small.thumbnail((800, 800))
                jpeg = io.BytesIO()
                small.save(jpeg, "JPEG", quality=85)
                output["data"]["image/jpeg"] = base64.b64encode(jpeg.getvalue()).decode()
                output["metadata"] = {"image/jpeg": output["metadata"].get("image/png", {})}


def write_address(repository: str) -> None:
    """Let badges and install cells name a repository on GitHub, OWNER/NAME."""
    for path in (*NOTEBOOKS, PAGE):
        text = path.read_text(encoding="utf-8")
        path.write_text(ADDRESS.sub(rf"\g<1>{repository}", text), encoding="utf-8")


def main() -> None:
    """Run them, and write them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", help="notebooks, such as own_board; without, all")
    parser.add_argument("--repository", help="OWNER/NAME on GitHub; nothing is run")
    options = parser.parse_args()
    if options.repository:
        write_address(options.repository)
        return
    for path in NOTEBOOKS:
        if options.names and path.stem not in options.names:
            continue
        start = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            notebook = execute_notebook(path, Path(folder))
        store_as_jpeg(notebook)
        nbformat.write(notebook, path)
        print(f"{path.stem}: {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
