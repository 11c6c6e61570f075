"""`radhar view`: a web page that plays samples of a data set."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.learning_options import needs
from radhar_cli.commands.options import Replace, refuse_to_replace
from radhar_cli.commands.tell import report, tell

if TYPE_CHECKING:
    from radhar_cli.dataset.reading import Dataset


def view(
    dataset: Annotated[Path, typer.Argument(help="Folder that `generate` wrote, or dataset.h5.")],
    sample: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CLASS/INDEX",
            help="Sample to show; may be repeated. The default is the first of each class.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="HTML file to write, which should be new. The default is view.html beside the "
            "data; the one of an earlier view is replaced.",
        ),
    ] = None,
    overwrite: Replace = False,
) -> None:
    """Make a web page that plays samples of a data set.

    It is one HTML file for any browser. Skeletons are simulated again from the stored config.

    Example:

      radhar view datasets/quickstart --sample walking/3
    """
    needs("plotly")

    from radhar_cli.dataset.reading import open_dataset
    from radhar_cli.dataset.sample_page import choose_rows, sample_entries
    from radhar_cli.figures.scene_page import write_page
    from radhar_cli.files.replacing import refuse_links

    if out is not None:
        refuse_to_replace(out, overwrite, "view.html")
    with open_dataset(dataset) as data:
        rows = choose_rows(data, sample or [])
        _tell_of_other_words(sample or [], data, rows)
        path = out or data.path.parent / "view.html"
        refuse_links(path.parent, path)
        write_page(sample_entries(data, rows), path)
    report(file=path, samples=len(rows))
    tell(str(path))


def _tell_of_other_words(samples: list[str], data: "Dataset", rows: list[int]) -> None:
    """Print the class that each word of --sample stands for, where it is not the class's name."""
    from radhar_cli.dataset.layout import Rows
    from radhar_cli.motion.activities.vocabulary import plain_word

    words = dict[str, str]()
    for sample, row in zip(samples, rows, strict=False):
        word, activity = sample.partition("/")[0], Rows.of(data.config)[row][0]
        if word != activity.label and plain_word(word) != activity.slug:
            words[word] = activity.slug
    for word, slug in words.items():
        tell(f"--sample: {word} is taken for {slug}, which the data set has", err=True)
