"""Whatever happens to the shards, a finished data set is the right one or there is none.

Rows are stubs (noise of the row's own number), so that a build takes some hundredths of a second.
"""

import hashlib
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from helpers.listener import Listener
from helpers.slow import examples
from helpers.small import fingerprint, small_config
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config, load_config
from radhar_cli.dataset import batch as batch_module
from radhar_cli.dataset import column_writers
from radhar_cli.dataset import verify as verify_module
from radhar_cli.dataset.build import build
from radhar_cli.dataset.sample import StoredSample
from radhar_cli.dataset.shards import list_shards, shard_folder
from radhar_cli.dataset.verify import verify
from radhar_cli.errors import UnfinishedError
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.processing.power_map import MapImage
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.scene import Scene, draw_scene, scene_numbers


def stub_draw(config: Config, activity: Activity, index: int) -> tuple[Scene, Flags]:
    return draw_scene(config, activity, index, index % 3), Flags(0)


def stub_synthesise(scene: Scene, plan: object, config: Config) -> StoredSample:
    assert config.maps == scene.config.maps

    def image(name: str) -> MapImage:
        drawn = json.dumps([name, scene.name, scene_numbers(scene)], sort_keys=True)
        rng = np.random.default_rng(list(hashlib.sha256(drawn.encode()).digest()))
        levels = rng.integers(0, 256, config.image.size_px, dtype=np.uint8)
        return MapImage(levels, float(rng.random()), (0.0, 1.0, *sorted(rng.random(2))))

    return StoredSample({name: image(name) for name in config.maps}, -100.0 - scene.index)


@pytest.fixture(scope="module", autouse=True)
def stubs() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        for module in (batch_module, verify_module):
            patch.setattr(module, "draw_valid_scene", stub_draw)
            patch.setattr(module, "synthesise", stub_synthesise)
            patch.setattr(module, "plan_images", lambda config: None)
        yield


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Config:
    changes = ["maps=[rtm, stft]", "image.size_px=16", "samples_per_class=4"]
    return load_config(small_config(tmp_path_factory.mktemp("config")), changes)


