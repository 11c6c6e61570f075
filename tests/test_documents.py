"""Every block of README.md and docs is run, page by page, at small size.

The blocks of a page run in order in a folder laid out as a clone: YAML is built, Python executed,
shell text given to bash as it stands, where this process answers for `radhar`. A YAML block whose
first line is `# name.yaml` is written under that name instead, before the others run.
`make test` runs the README and the short pages, and reads the blocks of the others.
"""

import ast
import importlib
import json
import re
import shutil
import subprocess
import tomllib
from collections.abc import Callable, Iterator
from itertools import filterfalse, islice
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
import yaml
from capture.dca1000_file import Radar, body, echo, words
from capture.recipes.published_files import write_mars, write_radhar
from capture.uart_bytes import demo_packet, floats, side_info
from helpers.boards import CFG
from helpers.capture_files import write_all
from helpers.command_line import ROOT, radhar
from helpers.documents import PAGES, Block, blocks
from helpers.poses import BLAZE, NTU, WALKER, T, c3d_bytes, camera, landmarks, names
from helpers.recorded import frames, write_amc, write_bvh, write_motions, write_npz
from helpers.shell import Answer, Call, run_shell
from helpers.slow import slow
from learning.patterns import tree
from torch.utils.data import DataLoader
from typer.main import get_command

from radhar_cli.cli import program
from radhar_cli.config import Config, load_config, load_radars
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.scene.checks.drawing import draw_valid_scene

LANGUAGES = {"sh", "bash", "yaml", "python", "py", "text"}  # signatures (py), text are not run
# What no test can run, by a part of the block, and why.
NOT_RUN = {
    "dask_jobqueue": "needs SLURM",
    "rule merge": "needs Snakemake",
    "mediapipe as mp": "needs a camera and a network",
    "load_dataset": "tests/dataset/test_formats.py does, in a process of its own",
    "torchvision.datasets": "the same",
}
# Commands whose options alone are looked at, by a word of theirs, and why.
OPTIONS_ONLY = {
    "--cluster": "other machines; tests/dataset/test_cluster.py has some",
    "tradeoff": "takes minutes; tests/study/tradeoff runs its parts",
}
# Pages whose commands take seconds of a processor, for `make test-all`.
LONG = {
    "audit.md",
    "benchmark_simulators.md",
    "board_profiles.md",
    "boards.md",
    "fall_detection.md",
    "frames.md",
    "impulse.md",
    "maps.md",
    "measured.md",
    "motion_files.md",
    "noise.md",
    "people.md",
    "poses.md",
    "radars.md",
    "recipes.md",
    "scenes.md",
    "several_radars.md",
    "streams.md",
    "tour.md",
    "training.md",
}
# What makes a config small, and a command: it stands after its own words.
FEW = ["stationary", "walking", "walking_to_falling"]
SMALL_DATA = {"samples_per_class": 2, "split": {"train": 0.5, "validation": 0.5}}
SMALL_IMAGE = {"size_px": 32}
SMALL = {
    "generate": {"--jobs": "1"},
    "train": {"--set": "epochs=1 workers=0"},
    "adapt": {"--epochs": "1"},
    "verify": {"--samples": "1"},
    "prepare": {"--jobs": "1"},
    "simulate": {"--set": "duration_s=3"},
    "limits": {"--minutes": "0.05"},
    "benchmark": {"--seeds": "1", "--epochs": "1", "--per-class": "3", "--rows": "simulation,1"},
}
# What SLURM would say.
ENVIRONMENT = {
    "SCRATCH": ".",
    "SLURM_ARRAY_TASK_ID": "1",
    "SLURM_ARRAY_TASK_COUNT": "1",
    "SLURM_CPUS_PER_TASK": "1",
}


def ran(*words: object) -> None:
    done = radhar(*words)
    assert done.returncode == 0, done.stderr


