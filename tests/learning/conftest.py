"""Runs that several tests look at; nobody changes them."""

import importlib.util
import sys
import warnings
from pathlib import Path

import pytest
from learning.patterns import split_tree, trained

OPERATORS = Path(__file__).resolve().parents[1] / "torchvision_operators/sitecustomize.py"


@pytest.fixture(scope="session")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tree of three of our classes, train and val."""
    return split_tree(tmp_path_factory.mktemp("data") / "tree")


@pytest.fixture(scope="session")
def run_dir(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of three epochs on it."""
    folder = tmp_path_factory.mktemp("runs") / "plain"
    trained(data, folder)
    return folder


@pytest.fixture(scope="session")
def zoo() -> None:
    """timm loads, with the operators of torchvision declared where its build lacks them."""
    if "timm" in sys.modules:
        return
    spec = importlib.util.spec_from_file_location("torchvision_operators", OPERATORS)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spec.loader.exec_module(module)
        importlib.import_module("timm")
