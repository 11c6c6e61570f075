"""`radhar config init`: a file out of the schema that says every key, its default and meaning."""

import re
from functools import partial
from pathlib import Path
from types import NoneType
from typing import get_args

import numpy as np
import pytest
from helpers.command_line import ROOT, ok, radhar

from radhar_cli.config import Config, load_config
from radhar_cli.config.built_in_radars import device_of
from radhar_cli.config.documents import PRESETS, RADARS, find_preset
from radhar_cli.config.reading import load_section, load_sections
from radhar_cli.config.room import WallConfig
from radhar_cli.config.starting_file import WIDTH, as_commented_yaml, of_board, of_preset
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import ConfigError
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.radar.board import DEVICES
from radhar_cli.scene.single.simulate import simulate
from radhar_cli.schema.section import Section

KINDS = pytest.mark.parametrize("kind", [Config, TrainConfig], ids=["data", "train"])


def keys(kind: type[Section]) -> set[str]:
    """Names of the keys of a file, those of sections that are null by default too."""
    found = set()
    for name, field in kind.model_fields.items():
        if not field.exclude:
            found.add(name)
            parts = get_args(field.annotation)
            for one in parts if NoneType in parts else [field.annotation]:
                if isinstance(one, type) and issubclass(one, Section):
                    found |= keys(one)
    return found


@KINDS
def test_it_reads_back_as_the_defaults(tmp_path: Path, kind: type[Section]) -> None:
    path = tmp_path / "new.yaml"
    path.write_text(as_commented_yaml(kind))
    assert load_section(kind, path) == kind()


@KINDS
def test_every_key_stands_in_it_and_is_explained(kind: type[Section]) -> None:
    text = as_commented_yaml(kind)
    lines = text.splitlines()
    assert max(map(len, lines)) <= WIDTH
    stand = {}
    for number, line in enumerate(lines):
        found = re.match(r" *(?:# )? *([a-z][a-z0-9_]*):(?: |$)", line)
        if found:
            explained = "  # " in line or re.match(r" *(?:# )? *# ", lines[number - 1])
            stand[found[1]] = bool(explained) or line.endswith(f"{found[1]}:")
    assert keys(kind) <= stand.keys()
    assert not [key for key in keys(kind) if not stand[key]]


def test_the_starting_file_leaves_defaults_of_the_model_alone(tmp_path: Path) -> None:
    path = tmp_path / "new.yaml"
    path.write_text(as_commented_yaml(Config).replace("model: human", "model: paper"))
    assert load_config(path) == Config(motion={"model": "paper"})


def test_a_commented_section_can_be_uncommented(tmp_path: Path) -> None:
    text = as_commented_yaml(Config)
    path = tmp_path / "new.yaml"
    before, _, rest = text.partition("wall: null")
    block, _, after = rest.partition("\n\n")
    wall = "\n".join(line.removeprefix("# ") for line in block.splitlines()[1:])
    path.write_text(f"{before}{wall}\n\n{after}")
    assert load_config(path) == Config(wall=WallConfig())


@pytest.mark.every(4)
@pytest.mark.parametrize("name", RADARS)
def test_a_known_radar_is_simulated(tmp_path: Path, name: str) -> None:
    """A person gives points where it is."""
    text = of_board(name.upper(), tmp_path)
    (tmp_path / "mine.yaml").write_text(text)
    config = load_config(tmp_path / "mine.yaml", ["duration_s=0.5", "motion.range_m=2"])
    scene = simulate(config, "punching", maps=("points", "range_doppler"))
    assert scene.board is not None
    assert scene.board.array == DEVICES[device_of(name)].array
    points = scene.frames["cloud"].points
    assert len(points) > 3
    assert abs(np.median(np.linalg.norm(points[:, :3], axis=1)) - 2) < 0.5


@pytest.mark.parametrize("name", ["iwr1443boost", "iwr6843isk_people", "iwrl6432boost_clouds"])
def test_a_data_set_of_a_known_radar_is_built(tmp_path: Path, name: str) -> None:
    """Its frames hold people's points."""
    ok("config", "init", tmp_path / "mine.yaml", "--radar", name)
    tiny = ("samples_per_class=1", "activities=[punching]", "duration_s=0.5")
    parts = "split={train: 1, validation: 0, test: 0}"
    changes = [word for one in (*tiny, parts) for word in ("--set", one)]
    ok("generate", tmp_path / "mine.yaml", "-o", tmp_path / "data", *changes)
    with open_dataset(tmp_path / "data") as data:
        assert len(data.products["points"][0]) > 3


def test_the_minimal_file_is_short_and_can_be_built_at_once(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    said = ok("config", "init", path, "--minimal").stdout
    lines = path.read_text().splitlines()
    assert len(lines) <= 16
    assert max(map(len, lines)) <= WIDTH
    assert f"radhar generate {path} -o OUT" in said
    ok("generate", path, "-o", tmp_path / "data", "--set", "samples_per_class=2")
    with open_dataset(tmp_path / "data") as data:
        assert data.config.maps == ("rtm", "stft")
        assert len(data) == 2 * len(load_config(path).activities)
    both = radhar("config", "init", tmp_path / "other.yaml", "--minimal", "--train")
    assert both.returncode == 2
    assert "should be only one of them" in both.stderr


def test_an_unknown_radar_is_a_line_that_names_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r'"iwr6843": should be .* or one of iwr1443boost, .*isk'):
        of_board("iwr6843", tmp_path)


