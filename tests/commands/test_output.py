"""What every command prints: for people, for programs (--json), nothing (--quiet); its status."""

import ast
import contextlib
import io
import json
import sys
from pathlib import Path
from typing import Any

import pytest
from helpers.command_line import ROOT, ok, radhar
from helpers.documented import KEYS
from helpers.small import small_config
from learning.patterns import BASE, split_tree

from radhar_cli import commands
from radhar_cli.cli import main, program
from radhar_cli.commands import tell
from radhar_cli.commands.terminal import BarProgress

FOLDER = Path(str(commands.__file__)).parent
# Modules that report for commands of others.
FOR = {"terminal": ["generate", "merge"], "scene_folder": ["simulate"]}


def registered(app, prefix=""):
    """{command: its module}."""
    found = {}
    for one in app.registered_commands:
        name = one.name or one.callback.__name__
        found[prefix + name] = one.callback.__module__.rpartition(".")[2]
    for group in app.registered_groups:
        found |= registered(group.typer_instance, f"{prefix}{group.name} ")
    return found


def values(done):
    """The one object that a command printed."""
    assert done.stdout.endswith("\n")
    (line,) = done.stdout.splitlines()
    found: dict[str, Any] = json.loads(line, parse_constant=pytest.fail)
    return found


def reports(module):
    """The keywords of every call of `report` in a module."""
    tree = ast.parse((FOLDER / f"{module}.py").read_text())
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    return [
        {word.arg for word in call.keywords if word.arg}
        for call in calls
        if ast.unparse(call.func) == "report"
    ]


