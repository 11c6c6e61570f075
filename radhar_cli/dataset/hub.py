"""The output folder as a data set of the Hugging Face Hub: data card, picture, metadata.csv."""

from pathlib import Path

from radhar_cli.dataset.card import Files, card, configurations, front_matter
from radhar_cli.dataset.files import refuse_links, write_whole
from radhar_cli.dataset.gallery import gallery_png
from radhar_cli.dataset.image_file import image_size
from radhar_cli.dataset.layout import CARD, GALLERY, PNG, png_folder
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import write_metadata, wrong_metadata
from radhar_cli.errors import FolderError


def write_hub_files(source: Path, folder: Path, png: bool) -> None:
    """Write what is missing of the card, its picture and the metadata of the images.

    A card that was written before the folder had images, and not changed since, is written anew.

    Args:
        source: dataset.h5, or what is going to be it.
    """
    with Dataset(source) as data:
        if png:
            write_metadata(data, folder)
        for name in (GALLERY, CARD):
            refuse_links(folder, folder / name)
        if not (folder / GALLERY).exists():
            write_whole(folder, folder / GALLERY, gallery_png(data))
        path = folder / CARD
        text = path.read_bytes() if path.exists() else None
        early = png and text is not None and b"\nconfigs:" not in text  # before there were images
        if text is None or (early and text == folder_card(data, False).encode()):
            write_whole(folder, path, folder_card(data, png).encode())


def loading(name: str) -> str:
    """Markdown: how `datasets` loads a map."""
    return f"""\
```python
from datasets import load_dataset

data = load_dataset("FOLDER OR NAME ON THE HUB", "{name}")  # one configuration a map
sample = data["train"][0]
sample["image"]  # numpy.asarray(...): grey levels; .convert("RGB"): colours
```"""


def png_files(data: Dataset) -> Files:
    """The configurations of a folder with PNGs: one a map."""
    present = data.present_splits
    return {
        name: {split: f"{png_folder(name, n).as_posix()}/**" for n, split in present.items()}
        for name in data.config.maps
    }


def folder_card(data: Dataset, png: bool) -> str:
    """The data card of an output folder."""
    name = data.config.maps[0]
    h5 = (
        "`dataset.h5` holds everything for h5py and MATLAB: `/maps/<map>`, `/label`, `/split`, "
        "`/scene/<column>`."
    )
    if not png:
        return card(
            data,
            {},
            f"{h5} `radhar convert . -o OUT --to parquet` makes a data set of it that "
            "`datasets.load_dataset` reads.",
        )
    return card(
        data,
        {"configs": configurations(data.config, png_files(data))},
        f"""\
{loading(name)}

torchvision's `ImageFolder("png/{name}/train")` reads the same images, but numbers the classes by
the alphabet. {h5}""",
    )


def wrong_hub_files(data: Dataset, folder: Path) -> list[str]:
    """What is wrong with the card, its picture and the metadata, a line each.

    A card's text, its licence and more are its owner's to change; what `load_dataset` reads is
    not. A folder without picture is no worse for it, nor one without card and images.
    """
    png = (folder / PNG).is_dir()
    problems = wrong_metadata(data, folder) if png else []
    try:
        if (folder / GALLERY).exists():
            image_size(folder / GALLERY)
        if png or (folder / CARD).exists():
            found = front_matter(folder / CARD).get("configs")
            if found not in (configurations(data.config, png_files(data)), *([None] * (not png))):
                problems.append(
                    f"{CARD}: its configs are not the maps here; where there is no card `generate` "
                    "writes one"
                )
    except FolderError as error:
        problems.append(str(error))
    return problems
