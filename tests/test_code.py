"""The code itself: layers of imports, light start, one place for each kind of file."""

import ast
import graphlib
import importlib.util
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "radhar_cli"

# Data flows down this list; a package imports only from itself and from those above it.
PACKAGES = (
    "errors",
    "numerics",
    "files",
    "processes",
    "extensions",
    "schema",
    "motion",
    "radar",
    "processing",
    "readers",
    "echo",
    "config",
    "scene",
    "figures",
    "dataset",
    "capture",
    "learning",
    "study",
    "commands",
    "cli",
    "__main__",
)
# The same within rooms that have floors of their own; "" are the modules of the room itself.
FLOORS = {
    "echo": ("receiver", "", "bodies"),
    "scene": ("", "products", "checks", "single"),
}


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT)


@cache
def nodes(path: Path) -> list[ast.AST]:
    """Everything in the syntax tree of a file, its module first."""
    return [*ast.walk(ast.parse(path.read_text()))]


@cache
def imports(path: Path) -> set[str]:
    """Modules that a file imports anywhere, functions included."""
    found = set()
    for node in nodes(path):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
    return found


def files() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def package(path: Path) -> str:
    first = path.relative_to(PACKAGE).parts[0]
    return first.removesuffix(".py")


def floor(module: str) -> tuple[int, int]:
    """Place of a module, `radhar_cli.room.more`, on the way that data goes down."""
    room, *inner = module.split(".")[1:]
    floors = FLOORS.get(room, ())
    name = inner[0] if inner and inner[0] in floors else ""
    return PACKAGES.index(room), floors.index(name) if floors else 0


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def test_imports_follow_the_layers() -> None:
    back = [
        f"{path.relative_to(PACKAGE)} imports {module}"
        for path in files()
        if path != PACKAGE / "__init__.py"
        for module in imports(path)
        if module.startswith("radhar_cli.") and floor(module) > floor(module_of(path))
    ]
    assert not back


def imported_modules(path: Path) -> set[str]:
    """Modules of the package that a file imports at run time, anywhere in it."""
    modules = set[str]()
    waiting = nodes(path)[:1]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            waiting += node.orelse
            continue
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("radhar_cli"):
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                is_module = (ROOT / f"{inner.replace('.', '/')}.py").exists()
                modules.add(inner if is_module else str(node.module))
        waiting += ast.iter_child_nodes(node)
    return modules


def test_no_module_imports_itself_through_others() -> None:
    """Not even where a function imports, which only hides a circle."""
    graph = {
        module_of(path): imported_modules(path) for path in files() if path.name != "__init__.py"
    }
    assert list(graphlib.TopologicalSorter(graph).static_order())  # raises CycleError


def test_a_class_name_means_one_thing() -> None:
    found = [
        node.name
        for path in files()
        for node in ast.iter_child_nodes(nodes(path)[0])
        if isinstance(node, ast.ClassDef)
    ]
    assert len(found) == len(set(found)), [name for name in set(found) if found.count(name) > 1]


def test_the_page_has_the_imports_between_packages() -> None:
    small = PACKAGES[: PACKAGES.index("motion")]
    found: dict[str, set[str]] = {name: set() for name in PACKAGES[len(small) : -1]}
    for path in files():
        inner = {m.split(".")[1] for m in imports(path) if m.startswith("radhar_cli.")}
        if package(path) in found:
            found[package(path)] |= inner & found.keys() - {package(path)}
    rows = [
        f"| `{name}` | {', '.join(f'`{one}`' for one in PACKAGES if one in some)} |"
        for name, some in found.items()
    ]
    page = (ROOT / "docs/reference/architecture.md").read_text()
    assert "\n".join(["| package | imports |", "| --- | --- |", *rows]) in page
    assert not [name for name in small if f"`{name}`" not in page]


LIBRARIES: dict[str, set[str]] = {
    "typer": {"commands", "cli"},
    "h5py": {"files", "readers", "dataset", "scene"},
    "tqdm": {"commands"},
    "joblib": {"dataset"},
    "distributed": {"dataset"},
    "pyarrow": {"dataset"},
    "yaml": {"config", "dataset", "commands"},
    "torch": {"learning"},
    "timm": {"learning"},
    "sklearn": {"learning", "study"},
    "skimage": {"study"},
    "plotly": {"figures"},
}


def test_libraries_stay_in_their_packages() -> None:
    for library, allowed in LIBRARIES.items():
        users = {package(p) for p in files() if any(m.split(".")[0] == library for m in imports(p))}
        assert users <= allowed, library


def test_physics_reads_no_config_objects() -> None:
    for path in files():
        if package(path) in ("motion", "radar", "readers", "echo", "processing"):
            mine = {m for m in imports(path) if m.startswith("radhar_cli.config")}
            assert mine <= {"radhar_cli.numerics.rounding"}, path


def test_importing_the_package_imports_nothing_else_of_it() -> None:
    code = "import sys, radhar_cli; print([m for m in sys.modules if m.startswith('radhar_cli.')])"
    assert run(sys.executable, "-c", code).stdout.strip() == "[]"


def test_help_needs_no_heavy_import() -> None:
    heavy = ["numpy", "scipy", "h5py", "matplotlib", "pydantic", "joblib", "PIL", "torch"]
    code = (
        "import sys; from radhar_cli.cli import program; program();"
        f"print([m for m in {heavy} if m in sys.modules])"
    )
    assert run(sys.executable, "-c", code).stdout.strip() == "[]"


