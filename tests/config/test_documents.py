"""`base`: a config over another; merged deeply, in a chain, refused where missing or circular."""

import os
from pathlib import Path
from textwrap import dedent

import pytest
import yaml

from radhar_cli.config import Config, load_config, resolved
from radhar_cli.config.documents import MAX_CHAIN
from radhar_cli.config.identity import as_yaml, config_hash
from radhar_cli.config.reading import load_section
from radhar_cli.errors import ConfigError
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.schema.number import Choice, Normal, Uniform, Vary


def write(folder: Path, **texts: str) -> None:
    """Files by name, `shared/` for `shared__`."""
    for name, text in texts.items():
        path = folder / f"{name.replace('__', '/')}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dedent(text))


def refusal(path: Path, *overrides: str) -> str:
    with pytest.raises(ConfigError) as caught:
        load_config(path, overrides)
    return str(caught.value)


def test_keys_of_a_file_override_those_of_its_base(tmp_path: Path) -> None:
    write(
        tmp_path,
        lab="""
        seed: 5
        radar: {carrier_hz: 24e9, prf_hz: 2000}
        motion: {model: paper, range_m: {per_activity: {default: 2, walking: 3}}}
        maps: [rtm, stft]
        wall: {eps_r: 4, loss_tangent: 0.1}
        """,
        mine="""
        base: lab.yaml
        radar: {prf_hz: 1000}
        motion: {range_m: {per_activity: {walking: 1}}}
        maps: [stft]
        wall: {eps_r: 5}
        """,
    )
    write(
        tmp_path,
        whole="""
        seed: 5
        radar: {carrier_hz: 24e9, prf_hz: 1000}
        motion: {model: paper, range_m: {per_activity: {default: 2, walking: 1}}}
        maps: [stft]
        wall: {eps_r: 5, loss_tangent: 0.1}
        """,
    )
    mine, whole = load_config(tmp_path / "mine.yaml"), load_config(tmp_path / "whole.yaml")
    assert mine == whole
    assert config_hash(mine) == config_hash(whole)


@pytest.mark.parametrize(
    ("lower", "own", "both"),
    [
        ("{normal: [1.7, 0.1], min: 1.6}", "{uniform: [1, 2]}", Uniform(uniform=(1, 2))),
        ("{normal: [1.7, 0.1], min: 1.6}", "{normal: [1.8, 0.1]}", Normal(normal=(1.8, 0.1))),
        ("{normal: [1.7, 0.1]}", "{min: 1.6}", Normal(normal=(1.7, 0.1), min=1.6)),
        ("{choice: [1, 2, 3]}", "1.5", 1.5),
        ("1.5", "{vary: [2, 0.1]}", Vary(vary=(2, 0.1))),
        ("{choice: [1, 2, 3]}", "{choice: [1]}", Choice(choice=(1,))),
    ],
)
def test_a_distribution_is_overridden_as_a_whole(
    tmp_path: Path, lower: str, own: str, both: object
) -> None:
    write(tmp_path, a=f"snr_db: {lower}", b=f"base: a.yaml\nsnr_db: {own}")
    assert load_config(tmp_path / "b.yaml").snr_db == both


def test_a_plain_number_replaces_one_by_activity_and_vice_versa(tmp_path: Path) -> None:
    by_activity = "{per_activity: {default: 2, walking: 1}}"
    write(tmp_path, a=f"motion: {{model: paper, range_m: {by_activity}, paper: {{gait_hz: 2}}}}")
    write(
        tmp_path,
        b="base: a.yaml\n"
        f"motion: {{range_m: {{uniform: [1, 2]}}, paper: {{gait_hz: {by_activity}}}}}",
    )
    motion = load_config(tmp_path / "b.yaml").motion
    assert motion.range_m == Uniform(uniform=(1, 2))
    assert resolved(motion)["paper"]["gait_hz"] == {"per_activity": {"default": 2, "walking": 1}}


def test_null_removes_a_section(tmp_path: Path) -> None:
    write(tmp_path, a="wall: {eps_r: 4}\nsnr_db: 3", b="base: a.yaml\nwall: null\nsnr_db: null")
    config = load_config(tmp_path / "b.yaml")
    assert (config.wall, config.snr_db) == (None, None)


