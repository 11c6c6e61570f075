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


def _long_functions(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and name of every function that does not fit on a screen."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            first = node.body[0]
            if ast.get_docstring(node) and len(node.body) > 1:
                first = node.body[1]
            lines = (node.end_lineno or 0) - first.lineno + 1
            if lines > LONGEST_FUNCTION:
                yield node.lineno, f"{node.name}: {lines} lines"


@pytest.fixture(scope="module")
def trees() -> dict[Path, ast.Module]:
    """{path: syntax tree} of every module of the package."""
    return {path: ast.parse(path.read_text()) for path in sorted(PACKAGE.rglob("*.py"))}


def test_values_are_named_by_nouns_of_the_field(trees: dict[Path, ast.Module]) -> None:
    general = [
        f"{path}:{line}: {name}"
        for path, tree in trees.items()
        for line, name in _bound_names(tree)
        if name in GENERAL
    ]
    assert not general, "\n".join(general)


def test_functions_fit_on_a_screen(trees: dict[Path, ast.Module]) -> None:
    long = [
        f"{path}:{line}: {function}"
        for path, tree in trees.items()
        for line, function in _long_functions(tree)
    ]
    assert not long, "\n".join(long)
