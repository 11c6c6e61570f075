"""Words of errors that several commands share."""

import re
from pathlib import Path

import pytest

from radhar_cli.errors import describe_schema, how_to_install

ROOT = Path(__file__).parents[1]


def test_a_newer_file_asks_for_an_update_and_an_earlier_one_for_its_cure() -> None:
    assert describe_schema(9, 3, ", in which x") == (
        "schema_version = 9: is written by a newer radhar, this one reads 3: update radhar"
    )
    assert describe_schema(2, 3, ", in which x") == "schema_version = 2: should be 3, in which x"


@pytest.mark.parametrize("path", sorted((ROOT / "radhar_cli").rglob("*.py")), ids=str)
def test_no_message_installs_radhar_from_an_index_that_does_not_have_it(path: Path) -> None:
    assert "pip install 'radhar[" not in path.read_text()


def test_packages_that_messages_name_are_those_of_the_extras() -> None:
    extras = (ROOT / "pyproject.toml").read_text()
    modules = "torch safetensors sklearn skimage timm numba distributed pyarrow onnx plotly"
    for package in how_to_install(*modules.split()).removeprefix("pip install ").split():
        assert re.search(rf'"{package}>=', extras), package
