"""Two states of the sources are two builds, though they share a version."""

import shutil
from pathlib import Path

import pytest

from radhar_cli.dataset import build_version as module


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the package, whose build is taken."""
    copy = Path(shutil.copytree(module.PACKAGE, tmp_path / "radhar_cli"))
    monkeypatch.setattr(module, "PACKAGE", copy)
    return copy


def build() -> str:
    return module.build_version.__wrapped__()


def test_a_copy_is_the_same_build(package: Path) -> None:
    assert build() == module.build_version()


@pytest.mark.parametrize(
    ("path", "another"),
    [("echo/beat.py", True), ("dataset/card.py", True), ("learning/report.py", False)],
)
def test_what_decides_bytes_decides_the_build(package: Path, path: str, another: bool) -> None:
    before = build()
    with (package / path).open("a") as file:
        file.write("# another state\n")
    assert (build() != before) == another
