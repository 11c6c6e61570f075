"""`radhar --version` and shell completion."""

import numpy as np
from typer.testing import CliRunner

from radhar_cli import __version__
from radhar_cli.cli import program


def test_version_names_the_libraries_that_decide_bytes() -> None:
    done = CliRunner().invoke(program(), ["--version"])
    assert done.exit_code == 0
    lines = done.stdout.splitlines()
    assert lines[0] == f"radhar {__version__}"
    assert len(lines) == 2
    assert f"numpy {np.__version__}" in lines[1]
    assert "h5py" in lines[1]


def test_the_shell_completes_commands_and_options() -> None:
    for words, wanted in (
        ("radhar pre", {"predict", "preview"}),
        ("radhar inspect --j", {"--json"}),
    ):
        asked = {
            "_RADHAR_COMPLETE": "complete_bash",
            "COMP_WORDS": words,
            "COMP_CWORD": str(words.count(" ")),
        }
        done = CliRunner().invoke(program(), [], env=asked, prog_name="radhar")
        assert set(done.stdout.split()) == wanted
