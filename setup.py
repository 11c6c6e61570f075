"""What pyproject.toml cannot say of the package: links that lead somewhere from a package index.

RADHAR_REPOSITORY is the address of the repository, such as https://github.com/OWNER/radhar, which
the release workflow knows. With it links and images of README.md are those of the version's tag,
and the package names source, issues and changes; without it nothing is changed.
"""

import os
import re
from pathlib import Path

from setuptools import setup

HERE = Path(__file__).parent
PAPER = "https://arxiv.org/abs/2509.06751"


def as_absolute(text: str, address: str, tag: str) -> str:
    """Return Markdown whose links to files of the repository are addresses of its tag."""
    text = re.sub(r"(!\[[^]]*\]\()(?!https?:|#)", rf"\1{address}/raw/{tag}/", text)
    return re.sub(r"((?<!!)\[[^]]*\]\()(?!https?:|#)", rf"\1{address}/blob/{tag}/", text)


def main() -> None:
    """Build what `python -m build` or pip asks for."""
    source = (HERE / "radhar_cli/__init__.py").read_text(encoding="utf-8")
    tag = "v" + re.findall(r'^__version__ = "(.+)"$', source, re.MULTILINE)[0]
    text, urls = (HERE / "README.md").read_text(encoding="utf-8"), {"Paper": PAPER}
    if address := os.environ.get("RADHAR_REPOSITORY", "").rstrip("/"):
        text = as_absolute(text, address, tag)
        urls |= {"Source": address, "Documentation": f"{address}/tree/{tag}/docs"}
        urls |= {"Issues": f"{address}/issues", "Changelog": f"{address}/blob/{tag}/CHANGELOG.md"}
    setup(
        long_description=text,
        long_description_content_type="text/markdown",
        project_urls=urls,
    )


if __name__ == "__main__":
    main()
