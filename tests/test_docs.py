"""The documents: no dead link, no placeholder, and every config key is in the table."""

import re
from pathlib import Path
from typing import Any

import command_pages
import config_tables
import h5py
import pytest
import python_page
import ti_command_table
from helpers.documents import DOCS, PAGES, Row, commands, leaves, rows, value_at, written
from pydantic import BaseModel
from typer.main import get_command

from radhar_cli.cli import program
from radhar_cli.config import Config
from radhar_cli.config.classes import FilesConfig
from radhar_cli.config.reading import load_section
from radhar_cli.learning.settings import ScheduleConfig, TrainConfig
from radhar_cli.scene.single.scene_file import write_scene
from radhar_cli.scene.single.simulate import simulate

ROOT = Path(__file__).resolve().parents[1]
PAGE = {page.name: page for page in DOCS}


def test_pages_are_short_and_begin_with_what_they_are_for() -> None:
    assert len(PAGE) == len(DOCS), "two pages of one name"
    for page in DOCS:
        title, _, first, *_ = lines = page.read_text().splitlines()
        made_by_script = "movements.md", "tradeoff_tables.md", "python.md", "limits.md"
        most = 800 if page.name in made_by_script else 300
        assert len(lines) <= most, page
        assert title.startswith("# "), page
        assert first.startswith("After this page you ") or page.name == "index.md", page


@pytest.mark.parametrize("page", [*ROOT.glob("*.md"), *PAGES], ids=lambda p: p.name)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text()
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", text):
        assert (page.parent / target).exists(), target
    assert not re.search(r"TODO|FIXME|[A-Z]{4,}_TABLE", text)
    assert not re.search(r"^(<<<<<<<|=======|>>>>>>>)", text, re.MULTILINE)  # of a merge


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_and_their_options_exist(page: Path) -> None:
    for program_, *words in commands(page):
        options = [word.partition("=")[0].strip("\"'") for word in words if word.startswith("--")]
        if program_ == "python":
            text = (ROOT / words[0]).read_text()
            assert all(f'"{option}"' in text for option in options), words
            continue
        known: Any = get_command(program())
        for word in words:
            known = getattr(known, "commands", {}).get(word, known)
        there = {o for one in known.params for o in (*one.opts, *one.secondary_opts)}
        assert set(options) <= {*there, "--help"}, words


def sections(model: type[BaseModel], prefix: str = "") -> list[str]:
    found = []
    for name, field in model.model_fields.items():
        kinds = [field.annotation, *getattr(field.annotation, "__args__", ())]
        inner = next((k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)), None)
        found += sections(inner, name) if inner else [name]
    return found


@pytest.mark.parametrize(
    ("kind", "pages"),
    [(Config, ["config.md", "config_signal.md"]), (TrainConfig, ["training.md"])],
    ids=["data", "train"],
)
def test_every_config_key_is_documented(kind: type[BaseModel], pages: list[str]) -> None:
    text = "".join(PAGE[page].read_text() for page in pages)
    missing = [key for key in sections(kind) if key not in text]
    assert not missing


@pytest.mark.parametrize("page", [*config_tables.PAGES])
def test_tables_of_keys_are_those_of_the_schema(page: str) -> None:
    """`python scripts/config_tables.py` writes them."""
    text = PAGE[page].read_text()
    assert config_tables.fill_tables(text) == text


def test_page_of_ti_commands_is_made_of_the_parsers_table() -> None:
    """`python scripts/ti_command_table.py` writes it."""
    text = ti_command_table.PAGE.read_text()
    assert ti_command_table.fill_table(text) == text


def test_pages_of_commands_are_those_of_the_program() -> None:
    """`python scripts/command_pages.py` writes them."""
    found = {page.name: page.read_text() for page in command_pages.FOLDER.glob("*")}
    assert found == command_pages.pages()


def test_page_of_the_python_interface_is_made_of_its_docstrings() -> None:
    """`python scripts/python_page.py` writes it."""
    assert python_page.PAGE.read_text() == python_page.page()


def test_every_entry_of_a_scene_is_documented(tmp_path: Path) -> None:
    scene = simulate(
        ROOT / "configs/human/people.yaml", "walking", maps=("rtm", "stft_compensated")
    )
    write_scene(scene, tmp_path / "scene.h5")
    text, entries = PAGE["files.md"].read_text(), list[str]()
    with h5py.File(tmp_path / "scene.h5") as file:
        file.visititems(lambda name, item: entries.append(name) if hasattr(item, "shape") else None)
        assert all(f"`{name}`" in text for name in file.attrs)
    for name in entries:
        name = re.sub(r"^truth/person_\d+/", "truth/", name)
        name = re.sub(r"^truth/paths/.*", "truth/paths", name)
        name = re.sub(r"^(maps|axes)/\w+", r"\1/<map>", name)
        name = re.sub(r"(<map>/)\w+", r"\1<axis>", name)
        name = re.sub(r"^slow_time/\w+", "slow_time/<stage>", name)
        assert f"`/{name}`" in text, name


OF_FILES = FilesConfig(files=("wave.bvh",))
TABLES: list[tuple[str, tuple[BaseModel, ...]]] = [
    ("training.md", (TrainConfig(),)),
    ("motion_files.md", (OF_FILES,)),
]
ROWS = [(page, kinds, row) for page, kinds in TABLES for row in rows(PAGE[page])]


@pytest.mark.parametrize(
    ("page", "kinds", "row"), ROWS, ids=[f"{p}-{r.keys[0]}" for p, _, r in ROWS]
)
def test_tables_have_the_defaults_of_the_schema(
    page: str, kinds: tuple[BaseModel, ...], row: Row
) -> None:
    if not row.default:
        return
    known = [one for one in kinds if row.keys[0].split(".")[0] in type(one).model_fields]
    words, in_table = {"null", "true", "false"}, written(row.default)
    for key in row.keys:
        values = [value_at(one, key) for one in known]
        values = [value for value in values if value is not None] or values
        expected = leaves(values, bounds=False)
        missing = {one for one in expected if one in words or isinstance(one, float)} - in_table
        assert not missing, key
        assert all(one in row.default for one in expected - words if isinstance(one, str)), key
    assert in_table <= leaves(
        [value_at(one, key) for one in known for key in row.keys], bounds=True
    )


def test_the_papers_training_config_is_its_table() -> None:
    paper = load_section(TrainConfig, ROOT / "configs/train/paper.yaml")
    assert (paper.model, paper.epochs, paper.batch_size) == ("fftnet", 20, 128)
    assert (paper.optimiser, paper.learning_rate, paper.weight_decay) == ("adam", 0.00147, 1e-4)
    assert paper.schedule == ScheduleConfig(kind="step", every_epochs=10, factor=0.1)
    assert (paper.label_smoothing, paper.warmup_epochs, paper.average_last) == (0.1, 0, 0)
