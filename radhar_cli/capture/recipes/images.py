"""Images that exist already, such as CI4R's: trees of class folders, tables, .npz and Parquet.

Images say no axes: `maps`, `recordings.rows` and `recordings.window_s` of the config give them.
"""

from pathlib import Path

from radhar_cli.capture.images import are_images
from radhar_cli.capture.recipes.recipe import SetRecipe
from radhar_cli.dataset.image_file import SUFFIXES


def find_manifest(folder: Path) -> Path:
    """Return the source of the images: a table or an .npz in a folder of such, else the folder."""
    if folder.is_dir():
        inside = sorted(path for path in folder.iterdir() if path.is_file())
        packed = [path for path in inside if path.suffix.lower() not in {*SUFFIXES, ".parquet"}]
        manifests = [path for path in packed if are_images(path)]
        if len(manifests) == 1:
            return manifests[0]
    return folder


RECIPE = SetRecipe(
    source="images that exist already, such as those of CI4R",
    licence="",
    holds="a folder a class, a table (file, label, person, split), .npz, Parquet of Hugging Face",
    tested="files written by these layouts",
    layout="walking/0001.png",
    find_manifest=find_manifest,
    config={"maps": [], "output": {"png": True}},
)
