"""Configs that never end, nest without end, or are no files: a refusal at once, naming the line."""

import os
import re

import pytest
from security.bounded import Answer, answers, refused

from radhar_cli.config.yaml_reader import MAX_TEXT, parse_yaml
from radhar_cli.errors import ConfigError
from radhar_cli.files.untrusted import DEEPEST, parse_json


def laughs(first: str, one: str, joined: str) -> str:
    """Nine lines, each of which stands for nine of the one before."""
    lines = [f"k0: &a0 {first}"]
    for level in range(1, 10):
        inner = ", ".join(one.format(i=i, alias=f"*a{level - 1}") for i in range(9))
        lines.append(f"k{level}: &a{level} {joined.format(inner)}")
    return "\n".join(lines)


# {name: (text, line that the message names, what it says)}
HOSTILE = {
    "aliases in lists": (laughs("[1, 2]", "{alias}", "[{}]"), 6, "alias written out"),
    "aliases in maps": (laughs("{x: 1}", "m{i}: {alias}", "{{{}}}"), 6, "alias written out"),
    "merges": (laughs("{x: 1}", "{alias}", "{{<<: [{}]}}"), 6, "alias written out"),
    "a long text, often": (f"a: &a {'x' * 1000}\nb: [{'*a,' * 99}]", 2, "alias written out"),
    "a list in itself": ("seed: &a [*a]", 1, "'a' stands inside of what it stands for"),
    "a map in itself": ("radar: &a {tx_m: {x: *a}}", 1, "'a' stands inside"),
    "a merge in itself": ("radar: &a {<<: *a}", 1, "'a' stands inside"),
    "a merge": ("radar: {<<: {prf_hz: 1}}", 1, "unknown key"),
    "deep flow lists": ("seed: " + "[" * 5000, 1, "deeper than"),
    "deep flow maps": ("seed: " + "{a: " * 5000, 1, "deeper than"),
    "deep blocks": ("- " * 5000, 1, "deeper than"),
    "deep keys": ("? " * 5000, 1, "deeper than"),
    "deep lines": ("\n".join(" " * i + "a:" for i in range(200)), DEEPEST, "deeper than"),
    "a huge integer": ("seed: " + "9" * 60_000, 1, "60000 digits"),
    "a large integer": ("seed: " + "9" * 4300, 1, "seed = 999"),
    "a huge number": ("duration_s: 1" + "0" * 4299, 1, "duration_s = 1000"),
    "a huge exponent": ("duration_s: 1e" + "9" * 4000, 1, "duration_s = Infinity"),
    "a huge key": ("x" * 1000 + ": 1", 1, "should be text of at most 100 characters"),
    "a huge text": ("snr_reference: " + "x" * 60_000, 1, "snr_reference = "),
    "a huge name": ("activities: [" + "x" * 60_000 + "]", 1, "xxx\\.\\.\\.$"),
    "a huge colour": ("image: {colour_map: " + "x" * 60_000 + "}", 1, "image.colour_map = "),
    "many mistakes": ("snr_db: {choice: [" + "a," * 30_000 + "]}", 1, "and 29980 more"),
    "many keys": ("\n".join(f"k{i}: 1" for i in range(7000)), 1, "unknown key"),
    "a timestamp": ("seed: 2001-01-01", 1, 'seed = "2001-01-01"'),
    "sexagesimal": ("seed: 190:20:30", 1, 'seed = "190:20:30"'),
    "a tag of a date": ("seed: !!timestamp x", 1, "the tag .* has no meaning here"),
    "a tag of nothing": ('seed: !!int ""', 1, "the tag .* has no meaning here"),
    "a tag of bytes": ("seed: !!binary x", 1, "the tag .* has no meaning here"),
    "a tag of code": ("seed: !!python/object/apply:os.system [x]", 1, "has no meaning here"),
    "a tag of one's own": ("%TAG ! tag:x:\n---\nseed: !int 3", 3, "has no meaning here"),
    "escapes in a key": ('"\\e[2Jx\\n\\u202e": 1', 1, r"\\x1b\[2Jx\\n\\u202e = 1"),
    "escapes in a value": ('snr_reference: "\\e[2J"', 1, r'snr_reference = "\\u001b\[2J"'),
    "escapes in a name": ('activities: ["\\e[2J"]', 1, "is not an activity"),
    "an unknown alias": ("seed: *nobody", 1, "undefined alias"),
}


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Answer]:
    """What `config show` says of every hostile text, and `generate` of what is no such text."""
    place = tmp_path_factory.mktemp("yaml")
    cases: dict[str, list[object]] = {}
    for number, (name, (text, _, _)) in enumerate(HOSTILE.items()):
        path = place / f"{number}.yaml"
        path.write_text(text)
        cases[name] = ["config", "show", path]
    lol = place / "0.yaml"
    cases["generate"] = ["generate", lol, "-o", place / "out"]
    cases["--set"] = ["config", "show", place / "good.yaml", "--set", "radar=" + "[" * 5000]
    cases["train"] = ["config", "show", lol, "--train"]
    (place / "good.yaml").write_text("seed: 3\n")
    (place / "large.yaml").write_text("# \n" * MAX_TEXT)
    (place / "null.yaml").write_bytes(b"seed: \x00")
    (place / "\x1b[2J.yaml").write_text("seed: -1")
    (place / "sparse.yaml").touch()
    os.truncate(place / "sparse.yaml", 2**40)
    os.mkfifo(place / "fifo.yaml")
    (place / "loop.yaml").symlink_to(place / "loop.yaml")
    for name in ("good", "large", "null", "\x1b[2J", "sparse", "fifo", "loop"):
        cases[name] = ["config", "show", place / f"{name}.yaml"]
    for name, path in {"device": "/dev/zero", "folder": place, "bytes": "\udcff.yaml"}.items():
        cases[name] = ["config", "show", path]
    return answers(place, cases, warm_up=[["config", "show", place / "good.yaml"]])


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_config_is_refused_with_its_line(given: dict[str, Answer], name: str) -> None:
    _, line, says = HOSTILE[name]
    message = refused(given[name])
    number = list(HOSTILE).index(name)
    assert f"{number}.yaml:{line}: " in message.splitlines()[0]
    assert re.search(says, message), message[:500]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("generate", "0.yaml:6: not valid YAML"),
        ("train", "0.yaml:6: not valid YAML"),
        ("--set", "--set radar:1: not valid YAML"),
        ("large", f"large.yaml: cannot be read as text (holds more than {MAX_TEXT} bytes)"),
        ("sparse", "sparse.yaml: cannot be read as text (holds more than"),
        ("null", "null.yaml: not valid YAML: unacceptable character"),
        ("fifo", "fifo.yaml: cannot be read as text (is a FIFO"),
        ("device", "/dev/zero: cannot be read as text (is a FIFO, a socket or a device"),
        ("folder", "cannot be read as text (is a folder"),
        ("loop", "loop.yaml: cannot be read as text (Too many levels of symbolic links)"),
        ("\x1b[2J", "\\x1b[2J.yaml:1: seed = -1"),
        ("bytes", "\\udcff.yaml: no such file"),
    ],
)
def test_files_that_are_no_configs_are_refused(
    given: dict[str, Answer], name: str, says: str
) -> None:
    assert says in refused(given[name])


def test_a_good_config_is_still_read(given: dict[str, Answer]) -> None:
    assert given["good"].status == 0
    assert "seed: 3" in given["good"].out


def test_configs_within_the_limits_are_read() -> None:
    numbers = ", ".join(["1"] * (MAX_TEXT // 4))
    value, lines = parse_yaml(f"a: &a {{b: 1}}\nc: {{d: *a}}\ne: [{numbers}]", "x")
    assert value == {"a": {"b": 1}, "c": {"d": {"b": 1}}, "e": [1] * (MAX_TEXT // 4)}
    assert lines == {"a": 1, "a.b": 1, "c": 2, "c.d": 2, "c.d.b": 1, "e": 3}
    nested = "[" * (DEEPEST - 1) + "]" * (DEEPEST - 1)
    assert parse_yaml(nested, "x")
    assert parse_json(nested)
    for too_deep in ("[" * (DEEPEST + 1) + "]" * (DEEPEST + 1), "[" * 100_000):
        with pytest.raises(ConfigError, match="deeper"):
            parse_yaml(too_deep, "x")
        with pytest.raises(ValueError, match="deeper"):
            parse_json(too_deep)
