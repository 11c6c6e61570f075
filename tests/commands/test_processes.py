"""Commands in processes of their own, as a shell starts them.

`make smoke` does so with generate, train, eval and predict.
"""

from pathlib import Path

import pytest
from command_line import Done, process, radhar
from learning.patterns import split_tree, trained
from small import small_config


def smoke(*arguments: object) -> Done:
    done = process("-m", "radhar_cli", *arguments)
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a config and the data set of it."""
    place = tmp_path_factory.mktemp("made")
    small_config(place)
    assert radhar("generate", place / "small.yaml", "-o", place / "set").returncode == 0
    return place


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("simulate {}/small.yaml -a S8 -o {}/scene --no-figures --maps stft", "scene.h5"),
        ("verify {}/set", ""),
        ("preview {}/set --map stft --per-class 1", "preview_stft.png"),
        ("inspect {}/set", "punching"),
        ("config show {}/small.yaml", "samples_per_class: 3"),
        ("tradeoff --help", "Example"),
    ],
)
def test_data(made: Path, command: str, expected: str) -> None:
    assert expected in smoke(*command.replace("{}", str(made)).split()).stdout


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a tree of images and a run on them."""
    place = tmp_path_factory.mktemp("learned")
    split_tree(place / "tree", 2, 1)
    trained(place / "tree", place / "run", epochs=1)
    return place


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("export {}/run -o {}/model.onnx", "model.onnx"),
        ("models", "fftnet"),
    ],
)
def test_learning(learned: Path, command: str, expected: str) -> None:
    assert expected in smoke(*command.replace("{}", str(learned)).split()).stdout
