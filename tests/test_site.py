"""The site builds without a warning, and shows the notebooks."""

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest
import run_notebook
from helpers.command_line import ROOT

import radhar_cli

pytestmark = pytest.mark.slow  # tests/test_docs.py looks at links of pages


def run_site_command(*more: object) -> "subprocess.CompletedProcess[str]":
    """Run the command of `make site`, with more options.

    `--quiet` is none of them: MkDocs then does not count the warnings that `--strict` fails at.
    """
    recipe = re.search(r"^site:.*\n\t\$\(BIN\)/python (.*)$", (ROOT / "Makefile").read_text(), re.M)
    assert recipe
    return subprocess.run(
        [sys.executable, *recipe[1].split(), *map(str, more)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
    )


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `make site` makes: a dead link or anchor, or a page that no menu has, fails."""
    out = tmp_path_factory.mktemp("site")
    done = run_site_command("-d", out)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


@pytest.mark.parametrize(
    ("link", "status"),
    [("other.md#a-heading", 0), ("other.md#no-heading", 1), ("nowhere.md", 1)],
)
def test_a_dead_link_or_anchor_fails(link: str, status: int, tmp_path: Path) -> None:
    docs, settings = tmp_path / "docs", tmp_path / "mkdocs.yml"
    docs.mkdir()
    (docs / "index.md").write_text(f"# Home\n\n[a link]({link})\n")
    (docs / "other.md").write_text("# Other\n\n## A heading\n")
    pages = "nav: [index.md, other.md]"
    settings.write_text(f"INHERIT: {ROOT / 'mkdocs.yml'}\ndocs_dir: {docs}\n{pages}\n")
    done = run_site_command("-f", settings, "-d", tmp_path / "site")
    assert done.returncode == status, done.stdout + done.stderr
    assert (link in done.stderr) == bool(status)


def test_every_page_is_there(site: Path) -> None:
    for page in (ROOT / "docs").rglob("*.md"):
        path = page.relative_to(ROOT / "docs").with_suffix("")
        made = site / path / "index.html" if path.name != "index" else site / "index.html"
        assert made.is_file(), path


def test_python_page_has_the_interface(site: Path) -> None:
    text = (site / "reference/python/index.html").read_text()
    for name, module in radhar_cli._INTERFACE.items():
        assert re.search(rf'id="{module}[\w.]*\.{name}"', text), name


class _Addresses(HTMLParser):
    """What a browser fetches to show a page, and where its links lead."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.links: list[str] = []
        self.feed(page.read_text())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        known = dict(attrs)
        if tag in ("script", "img", "iframe"):
            self.fetched.append(known.get("src") or "")
        elif tag == "link" and known.get("rel") == "stylesheet":
            self.fetched.append(known.get("href") or "")
        elif tag == "a":
            self.links.append(known.get("href") or "")


def test_pages_fetch_nothing_from_elsewhere_and_their_links_lead_somewhere(site: Path) -> None:
    """Those of the notebooks too, which MkDocs does not look at."""
    for page in {*site.rglob("*.html")} - {site / "404.html"}:
        addresses = _Addresses(page)
        for address in addresses.fetched + addresses.links:
            elsewhere = re.match(r"https?:|//", address)
            assert not (elsewhere and address in addresses.fetched), (page, address)
            if not elsewhere and not address.startswith("data:"):
                assert (page.parent / address.partition("#")[0]).exists(), (page, address)


@pytest.mark.parametrize("notebook", run_notebook.NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_are_shown_with_their_pictures(notebook: Path, site: Path) -> None:
    shown = (site / f"guide/{notebook.stem}/index.html").read_text()
    pictures = notebook.read_text().count('"image/jpeg": "')
    assert shown.count("data:image/jpeg") == pictures >= 1
