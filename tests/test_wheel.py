"""What `make dist` makes: a wheel that works without the repository, and all of its sources."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Sequence
from email import message_from_bytes
from pathlib import Path
from typing import NamedTuple

import pytest
from helpers.command_line import ROOT
from helpers.documents import blocks
from helpers.small import small_config

PACKAGE, CONFIGS = ROOT / "radhar_cli", ROOT / "configs"
OF_WHEEL = "radhar_cli", "configs"
BESIDE = ".github", "docs", "examples", "notebooks", "scripts", "tests"
UNSHIPPED = {".gitignore", ".git", ".dmypy.json"}
ADDRESS = "https://code.example/somebody/radhar"


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


class Built(NamedTuple):
    """What `make dist` makes of a copy of the repository, and the files of that."""

    wheel: Path
    sources: Path
    files: set[str]


def build(folder: Path, parts: Sequence[str]) -> Built:
    """Build what git would give, as a folder of an earlier build could lend it old modules.

    Args:
        folder: where it is copied and whole.
        parts: folders of the repository; files beside them are always there.
    """
    source, out = folder / "source", folder / "dist"
    for name in parts:
        ignored = shutil.ignore_patterns("__pycache__", ".mypy_cache", ".hypothesis")
        shutil.copytree(ROOT / name, source / name, symlinks=True, ignore=ignored)
    for path in ROOT.iterdir():
        if path.is_file() and path.name not in UNSHIPPED:
            shutil.copy(path, source)
    shipped = (path for path in source.rglob("*") if path.is_file() and "presets" not in path.parts)
    files = {str(path.relative_to(source)) for path in shipped}
    # The archive of sources first, the wheel out of it.
    command = (sys.executable, "-m", "build", "--no-isolation", "-o", out, source)
    run(*command, folder=source, RADHAR_REPOSITORY=ADDRESS)
    (wheel,), (sources,) = out.glob("*.whl"), out.glob("*.tar.gz")
    return Built(wheel, sources, files)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built without the documents, which take time and are no part of it."""
    return build(tmp_path_factory.mktemp("light"), OF_WHEEL).wheel


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Built:
    return build(tmp_path_factory.mktemp("whole"), (*OF_WHEEL, *BESIDE))


@pytest.mark.slow
def test_the_archive_of_sources_holds_tests_documents_and_all_else(whole: Built) -> None:
    """All but what git and its host alone need, so that `make test` runs in it."""
    with tarfile.open(whole.sources) as file:
        inside = {name.partition("/")[2] for name in file.getnames()}
    assert {"tests/test_wheel.py", "docs/index.md", "CHANGELOG.md", "CITATION.cff"} < inside
    assert whole.files <= inside, whole.files - inside


def test_the_package_index_shows_where_everything_is(wheel: Path) -> None:
    """The README has no link that leads nowhere outside the repository."""
    with zipfile.ZipFile(wheel) as file:
        metadata = next(name for name in file.namelist() if name.endswith("/METADATA"))
        about = message_from_bytes(file.read(metadata))
    named = dict(url.split(", ") for url in about.get_all("Project-URL", []))
    assert named.keys() >= {"Source", "Documentation", "Issues", "Changelog", "Paper"}
    assert named["Source"] == ADDRESS
    tag = f"v{about['Version']}"
    targets = re.findall(r"\]\((.+?)\)", str(about.get_payload()))
    for target in targets:
        assert target.startswith(("https://", "#")), target
    ours = [target for target in targets if target.startswith(f"{ADDRESS}/")]
    assert any(target.startswith(f"{ADDRESS}/raw/{tag}/docs/images/") for target in ours)
    for target in ours:
        path = re.sub(rf"^{ADDRESS}/(raw|blob)/{tag}/|#.*", "", target)
        assert (ROOT / path).exists(), target
    assert about["Author"]
    assert about["Keywords"]


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
    assert names == ours | {"radhar.py", "radhar_cli/py.typed", "radhar_cli/dataset/viridis.rgb"}
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
def test_it_works_in_an_empty_environment(whole: Built, tmp_path: Path) -> None:
    """Wheel, then archive of sources. Fetches what it depends on: the only test that does."""
    run(sys.executable, "-m", "venv", "empty", folder=tmp_path)
    programs = tmp_path / "empty" / ("Scripts" if os.name == "nt" else "bin")
    pip = (programs / "python", "-m", "pip", "--disable-pip-version-check", "install", "--quiet")
    run(*pip, "-c", ROOT / "constraints.txt", whole.wheel, folder=tmp_path)
    radhar = programs / "radhar"
    run(radhar, "config", "init", "mine.yaml", folder=tmp_path)
    run(radhar, "config", "show", "mine.yaml", folder=tmp_path)
    small_config(tmp_path)
    run(radhar, "generate", "small.yaml", "-o", "set", "--jobs", 1, folder=tmp_path)
    assert "synthesised again" in run(radhar, "verify", "set", "--samples", 1, folder=tmp_path)
    assert "no torch" in run(radhar, "--version", folder=tmp_path)
    (snippet,) = (one.text for one in blocks(ROOT / "README.md") if one.language == "python")
    said = run(programs / "python", "-c", snippet, folder=tmp_path)
    assert said.startswith("(36, 64, 64)")
    done = subprocess.run(
        [radhar, "train", "set", "-o", "run"], cwd=tmp_path, capture_output=True, text=True
    )
    command = done.stderr.partition("not installed: ")[2]
    assert command.startswith("empty/bin/python -m pip install "), done.stderr
    run(*pip, "--no-deps", "--force-reinstall", whole.sources, folder=tmp_path)
    assert said == run(programs / "python", "-c", snippet, folder=tmp_path)
