"""`radhar --version` and the lists of commands."""

import re

import numpy as np
import pytest
from typer.main import get_command
from typer.testing import CliRunner

from radhar_cli import __version__
from radhar_cli.cli import program


def test_version_names_the_libraries_that_decide_bytes():
    done = CliRunner().invoke(program(), ["--version"])
    assert done.exit_code == 0
    lines = done.stdout.splitlines()
    assert re.fullmatch(rf"radhar {re.escape(__version__)}\+[0-9a-f]{{12}}", lines[0])
    assert len(lines) == 2
    assert f"numpy {np.__version__}" in lines[1]
    assert "h5py" in lines[1]


@pytest.mark.parametrize("group", [[], ["config"]], ids=["radhar", "config"])
def test_help_of_80_columns_cuts_no_summary(group):
    done = CliRunner().invoke(program(), [*group, "--help"], env={"COLUMNS": "80"})
    listed = get_command(program())
    for name in group:
        listed = listed.commands[name]
    for name, command in listed.commands.items():
        summary = " ".join(command.help.split("\n\n")[0].split())
        line = rf"\n  {name} +{re.escape(summary)}\n"
        assert re.search(line, done.stdout), f"{name}: {summary}"


def test_help_groups_every_command():
    shown = CliRunner().invoke(program(), ["--help"]).stdout
    headings = re.findall(r"^(\w[^:\n]*):\n  \w", shown, re.MULTILINE)
    assert len(headings) == 5
    assert "Commands" not in headings