def test_a_class_of_a_base_is_replaced_by_another_kind_and_keeps_its_number(tmp_path: Path) -> None:
    write(
        tmp_path,
        a="classes: {pace: {sequence: [walking], pauses_s: [1]}, rest: {sequence: [standing_up]}}",
        b="base: a.yaml\nclasses: {pace: {sequence: [standing_up, walking]}}",
    )
    config = load_config(tmp_path / "b.yaml")
    assert [a.slug for a in config.chosen_activities[-2:]] == ["pace", "rest"]
    assert resolved(config)["classes"]["pace"]["pauses_s"] == [0, 0]


def test_bases_are_relative_to_the_file_that_names_them(tmp_path: Path) -> None:
    write(
        tmp_path,
        shared__radar="radar: {prf_hz: 2000, carrier_hz: 5e9}\nseed: 1",
        shared__room="base: radar.yaml\nseed: 2\nsnr_db: 7",
        mine__scene="base: ../shared/room.yaml\nseed: 3",
    )
    config = load_config(tmp_path / "mine/scene.yaml")
    assert (config.seed, config.snr_db, config.radar.prf_hz) == (3, 7, 2000)


def test_a_base_given_by_set_is_relative_to_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, other="seed: 9\nsnr_db: 1", own="seed: 4", sub__mine="base: ../own.yaml")
    monkeypatch.chdir(tmp_path)
    mine = Path("sub/mine.yaml")
    assert load_config(mine).seed == 4
    changed = load_config(mine, ["base=other.yaml", "snr_db=2"])
    assert (changed.seed, changed.snr_db) == (9, 2)
    assert load_config(mine, ["base=null"]) == Config()
    assert (
        refusal(mine, "base=none.yaml") == '--set base: base = "none.yaml": none.yaml: no such file'
    )
    write(tmp_path, teach="epochs: 3", short="base: teach.yaml\nseed: 2")
    assert load_section(TrainConfig, Path("short.yaml")) == TrainConfig(epochs=3, seed=2)
    assert load_section(TrainConfig, None, ["base=teach.yaml"]) == TrainConfig(epochs=3)


def test_overrides_apply_to_keys_of_a_base(tmp_path: Path) -> None:
    write(tmp_path, a="snr_db: {normal: [10, 1]}\nradar: {prf_hz: 1000}", b="base: a.yaml")
    config = load_config(tmp_path / "b.yaml", ["snr_db.min=9", "radar.chirp_s=2e-5"])
    assert config.snr_db == Normal(normal=(10, 1), min=9)
    assert (config.radar.prf_hz, config.radar.chirp_s) == (1000, 2e-5)


def test_stored_configs_name_no_base(tmp_path: Path) -> None:
    write(tmp_path, a="seed: 4", b="base: a.yaml")
    config = load_config(tmp_path / "b.yaml")
    assert "base" not in yaml.safe_load(as_yaml(config))
    (tmp_path / "a.yaml").unlink()
    write(tmp_path, c=as_yaml(config))
    assert load_config(tmp_path / "c.yaml") == config


def test_mistakes_name_the_file_and_line_they_are_in(tmp_path: Path) -> None:
    write(
        tmp_path,
        a="seed: 1\nradar:\n  prf_hz: -5\n  chirp_s: 4e-5\nsead: 3\nsnr_db: {uniform: [2, 1]}",
        b="base: a.yaml\nradar:\n  chirp_s: x\nsnr_db: {normal: [0, -1]}",
    )
    a, b = tmp_path / "a.yaml", tmp_path / "b.yaml"
    told = [line.partition(" = ")[0] for line in refusal(b).splitlines()]
    assert sorted(told) == sorted(
        [f"{a}:3: radar.prf_hz", f"{b}:3: radar.chirp_s", f"{a}:5: sead", f"{b}:4: snr_db"]
    )
    write(tmp_path, c="base: a.yaml\nroom: {reflectors: [{rcs_dbsm: 1, zzz: 3}]}")
    write(tmp_path, a="room:\n  reflectors:\n    - zzz: 3\n      residual_m: 9")
    assert refusal(tmp_path / "c.yaml").startswith(
        f"{tmp_path / 'c.yaml'}:2: room.reflectors.0.zzz"
    )
    write(tmp_path, a="seed: [1")
    assert refusal(b).startswith(f'{b}:1: base = "a.yaml": {a}:1: not valid YAML')


