"""The program as a user meets it: end to end in a temporary folder."""

import json
import re
from pathlib import Path

import h5py
import pytest
import yaml
from command_line import ROOT, process, radhar
from small import small_config

TRAINING = sorted((ROOT / "configs/train").glob("*.yaml"))
CONFIGS = sorted(set((ROOT / "configs").rglob("*.yaml")) - set(TRAINING))


def test_generate_verify_and_generate_again(tmp_path: Path) -> None:
    config, out = small_config(tmp_path), tmp_path / "set"
    first = radhar("generate", config, "-o", out, "--jobs", 1)
    assert first.returncode == 0, first.stderr
    assert "9 samples" in first.stdout
    assert "it/s" not in first.stderr, "quiet when not a terminal"
    again = radhar("generate", config, "-o", out)
    assert again.returncode == 0
    assert "is complete" in again.stdout
    assert yaml.safe_load((out / "config.yaml").read_text())["seed"] == 7
    checked = radhar("verify", out, "--samples", 3)
    assert checked.returncode == 0
    assert "byte for byte" in checked.stdout
    with h5py.File(out / "dataset.h5", "r+") as file:
        file["label"][0] = 3
    wrong = radhar("verify", out)
    assert wrong.returncode == 1
    assert "WRONG /label" in wrong.stdout


def test_repeated_set_options_change_the_config(tmp_path: Path) -> None:
    out = tmp_path / "set"
    done = radhar(
        *("generate", small_config(tmp_path), "-o", out, "--jobs", 1),
        *("--set", "samples_per_class=1", "--set", "snr_db=null", "--set", "output.png=false"),
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(out / "dataset.h5") as file:
        stored = json.loads(file.attrs["config"])
    assert stored["samples_per_class"] == 1
    assert stored["snr_db"] is None
    assert not (out / "png").exists()


def test_dry_run_prints_the_plan_and_writes_nothing(tmp_path: Path) -> None:
    config = small_config(tmp_path)
    done = radhar("generate", config, "-o", tmp_path / "set", "--dry-run")
    assert done.returncode == 0, done.stderr
    for word in ("torso_track", "fsst_compensated", "samples     9", "MiB", "time        about"):
        assert word in done.stdout
    assert sorted(p.name for p in tmp_path.iterdir()) == ["small.yaml"]


def test_dry_run_refuses_what_the_build_would_refuse(tmp_path: Path) -> None:
    """Where a scene of its sample is outside the model; with the cure it says how many are."""
    changes = ["--set", "motion={model: paper, range_m: 28}", "--set", "on_invalid=error"]
    command = ["generate", small_config(tmp_path), "-o", tmp_path / "set", *changes]
    dry, built = radhar(*command, "--dry-run"), radhar(*command, "--jobs", 1)
    assert (dry.returncode, dry.stdout) == (built.returncode, built.stdout) == (2, "")
    assert dry.stderr == built.stderr
    assert "walking/0: a scatterer leaves the range half-band" in dry.stderr
    assert "on_invalid: redraw draws such scenes again; generate --dry-run checks 9" in dry.stderr
    kept = radhar(*command[:-1], "on_invalid=keep", "--dry-run", "--json")
    found = json.loads(kept.stdout)
    assert (found["checked"], found["redrawn"]) == (9, 0)
    assert any("of 9 recordings: a scatterer leaves" in one for one in found["warnings"])


def test_dry_run_counts_points_and_range_bins(tmp_path: Path) -> None:
    own = ("body.scatterers=segments", "processing.range_sum=gated", "processing.gate_m=0.5")
    more = (*own, "maps=[stft]", "activities=[walking]")
    changes = [part for one in more for part in ("--set", one)]
    config = small_config(tmp_path)
    done = radhar("generate", config, "-o", tmp_path / "set", "--dry-run", *changes)
    assert done.returncode == 0, done.stderr
    assert re.search(r"S8 +\d+: trunk \d+, head \d+", done.stdout)
    bins = re.search(r"S8 +(\d+) a frame, (\d+) in all; frames show (\d+) %", done.stdout)
    assert bins is not None
    shown, every, share = (int(number) for number in bins.groups())
    assert shown <= every
    assert 100 * shown / every - 1 <= share <= 100


@pytest.mark.parametrize("path", [*CONFIGS, *TRAINING], ids=lambda p: f"{p.parent.name}-{p.stem}")
def test_shipped_configs_resolve_and_show_round_trips(path: Path, tmp_path: Path) -> None:
    kind = ["--train"] if path in TRAINING else []
    shown = radhar("config", "show", path, *kind)
    assert shown.returncode == 0, shown.stderr
    (tmp_path / "again.yaml").write_text(shown.stdout)
    assert radhar("config", "show", tmp_path / "again.yaml", *kind).stdout == shown.stdout


def test_schema_is_json_schema() -> None:
    schema = json.loads(radhar("config", "schema").stdout)
    assert schema["properties"]["radar"]
    assert schema["additionalProperties"] is False


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("radar: {prf_hz: -5}", ["radar.prf_hz", "-5", "above 0"]),
        ("motion: {sped_mps: 1}", ["motion.sped_mps", "speed_mps"]),
        ("activities: [wlaking]", ["activities", "walking"]),
        ("radar: {chirp_s: 1e-3}", ["radar.chirp_s", "0.001", "shorter than the pulse interval"]),
        ("seed: [1", ["not valid YAML"]),
        ("image: {colour_map: viridus}", ["image.colour_map", "viridus", "viridis"]),
    ],
)
def test_broken_configs_are_refused_in_one_message_with_status_2(
    tmp_path: Path, text: str, expected: list[str]
) -> None:
    path = small_config(tmp_path, text)
    done = radhar("generate", path, "-o", tmp_path / "set")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    for word in expected:
        assert word in done.stderr
    assert not (tmp_path / "set").exists()


