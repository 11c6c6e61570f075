"""The code itself: lint, types, layers of imports, lightness of the program."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "radhar_cli"

# Data flows down this list; a room imports only from itself and from rooms above it.
ROOMS = (
    "arrays",
    "errors",
    "activity",
    "randomness",
    "process",
    "config",
    "body",
    "motion",
    "scenario",
    "radar",
    "echo",
    "processing",
    "pipeline",
    "simulation",
    "figures",
    "dataset",
    "learning",
    "tradeoff",
    "commands",
    "cli",
    "__main__",
)


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT)


def imports(path: Path) -> set[str]:
    """Modules that a file imports anywhere, functions included."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
    return found


def files() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def room(path: Path) -> str:
    first = path.relative_to(PACKAGE).parts[0]
    return first.removesuffix(".py")


@pytest.mark.parametrize("path", files(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_never_turn_back(path: Path) -> None:
    if path == PACKAGE / "__init__.py":
        assert imports(path) <= {"importlib"}, "importing the package should stay light"
        return
    here = ROOMS.index(room(path))
    for module in imports(path):
        if module.startswith("radhar_cli."):
            there = module.split(".")[1]
            assert ROOMS.index(there) <= here, f"{path.name} imports {module}"


@pytest.mark.parametrize(
    ("library", "allowed"),
    [
        ("typer", {"commands", "cli"}),
        ("h5py", {"dataset", "simulation"}),
        ("tqdm", {"commands"}),
        ("joblib", {"dataset"}),
        ("yaml", {"config", "dataset", "commands"}),
        ("torch", {"learning"}),
        ("timm", {"learning"}),
        ("sklearn", {"learning"}),
        ("skimage", {"tradeoff"}),
    ],
)
def test_libraries_stay_in_their_rooms(library: str, allowed: set[str]) -> None:
    users = {room(p) for p in files() if any(m.split(".")[0] == library for m in imports(p))}
    assert users <= allowed


def test_physics_reads_no_config_objects() -> None:
    for path in files():
        if room(path) in ("body", "motion", "radar", "echo", "processing"):
            mine = {m for m in imports(path) if m.startswith("radhar_cli.config")}
            assert mine <= {"radhar_cli.config.rounding"}, path


def test_help_needs_no_heavy_import() -> None:
    heavy = ["numpy", "scipy", "h5py", "matplotlib", "pydantic", "joblib", "PIL", "torch"]
    code = (
        "import sys; from radhar_cli.cli import program; program();"
        f"print([m for m in {heavy} if m in sys.modules])"
    )
    assert run(sys.executable, "-c", code).stdout.strip() == "[]"


def test_ruff() -> None:
    for command in (["check"], ["format", "--check"]):
        done = run(sys.executable, "-m", "ruff", *command, ".")
        assert done.returncode == 0, done.stdout


def test_mypy_strict() -> None:
    done = run(sys.executable, "-m", "mypy")
    assert done.returncode == 0, done.stdout