def small(document: dict[str, Any]) -> dict[str, Any]:
    """A config of data or of training, made small."""
    if "epochs" in document or "base" in document:
        return {**document, "epochs": 1}
    image = {**document.get("image", {}), **SMALL_IMAGE}
    if "recordings" in document:
        return {**document, "image": image}
    if "stream" in document:
        few_streams = {"duration_s": 20, "stream": {**document["stream"], "count": 10}}
        return {**document, **few_streams, "split": SMALL_DATA["split"], "image": image}
    few = {"activities": FEW} if document.get("activities", "all") == "all" else {}
    return {**document, **SMALL_DATA, **few, "image": image}


def clone(folder: Path) -> None:
    """Configs made small, scripts and examples."""
    for path in (ROOT / "configs").rglob("*.yaml"):
        there = folder / path.relative_to(ROOT)
        there.parent.mkdir(parents=True, exist_ok=True)
        there.write_text(yaml.safe_dump(small(yaml.safe_load(path.read_text())), sort_keys=False))
    for path in (ROOT / "configs").rglob("*.cfg"):
        shutil.copy(path, folder / path.relative_to(ROOT))
    for name in ("scripts", "examples", "Makefile", "pyproject.toml", "radhar_cli"):
        (folder / name).symlink_to(ROOT / name)


# Files that nobody has, made where a page asks for them.


def data_set(path: Path) -> None:
    ran("generate", "configs/quickstart.yaml", "-o", path, "--jobs", "1")


def data_set_of_three_parts(path: Path) -> None:
    document = yaml.safe_load(Path("configs/quickstart.yaml").read_text())
    third = {"train": 0.34, "validation": 0.33, "test": 0.33}
    Path("parts.yaml").write_text(
        yaml.safe_dump({**document, "samples_per_class": 3, "split": third})
    )
    ran("generate", "parts.yaml", "-o", path, "--jobs", "1")


def network(path: Path) -> None:
    ran("train", "datasets/quickstart", "-o", "runs/made", "--set", "epochs=1")
    shutil.copy("runs/made/best.safetensors", path)


def movement(path: Path) -> None:
    path.parent.mkdir(exist_ok=True)
    write = {".bvh": write_bvh, ".amc": write_amc, ".npz": write_npz}[path.suffix]
    write(path, frames("punching", 4.0))


def webcam(path: Path) -> None:
    """World landmarks, relative to the hips."""
    hips = [names("blazepose33").index(f"{side}_hip") for side in ("right", "left")]
    centred = BLAZE - BLAZE[:, hips].mean(axis=1, keepdims=True)
    path.write_text(json.dumps(landmarks(centred)))


def gait_markers(path: Path) -> None:
    """Markers of Plug-in Gait, each at its joint."""
    joints = ["hip", "hip", "hip", "hip", "head", "head", "head", "head"]
    labels = ["LASI", "RASI", "LPSI", "RPSI", "LFHD", "RFHD", "LBHD", "RBHD"]
    for side in ("right", "left"):
        for marker, joint in zip(
            ["SHO", "ELB", "WRA", "WRB", "KNE", "ANK"],
            ["shoulder", "elbow", "hand", "hand", "knee", "ankle"],
            strict=True,
        ):
            labels.append(side[0].upper() + marker)
            joints.append(f"{side}_{joint}")
    path.write_bytes(c3d_bytes(WALKER[:, [JOINTS.index(joint) for joint in joints]], labels))


def capture(path: Path) -> None:
    """Of TI's card, and what Studio says of the radar."""
    (path.parent / "setup.mmwave.json").write_text(json.dumps(CARD.studio()))
    motion = {"range_m": 2, "angle_deg": 0, "walking": {"speed_mps": 0.7}}
    walker = Config.model_validate({"duration_s": 4.2, "activities": ["S8"], "motion": motion})
    beat = echo(CARD, body(walker), round(4.2e3 / CARD.period_ms), 0)
    words(beat, len(CARD.transmitters)).tofile(path)


ADVANCED = (Path(__file__).parent / "radar/cfg/advframe.cfg").read_text()
CARD = Radar(samples=32, idle_us=2466.0, loops=8, period_ms=20.0, transmitters=(1,), receivers=0b1)


