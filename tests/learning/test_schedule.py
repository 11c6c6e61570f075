"""The learning rate at every step."""

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from learning.patterns import settings

from radhar_cli.config.reading import load_section
from radhar_cli.learning.optimiser import learning_rate_of_step
from radhar_cli.learning.settings import TrainConfig

ROOT = Path(__file__).resolve().parents[2]


def at(config, epoch, done):
    """The rate of the step of an epoch before which the share `done` of a hundred is behind."""
    return learning_rate_of_step(config, epoch, round(100 * done), 100)


def test_the_papers_rate_falls_tenfold_every_ten_epochs():
    paper = load_section(TrainConfig, ROOT / "configs/train/paper.yaml")
    rates = [at(paper, epoch, 0.5) for epoch in range(20)]
    assert rates[:10] == [0.00147] * 10
    assert rates[10:] == pytest.approx([0.000147] * 10)
    assert at(settings(epochs=50), 20, 0.0) == pytest.approx(1e-5)
    assert at(settings(epochs=50), 19, 0.99) == pytest.approx(1e-4)


def test_cosine_starts_at_the_rate_and_ends_at_zero():
    config = settings(epochs=10, schedule={"kind": "cosine"})
    assert at(config, 0, 0.0) == pytest.approx(1e-3)
    assert at(config, 5, 0.0) == pytest.approx(5e-4)
    assert at(config, 2, 0.5) == pytest.approx(1e-3 * (1 + math.cos(math.pi / 4)) / 2)
    assert at(config, 9, 0.99) == pytest.approx(0.0, abs=1e-8)


def test_the_constant_schedule_is_constant():
    config = settings(epochs=40, schedule={"kind": "constant"})
    assert {at(config, epoch, 0.3) for epoch in range(40)} == {1e-3}


def test_warm_up_is_linear_and_the_schedule_follows():
    config = settings(epochs=10, warmup_epochs=2.0, schedule={"kind": "cosine"})
    assert at(config, 0, 0.0) == pytest.approx(1e-3 / 200), "the first of two hundred steps"
    assert at(config, 0, 0.49) == pytest.approx(0.25e-3)
    assert at(config, 0, 0.99) == pytest.approx(0.5e-3)
    assert at(config, 1, 0.49) == pytest.approx(0.75e-3)
    assert at(config, 1, 0.99) == pytest.approx(1e-3, rel=1e-3)
    assert at(config, 2, 0.0) == pytest.approx(1e-3)
    assert at(config, 6, 0.0) == pytest.approx(5e-4), "half of what the warm-up leaves"


@examples(max_examples=200)
@given(
    epochs=st.integers(1, 60),
    warm=st.floats(0, 1),
    kind=st.sampled_from(["step", "cosine", "constant"]),
    where=st.floats(0, 1, exclude_max=True),
    done=st.floats(0, 0.99),
)
def test_rate_lies_between_zero_and_the_initial_one(epochs, warm, kind, where, done):
    config = settings(epochs=epochs, warmup_epochs=warm * epochs, schedule={"kind": kind})
    assert 0 < at(config, int(where * epochs), done) <= 1e-3 * (1 + 1e-12)


def test_warm_up_longer_than_the_run_is_refused():
    with pytest.raises(ValueError, match="warmup_epochs of at most epochs"):
        settings(epochs=3, warmup_epochs=3.5)
