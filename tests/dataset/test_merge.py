"""Parts built separately merge into the data set of one build; gaps are refused."""

import shutil
import signal
import subprocess
import sys
import time
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import radhar
from helpers.listener import Listener
from helpers.small import fingerprint, small_config
from PIL import Image

from radhar_cli.config import load_config
from radhar_cli.dataset.build import build, build_part
from radhar_cli.dataset.merge import merge
from radhar_cli.dataset.parts import DataSetPart
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.shards import list_shards
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import FolderError, UnfinishedError

CHANGES = [
    "maps=[rtm, stft]",
    "image.size_px=16",
    # in no alphabetical order
    "motion.walking.speed_mps={per_activity: {walking: 1.4, default: 1.5}}",
]


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    return load_config(small_config(tmp_path_factory.mktemp("config")), CHANGES)


@pytest.fixture(scope="module")
def whole_folder(config, tmp_path_factory):
    """Folder of the data set made in one piece."""
    folder = tmp_path_factory.mktemp("whole") / "set"
    build(config, folder, 1, Listener())
    return folder


@pytest.fixture(scope="module")
def whole(whole_folder):
    """Fingerprint of the data set made in one piece."""
    return fingerprint(whole_folder)


@pytest.fixture(scope="module")
def made(config, tmp_path_factory):
    """All four parts of a data set, for tests to copy."""
    out = tmp_path_factory.mktemp("parts") / "set"
    for number in (3, 1, 4, 2):
        build_part(config, out, DataSetPart(4, number), 1, Listener(), batch_size=1 + number % 2)
    return out


@pytest.fixture
def out(made, tmp_path):
    return Path(shutil.copytree(made, tmp_path / "set"))


def merged(out):
    """Fingerprint of a merged data set, its parts aside."""
    return {k: v for k, v in fingerprint(out).items() if not k.startswith("parts/")}


def changed_levels(folder, other):
    """Grey levels that differ in the images of two data sets.

    Returns:
        (file, number of pixels, and row, column, level and other level of the first eight of them)
        of each image that differs.
    """
    changes = []
    for path in sorted(folder.glob("png/**/*.png")):
        name = path.relative_to(folder)
        levels, others = (np.asarray(Image.open(each / name)) for each in (folder, other))
        rows, columns = np.nonzero(levels != others)
        if rows.size:
            pixels = zip(rows, columns, levels[rows, columns], others[rows, columns], strict=True)
            first = [tuple(map(int, pixel)) for pixel in islice(pixels, 8)]
            changes.append((str(name), rows.size, first))
    return changes