def test_reading_a_data_set_needs_no_physics() -> None:
    code = "import sys, radhar_cli.dataset.reading, radhar_cli.commands.terminal;"
    code += "print([m for m in ('scipy', 'matplotlib', 'PIL', 'joblib') if m in sys.modules])"
    assert run(sys.executable, "-c", code).stdout.strip() == "[]"


def test_building_maps_needs_no_slow_parts_of_scipy() -> None:
    code = "import sys, radhar_cli.dataset.build;"
    slow = [f"scipy.{part}" for part in ("stats", "signal", "interpolate", "ndimage", "optimize")]
    code += f"print([m for m in {slow} if m in sys.modules])"
    assert run(sys.executable, "-c", code).stdout.strip() == "[]"


def test_radars_that_are_no_boards_need_no_table_of_commands() -> None:
    code = "import sys, radhar_cli.dataset.build;"
    code += "print([m for m in sys.modules if m.endswith(('.ti_commands', '.ti_cfg'))])"
    assert run(sys.executable, "-c", code).stdout.strip() == "[]"


# Each kind of file from elsewhere is opened in one place, and one place writes to the terminal.
ONE_PLACE = [
    ("yaml", {"config/yaml_reader.py"}, {"dump", "safe_dump", "YAMLError", "MarkedYAMLError"}),
    ("Image", {"dataset/image_file.py"}, {"fromarray", "new"}),
    (
        "zipfile",
        {
            "readers/motion/npz.py",
            "learning/run_folder.py",
            "readers/captures/array_files.py",
            "capture/images.py",
            "readers/captures/packed_files.py",
        },
        {"ZIP_STORED", "BadZipFile"},
    ),
    ("typer", {"commands/tell.py"}, {"Argument", "Option", "Exit", "Typer"}),
]


@cache
def calls(path: Path) -> set[str]:
    """`name` and `name.attribute` of every function that a file calls."""
    called = [node.func for node in nodes(path) if isinstance(node, ast.Call)]
    names = [f for f in called if isinstance(f, ast.Name)]
    dotted = [f for f in called if isinstance(f, ast.Attribute) and isinstance(f.value, ast.Name)]
    return {f.id for f in names} | {ast.unparse(f) for f in dotted}


@pytest.mark.parametrize(
    ("library", "places", "harmless"), ONE_PLACE, ids=[library for library, *_ in ONE_PLACE]
)
def test_files_from_elsewhere_are_opened_in_one_place(
    library: str, places: set[str], harmless: set[str]
) -> None:
    for path in files():
        if str(path.relative_to(PACKAGE)) not in places:
            used = {c for c in calls(path) if c.startswith(f"{library}.")}
            assert used <= {f"{library}.{name}" for name in harmless}, path


ARRAYS = {"np.load", "np.memmap", "np.fromfile", "loadmat"}


def test_arrays_from_elsewhere_are_opened_where_they_are_checked() -> None:
    users = {str(p.relative_to(PACKAGE)) for p in files() if ARRAYS & calls(p)}
    readers = {
        f"readers/captures/{name}.py" for name in ("matlab_files", "xethru_files", "dca1000")
    }
    assert users == {*readers, "capture/images.py"}


def test_noise_is_made_by_the_receiver_alone() -> None:
    assert {p.name for p in files() if "noise_variance" in calls(p)} == {"noise_law.py"}
    # Movements draw from streams that the person of a scene names; their physics draws nothing.
    drawing = {"motion/movements", "echo/receiver", "echo/bodies"}
    draw = {
        path.relative_to(PACKAGE).parent.as_posix()
        for path in files()
        if any(c.startswith("rng.") for c in calls(path))
    } - drawing
    still = ("motion", "radar", "readers", "echo", "processing", "scene/single", "capture")
    assert not [name for name in draw if name.startswith(still)]


def test_only_one_module_prints() -> None:
    assert {p.name for p in files() if "print" in calls(p)} == {"cli.py"}
    assert {p.name for p in files() if "tqdm.write" in calls(p)} == {"terminal.py"}


def test_hdf5_is_opened_for_reading_in_one_place_and_for_writing_in_two() -> None:
    doors, in_memory = ("readers/untrusted_hdf5.py", "readers/hdf5_check.py"), "dataset/shards.py"
    fillers = {"dataset/column_writers.py", "dataset/file_description.py"}
    fillers |= {"dataset/array_description.py"}
    fillers |= {"scene/single/board_file.py", "scene/single/scene_file.py"}
    for path in files():
        name = str(path.relative_to(PACKAGE))
        if "h5py" in imports(path):
            known = {*doors, in_memory, "files/new_hdf5.py", *fillers, "dataset/identity.py"}
            assert name in known, f"{name} imports h5py"
        for node in nodes(path):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "h5py.File":
                assert name in {*doors, in_memory, "files/new_hdf5.py"}, name
                assert name in doors or ast.unparse(node.args[1]) == "'w'", name


WITHOUT_MAIN = {ROOT / "scripts/page_parts.py", ROOT / "scripts/studies/shared.py"}
SCRIPTS = sorted({*(ROOT / "scripts").rglob("*.py")} - WITHOUT_MAIN)


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda p: p.stem)
def test_scripts_use_existing_names(path: Path) -> None:
    spec = importlib.util.spec_from_file_location(f"scripts_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert callable(module.main)
