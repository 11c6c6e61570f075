"""`radhar demo`: the first data set, checked, and what to look at next."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.generate import generate
from radhar_cli.commands.tell import report, tell
from radhar_cli.commands.verify import verify


def demo(
    out: Annotated[Path, typer.Argument(help="Folder to write the data set to.")] = Path(
        "datasets/quickstart"
    ),
) -> None:
    """Build a small data set, check it, and say what to look at.

    It is the config `quickstart`, 720 samples of twelve activities, and takes about half a minute.

    Example:

      radhar demo
    """
    generate(Path("quickstart"), out)
    verify(out)
    gallery = out / "gallery.png"
    following = {
        f"radhar view {out}": "a page of its samples",
        f"radhar train {out} -o runs/quickstart": "a network",
        f"radhar eval runs/quickstart {out}": "its confusion matrix, report.html",
        "radhar config list": "other data sets, by name",
        "radhar config init mine.yaml --minimal": "one of your own",
    }
    report(gallery=gallery, next=[*following])
    tell(f"look at  {gallery}")
    tell("then")
    width = max(map(len, following))
    for command, gives in following.items():
        tell(f"  {command:{width}}  {gives}")