def subframes(path: Path) -> None:
    """What a board of two subframes sends of something that stands still, in two frames."""
    (path.parent / "advframe.cfg").write_text(ADVANCED)
    beat = np.exp(-0.2j * np.pi * np.arange(256))
    words(np.tile(beat[None, :, None], (4, 1, 2 * 2 * 64)), 1).tofile(path)


def array(path: Path) -> None:
    """Frames of a radar with two receivers."""
    beat = np.random.default_rng(0).normal(size=(2, 10, 32, 2, 64)).astype(np.float32)
    np.save(path, beat[0] + 1j * beat[1])


def masks(path: Path) -> None:
    images = np.random.default_rng(0).random((8, 32, 32)) < 0.3
    np.savez(path, images=images, label=np.array(["walking", "falling"] * 4))


def recordings_table(path: Path) -> None:
    """What is known of each image of a tree that another function makes."""
    images = sorted(Path("measured").rglob("*.png"))
    rows = [
        f"{file.relative_to('measured')},{file.parent.name},P{n % 3}"
        for n, file in enumerate(images)
    ]
    path.write_text("\n".join(["file,class,person", *rows]) + "\n")


def few_samples(path: Path) -> None:
    document = yaml.safe_load(Path("configs/quickstart.yaml").read_text())
    path.write_text(yaml.safe_dump({**document, "samples_per_class": 3}))


def idle(path: Path) -> None:
    """A program that does nothing; tests/test_contributing.py runs the real one."""
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)


def dump(path: Path) -> None:
    """What a board sends of somebody who walks, in 20 frames of three points."""
    places = [[(0.1 * k, 3 - 0.1 * n, 0.5 * k, -1.0) for k in range(3)] for n in range(20)]
    packets = (
        demo_packet(n, [(1, floats(rows)), (7, side_info([[15, 40]] * 3))], 3)
        for n, rows in enumerate(places)
    )
    path.write_bytes(b"".join(packets))


def replay(path: Path) -> None:
    """Twenty frames of somebody who punches, as the visualizer keeps them."""
    point = [0.1, 2.0, 0.3, -0.5, 15.0, 40.0, 255]
    frames = [
        {"frameData": {"frameNum": n, "pointCloud": [point] * (n % 3)}, "timestamp": 100 * n}
        for n in range(20)
    ]
    cfg = CFG.splitlines(keepends=True)
    path.write_text(json.dumps({"cfg": cfg, "demo": "Out of Box Demo", "data": frames}))


def point_table(path: Path) -> None:
    """A point a frame of two who do different things."""
    for place, label in ((path, "walking"), (path.parents[1] / "falling/anna.csv", "falling")):
        place.parent.mkdir(parents=True, exist_ok=True)
        rows = [f"{n},0.5,2,0.25,-1,{label}" for n in range(60)]
        place.write_text("\n".join(["frame,x,y,z,doppler,label", *rows, ""]))


def simulated_tables(path: Path) -> None:
    """A point a frame of two seconds at 30 Hz, of several people of two classes."""
    for label in ("boxing", "walk"):
        (path / label).mkdir(parents=True)
        for number in range(1, 9):
            rows = [f"{n},0.5,2,0.25,{number / 10}" for n in range(61)]
            text = "\n".join(["frame,x,y,z,doppler", *rows, ""])
            (path / label / f"{number}.csv").write_text(text)


