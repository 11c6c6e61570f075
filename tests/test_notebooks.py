"""The notebooks run, are stored as they ran, and open in Colab by a badge."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest
import run_notebook
from helpers.command_line import ROOT

NOTEBOOKS = {path.stem: path for path in run_notebook.NOTEBOOKS}
BADGE = r"\]\(https://colab\.research\.google\.com/github/([\w.-]+/[\w.-]+)/blob/main/([\w/.-]+)\)"
INSTALL = (
    "import importlib.util\n\n"
    'if importlib.util.find_spec("radhar") is None:  # as in Colab\n'
    '    %pip install --quiet "radhar[train] @ git+https://github.com/{}"'
)
MOST_BYTES = 300_000


@pytest.fixture(params=NOTEBOOKS)
def path(request: pytest.FixtureRequest) -> Path:
    return NOTEBOOKS[request.param]


def code_cells(notebook: Any) -> Iterator[Any]:
    return (cell for cell in notebook.cells if cell.cell_type == "code")


def printed(notebook: Any) -> str:
    outputs = (output for cell in code_cells(notebook) for output in cell.outputs)
    return "".join(output.get("text", "") for output in outputs)


def test_a_notebook_is_stored_as_it_ran(path: Path) -> None:
    """Cells in order, without an error or a path of the machine that it ran on."""
    notebook = nbformat.read(path, 4)
    nbformat.validate(notebook)
    cells = [*code_cells(notebook)]
    assert [cell.execution_count for cell in cells] == [*range(1, len(cells) + 1)]
    assert all(output.output_type != "error" for cell in cells for output in cell.outputs)
    assert sum("image/jpeg" in str(cell.outputs) for cell in cells) >= 1
    assert not re.search(r"(?<![\w.])/(home|root|tmp|usr|var|work|Users)/", printed(notebook))
    assert path.stat().st_size < MOST_BYTES


def test_a_notebook_opens_in_colab(path: Path) -> None:
    """Its badge leads to itself, and its first code installs radhar where it is not."""
    notebook = nbformat.read(path, 4)
    badge = re.search(BADGE, notebook.cells[0].source)
    assert badge
    assert ROOT / badge[2] == path
    assert notebook.cells[0].metadata.tags == ["colab"], "the site leaves it out"
    assert next(code_cells(notebook)).source == INSTALL.format(badge[1])


def test_the_page_lists_the_notebooks_and_opens_them_in_colab() -> None:
    text = run_notebook.PAGE.read_text()
    badges = re.findall(BADGE, text)
    repository = re.search(BADGE, nbformat.read(NOTEBOOKS["first_hour"], 4).cells[0].source)
    assert repository
    assert badges == [(repository[1], f"notebooks/{name}.ipynb") for _, name in badges_of(text)]
    assert {name for _, name in badges_of(text)} == set(NOTEBOOKS)
    for name, source in NOTEBOOKS.items():
        assert (run_notebook.PAGE.parent / f"{name}.ipynb").resolve() == source


def badges_of(text: str) -> list[tuple[str, str]]:
    """Title and name of each notebook in the rows of the page's table."""
    return re.findall(r"^\| \[([^]]+)\]\((\w+)\.ipynb\) \|", text, re.MULTILINE)


def test_another_repository_is_written_everywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    book, page = tmp_path / "extending.ipynb", tmp_path / "notebooks.md"
    book.write_text(NOTEBOOKS["extending"].read_text())
    page.write_text(run_notebook.PAGE.read_text())
    monkeypatch.setattr(run_notebook, "NOTEBOOKS", [book])
    monkeypatch.setattr(run_notebook, "PAGE", page)
    run_notebook.write_address("some-body/radar.x")
    notebook = nbformat.read(book, 4)
    badges = re.findall(BADGE, notebook.cells[0].source + page.read_text())
    assert {repository for repository, _ in badges} == {"some-body/radar.x"}
    assert next(code_cells(notebook)).source == INSTALL.format("some-body/radar.x")


# What the last cells that print say at small size, where a network has learned little.
RUNS: dict[str, tuple[dict[str, int], str]] = {
    "first_hour": ({}, r"recorded: (\w+)/\d+: \1 .*"),
    "own_board": ({"samples": 5, "epochs": 2}, r"own/walking/ben\.csv \[('\w+'(, )?){4}\]"),
    "sim_to_real": ({"samples": 5, "epochs": 2, "seconds": 5}, r" +run_adapted: \d+ %"),
    "extending": ({"samples": 5, "epochs": 1}, r"data: 15 samples; .* equal byte for byte.*"),
}


def test_every_notebook_is_run() -> None:
    assert set(RUNS) == set(NOTEBOOKS)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::RuntimeWarning:zmq")
def test_a_notebook_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MARS", raising=False)
    sizes, line = RUNS[path.stem]
    text = printed(run_notebook.execute_notebook(path, tmp_path, **sizes))
    matching = [one for one in text.splitlines() if re.fullmatch(line, one)]
    assert len(matching) >= (2 if path.stem == "first_hour" else 1), text  # two recordings