def test_every_shipped_config_is_a_preset() -> None:
    shipped = (ROOT / "configs").rglob("*.yaml")
    assert {str(path.relative_to(ROOT / "configs")) for path in shipped} == {
        f"{name}.yaml" for name in PRESETS
    }


@pytest.mark.every(4)
@pytest.mark.parametrize("name", PRESETS)
def test_a_written_preset_needs_no_other_file(tmp_path: Path, name: str) -> None:
    """It says in a folder of its own what the shipped config says in its own."""
    path, is_training = tmp_path / "mine.yaml", name.startswith("train/")
    said = ok("config", "init", path, "--preset", name).stdout
    read = partial(load_section, TrainConfig) if is_training else load_sections
    assert read(path) == read(ROOT / f"configs/{name}.yaml")
    assert path.read_text().startswith("# ")
    then = f"train DATA --config {path}" if is_training else f"generate {path}"
    assert f"radhar {then} -o OUT" in said


def test_a_preset_is_named_as_documents_name_its_file() -> None:
    """One that needs no other file keeps its comments."""
    text = (ROOT / "configs/human/older.yaml").read_text()
    assert of_preset("configs/human/older.yaml") == of_preset("human/older") == text


@pytest.mark.parametrize("name", PRESETS)
def test_the_last_part_of_its_name_is_enough(name: str) -> None:
    last = name.rpartition("/")[2]
    assert find_preset(last) == (last if last in PRESETS else name)


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("human/rom", "did you mean 'human/room'?"),
        ("quikstart", "did you mean 'quickstart'?"),
        ("/etc/passwd", "should be one of"),
        ("", "should be one of"),
    ],
)
def test_an_unknown_preset_is_a_line_that_says_what_is_meant_or_lists_them(
    tmp_path: Path, name: str, advice: str
) -> None:
    done = radhar("config", "init", tmp_path / "mine.yaml", "--preset", name)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert f'--preset "{name}": {advice}' in line
    assert not (tmp_path / "mine.yaml").exists()


def test_presets_are_listed_with_what_they_are() -> None:
    lines = ok("config", "init", "--preset", "list").stdout.splitlines()
    assert [line.split()[0] for line in lines] == [*PRESETS]
    assert all(len(line.split()) > 3 for line in lines)


def test_a_config_that_radhar_comes_with_goes_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    room = load_config(ROOT / "configs/human/room.yaml")
    for name in ("configs/human/room.yaml", "human/room", "room"):
        assert load_config(name) == room
    (tmp_path / "over.yaml").write_text("base: human/room\nsnr_db: 7\n")
    assert load_config("over.yaml") == room.replace(snr_db=7)
    (tmp_path / "room").write_text("snr_db: 3\n")
    assert load_config("room").snr_db == 3  # a file goes before a name


def test_a_name_like_that_of_a_config_is_suggested(tmp_path: Path) -> None:
    (tmp_path / "over.yaml").write_text("base: human/rooom\n")
    for given in ("human/rom", str(tmp_path / "over.yaml")):
        done = radhar("config", "show", given)
        assert done.returncode == 2
        assert "did you mean 'human/room'?" in done.stderr
        assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("name", ["room.yaml", "quickstart.yaml", "configs/room.yaml", "human/rom"])
def test_a_file_that_is_missing_is_no_name(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = radhar("generate", name, "-o", "set")
    assert done.returncode == 2
    assert f"{name}: no such file" in done.stderr


@pytest.mark.parametrize(
    ("cfarCfg", "transmitters", "notes"),
    [
        ("15 1", 7, ["peak grouping is on"]),
        ("15 0", 7, []),
        ("15 0", 5, ["the elements that the file uses lie in one row"]),
        ("15 1", 1, ["peak grouping is on", "the elements that the file uses lie in one row"]),
    ],
)
def test_a_started_config_says_what_its_points_will_lack(
    tmp_path: Path, cfarCfg: str, transmitters: int, notes: list[str]
) -> None:
    on = [n for n in range(3) if transmitters >> n & 1]
    lines = [f"channelCfg 15 {transmitters} 0", "adcCfg 2 1"]
    lines += ["profileCfg 0 77 12 7 40 0 0 80 1 128 4500 0 0 30"]
    lines += [f"chirpCfg {k} {k} 0 0 0 0 0 {1 << n}" for k, n in enumerate(on)]
    lines += [f"frameCfg 0 {len(on) - 1} 64 0 50 1 0", f"cfarCfg -1 0 2 8 4 3 0 {cfarCfg}"]
    (tmp_path / "board.cfg").write_text("% Platform:xWR18xx\n" + "\n".join(lines))
    out = tmp_path / "mine.yaml"
    said = ok("config", "init", out, "--radar", tmp_path / "board.cfg").stdout
    known = "peak grouping is on", "the elements that the file uses lie in one row"
    assert [note for note in known if note in said] == notes
    assert [note for note in known if f"# {note}" in out.read_text()] == notes


@pytest.mark.parametrize("name", ["bgt60tr13c", "Position2Go", "tinyrad24g", "fmcw24_1x4"])
def test_a_radar_of_another_maker_is_written_by_its_name(tmp_path: Path, name: str) -> None:
    path = tmp_path / "mine.yaml"
    ok("config", "init", path, "--radar", name)
    radar = load_config(path).radar
    assert radar.named == "radar.frame"
    assert radar == load_config(ROOT / f"configs/boards/{name.lower()}.yaml").radar
