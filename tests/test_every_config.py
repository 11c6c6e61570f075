"""Every shipped config, and every one of README and the documents, is built and verified.

All classes, one sample each (or one a person), nothing else is changed.
"""

from pathlib import Path

import pytest
import yaml
from helpers.command_line import ok
from helpers.documents import PAGES, Block, blocks
from helpers.recorded import write_motions

from radhar_cli.config import load_radars

ROOT = Path(__file__).resolve().parents[1]
CONFIGS = sorted((ROOT / "configs").rglob("*.yaml"))
OF_DATA = [path for path in CONFIGS if path.parent.name != "train"]
# Configs of recordings go with a manifest: test_documents runs them.
BLOCKS = [
    block
    for page in PAGES
    for block in blocks(page)
    if block.language == "yaml" and "recordings" not in yaml.safe_load(block.text)
]

pytestmark = pytest.mark.slow


def build(path: Path, folder: Path) -> None:
    """Build a config with a sample a class, or one of each person, and verify the data set."""
    config = next(iter(load_radars(path).values()))
    persons = config.split.subjects
    sets = ["--set", f"samples_per_class={persons or 1}"]
    if config.stream is not None:
        sets = ["--set", f"stream.count={persons or 1}", "--set", "duration_s=20"]
    if persons is None:
        sets += ["--set", "split={train: 1, validation: 0}"]
    ok("generate", path, "-o", folder / "set", *sets)
    ok("verify", folder / "set")


@pytest.mark.parametrize("path", OF_DATA, ids=lambda path: str(path.relative_to(ROOT / "configs")))
def test_a_shipped_config_is_built_and_verified(path: Path, tmp_path: Path) -> None:
    build(path, tmp_path)


@pytest.mark.parametrize("block", BLOCKS, ids=str)
def test_a_config_of_the_documents_is_built_and_verified(block: Block, tmp_path: Path) -> None:
    """Beside motion files where it has patterns, and its base where it has one."""
    document = yaml.safe_load(block.text)
    write_motions(document, tmp_path)
    if "base" in document:
        (tmp_path / document["base"]).write_text((ROOT / "configs/quickstart.yaml").read_text())
    path = tmp_path / "block.yaml"
    path.write_text(block.text)
    build(path, tmp_path)
