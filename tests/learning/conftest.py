"""Runs that several tests read and none changes."""

import pytest
import torch
from learning.patterns import split_tree, trained

from radhar_cli.learning.models.timm_networks import load_timm


@pytest.fixture(autouse=True)
def fresh_torch(blank_figures):
    """Chance, threads and algorithms as in a new process, whatever ran before."""
    torch.manual_seed(0)
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(False)


@pytest.fixture(scope="session")
def data(tmp_path_factory):
    """A tree of three of our classes, train and val."""
    return split_tree(tmp_path_factory.mktemp("data") / "tree")


@pytest.fixture(scope="session")
def run_dir(data, tmp_path_factory):
    """A run of three epochs on it."""
    folder = tmp_path_factory.mktemp("runs") / "plain"
    trained(data, folder)
    return folder


@pytest.fixture(scope="session")
def zoo():
    """timm loads."""
    load_timm()
