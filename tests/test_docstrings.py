"""Docstrings: whoever calls a function reads what it does, in a sentence that names its subject."""

import ast
import re
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "radhar_cli"
PATHS = sorted(PACKAGE.rglob("*.py"))
# A sentence that begins so leaves its reader to ask "of what?", or names no subject.
FRAGMENT = re.compile(
    r"(Of|As|With|By|From|To|The same|Amplitude\.|That|Those|What|How|Why|Who|Where|When|Say)\b"
)

Function = ast.FunctionDef | ast.AsyncFunctionDef


def classes() -> dict[str, ast.ClassDef]:
    """{name: definition} of every class of the package, whose names mean one thing each."""
    return {
        node.name: node
        for path in PATHS
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ClassDef)
    }


def base_names(definition: ast.ClassDef) -> list[str]:
    """Names of the bases, without subscripts and modules."""
    names = []
    for base in definition.bases:
        plain = base.value if isinstance(base, ast.Subscript) else base
        names.append(plain.attr if isinstance(plain, ast.Attribute) else ast.unparse(plain))
    return names


def described_members(definition: ast.ClassDef) -> set[str]:
    """Names of the members that a class describes, by docstrings or under Attributes."""
    members = {
        member.name
        for member in definition.body
        if isinstance(member, Function) and ast.get_docstring(member)
    }
    members |= {
        member.target.id
        for member in definition.body
        if isinstance(member, ast.AnnAssign) and isinstance(member.target, ast.Name)
    }
    _, _, attributes = (ast.get_docstring(definition) or "").partition("Attributes:")
    for line in attributes.splitlines():
        if match := re.match(r" +([a-z_, ]+): ", line):
            members |= set(match[1].split(", "))
    return members


def protocol_members(known: dict[str, ast.ClassDef]) -> set[str]:
    """Names that a Protocol of the package describes once, for whoever implements it."""
    protocols = [one for one in known.values() if "Protocol" in base_names(one)]
    return set().union(*map(described_members, protocols))


def inherits_docstring(name: str, definition: ast.ClassDef, known: dict[str, ast.ClassDef]) -> bool:
    """Whether a base class of the package describes a member of that name."""
    bases = [known[base] for base in base_names(definition) if base in known]
    return any(
        name in described_members(base) or inherits_docstring(name, base, known) for base in bases
    )


def undocumented(path: Path, known: dict[str, ast.ClassDef]) -> list[str]:
    """Public functions, classes and methods of a file that nothing describes."""
    missing, protocols = [], protocol_members(known)
    for node in ast.parse(path.read_text()).body:
        if not isinstance(node, Function | ast.ClassDef) or node.name.startswith("_"):
            continue
        if not ast.get_docstring(node):
            missing.append(f"{path.relative_to(PACKAGE)}:{node.lineno} {node.name}")
        if isinstance(node, ast.ClassDef):
            elsewhere = protocols | described_members(node)
            missing += [
                f"{path.relative_to(PACKAGE)}:{member.lineno} {node.name}.{member.name}"
                for member in node.body
                if isinstance(member, Function)
                and not member.name.startswith("_")
                and member.name not in elsewhere
                and not inherits_docstring(member.name, node, known)
            ]
    return missing


def texts(path: Path) -> list[tuple[int, str]]:
    """(line, text) of every docstring, and of every text under a field."""
    bodies = [getattr(node, "body", []) for node in ast.walk(ast.parse(path.read_text()))]
    return [
        (member.lineno, member.value.value)
        for body in bodies
        if isinstance(body, list)
        for member in body
        if isinstance(member, ast.Expr)
        and isinstance(member.value, ast.Constant)
        and isinstance(member.value.value, str)
    ]


def test_everything_public_says_what_it_does() -> None:
    known = classes()
    missing = [line for path in PATHS for line in undocumented(path, known)]
    assert not missing, f"{len(missing)}:\n" + "\n".join(missing)


def test_every_text_names_its_subject() -> None:
    fragments = [
        f"{path.relative_to(PACKAGE)}:{line} {text.splitlines()[0]}"
        for path in PATHS
        for line, text in texts(path)
        if FRAGMENT.match(text) or len(text.split()) < 2
    ]
    assert not fragments, f"{len(fragments)}:\n" + "\n".join(fragments)


@pytest.mark.parametrize(
    ("text", "is_fragment"),
    [
        ("Of walking.", True),
        ("Walking speed.", False),
        ("As the floor.", True),
        ("Offset.", False),
        ("How people walk.", True),
        ("When the walk begins, s.", True),
        ("Say which keys are unused.", True),
        ("Whether the walk has begun.", False),
    ],
)
def test_a_fragment_is_told_from_a_sentence(text: str, is_fragment: bool) -> None:
    assert bool(FRAGMENT.match(text)) == is_fragment