@pytest.fixture(scope="module")
def whole(config: Config, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole") / "set"
    build(config, folder, 1, Listener(), batch_size=5)
    assert verify(folder, 12).problems == []
    return folder


class AtAssembly(Listener):
    """Changes a folder when its shards are all made, before assembly."""

    def __init__(self, action: Callable[[], None]) -> None:
        super().__init__()
        self.action = action

    def stage(self, name: str, total: int, done: int, unit: str | None = None) -> None:
        if name == "assembling":
            self.action()


def interrupted(config: Config, folder: Path, batch_size: int) -> Path:
    """A folder with all shards made and nothing put together; returns its work folder."""

    def stop() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        build(config, folder, 1, AtAssembly(stop), batch_size=batch_size)
    return folder / ".radhar"


def test_a_shard_that_vanishes_is_named_and_made_again(
    config: Config, whole: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "set"

    def lose_two() -> None:
        for start in (2, 8):
            (shard_folder(folder) / f"rows-{start:09d}-{start + 2:09d}.h5").unlink()

    with pytest.raises(UnfinishedError, match=r"rows 2-3, 8-9 \(4 of 12\) are missing"):
        build(config, folder, 1, AtAssembly(lose_two), batch_size=2)
    assert not (folder / "dataset.h5").exists()
    assert not list((folder / ".radhar").rglob("unfinished/*"))
    assert build(config, folder, 1, Listener(), batch_size=3).new_samples == 4
    assert fingerprint(folder) == fingerprint(whole)


def test_a_stale_directory_listing_loses_no_row(
    config: Config, whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    listing = Path.iterdir

    def without_shards(path: Path) -> Iterator[Path]:
        return iter(()) if path.name == "shards" else listing(path)

    interrupted(config, tmp_path / "set", 3)
    monkeypatch.setattr(Path, "iterdir", without_shards)
    build(config, tmp_path / "set", 1, Listener(), batch_size=2)
    assert fingerprint(tmp_path / "set") == fingerprint(whole)


def test_a_damaged_shard_is_made_again_and_a_foreign_one_kept(
    config: Config, whole: Path, tmp_path: Path
) -> None:
    other = interrupted(config.model_copy(update={"seed": 8}), tmp_path / "other", 4)
    work = interrupted(config, tmp_path / "set", 4)
    first, second, _ = (shard.path for shard in list_shards(tmp_path / "set"))
    first.write_bytes(first.read_bytes()[:-1])
    foreign = (other / "shards" / second.name).read_bytes()
    second.write_bytes(foreign)
    (work / "shards" / "notes.txt").write_text("mine")
    notes = Listener()
    assert build(config, tmp_path / "set", 1, notes).new_samples == 8
    assert [m.rpartition(": ")[2] for m in notes.messages if "shards" in m] == [
        "does not match its checksum; its rows are made again",
        "belongs to another data set; its rows are made again",
    ]
    assert fingerprint(tmp_path / "set") == fingerprint(whole)
    left = {path.read_bytes() for path in (work / "shards").iterdir()}
    assert left == {foreign, b"mine"}


def test_chunk_layout_does_not_depend_on_the_shards(
    config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With more rows than a run of chunks or of columns, on both sides of their borders."""
    monkeypatch.setattr(column_writers, "COLUMN_RUN", 20)
    many = config.model_copy(
        update={
            "samples_per_class": 50,
            "output": config.output.model_copy(update={"png": False}),
        }
    )
    for name, size in (("a", 7), ("b", 128), ("c", 150)):
        build(many, tmp_path / name, 1, Listener(), batch_size=size)
    assert fingerprint(tmp_path / "a") == fingerprint(tmp_path / "b") == fingerprint(tmp_path / "c")
    assert verify(tmp_path / "a", 10).problems == []


Pieces = dict[str, list[bytes]]
"""Contents by path below .radhar: the file that radhar wrote there, for several data sets."""


@pytest.fixture(scope="module")
def pieces(config: Config, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Pieces]:
    """What interrupted builds leave, of this data set and of its likes, in several batch sizes."""
    place = tmp_path_factory.mktemp("pieces")
    likes = {
        "right": config,
        "seed": config.model_copy(update={"seed": 8}),
        "split": config.model_copy(
            update={"split": config.split.model_copy(update={"train": 0.5, "validation": 0.5})}
        ),
        "more": config.model_copy(update={"samples_per_class": 5}),
    }
    found: dict[str, Pieces] = {name: {} for name in likes}
    for name, like in likes.items():
        for size in (2, 3, 5):
            work = interrupted(like, place / f"{name}{size}", size)
            for path in work.glob("*/*"):
                found[name].setdefault(str(path.relative_to(work)), []).append(path.read_bytes())
    return found


@st.composite
def disturbances(draw: st.DrawFn, pieces: dict[str, Pieces]) -> dict[str, bytes | None]:
    """What lies below .radhar: some of this data set's files, whole, damaged or exchanged."""
    names = sorted({name for found in pieces.values() for name in found})
    laid: dict[str, bytes | None] = {}
    for name in draw(st.lists(st.sampled_from(names), unique=True, max_size=len(names))):
        right = pieces["right"].get(name, [b""])[0]
        kind = draw(st.sampled_from(("right", "cut", "flipped", "exchanged", "foreign", "gone")))
        if kind == "cut":
            laid[name] = right[: draw(st.integers(0, max(0, len(right) - 1)))]
        elif kind == "flipped" and right:
            place = draw(st.integers(0, len(right) - 1))
            laid[name] = right[:place] + bytes([right[place] ^ 255]) + right[place + 1 :]
        elif kind == "exchanged":
            laid[name] = pieces["right"][draw(st.sampled_from(sorted(pieces["right"])))][0]
        elif kind == "foreign":
            found = pieces[draw(st.sampled_from(sorted(pieces)))]
            laid[name] = found.get(name, found[min(found)])[0]
        elif kind == "gone":
            laid[name] = None
        elif right:
            laid[name] = right
    return laid


def lay(work: Path, laid: dict[str, bytes | None]) -> None:
    for name, content in laid.items():
        (work / name).parent.mkdir(parents=True, exist_ok=True)
        if content is None:
            (work / name).unlink(missing_ok=True)
        else:
            (work / name).write_bytes(content)


@settings(max_examples=examples(40), deadline=None)
@given(data=st.data())
def test_damaged_or_exchanged_shards_never_give_a_wrong_data_set(
    data: st.DataObject, config: Config, whole: Path, pieces: dict[str, Pieces]
) -> None:
    """Before a run and again in the midst of it; afterwards the same command, left alone."""
    before, meanwhile = (data.draw(disturbances(pieces), label=when) for when in ("before", "then"))
    size = data.draw(st.sampled_from((1, 2, 3, 5, 12, None)), label="batch size")
    with TemporaryDirectory() as place:
        folder = Path(place, "set")
        lay(folder / ".radhar", before)
        listener = AtAssembly(lambda: lay(folder / ".radhar", meanwhile))
        try:
            build(config, folder, 1, listener, batch_size=size)
        except UnfinishedError as error:
            refusal = str(error)
        else:
            refusal = None
        if refusal is None:
            assert fingerprint(folder) == fingerprint(whole)
        else:
            assert re.search(r"rows [\d, .-]+ \(\d+ of 12\) are missing .* resumes", refusal)
            assert not (folder / "dataset.h5").exists()
        build(config, folder, 1, Listener(), batch_size=size)
        assert fingerprint(folder) == fingerprint(whole)
