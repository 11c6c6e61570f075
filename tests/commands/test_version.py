"""`radhar --version` and shell completion."""

import re

import numpy as np
import pytest
from typer.main import get_command
from typer.testing import CliRunner

from radhar_cli import __version__
from radhar_cli.cli import program
from radhar_cli.commands import completion
from radhar_cli.config.schema import WallConfig

WALL = WallConfig.model_fields


def test_version_names_the_libraries_that_decide_bytes():
    done = CliRunner().invoke(program(), ["--version"])
    assert done.exit_code == 0
    lines = done.stdout.splitlines()
    assert re.fullmatch(rf"radhar {re.escape(__version__)}\+[0-9a-f]{{12}}", lines[0])
    assert len(lines) == 2
    assert f"numpy {np.__version__}" in lines[1]
    assert "h5py" in lines[1]


def completed(words):
    """What bash offers for the last word."""
    asked = {
        "_RADHAR_COMPLETE": "complete_bash",
        "COMP_WORDS": words,
        "COMP_CWORD": str(words.count(" ")),
    }
    return set(CliRunner().invoke(program(), [], env=asked, prog_name="radhar").stdout.split())


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("radhar pre", {"predict", "preview"}),
        ("radhar inspect --j", {"--json"}),
        ("radhar simulate c.yaml -a walking_to_", {"walking_to_sitting", "walking_to_falling"}),
        ("radhar motion c.yaml --activity ki", {"kicking"}),
        ("radhar generate c.yaml --set radar.p", {"radar.position_m=", "radar.prf_hz="}),
        ("radhar generate c.yaml --set wal", {"wall=", *(f"wall.{key}=" for key in WALL)}),
        ("radhar config show c.yaml --set snr_d", {"snr_db="}),
        ("radhar train d --set schedule.k", {"schedule.kind="}),
        ("radhar train d --model small", {"smallnet"}),
        ("radhar train d --map rt", {"rtm"}),
        ("radhar simulate c.yaml --maps stft,rt", {"stft,rtm"}),
        ("radhar import walk.npy --set snr", set()),
    ],
)
def test_the_shell_completes(words, wanted):
    assert completed(words) == wanted


def test_every_completed_model_is_listed():
    from radhar_cli.learning.models.build import RIVALS
    from radhar_cli.learning.models.zoo import OURS

    assert set(completion.MODELS) == {*OURS, *RIVALS}


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
