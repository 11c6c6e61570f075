"""The estimate of a build: nothing written, sizes close to the truth."""

from itertools import count

import pytest
from small import small_config

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset import estimate as estimate_module
from radhar_cli.dataset.build import build
from radhar_cli.dataset.estimate import estimate, jobs_that_pay


def test_bytes_are_close_to_those_of_the_build(tmp_path):
    config = load_config(small_config(tmp_path), ["samples_per_class=6", "image.size_px=128"])
    found = estimate(config, jobs=1)
    build(config, tmp_path / "set", 1, BarProgress())
    hdf5 = (tmp_path / "set/dataset.h5").stat().st_size
    pngs = sum(path.stat().st_size for path in (tmp_path / "set/png").rglob("*.png"))
    assert found.samples == 18
    assert 0.8 < found.hdf5_bytes / hdf5 < 1.25
    assert 0.9 < found.png_bytes / pngs < 1.1


def test_time_grows_with_samples_and_shrinks_with_jobs(tmp_path, monkeypatch):
    """By a clock that gives every sample 20 ms, so that the machine's mood plays no part."""
    monkeypatch.setattr(estimate_module, "perf_counter", map((0.02).__mul__, count()).__next__)
    few = load_config(small_config(tmp_path))
    many = load_config(small_config(tmp_path), ["samples_per_class=300"])
    one, two, more = estimate(few, 1), estimate(many, 2), estimate(many, 1)
    assert more.seconds > 5 * one.seconds
    assert two.seconds < 0.75 * more.seconds
    assert 900 * 0.02 < more.seconds < 900 * 0.025


@pytest.mark.parametrize(("samples", "second", "jobs"), [(12, 0.02, 1), (90, 0.02, 3), (12, 9, 4)])
def test_few_samples_are_made_by_few_processes(tmp_path, monkeypatch, samples, second, jobs):
    monkeypatch.setattr(estimate_module, "cores", lambda: 4)
    monkeypatch.setattr(estimate_module, "process_time", map(second.__mul__, count()).__next__)
    config = load_config(small_config(tmp_path), [f"samples_per_class={samples // 3}"])
    assert jobs_that_pay(config) == jobs
