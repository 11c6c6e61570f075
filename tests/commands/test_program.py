"""The program as a user meets it: end to end in a temporary folder."""

import json
import re
import shlex
from pathlib import Path

import h5py
import pytest
import yaml
from helpers.command_line import ROOT, ok, process, radhar
from helpers.small import small_config
from typer.main import get_command

from radhar_cli.cli import program
from radhar_cli.config import Config, load_config
from radhar_cli.config.documents import PRESETS
from radhar_cli.config.reading import load_section
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.split import split_rows
from radhar_cli.learning.settings import TrainConfig

TRAINING = sorted((ROOT / "configs/train").glob("*.yaml"))
CONFIGS = sorted(set((ROOT / "configs").rglob("*.yaml")) - set(TRAINING))


def test_generate_verify_and_generate_again(tmp_path):
    config, out = small_config(tmp_path), tmp_path / "set"
    first = ok("generate", config, "-o", out, "--jobs", 1)
    assert "9 samples" in first.stdout
    assert "it/s" not in first.stderr, "quiet when not a terminal"
    again = ok("generate", config, "-o", out)
    assert "is complete" in again.stdout
    assert yaml.safe_load((out / "config.yaml").read_text())["seed"] == 7
    checked = ok("verify", out, "--samples", 3)
    assert "byte for byte" in checked.stdout
    with h5py.File(out / "dataset.h5", "r+") as file:
        file["label"][0] = 2
    wrong = radhar("verify", out)
    assert wrong.returncode == 1
    assert "WRONG /label" in wrong.stdout


def test_repeated_set_options_change_the_config(tmp_path):
    out = tmp_path / "set"
    ok(
        *("generate", small_config(tmp_path), "-o", out, "--jobs", 1),
        *("--set", "samples_per_class=1", "--set", "snr_db=null", "--set", "output.png=false"),
    )
    with h5py.File(out / "dataset.h5") as file:
        stored = json.loads(file.attrs["config"])
    assert stored["samples_per_class"] == 1
    assert stored["snr_db"] is None
    assert not (out / "png").exists()


def test_dry_run_prints_the_plan_and_writes_nothing(tmp_path):
    config = small_config(tmp_path)
    done = ok("generate", config, "-o", tmp_path / "set", "--dry-run")
    for word in ("stage", "samples     9", "MiB", "time        about", "training    some "):
        assert word in done.stdout
    assert sorted(p.name for p in tmp_path.iterdir()) == ["small.yaml"]


def test_dry_run_refuses_what_the_build_would_refuse(tmp_path):
    """Where a scene of its sample is outside the model; with the cure it says how many are."""
    changes = ["--set", "motion={model: paper, range_m: 28}", "--set", "on_invalid=error"]
    command = ["generate", small_config(tmp_path), "-o", tmp_path / "set", *changes]
    dry, built = radhar(*command, "--dry-run"), radhar(*command, "--jobs", 1)
    assert (dry.returncode, dry.stdout) == (built.returncode, built.stdout) == (2, "")
    assert dry.stderr == built.stderr
    assert ": a scatterer leaves the range half-band" in dry.stderr
    assert "on_invalid: redraw draws such scenes again" in dry.stderr
    kept = radhar(*command[:-1], "on_invalid=keep", "--dry-run", "--json")
    found = json.loads(kept.stdout)
    assert (found["checked"], found["redrawn"]) == (9, 0)
    assert any("of 9 recordings: a scatterer leaves" in one for one in found["warnings"])


@pytest.mark.every(4)
@pytest.mark.parametrize("path", [*CONFIGS, *TRAINING], ids=lambda p: f"{p.parent.name}-{p.stem}")
def test_shipped_configs_resolve_and_show_round_trips(path, tmp_path):
    kind = ["--train"] if path in TRAINING else []
    shown = ok("config", "show", path, *kind)
    (tmp_path / "again.yaml").write_text(shown.stdout)
    assert radhar("config", "show", tmp_path / "again.yaml", *kind).stdout == shown.stdout


@pytest.mark.parametrize("group", [[], ["config"]])
def test_a_group_alone_shows_its_help(group):
    done = radhar(*group)
    assert done.returncode == 2
    assert done.stderr.startswith("Usage: radhar")


def every_command(command, *words):
    """(words, command) of a command and of all below it."""
    yield words, command
    for name, inner in getattr(command, "commands", {}).items():
        yield from every_command(inner, *words, name)


def images_of_the_quickstart():
    """Paths of the PNGs that `make demo` writes."""
    config = load_config(ROOT / "configs/quickstart.yaml")
    rows = Rows.of(config)
    for row, split in enumerate(split_rows(config)):
        for name in config.maps:
            yield f"datasets/quickstart/{rows.png_path(name, split, row)}"


IMAGES = {*images_of_the_quickstart()}
HELPS = {" ".join(words): known for words, known in every_command(get_command(program())) if words}


@pytest.mark.every(3)
@pytest.mark.parametrize("name", HELPS)
def test_the_examples_of_a_help_can_be_run(name):
    """Without a clone: they name configs that radhar comes with, which take their --set."""
    assert "configs/" not in HELPS[name].help
    examples = re.findall(r"^ +radhar (.*(?:\n +\S.*)*)$", HELPS[name].help, re.MULTILINE)
    assert examples, "has no example"
    for words in map(shlex.split, examples):
        assert f"{' '.join(words)} ".startswith(f"{name} ")
        known, arguments = get_command(program()), words
        while hasattr(known, "commands"):
            first, *arguments = arguments
            known = known.commands[first]
        context = known.make_context(first, arguments)
        sets = context.params.get("set_") or []
        for word in PRESETS.keys() & {*words}:
            load_section(TrainConfig if word.startswith("train/") else Config, Path(word), sets)
        images = {word for word in words if word.startswith("datasets/") and word.endswith(".png")}
        assert images <= IMAGES


@pytest.mark.parametrize(("limit", "file"), [(6000, ""), (40_000, "dataset.h5: ")])
def test_full_disk_is_one_line_and_keeps_finished_samples(tmp_path, limit, file):
    """A limit on the size of a file stands for a full disk: writing fails midway, as there."""
    config = small_config(tmp_path)
    limited = (
        f"import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}));"
        "from radhar_cli.cli import main; sys.argv[0] = 'radhar'; main()"
    )
    command = ("generate", config, "-o", tmp_path / "set", "--jobs", 1)
    done = process("-c", limited, *command, "--batch", 1)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert file in done.stderr
    assert "is kept, and the same command resumes" in done.stderr
    assert not (tmp_path / "set/dataset.h5").exists()
    assert radhar(*command).returncode == 0
