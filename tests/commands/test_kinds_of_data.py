"""Every command on every kind of data set: each works, or says in a line what to do instead."""

from pathlib import Path

import numpy as np
import pytest
from capture.recipes.published_files import write_mars, write_radhar
from helpers.boards import CFG, CLOUDS
from helpers.command_line import ok, radhar
from learning.patterns import tree

from radhar_cli.study.audit import audit
from radhar_cli.study.audit.held_out import Effort

MAPS = """
radar: {carrier_hz: 24e9, bandwidth_hz: 250e6, prf_hz: 500, adc_rate_hz: 0.4e6}
activities: [punching, walking]
samples_per_class: 10
duration_s: 1
image: {size_px: 32}
maps: [rtm, stft]
processing: {clutter: mean}
split: {train: 0.5, validation: 0.5}
"""
MEASURED = """
maps: [stft]
image: {size_px: 32}
processing: {clutter: mean}
recordings: {window_s: 0.25, hop_s: 0.08}
split: {train: 0.5, validation: 0.5}
"""
SHORT = ("recordings.window_s=1", "recordings.hop_s=0.5")
HEADER = (
    *("dataset=beat", "carrier_hz=24e9", "bandwidth_hz=250e6", "adc_rate_hz=0.4e6"),
    *("prf_hz=500", "axes=[receiver, sample, pulse]"),
)
HALVES = "split={train: 0.5, validation: 0.5}"
AXES = ("axes=[right,ahead,up]", "doppler=receding", "frame_s=0.1")
QUICK = ("device=cpu", "precision=float32", "threads=1", "epochs=1", "batch_size=4")
# {kind: (network, set that it is compared with, names of classes there)}
KINDS = {
    "maps": ("smallnet", "maps"),
    "captures": ("smallnet", "maps"),
    "images": ("smallnet", "maps"),
    "tree": ("smallnet", "maps"),
    "board": ("cloudnet", "board"),
    "mars": ("cloudnet", "board"),
    "radhar": ("cloudnet", "board"),
    "points": ("cloudnet", "board"),
}
WALKING = {"mars": "left_upper_limb_extension", "radhar": "walk"}  # what is compared with it
NO_POINTS = "needs a board's data set, maps: [points]"
NO_DATA_SET = "no such file; `radhar prepare` makes data sets of images and points"
NO_BINS = "needs bins of Doppler; import the recordings with --radar FILE.cfg"
NO_JOINTS = "mars needs true joints, which it lacks; ti needs none"
# What is refused, by what is said; everything else works.
REFUSED = {
    **{(kind, f"convert {to}"): NO_POINTS for kind in ("maps", "captures", "images")
       for to in ("mars", "ros", "ti")},
    **{("tree", command): NO_DATA_SET for command in (
        "preview", "view", "verify", "convert parquet", "convert mars", "convert ros",
        "convert ti")},
    **{(kind, "convert ros"): NO_BINS for kind in ("mars", "radhar", "points")},
    **{(kind, "convert mars"): NO_JOINTS for kind in ("radhar", "points")},
    **{(kind, "joints"): "has no clouds" for kind in ("maps", "captures", "images")},
    ("tree", "joints"): "is no data set with clouds",
    **{(kind, "joints"): "needs true joints, which measured data lack"
       for kind in ("radhar", "points")},
}  # fmt: skip


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small data set of each kind, with a run of classes of each."""
    folder = tmp_path_factory.mktemp("kinds")
    for name, text in {"maps": MAPS, "measured": MEASURED, "board": CLOUDS}.items():
        (folder / f"{name}.yaml").write_text(text)
    (folder / "board.cfg").write_text(CFG)
    make = ("--jobs", 1, "-q", "--set", "output.png=false")
    ok("generate", folder / "maps.yaml", "-o", folder / "maps", *make)
    ok("generate", folder / "board.yaml", "-o", folder / "board", *make,
       "--set", "samples_per_class=10", "--set", HALVES)  # fmt: skip
    make_captures(folder / "recorded")
    ok("generate", folder / "measured.yaml", "--recordings", folder / "recorded/manifest.csv",
       "-o", folder / "captures", *make)  # fmt: skip
    tree(folder / "tree", ("punching", "walking"), {"": 10})
    prepare(folder, "images", folder / "tree", "maps=[stft]", "recordings.rows=[-250,250]", HALVES)
    write_mars(folder / "mars_files")
    prepare(folder, "mars", folder / "mars_files", HALVES, *SHORT)
    write_radhar(folder / "radhar_files")
    prepare(folder, "radhar", folder / "radhar_files", HALVES, SHORT[0], "recordings.hop_s=2")
    write_tables(folder / "tables")
    prepare(folder, "points", folder / "tables", HALVES, *SHORT, *AXES)
    settings = [word for key in QUICK for word in ("--set", key)]
    for kind, (network, _) in KINDS.items():
        run = folder / f"{kind}_run"
        ok("train", folder / kind, "-o", run, "--model", network, *settings)
    return folder


def make_captures(folder: Path) -> None:
    """Recordings of two persons, imported from arrays as those of any other radar."""
    folder.mkdir()
    rows = ["file,label,person"]
    for label in ("punching", "walking"):
        for person in (1, 2):
            raw = folder / f"{label}{person}"
            ok("simulate", folder.parent / "maps.yaml", "--activity", label, "--seed", person,
               "--raw", "--no-figures", "-o", raw)  # fmt: skip
            said = [word for key in HEADER for word in ("--set", key)]
            ok("import", raw / "recording.h5", *said, "-o", folder / f"{label}{person}.h5")
            rows.append(f"{label}{person}.h5,{label},{person}")
    (folder / "manifest.csv").write_text("\n".join([*rows, ""]))


def write_tables(folder: Path) -> None:
    """Clouds of two classes and two persons as anybody would write them."""
    rng = np.random.default_rng(1)
    for label, speed in (("walking", 1.0), ("waving", 0.3)):
        (folder / label).mkdir(parents=True)
        for person in ("anna", "bob"):
            lines = ["frame,x,y,z,doppler,intensity"]
            for frame in range(60):
                for x, y, z in rng.normal((0, 2, 0.2), (0.2, 0.15, 0.4), (rng.integers(4, 9), 3)):
                    doppler = rng.normal(speed * np.cos(frame / 10), 0.2)
                    lines.append(f"{frame},{x:.3f},{y:.3f},{z:.3f},{doppler:.3f},30")
            (folder / label / f"{person}.csv").write_text("\n".join([*lines, ""]))


def prepare(folder: Path, name: str, source: Path, *settings: str) -> None:
    words = [word for key in settings for word in ("--set", key)]
    ok("prepare", name, source, "-o", folder / name, "--jobs", 1, "-q", *words)


def words_of(kind: str, command: str, sets: Path, out: Path) -> tuple[object, ...]:
    """Words of a command on the data set of a kind."""
    data, run, (_, partner) = sets / kind, sets / f"{kind}_run", KINDS[kind]
    renamed: tuple[object, ...] = ()
    if kind in WALKING:
        names = out / "names.yaml"
        names.write_text(f"{WALKING[kind]}: walking\n")
        renamed = ("--classes", names)
    match command.split():
        case ["inspect" | "verify" as name]:
            return name, data
        case ["preview" | "view" as name]:
            return name, data, "-o", out / f"x.{'png' if name == 'preview' else 'html'}"
        case ["audit"]:
            return "audit", data, "--quick", "-o", out / "audit", "--per-class", 8
        case ["eval"]:
            return "eval", run, data, "-o", out / "eval", "--split", "val", "--device", "cpu"
        case ["adapt"]:
            return "adapt", run, data, "-o", out / "adapted", "--epochs", 1, "--device", "cpu"
        case ["predict"]:
            return "predict", run, data, "-o", out / "found.csv", "--device", "cpu"
        case ["joints"]:
            settings = [word for key in QUICK for word in ("--set", key)]
            model = ("--model", "cloudnet", "--target", "skeleton")
            return "train", data, "-o", out / "joints", *model, *settings
        case ["compare"]:
            return "compare", sets / partner, data, "-o", out / "compared", *renamed
        case ["convert", to]:
            return "convert", data, "-o", out / to, "--to", to
        case other:
            raise AssertionError(other)


COMMANDS = (
    *("inspect", "preview", "view", "audit", "verify", "eval", "adapt", "predict", "joints"),
    *("compare", "convert parquet", "convert mars", "convert ros", "convert ti"),
)


@pytest.mark.every(8)
@pytest.mark.usefixtures("blank_figures")
@pytest.mark.parametrize("kind", KINDS)
def test_every_command_works_or_says_in_a_line_what_to_do(
    kind: str, sets: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(audit, "QUICK", Effort(trees=2, folds=2, permutations=5))
    for command in COMMANDS:
        done = radhar(*words_of(kind, command, sets, tmp_path))
        expected = REFUSED.get((kind, command))
        if expected is None:
            assert done.returncode == 0, (kind, command, done.stderr)
        else:
            assert done.returncode == 2, (kind, command, done.stdout)
            assert expected in done.stderr, (kind, command)
            assert done.stderr.count("\n") == 1, done.stderr
        assert "Traceback" not in done.stderr


@pytest.mark.usefixtures("blank_figures")
def test_clouds_are_compared_as_clouds(sets: Path, tmp_path: Path) -> None:
    """Whoever made them: a board's first map is another, and a table has no SNR."""
    done = ok("compare", sets / "board", sets / "points", "-o", tmp_path / "compared")
    assert "the SNR is not compared, as a side does not have it" in done.stderr
    assert "points a frame:" in done.stdout
    table = (tmp_path / "compared/statistics.csv").read_text()
    assert "walking,chamfer,m," in table
    assert "walking,spread_up,m," in table
    assert "envelope" not in table
