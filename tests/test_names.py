"""Names of values and arguments: nouns of the field, not words that could stand for anything."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "radhar_cli"
# Words that say nothing of a value. In a comprehension, which is read at a glance, they may stand.
# fmt: off
GENERAL = {
    "one", "found", "there", "made", "given", "most", "at", "some", "told", "seen", "kept", "own",
    "again", "asked", "theirs", "ours", "mine", "which", "shown", "what", "who", "whose", "here",
    "way", "thing", "things", "stuff", "whole", "taken", "everybody",
}
# fmt: on
LONGEST_FUNCTION = 45  # lines, docstring left out


def _bound_names(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and name of everything that a module assigns, loops over or takes as an argument."""
    in_comprehensions = {
        name
        for node in ast.walk(tree)
        if isinstance(node, ast.comprehension)
        for name in ast.walk(node.target)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            if node not in in_comprehensions:
                yield node.lineno, node.id
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg


FILES = sorted(path for path in PACKAGE.rglob("*.py"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_values_are_named_by_nouns_of_the_field(path: Path) -> None:
    general = [
        f"{path}:{line}: {name}"
        for line, name in _bound_names(ast.parse(path.read_text()))
        if name in GENERAL
    ]
    assert not general


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_functions_fit_on_a_screen(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            first = node.body[0]
            if ast.get_docstring(node) and len(node.body) > 1:
                first = node.body[1]
            lines = (node.end_lineno or 0) - first.lineno + 1
            assert lines <= LONGEST_FUNCTION, f"{path}:{node.lineno}: {node.name}: {lines} lines"
