"""What the hostile files are made from; read-only."""

from pathlib import Path

import pytest
from security.made import data_set, training_run


@pytest.fixture(scope="session")
def good_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set of ours."""
    return data_set(tmp_path_factory.mktemp("good"))


@pytest.fixture(scope="session")
def good_run(good_set: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that learned from it."""
    return training_run(tmp_path_factory.mktemp("good_run"), good_set)
