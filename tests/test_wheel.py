"""The wheel: all of the package and nothing else, and it works where there is no repository."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from helpers.command_line import ROOT
from helpers.small import small_config

PACKAGE, CONFIGS = ROOT / "radhar_cli", ROOT / "configs"


def run(*command: object, folder: Path, **more: str) -> str:
    done = subprocess.run(
        [*map(str, command)],
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": "", **more},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built of what git would give, as a folder of an earlier build could lend it old modules."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    for folder in (PACKAGE, CONFIGS):
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(folder, source / folder.name, symlinks=True, ignore=ignored)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    build = (sys.executable, "-m", "build", "--no-isolation", "-o", out, source)
    run(*build, folder=source)  # the archive of sources first, the wheel out of it
    (built,) = out.glob("*.whl")
    return built


def test_the_wheel_holds_the_package_and_nothing_else(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as file:
        names = {name for name in file.namelist() if ".dist-info/" not in name}
        metadata = next(name for name in file.namelist() if name.endswith("/METADATA"))
        about = file.read(metadata).decode()
        points = file.read(metadata.replace("METADATA", "entry_points.txt")).decode()
        licences = [name for name in file.namelist() if name.endswith("licenses/LICENSE")]
    found = (
        path
        for suffix in ("py", "cfg", "html", "txt")
        for path in PACKAGE.rglob(f"*.{suffix}")
        if "presets" not in path.parts
    )
    ours = {str(path.relative_to(ROOT)) for path in found}
    ours |= {
        f"radhar_cli/config/presets/{path.relative_to(CONFIGS)}"
        for path in CONFIGS.rglob("*")
        if path.is_file()
    }
    assert names == ours | {"radhar_cli/py.typed", "radhar_cli/dataset/viridis.rgb"}
    assert "radhar = radhar_cli.cli:main" in points
    assert licences
    for extra in ("train", "zoo", "cluster", "dev"):
        assert f"Provides-Extra: {extra}\n" in about


@pytest.mark.slow
def test_it_works_without_the_repository(wheel: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(wheel) as file:
        file.extractall(tmp_path / "installed")
    program = (
        "import radhar_cli, sys; from radhar_cli.cli import main;"
        f"assert radhar_cli.__file__.startswith({str(tmp_path / 'installed')!r});"
        "sys.argv[0] = 'radhar'; main()"
    )
    radhar = (sys.executable, "-P", "-c", program)
    more = {"folder": tmp_path, "PYTHONPATH": str(tmp_path / "installed")}
    run(*radhar, "config", "init", "mine.yaml", **more)
    assert "prf_hz: 10000.0" in run(*radhar, "config", "show", "mine.yaml", **more)
    run(*radhar, "config", "init", "board.yaml", "--preset", "measured/radhar_1443", **more)
    assert "frameCfg 0 2 16 0 33.333 1 0" in run(*radhar, "config", "show", "board.yaml", **more)
    run(*radhar, "config", "init", "room.yaml", "--preset", "human/room", **more)
    assert (tmp_path / "room.yaml").read_bytes() == (CONFIGS / "human/room.yaml").read_bytes()


@pytest.mark.slow
def test_it_works_in_an_empty_environment(wheel: Path, tmp_path: Path) -> None:
    """Fetches what it depends on: the only test that needs a network."""
    run(sys.executable, "-m", "venv", "empty", folder=tmp_path)
    programs = tmp_path / "empty" / ("Scripts" if os.name == "nt" else "bin")
    pip = (programs / "python", "-m", "pip", "--disable-pip-version-check", "install", "--quiet")
    run(*pip, "-c", ROOT / "constraints.txt", wheel, folder=tmp_path)
    radhar = programs / "radhar"
    run(radhar, "config", "init", "mine.yaml", folder=tmp_path)
    run(radhar, "config", "show", "mine.yaml", folder=tmp_path)
    small_config(tmp_path)
    run(radhar, "generate", "small.yaml", "-o", "set", "--jobs", 1, folder=tmp_path)
    assert "synthesised again" in run(radhar, "verify", "set", "--samples", 1, folder=tmp_path)
    assert "no torch" in run(radhar, "--version", folder=tmp_path)
