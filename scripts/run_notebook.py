"""Run notebooks/first_hour.ipynb in an empty folder and store what it shows.

python scripts/run_notebook.py
"""

import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOK = ROOT / "notebooks/first_hour.ipynb"


def executed(folder: Path) -> Any:
    """The notebook with its outputs; `radhar` is this Python's.

    Raises:
        CellExecutionError: a cell fails.
    """
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    notebook = nbformat.read(NOTEBOOK, 4)
    place = {"metadata": {"path": str(folder)}}
    client = NotebookClient(notebook, resources=place, record_timing=False, coalesce_streams=True)
    client.execute(env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT)})
    notebook.metadata["language_info"] = {"name": "python"}
    return notebook


def main() -> None:
    """Run it, and write it."""
    with tempfile.TemporaryDirectory() as folder:
        nbformat.write(executed(Path(folder)), NOTEBOOK)


if __name__ == "__main__":
    main()
