"""The documents: no dead link, no placeholder, and every config key is in the table."""

import re
from pathlib import Path

import pytest
from pydantic import BaseModel

from radhar_cli.config import Config, load_config
from radhar_cli.config.reading import load_section
from radhar_cli.learning.settings import TrainConfig

ROOT = Path(__file__).resolve().parents[1]
PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text()
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", text):
        assert (page.parent / target).exists(), target
    assert not re.search(r"TODO|FIXME|[A-Z]{4,}_TABLE", text)


def test_the_yaml_of_the_readme_is_a_config(tmp_path: Path) -> None:
    blocks = re.findall(r"```yaml\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert blocks
    for block in blocks:
        (tmp_path / "readme.yaml").write_text(block)
        load_config(tmp_path / "readme.yaml")


def sections(model: type[BaseModel], prefix: str = "") -> list[str]:
    found = []
    for name, field in model.model_fields.items():
        kinds = [field.annotation, *getattr(field.annotation, "__args__", ())]
        inner = next((k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)), None)
        found += sections(inner, name) if inner else [name]
    return found


@pytest.mark.parametrize(
    ("kind", "page"), [(Config, "config.md"), (TrainConfig, "training.md")], ids=["data", "train"]
)
def test_every_config_key_is_documented(kind: type[BaseModel], page: str) -> None:
    text = (ROOT / "docs" / page).read_text()
    missing = [key for key in sections(kind) if key not in text]
    assert not missing


def test_the_papers_training_config_is_the_default() -> None:
    assert load_section(TrainConfig, ROOT / "configs/train/paper.yaml") == TrainConfig()
