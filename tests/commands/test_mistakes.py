"""Mistakes on the command line: status 2, one line that says what would be right, nothing made."""

import json
import shutil
from pathlib import Path

import pytest
from helpers.command_line import radhar
from helpers.recorded import frames, write_amc
from helpers.small import small_config
from learning.patterns import BASE, split_tree, trained, tree

SIMULATE, GENERATE = "simulate small.yaml -a S8 -o x", "generate c.yaml -o x"
COMPARE = "compare set"
MISTAKES = {
    "generat": "No such command 'generat'. Did you mean 'generate'",
    "config shwo": "'shwo'. Did you mean 'show'",
    "generate": "Missing argument",
    "generate c.yaml": "Missing option",
    f"{GENERATE} --jbos 2": "No such option: --jbos",
    f"{GENERATE} --jobs 0": "--jobs 0: should be greater than or equal to 1",
    f"{GENERATE} -j two": "--jobs two: should be a valid integer",
    f"{GENERATE} --set radar.prf_hz=-5": "radar.prf_hz = -5: should be above 0",
    f"{GENERATE} --set motion.sped_mps=1": "'walking.speed_mps'",
    f"{GENERATE} --set activities=[wlaking]": "did you mean 'walking'",
    f"{GENERATE} --set image.colour_map=viridus": "'viridis'",
    "eval run data --repeats": "--repeats",
    "simulate small.yaml -a walkin -o x": "did you mean 'walking'",
    f"{SIMULATE} --joint rite_hand": "'right_hand'",
    f"{SIMULATE} --maps sftf": "did you mean",
    f"{SIMULATE} --set engine.kind=cubic": "engine.kind",
    "simulate small.yaml -o x --motion broken.amc": "needs its skeleton",
    "simulate small.yaml -o x --motion none.bvh": "--motion = ",
    f"{SIMULATE} --tolerance 5": "--tolerance: engine.tolerance_db = 5.0",
    "train tree -o x --target skeleton": "--target: should have model: cloudnet",
    "preview none": "no such file",
    "inspect none": "no such file",
    "inspect small.yaml": "not an HDF5 file",
    "motion small.yaml -a walking -o x.fbx": "should end in .bvh",
    "motion small.yaml -a flying -o x.bvh": "is not an activity",
    "motion small.yaml -a waking -o x.bvh": "--activity: 'waking' is not an activity; did you mean",
    "motion small.yaml -o x.bvh": "an activity is needed",
    "convert set -o tree --to parquet": "tree: already exists",
    "convert set -o x --to parket": "did you mean 'parquet'?",
    "convert none -o x --to parquet": "no such file",
    "convert set/png -o x --to parquet": "no such file",
    "convert set/config.yaml -o x --to parquet": "is not an HDF5 file",
    f"{COMPARE} set -o x --per-class 1": "--per-class 1: should be",
    f"{COMPARE} none -o x": "none: no such file or folder",
    f"{COMPARE} set -o x --map stfd": "has no map 'stfd'",
    f"{COMPARE} set/dataset.h5 -o set/x": "lies in the data",
    f"{COMPARE} small.yaml -o x": "small.yaml: is not a data set",
    f"{COMPARE} set -o x --classes names.yaml": "no class 'walkin' (--classes)",
    "train tree -o x --model fftnett": "did you mean 'fftnet'",
    "train tree -o x --set epoch=3": "did you mean 'epochs'",
    "train none -o x": "no such file or folder",
    "train alone -o x": "'walking' alone",
    "train tree -o tree/train": "lies in the data",
    "eval tree tree": "is given twice",
    "eval run": "give a data set after it",
    "eval run tree --split vall": "split = 'vall': is not a split; did you mean 'val'",
    "eval run tree --split test": "has no test images",
    "eval run tree --device cdua": "did you mean 'cuda'",
    "predict run train.json": "is not a data set",
    "adapt run tree -o x --epochs 0 --mix tree": "--mix: needs --epochs",
    "export tree -o x.onnx": "holds no best.safetensors",
}


@pytest.fixture(scope="module")
def place(small_set, tmp_path_factory):
    """A folder with configs, a data set, trees, a run and a motion without its skeleton."""
    folder = tmp_path_factory.mktemp("mistakes")
    small_config(folder)
    (folder / "c.yaml").write_text("base: small.yaml\n")
    (folder / "set").symlink_to(small_set)
    (folder / "names.yaml").write_text("walkin: walking\n")
    (folder / "train.json").write_text(json.dumps(BASE))
    write_amc(folder / "broken.amc", frames(seconds=0.5)).with_suffix(".asf").unlink()
    split_tree(folder / "tree", 2, 1)
    tree(folder / "alone", ("walking",), {"train": 2, "val": 1})
    trained(folder / "tree", folder / "run", epochs=1)
    return folder


@pytest.mark.every(2)
@pytest.mark.parametrize("words", MISTAKES)
def test_a_mistake_is_one_line(words, place, monkeypatch):
    monkeypatch.chdir(place)
    shutil.rmtree("x", ignore_errors=True)  # which another mistake may have made
    done = radhar(*words.split())
    said = [line for line in done.stderr.splitlines() if not line.startswith("reading ")]
    assert (done.returncode, len(said)) == (2, 1), done.stderr
    assert said[0].startswith("radhar: ")
    assert MISTAKES[words] in said[0]
    assert {path.name for path in Path("x").glob("*")} <= {".radhar"}, "nothing is made"
