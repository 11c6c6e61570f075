"""Where people are, where they head, when they begin and how noisy it is have one law for all.

A configuration that draws any of them by class gives the class away.
"""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from radhar_cli.config.documents import PRESETS, RADARS, WRITTEN_RADARS, read_on_bases
from radhar_cli.config.starting_file import MINIMAL, of_board, of_preset
from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.schema.twelve import DEFAULT

ROOT = Path(__file__).parents[2]
# Keys of what is not the movement, and of where it begins in the recording.
NOT_MOVEMENT = re.compile(
    r"(people\.\d+\.)?(motion\.(place|range_m|cross_range_m|angle_deg)|timing\.(onset|visible)"
    r"|snr_db|subject|duration_s|wall|room|receiver)(\.|$)"
)
# The paper's figures show one picture of each class, at the places that it gives; no set is made of
# them. In Glasgow's recordings people walk along a lane and do the rest at its end.
AS_PUBLISHED = {
    "configs/paper/figures_free_space.yaml",
    "configs/paper/figures_through_wall.yaml",
    "configs/measured/glasgow_5p8GHz.yaml",
}


def laws_by_class(value: Any, key: str = "") -> Iterator[str]:
    """Dotted keys of a document whose numbers differ by class."""
    if isinstance(value, dict) and set(value) == {"per_activity"}:
        yield key
        return
    items = value.items() if isinstance(value, dict) else ()
    items = enumerate(value) if isinstance(value, list) else items
    for name, inner in items:
        yield from laws_by_class(inner, f"{key}.{name}" if key else str(name))


def telling(document: Any) -> list[str]:
    """Keys of a document by which the class is told, though they are not the movement."""
    return [key for key in laws_by_class(document) if NOT_MOVEMENT.match(key)]


def shipped() -> Iterator[tuple[str, Any]]:
    """Documents that come with radhar or that it writes, with what names them."""
    for name, path in PRESETS.items():
        if not name.startswith("train/"):
            yield f"configs/{name}.yaml", read_on_bases(path, {})[0]
            yield f"configs/{name}.yaml", parse_yaml(of_preset(name), name)[0]
    for name in (*RADARS, *WRITTEN_RADARS):
        yield f"--radar {name}", parse_yaml(of_board(name, ROOT), name)[0]
    yield "--minimal", parse_yaml(MINIMAL, "minimal")[0]


def written() -> Iterator[tuple[str, Any]]:
    """YAML of the documents, with the file it stands in."""
    for path in (*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")):
        blocks = re.findall(r"^```yaml\n(.*?)^```", path.read_text("utf-8"), re.M | re.S)
        for text in blocks:
            yield str(path.relative_to(ROOT)), parse_yaml(text, path.name)[0]
    for path in (*ROOT.glob("docs/**/*.ipynb"), *ROOT.glob("notebooks/*.ipynb")):
        for cell in json.loads(path.read_text("utf-8"))["cells"]:
            blocks = re.findall(r"^%%writefile .*\.yaml\n(.*)", "".join(cell["source"]), re.S)
            for text in blocks:
                yield str(path.relative_to(ROOT)), parse_yaml(text, path.name)[0]


def test_what_is_looked_for_is_found() -> None:
    by_class = {"per_activity": {DEFAULT: 2, "walking": 6}}
    motion = {"motion": {"range_m": by_class, "walking": {"speed_mps": by_class}}}
    assert telling({**motion, "snr_db": by_class, "people": [motion]}) == [
        "motion.range_m",
        "snr_db",
        "people.0.motion.range_m",
    ]
    assert telling({"timing": {"onset": by_class}}) == ["timing.onset"]
    assert telling({"motion": {"place": {"range_m": by_class}}}) == ["motion.place.range_m"]
    assert telling({"samples_per_class": by_class}) == []


def test_no_shipped_config_tells_the_class_by_what_is_not_the_movement() -> None:
    found = {name for name, document in shipped() if telling(document)}
    assert found == AS_PUBLISHED


def test_no_config_of_the_documents_does_so() -> None:
    found = [(name, keys) for name, document in written() if (keys := telling(document))]
    assert found == []
    assert sum(1 for _ in written()) > 20


@pytest.mark.parametrize("name", [n for n in PRESETS if n.startswith("boards/")])
def test_people_before_a_board_have_a_place(name: str) -> None:
    """A start would be another place for who walks than for who does not."""
    motion = read_on_bases(PRESETS[name], {})[0]["motion"]
    assert "range_m" not in motion
    assert {*motion["place"]["range_m"]} == {"uniform"}
