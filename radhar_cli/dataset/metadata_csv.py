"""metadata.csv beside the images of a map and split: what `load_dataset` reads of each image."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

from radhar_cli.dataset.files import refuse_links, unfinished_path
from radhar_cli.dataset.layout import METADATA, Rows, png_folder
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import entries, number_names
from radhar_cli.replacing import replacing
from radhar_cli.untrusted import regular_size


def lines(data: Dataset) -> Iterator[tuple[int | None, bytes]]:
    """(split, line) of the files of all splits; the first line belongs to each of them."""
    rows = Rows.of(data.config)
    yield None, _line(["file_name", "label", "index", *number_names(data.config)])
    for entry in entries(data):
        numbers = ("" if value != value else repr(value) for value in entry.values)
        cells = [rows.file_name(entry.row), entry.label, str(entry.place), *numbers]
        yield entry.split, _line(cells)


def _line(cells: Sequence[str]) -> bytes:
    return (",".join(cells) + "\n").encode()


def paths(data: Dataset) -> list[tuple[int, Path]]:
    """(split, path inside the output folder) of every file that there should be."""
    return [
        (n, png_folder(name, n) / METADATA)
        for name in data.config.maps
        for n in data.present_splits
    ]


def write_metadata(data: Dataset, folder: Path) -> None:
    """Write the files that are not there, all of them line by line."""
    missing = [(split, path) for split, path in paths(data) if not (folder / path).exists()]
    if not missing:
        return
    unfinished_path(folder).parent.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        files = []
        for wanted, path in missing:
            refuse_links(folder, (folder / path).parent)
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            other = stack.enter_context(replacing(folder / path, unfinished_path(folder)))
            files.append((wanted, stack.enter_context(other.open("wb"))))
        for split, line in lines(data):
            for wanted, file in files:
                if split in (None, wanted):
                    file.write(line)


def wrong_metadata(data: Dataset, folder: Path) -> list[str]:
    """What is wrong with the files, a line each, but for maps that have no folder."""
    problems: dict[Path, str] = {}
    with ExitStack() as stack:
        files = []
        for split, path in paths(data):
            if not (folder / path).parent.parent.is_dir():
                continue
            try:
                regular_size(folder / path)
                files.append((split, path, stack.enter_context((folder / path).open("rb"))))
            except OSError as error:
                problems[path] = f"cannot be read ({error.strerror})"
        for number, (whose, line) in enumerate(lines(data)):
            for split, path, file in files:
                if whose in (None, split) and path not in problems and file.read(len(line)) != line:
                    what = line.partition(b",")[0].decode() if number else "its first line"
                    problems[path] = f"does not say of {what} what dataset.h5 does"
        for _, path, file in files:
            if path not in problems and file.read(1):
                problems[path] = "has rows after the last sample"
    return [f"{path}: {fault}" for path, fault in problems.items()]