FILES: dict[str, dict[str, Callable[[Path], object]]] = {
    "CONTRIBUTING.md": {
        f".venv/bin/{name}": idle for name in ("python", "ruff", "mypy", "pre-commit")
    },
    "audit.md": {
        "datasets/quickstart": data_set,
        "measured": lambda path: tree(path, FEW[:2]),
        "recordings.csv": recordings_table,
    },
    "cluster.md": {"CONFIG": few_samples, "config.yaml": few_samples},
    "config.md": {"lab.yaml": few_samples},
    "measured.md": {
        "adc_data_Raw_0.bin": capture,
        "adc_subframes.bin": subframes,
        "walk.npy": array,
        "masks.npz": masks,
        "masks": lambda path: tree(path, [*FEW[:2], "picking_up"]),
        "names.yaml": lambda path: path.write_text("picking_up: grabbing"),
    },
    "captures.md": {"walk.wav": lambda path: write_all(path.parent)},
    "prepare.md": {"downloads/MARS": write_mars, "captures/walking/anna.csv": point_table},
    "benchmark_simulators.md": {"downloads/RadHAR": write_radhar, "theirs": simulated_tables},
    "points.md": {
        "walk.bin": dump,
        "replay_1.json": replay,
        "board.cfg": lambda path: path.write_text(CFG),
    },
    "motion_files.md": {
        "wave/one.bvh": movement,
        "cmu/02_01.amc": movement,
        "cmu/02_02.amc": movement,
        "beds/low.npz": movement,
    },
    "poses.md": {
        "webcam.json": webcam,
        "recorded.npy": lambda path: np.save(path, camera(NTU) * [-1, -1, 1]),
        "ticks.npy": lambda path: np.save(path, np.round(1e7 * T).astype(np.int64)),
        "gait.c3d": gait_markers,
    },
    "output.md": {"CONFIG": few_samples, "datasets/mine": data_set},
    "recipes.md": {
        "walk.bin": dump,
        "replay_1.json": replay,
        "board.cfg": lambda path: path.write_text(CFG),
        "config.yaml": few_samples,
    },
    "stream.md": {"datasets/quickstart": data_set},
    "training.md": {
        "datasets/quickstart": data_set_of_three_parts,
        "networks/quickstart.safetensors": network,
    },
}


def first_batch(
    samples: Any, batch_size: int, shuffle: bool = False, num_workers: int = 0
) -> object:
    """What a loader gives first, without processes."""
    return islice(DataLoader(samples, batch_size=min(batch_size, 4), shuffle=shuffle), 1)


def tell(page: Path, folder: Path) -> None:
    """Run every block of a page, as its reader would."""
    clone(folder)
    for name, make in FILES.get(page.name, {}).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        make(Path(name))
    told = blocks(page)
    for block in told:
        if name := config_name(block):
            (folder / name).write_text(yaml.safe_dump(small(yaml.safe_load(block.text))))
    for block in told:
        if block.language not in ("text", "py") and not any(part in block.text for part in NOT_RUN):
            run_block(block, folder)


def config_name(block: Block) -> str | None:
    """The file that a block of YAML is, if it says so."""
    named = re.match(r"# (\S+\.yaml)\n", block.text)
    return named[1] if named else None


def run_block(block: Block, folder: Path) -> None:
    if block.language == "python":
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("torch.utils.data.DataLoader", first_batch)
            exec(compile(block.text, str(block), "exec"), {})
        plt.close("all")
    elif block.language != "yaml":
        done = run_shell("jq() { cat; }\n" + block.text, folder, PROGRAMS)
        assert done.returncode == 0, f"{block}: {done.stderr}"
    elif config_name(block) is None:
        path = folder / f"block_{block.line}.yaml"
        path.write_text(block.text)
        sets = as_sets({**SMALL_DATA, **{f"image.{key}": n for key, n in SMALL_IMAGE.items()}})
        ran("generate", path, "-o", f"built/{block.line}", "--jobs", "1", *sets)


def as_sets(values: dict[str, object]) -> list[str]:
    return [word for key in values for word in ("--set", f"{key}={json.dumps(values[key])}")]


def answer_radhar(call: Call) -> Answer:
    """The command, made small."""
    command, *words = call.words
    if any(word in call.words for word in OPTIONS_ONLY):
        get_command(program()).commands[command].make_context(command, words)
        return Answer()
    for name, options in SMALL.items():
        if {*name.split()} <= {*call.words}:
            words += [
                word
                for option, values in options.items()
                for value in values.split()
                for word in (option, value)
            ]
    if command == "generate" and "--recordings" not in words:
        document = yaml.safe_load(Path(words[0]).read_text())
        is_small = "stream" in document or document.get("samples_per_class", 300) <= 3
        if not is_small:  # written by a command, not by this test
            words += as_sets({**SMALL_DATA, "activities": FEW, "image.size_px": 32})
    done = radhar(command, *words)
    return Answer(done.returncode, done.stdout, done.stderr)