def test_every_command_reports_and_has_its_keys_documented():
    found = registered(program())
    assert {"generate", "simulate", "train", "eval"} <= found.keys()
    reported = set()
    for module in {*found.values(), *FOR}:
        names = FOR.get(module) or [name for name, of in found.items() if of == module]
        rows = [KEYS[row] for row in KEYS if row.partition(" --")[0] in names]
        for keywords in reports(module):
            assert keywords <= set().union(*rows), f"{module}: output.md should list them"
            reported.update(names)
    assert found.keys() == reported, "should call tell.report"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a config and a data set."""
    folder = tmp_path_factory.mktemp("place")
    small_config(folder)
    done = radhar("generate", folder / "small.yaml", "-o", folder / "set", "--jobs", 1, "--json")
    found = values(done)
    assert found.keys() == KEYS["generate"]
    assert (found["samples"], found["made"]) == (9, 9)
    assert found["classes"] == {"punching": 3, "walking": 3, "walking_to_falling": 3}
    assert sum(found["split"].values()) == 9
    assert found["bytes"] == (folder / "set/dataset.h5").stat().st_size
    return folder


OTHERS = {
    "generate": "generate {config} -o {set}",
    "generate --shard": "generate {config} -o {out} --shard 1/2 --jobs 1",
    "generate --dry-run": "generate {config} -o {out} --dry-run --jobs 1",
    "verify": "verify {set} --samples 1",
    "motion": "motion {config} -a walking --set motion.model=human -o {out}.bvh",
    "simulate": "simulate {config} -a walking -o {out} --maps stft --no-figures",
    "preview": "preview {set} -o {out}.png",
    "config init": "config init {out}.yaml",
}


@pytest.mark.parametrize("command", OTHERS)
def test_json_is_all_that_is_printed(place, tmp_path, command):
    names = {"config": place / "small.yaml", "set": place / "set", "out": tmp_path / "out"}
    done = ok(*OTHERS[command].format(**names).split(), "--json")
    assert values(done).keys() == KEYS[command]


def test_json_of_commands_that_show_files(place):
    shown = values(radhar("config", "show", place / "small.yaml", "--json"))
    assert shown["seed"] == 7
    assert values(radhar("inspect", place / "set", "--json"))["kind"] == "data set"


def test_numbers_that_are_not_finite_are_null(capsys):
    command = tell.with_output_options(
        lambda: tell.report(a=float("nan"), b=[(float("-inf"), 1)], c=Path("x"), d="\x1b\u202e")
    )
    command(json_=True, quiet=False)
    out = capsys.readouterr().out
    assert json.loads(out) == {"a": None, "b": [[None, 1]], "c": "x", "d": "\x1b\u202e"}
    assert out.strip().isprintable()


def test_quiet_prints_nothing_and_sets_the_status(place, tmp_path):
    config = place / "small.yaml"
    done = radhar("generate", config, "-o", tmp_path / "set", "--jobs", 1, "--quiet")
    assert (done.returncode, done.stdout) == (0, "")
    assert all(line.startswith("warning: ") for line in done.stderr.splitlines())
    again = radhar("generate", config, "-o", tmp_path / "set", "-q")
    assert (again.returncode, again.stdout, again.stderr) == (0, "", "")
    assert radhar("inspect", place / "set", "-q").stdout == ""
    assert radhar("verify", tmp_path / "set", "-q", "--samples", 0).stdout == ""
    (next((tmp_path / "set/png").rglob("*.png"))).write_bytes(b"")
    wrong = radhar("verify", tmp_path / "set", "-q", "--samples", 0)
    assert (wrong.returncode, wrong.stdout, wrong.stderr) == (1, "", "")
    told = radhar("verify", tmp_path / "set", "--json", "--samples", 0)
    assert told.returncode == 1
    assert len(values(told)["problems"]) == 1


def test_quiet_keeps_warnings_and_errors(place, tmp_path):
    far = ("--index", 99, "--maps", "stft", "--no-figures", "--quiet")
    done = radhar("simulate", place / "small.yaml", "-a", "walking", "-o", tmp_path, *far)
    assert done.stdout == ""
    assert done.stderr.startswith("warning: --index 99")
    done = radhar("verify", tmp_path / "none", "--quiet", "--json")
    assert (done.returncode, done.stdout) == (2, "")
    assert "no such file" in done.stderr


class Screen(io.StringIO):
    """An error stream that is a terminal, or none."""

    def __init__(self, terminal):
        super().__init__()
        self._terminal = terminal

    def isatty(self):
        return self._terminal


@pytest.mark.parametrize(
    ("terminal", "quiet", "shown"),
    [(True, False, True), (True, True, False), (False, False, False), (False, True, False)],
)
def test_progress_bars_show_on_terminals_only(monkeypatch, terminal, quiet, shown):
    screen = Screen(terminal)
    monkeypatch.setattr(sys, "stderr", screen)

    def work():
        bars = BarProgress()
        bars.stage("synthesis", 3)
        bars.advance(3)
        bars.say("resuming: 2 of 3")
        bars.say("warning: far away")
        bars.close()

    tell.with_output_options(work)(json_=False, quiet=quiet)
    assert ("synthesis" in screen.getvalue()) == shown
    assert ("resuming" in screen.getvalue()) == (not quiet)
    assert "warning: far away" in screen.getvalue()


def test_output_options_do_not_leak_into_the_next_command(capsys):
    def fail():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tell.with_output_options(fail)(json_=True, quiet=True)
    tell.report(a=1)
    tell.tell("spoken")
    assert capsys.readouterr().out == "spoken\n"


def test_help_and_docs_name_every_status():
    page = (ROOT / "docs/reference/output.md").read_text()
    shown = " ".join(radhar("--help").stdout.split())
    for status in (0, 1, 2, 130, 143):
        assert f"| {status} | " in page
        assert f" {status} " in shown.partition("Exit status:")[2]


def test_config_init_refuses_to_overwrite(tmp_path):
    out = tmp_path / "new.yaml"
    done = ok("config", "init", out)
    assert f"radhar generate {out} -o OUT" in done.stdout
    text = out.read_text()
    again = radhar("config", "init", out, "--train")
    assert again.returncode == 2
    assert "exists already" in again.stderr
    assert out.read_text() == text
    out.unlink()
    out.symlink_to(tmp_path / "elsewhere.yaml")
    assert radhar("config", "init", out).returncode == 2
    for nowhere in (tmp_path / "none/x.yaml", out / "x.yaml"):
        done = radhar("config", "init", nowhere)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert not (tmp_path / "elsewhere.yaml").exists()


def test_a_data_set_needs_no_base(tmp_path):
    small_config(tmp_path)
    own = tmp_path / "own.yaml"
    own.write_text("base: small.yaml\nsamples_per_class: 1\nmaps: [stft]\n")
    out = tmp_path / "set"
    ok("generate", own, "-o", out, "--jobs", 1)
    (tmp_path / "small.yaml").unlink()
    assert radhar("generate", own, "-o", out).returncode == 2
    stored = radhar("generate", out / "config.yaml", "-o", out)
    assert "is complete: 3 samples" in stored.stdout
    assert radhar("verify", out, "--samples", 1).returncode == 0


def on_a_terminal(monkeypatch, *words):
    """What a command writes to a terminal beside its results."""
    screen = Screen(True)
    monkeypatch.setattr(sys, "argv", ["radhar", *map(str, words)])
    with (
        contextlib.redirect_stderr(screen),
        contextlib.redirect_stdout(io.StringIO()),
        pytest.raises(SystemExit) as ended,
    ):
        main()
    assert not ended.value.code, screen.getvalue()
    return screen.getvalue()


def test_long_commands_show_how_far_they_are(small_set, tmp_path, monkeypatch):
    config = small_config(tmp_path)
    commands = {
        ("verify", small_set): ("checksum/s", "samples again", "sample/s", "PNG files", "file/s"),
        ("simulate", config, "-a", "walking", "-o", tmp_path / "scene"): ("step/s", "frame/s"),
        ("generate", config, "-o", tmp_path / "set", "--dry-run"): ("scene/s", "timing samples"),
    }
    for words, bars in commands.items():
        shown = on_a_terminal(monkeypatch, *words)
        assert [bar for bar in bars if bar not in shown] == [], words


def test_learning_counts_batches_and_evaluation_images(tmp_path, monkeypatch):
    data = split_tree(tmp_path / "tree")
    (tmp_path / "train.json").write_text(json.dumps({**BASE, "epochs": 1}))
    run = ("train", data, "-o", tmp_path / "run", "--config", tmp_path / "train.json")
    training = on_a_terminal(monkeypatch, *run)
    assert "batch/s" in training
    assert "sample/s" not in training
    assert "image/s" in on_a_terminal(monkeypatch, "eval", tmp_path / "run", data)