def test_wrong_use_is_status_2(tmp_path: Path) -> None:
    for arguments in (
        ["generate", "none.yaml", "-o", tmp_path / "x"],
        ["verify", tmp_path / "no"],
        *(
            ["import", f"none.{kind}", "-o", tmp_path / "x.h5"]
            for kind in ("npy", "sigmf-data", "h5")
        ),
        ["import", "none.bin", "--radar", "none.cfg", "-o", tmp_path / "x.h5"],
        ["fit", tmp_path / "no.h5", "-o", tmp_path / "x.yaml"],
    ):
        done = radhar(*arguments)
        assert done.returncode == 2
        assert "Traceback" not in done.stderr
        assert "no such file" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("generat", "No such command 'generat'. Did you mean 'generate'"),
        ("config shwo", "'shwo'. Did you mean 'show'"),
        ("generate", "Missing argument"),
        ("generate c.yaml", "Missing option"),
        ("generate c.yaml -o out --jbos 2", "No such option: --jbos"),
        ("generate c.yaml -o out --jobs 0", "--jobs 0: should be greater than or equal to 1"),
        ("generate c.yaml -o out -j two", "--jobs two: should be a valid integer"),
        ("eval run data --repeats", "--repeats"),
        ("compare a b -o c --zero x", "--zero x: should be a valid number"),
    ],
)
def test_mistaken_options_are_one_line_as_all_our_errors(arguments: str, said: str) -> None:
    done = radhar(*arguments.split())
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    assert done.stderr.startswith("radhar: ")
    assert said in done.stderr
    assert " --help)" in done.stderr


@pytest.mark.parametrize("group", [[], ["config"]])
def test_a_group_alone_shows_its_help(group: list[str]) -> None:
    done = radhar(*group)
    assert done.returncode == 2
    assert done.stderr.startswith("Usage: radhar")


def test_every_help_has_an_example() -> None:
    for command in (
        *("generate", "simulate", "verify", "preview", "inspect", "config show", "config schema"),
        *("train", "eval", "models", "export", "predict", "tradeoff", "import", "process", "fit"),
    ):
        done = radhar(*command.split(), "--help")
        assert done.returncode == 0
        assert "Example" in done.stdout, command


def test_second_run_on_a_live_folder_is_refused(tmp_path: Path) -> None:
    from radhar_cli.dataset.folder import folder_lock

    config = small_config(tmp_path)
    with folder_lock(tmp_path / "set"):
        done = radhar("generate", config, "-o", tmp_path / "set")
    assert done.returncode == 2
    assert "another run is writing here" in done.stderr


@pytest.mark.parametrize(("limit", "file"), [(6000, ""), (40_000, "dataset.h5: ")])
def test_full_disk_is_one_line_and_keeps_finished_samples(
    tmp_path: Path, limit: int, file: str
) -> None:
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