def answer_make(call: Call) -> Answer:
    """The commands of a target; how it sets up .venv aside."""
    text = Path("Makefile").read_text()
    for target in call.words:
        recipe = re.search(rf"^{target}:.*\n((?:\t.*\n)*)", text, re.MULTILINE)
        assert recipe, f"make {target}: there is none"
        if target in ("test", "test-all", "bench", "install"):
            continue
        for command in re.findall(r"\$\(BIN\)/radhar (.*)", recipe[1]):
            answer = answer_radhar(Call("radhar", command.split()))
            assert answer.status == 0, answer.err
    return Answer()


def answer_pip(call: Call) -> Answer:
    """What it would install is known."""
    project = tomllib.loads(Path("pyproject.toml").read_text())["project"]
    for extra in re.findall(r"radhar\[(\w+)\]", " ".join(call.words)):
        assert extra in project["optional-dependencies"], extra
    return Answer()


def answer_python(call: Call) -> Answer:
    """A script and its options are there; they take minutes to days."""
    script, *words = call.words
    if script != "-m":
        text = Path(script).read_text()
        assert all(f'"{word}"' in text for word in words if word.startswith("--")), call
    return Answer()


PROGRAMS = {
    "radhar": answer_radhar,
    "make": answer_make,
    "pip": answer_pip,
    "python": answer_python,
    "dask": lambda call: Answer(),
    "git": lambda call: Answer(),
}


RUN = [*filter(blocks, PAGES)]


def is_long(page: Path) -> bool:
    return page.name in LONG


@pytest.mark.parametrize(
    "page",
    [*filterfalse(is_long, RUN), *slow(filter(is_long, RUN))],
    ids=lambda page: page.name,
)
def test_a_page_does_what_it_says(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in ENVIRONMENT.items():
        monkeypatch.setenv(name, value)
    monkeypatch.chdir(tmp_path)
    tell(page, tmp_path)


def used_names(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """(module, name) of everything that a program takes from radhar."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("radhar_cli"):
            yield from ((str(node.module), alias.name) for alias in node.names)
        elif isinstance(node, ast.Attribute) and ast.unparse(node.value) in (
            "radhar",
            "radhar_cli",
        ):
            yield "radhar_cli", node.attr


@pytest.mark.parametrize("page", RUN, ids=lambda page: page.name)
def test_blocks_of_a_page_can_be_read(page: Path, tmp_path: Path) -> None:
    """Configs that are built load, programs take names that radhar has, shell text has no slip.

    tests/test_docs.py looks for the commands and their options.
    """
    for base in ("quickstart.yaml", "lab.yaml"):
        shutil.copy(ROOT / "configs/quickstart.yaml", tmp_path / base)
    for number, block in enumerate(blocks(page)):
        assert block.language in LANGUAGES, f"{block}: no language"
        if any(part in block.text for part in NOT_RUN):
            continue
        if block.language == "python":
            for module, name in used_names(ast.parse(block.text, str(block))):
                assert hasattr(importlib.import_module(module), name), f"{block}: {module}.{name}"
        elif block.language == "yaml" and config_name(block) is None:
            path = tmp_path / f"{number}.yaml"
            path.write_text(block.text)
            write_motions(yaml.safe_load(block.text), tmp_path)
            assert load_radars(path)
        elif block.language in ("sh", "bash"):
            done = subprocess.run(["bash", "-n"], input=block.text, capture_output=True, text=True)
            assert not done.stderr, f"{block}: {done.stderr}"


@pytest.mark.slow
def test_every_scene_of_the_readmes_data_set_can_be_drawn(tmp_path: Path) -> None:
    (told,) = (block for block in blocks(ROOT / "README.md") if block.language == "yaml")
    (tmp_path / "readme.yaml").write_text(told.text)
    config = load_config(tmp_path / "readme.yaml")
    for activity in config.chosen_activities:
        for index in range(config.samples_of(activity)):
            draw_valid_scene(config, activity, index)