def test_parts_in_one_place_or_two_are_the_build_in_one_piece(out, whole, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    (out / "parts/2-of-4").rename(elsewhere)
    merge(out, [elsewhere], 1, Listener())
    assert merged(out) == whole
    merge(out, [out, out / "parts/1-of-4", elsewhere], 1, Listener())
    assert merged(out) == whole
    shutil.rmtree(out / "parts")
    assert verify(out, 1).problems == []


def test_gaps_and_damage_name_the_parts_to_run_again(config, out, whole):
    shutil.rmtree(out / "parts/3-of-4")
    shard = list_shards(out / "parts/1-of-4")[-1].path
    content = shard.read_bytes()
    shard.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    with pytest.raises(UnfinishedError, match=r"rows 4-5 \(2 of 9\).* make .* --shard 3/4, then"):
        merge(out, [], 1, Listener())
    build_part(config, out, DataSetPart(4, 3), 1, Listener())
    with pytest.raises(
        UnfinishedError, match=r"rows 0-1 \(2 of 9\).* make .* --shard 1/4, then"
    ) as told:
        merge(out, [], 1, Listener())
    assert f"{shard} does not match its checksum" in str(told.value)
    assert not (out / "dataset.h5").exists()
    assert build_part(config, out, DataSetPart(4, 1), 1, Listener()).new_samples == 2
    merge(out, [], 1, Listener())
    assert merged(out) == whole


def test_damaged_shards_are_replaced_by_shards_of_other_rows(config, out, whole):
    damaged = list_shards(out / "parts/2-of-4")
    assert [shard.stop - shard.start for shard in damaged] == [1, 1]
    for shard in damaged:
        shard.path.write_bytes(shard.path.read_bytes()[:-1])
    notes = Listener()
    assert build_part(config, out, DataSetPart(4, 2), 1, notes, batch_size=2).new_samples == 2
    assert len(notes.messages) >= 2
    merge(out, [], 1, Listener())
    assert merged(out) == whole


def test_nothing_unfinished_is_left_in_a_part_or_the_whole(made, out):
    assert not list(made.rglob("*unfinished*"))
    merge(out, [], 1, Listener())
    assert not list(out.rglob("*unfinished*"))


def test_a_finished_part_makes_nothing_again(config, out):
    assert build_part(config, out, DataSetPart(4, 2), 1, Listener()).already_complete


def test_parts_of_something_else_are_refused(config, out, tmp_path):
    other = config.model_copy(update={"seed": 8})
    with pytest.raises(FolderError, match="holds parts of 4; this would be part 1/3"):
        build_part(config, out, DataSetPart(3, 1), 1, Listener())
    with pytest.raises(FolderError, match="should be at most K/9"):
        build_part(config, tmp_path / "ten", DataSetPart(10, 1), 1, Listener())
    with pytest.raises(FolderError, match="differs in\n  seed: 7 there, 8 here"):
        build_part(other, out, DataSetPart(4, 1), 1, Listener())
    with pytest.raises(FolderError, match="radhar merge"):
        build(config, out, 1, Listener())
    build_part(other, tmp_path / "other", DataSetPart(4, 2), 1, Listener())
    with pytest.raises(FolderError, match="seed: 7 there, 8 here"):
        merge(out, [tmp_path / "other"], 1, Listener())
    with pytest.raises(FolderError, match="no such folder"):
        merge(tmp_path / "nothing", [], 1, Listener())


def test_reading_unmerged_parts_asks_to_merge(out, tmp_path):
    part = out / "parts/1-of-4"
    with pytest.raises(FolderError, match=f"{part} is part 1/4 alone; `radhar merge OUT`"):
        open_dataset(part)
    with pytest.raises(FolderError, match=f"not made yet; `radhar merge {out}`"):
        open_dataset(out)
    (part / ".radhar/built").unlink()
    with pytest.raises(FolderError, match="unfinished; run `radhar generate` again"):
        open_dataset(part)
    with pytest.raises(FolderError, match="no such file"):
        open_dataset(tmp_path / "none")


def test_parts_hold_each_row_once():
    for count, of in ((9, 4), (10, 10), (1000, 7)):
        rows = [row for number in range(1, of + 1) for row in DataSetPart(of, number).rows(count)]
        assert rows == list(range(count))


def test_a_part_is_k_of_n():
    for wrong in ("0/3", "4/3", "1", "a/b", "1/3/5"):
        with pytest.raises(FolderError, match="should be K/N"):
            DataSetPart.parse(wrong)


def test_levels_that_differ_are_named(whole_folder, tmp_path):
    copy = Path(shutil.copytree(whole_folder, tmp_path / "set"))
    name = "png/rtm/train/walking/00002.png"
    image = Image.open(copy / name)
    level = image.getpixel((5, 3))
    image.putpixel((5, 3), level ^ 1)
    image.save(copy / name)
    assert changed_levels(whole_folder, copy) == [(name, 1, [(3, 5, level, level ^ 1)])]


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_the_program_makes_killed_parts_whole(whole, whole_folder, tmp_path):
    path, out = small_config(tmp_path), tmp_path / "set"
    arguments = ["generate", path, "-o", out, *(x for c in CHANGES for x in ("--set", c))]
    arguments = [*map(str, arguments), "--batch", "1", "--jobs", "1", "--shard"]
    part = out / "parts/2-of-2"
    for _ in range(20):  # on a busy machine a part may be whole before it is seen to have begun
        run = subprocess.Popen(
            [sys.executable, "-m", "radhar_cli", *arguments, "2/2"], stdout=subprocess.DEVNULL
        )
        while run.poll() is None and not list_shards(part):
            time.sleep(0.001)
        run.send_signal(signal.SIGKILL)
        run.wait()
        if 0 < len(list_shards(part)) < 5:
            break
        shutil.rmtree(part)
    assert 0 < len(list_shards(part)) < 5
    failed = radhar("merge", out)
    assert (failed.returncode, "--shard 1/2, --shard 2/2" in failed.stderr) == (1, True)
    for shard in ("1/2", "2/2"):
        assert radhar(*arguments, shard).returncode == 0
    assert radhar("merge", out).returncode == 0
    assert changed_levels(whole_folder, out) == []  # which says more than two digests
    assert merged(out) == whole


def test_parts_of_two_builds_of_radhar_are_not_merged(config, out, monkeypatch):
    monkeypatch.setattr("radhar_cli.dataset.identity.build_version", lambda: "0.1.0+another")
    part = DataSetPart(4, 2)
    build_part(config, out, part, 1, Listener(), overwrite=True)
    with pytest.raises(FolderError, match=r'versions\.radhar: "0\.1\.0\+[0-9a-f]{12}"'):
        merge(out, [], 1, Listener())
