"""What CONTRIBUTING.md tells to run is there, and hooks of pre-commit check what tests check."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from helpers.documents import ROOT, blocks

import radhar_cli

BIN = Path(sys.executable).parent
PAGE = ROOT / "CONTRIBUTING.md"
HOOKS = [
    hook
    for repository in yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    for hook in repository["hooks"]
]
ENTRIES = [shlex.split(hook["entry"]) for hook in HOOKS]
COMMANDS = [
    shlex.split(line, comments=True)
    for block in blocks(PAGE)
    if block.language == "sh"
    for line in block.text.splitlines()
    if line.startswith(".venv/bin/")
]
# Not installed with radhar: the page says how it comes there.
ELSEWHERE = {".venv/bin/pre-commit"}


def paths_of(words: list[str]) -> list[str]:
    """Files and folders that a command names."""
    return [word for word in words if re.match(r"(tests|scripts|configs)/", word)]


@pytest.mark.parametrize("words", [*COMMANDS, *ENTRIES], ids=" ".join)
def test_programs_modules_and_paths_exist(words: list[str]) -> None:
    program, *rest = words
    if program not in ELSEWHERE:
        assert (BIN / Path(program).name).exists(), program
    if rest[:1] == ["-m"]:
        subprocess.run([sys.executable, "-c", f"import {rest[1]}"], check=True, cwd=BIN)
    assert all((ROOT / path).exists() for path in paths_of(rest)), words


def test_one_test_runs_as_the_page_says() -> None:
    """The commands that name a file of tests of one package, which take a second."""
    words = next(one for one in COMMANDS if "tests/numerics/test_rounding.py" in one)
    done = subprocess.run([sys.executable, *words[1:]], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", ["ruff check", "ruff format", "mypy"])
def test_hooks_are_the_lint_of_the_page(name: str) -> None:
    def named(commands: list[list[str]]) -> list[str]:
        lines = [" ".join(words).removeprefix(".venv/bin/") for words in commands]
        return [line for line in lines if line.startswith(name)]

    assert named(COMMANDS)
    assert named(ENTRIES)
    assert [line.replace(" --check", "") for line in named(ENTRIES)] == named(COMMANDS)


def test_hooks_run_the_tests_of_the_code_without_a_network() -> None:
    (entry,) = (words for words in ENTRIES if "pytest" in words)
    assert paths_of(entry) == paths_of(
        next(words for words in COMMANDS if "tests/test_code.py" in words)
    )
    assert {hook["language"] for hook in HOOKS} == {"system"}
    collected = [*entry[1:], "--collect-only"]
    done = subprocess.run([sys.executable, *collected], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_a_release_is_of_the_version_of_the_package() -> None:
    """The tag, the last heading of the changes and the citation name it."""
    version = radhar_cli.__version__
    assert f"git tag -a v{version} " in PAGE.read_text()
    changes = (ROOT / "CHANGELOG.md").read_text()
    assert re.findall(r"^## (\S+?),", changes, re.MULTILINE)[0] == version
    assert re.search(
        rf"^version: \"?{re.escape(version)}", (ROOT / "CITATION.cff").read_text(), re.M
    )