def test_files_are_named_by_the_shortest_unambiguous_path(tmp_path: Path) -> None:
    write(tmp_path, root="radar: {chirp_s: x}", sub__mine="base: ../root.yaml")
    assert refusal(tmp_path / "sub/mine.yaml").startswith(f"{tmp_path / 'root.yaml'}:1: radar")
    write(tmp_path, far__sub__x="seed: 1", far__root="seed: x")
    (tmp_path / "link").symlink_to(tmp_path / "far/sub")
    write(tmp_path, link__mine="base: ../root.yaml")
    assert refusal(tmp_path / "link/mine.yaml").startswith(f"{tmp_path}/link/../root.yaml:1: seed")


def test_circular_bases_are_refused_with_their_chain(tmp_path: Path) -> None:
    write(tmp_path, a="base: b.yaml", b="seed: 1\nbase: sub/c.yaml", sub__c="base: ../a.yaml")
    a, b = tmp_path / "a.yaml", tmp_path / "b.yaml"
    c = tmp_path / "sub/c.yaml"
    assert refusal(a) == (
        f'{c}:1: base = "../a.yaml": should not lead back to a file on the way: '
        f"{a} -> {b} -> {c} -> {a}"
    )
    write(tmp_path, d="base: d.yaml")
    assert "should not lead back" in refusal(tmp_path / "d.yaml")


def test_chains_of_bases_have_a_maximum_length(tmp_path: Path) -> None:
    for n in range(MAX_CHAIN + 1):
        write(tmp_path, **{f"n{n}": f"base: n{n + 1}.yaml"})
    write(tmp_path, **{f"n{MAX_CHAIN + 1}": "seed: 3"})
    assert load_config(tmp_path / "n2.yaml").seed == 3
    assert f"should end after {MAX_CHAIN} files: " in refusal(tmp_path / "n1.yaml")


@pytest.mark.parametrize(
    ("base", "says"),
    [
        ("3", "base = 3: should be the path of a .yaml, .yml, .json file"),
        ("[a.yaml]", 'base = ["a.yaml"]: should be the path'),
        ("/etc/passwd", "should be the path"),
        ("none.yaml", "none.yaml: no such file"),
        ("fifo.yaml", "is a FIFO, a socket or a device"),
        ("folder.yaml", "is a folder"),
        ('"\\0.yaml"', "cannot be read as text"),
        ('"\\ud800.yaml"', "cannot be read as text"),
        ("x" * 300 + ".yaml", "cannot be read as text"),
        ("large.yaml", "holds more than"),
        ("list.yaml", "should be a mapping of keys"),
        ("laughs.yaml", "alias written out"),
    ],
    ids=lambda text: text[:12].strip('"\\'),
)
def test_invalid_bases_are_refused(tmp_path: Path, base: str, says: str) -> None:
    os.mkfifo(tmp_path / "fifo.yaml")
    (tmp_path / "folder.yaml").mkdir()
    alias = ", ".join(["*a"] * 99)
    write(tmp_path, large="# \n" * 2**16, list="[]", laughs=f"a: &a {'x' * 1000}\nb: [{alias}]")
    write(tmp_path, mine=f"seed: 2\nbase: {base}")
    told = refusal(tmp_path / "mine.yaml")
    assert told.startswith(f"{tmp_path / 'mine.yaml'}:2: base = ")
    assert says in told


def test_motion_files_of_a_base_lie_in_the_bases_folder(tmp_path: Path) -> None:
    named = "classes: {wave: [none*.bvh]}\nactivities: [wave]\nmotion: {model: file}"
    write(tmp_path, shared__a=named, b="base: shared/a.yaml", c="base: shared/d.yaml")
    assert f"there are none like it in {tmp_path / 'shared'}" in refusal(tmp_path / "b.yaml")
    write(tmp_path, shared__d=named.replace("file}", "file, folder: clips}"))
    assert f"none like it in {tmp_path / 'shared/clips'}" in refusal(tmp_path / "c.yaml")
    write(tmp_path, b="base: shared/a.yaml\nmotion: {folder: mine}")
    assert f"there are none like it in {tmp_path / 'mine'}" in refusal(tmp_path / "b.yaml")
