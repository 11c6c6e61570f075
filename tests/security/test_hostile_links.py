"""A file that another file names, or that lies beside it, may be a link, but not to elsewhere."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from helpers.recorded import frames, write_amc, write_bvh
from PIL import Image

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.windows import with_recordings
from radhar_cli.config import load_config
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.opening import open_images

HEADER = ["carrier_hz=77e9", "bandwidth_hz=1e9", "adc_rate_hz=1e6", "prf_hz=1000"]

Case = tuple[Path, Callable[[], object]]  # the file that is not named by the user; who reads it


def next_file_of_a_capture(folder: Path) -> Case:
    words = np.random.default_rng(0).integers(-99, 99, 400, "<i2")
    for number in range(2):
        (folder / f"a_Raw_{number}.bin").write_bytes(words.tobytes())
    settings = read_settings(None, [*HEADER, "samples=10", "receivers=1"])
    out = folder / "o.h5"
    return folder / "a_Raw_1.bin", lambda: import_capture([folder / "a_Raw_0.bin"], out, settings)


def recording_of_a_manifest(folder: Path) -> Case:
    np.save(folder / "x.npy", np.random.default_rng(0).standard_normal((8, 400)))
    import_capture(
        [folder / "x.npy"], folder / "x.h5", read_settings(None, [*HEADER, "axes=[sample,pulse]"])
    )
    (folder / "m.csv").write_text("file,label\nx.h5,walking\n")
    (folder / "c.yaml").write_text("maps: [stft]\nrecordings: {window_s: 0.2}\n")
    config = load_config(folder / "c.yaml")
    return folder / "x.h5", lambda: with_recordings(config, folder / "m.csv")


def image_of_a_tree(folder: Path) -> Case:
    _images(folder / "tree")
    text = "maps: [stft]\nrecordings: {window_s: 1, rows: [-1, 1]}\n"
    (folder / "c.yaml").write_text(text + "processing: {window_s: 0.5}\n")
    config = load_config(folder / "c.yaml")
    return folder / "tree/a/0.png", lambda: with_recordings(config, folder / "tree")


def image_to_train_on(folder: Path) -> Case:
    _images(folder / "tree")
    return folder / "tree/a/0.png", lambda: open_images(folder / "tree", None, "gray")


def _images(tree: Path) -> None:
    for name in "ab":
        (tree / name).mkdir(parents=True)
        Image.new("L", (32, 32)).save(tree / name / "0.png")


def motion_file_of_a_pattern(folder: Path) -> Case:
    (folder / "walk").mkdir()
    path = write_bvh(folder / "walk/1.bvh", frames(seconds=0.3))
    (folder / "c.yaml").write_text('duration_s: 1\nclasses: {wave: ["walk/*.bvh"]}\n')
    return path, lambda: load_config(folder / "c.yaml")


def skeleton_beside_an_amc(folder: Path) -> Case:
    (folder / "walk").mkdir()
    write_amc(folder / "walk/1.amc", frames(seconds=0.3))
    (folder / "c.yaml").write_text("duration_s: 1\nclasses: {wave: [walk/1.amc]}\n")
    return folder / "walk/1.asf", lambda: load_config(folder / "c.yaml")


CASES = [
    *(next_file_of_a_capture, recording_of_a_manifest, image_of_a_tree),
    *(image_to_train_on, motion_file_of_a_pattern, skeleton_beside_an_amc),
]


@pytest.mark.parametrize("case", CASES)
def test_a_link_may_lead_to_the_same_folder_and_not_out_of_it(
    case: Callable[[Path], Case], tmp_path: Path
) -> None:
    folder = tmp_path / "given"
    folder.mkdir()
    file, read = case(folder)
    read()
    within, outside = file.with_name(".kept"), tmp_path / "outside"
    file.rename(within)
    file.symlink_to(within)
    read()
    within.rename(outside)
    file.unlink()
    file.symlink_to(outside)
    with pytest.raises(FolderError) as error:
        read()
    assert str(error.value).startswith(f"{file}: is a link to {outside}, which lies outside of ")


@pytest.mark.parametrize("case", CASES)
def test_the_folder_and_what_the_user_names_may_be_links(
    case: Callable[[Path], Case], tmp_path: Path
) -> None:
    (tmp_path / "real").mkdir()
    folder = tmp_path / "given"
    folder.symlink_to(tmp_path / "real")
    case(folder)[1]()


def test_a_folder_that_a_pattern_names_may_be_a_link(tmp_path: Path) -> None:
    (tmp_path / "given").mkdir()
    _, read = motion_file_of_a_pattern(tmp_path / "given")
    (tmp_path / "given/walk").rename(tmp_path / "elsewhere")
    (tmp_path / "given/walk").symlink_to(tmp_path / "elsewhere")
    read()
