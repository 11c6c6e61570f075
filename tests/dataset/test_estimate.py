"""The estimate of a build: nothing written, sizes close to the truth."""

import time
from itertools import count

import pytest
from helpers.command_line import ok
from helpers.small import small_config

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset import batch as batch_module
from radhar_cli.dataset import estimate as estimate_module
from radhar_cli.dataset.build import build
from radhar_cli.dataset.estimate import estimate, jobs_that_pay, plan_build
from radhar_cli.dataset.layout import Rows
from radhar_cli.processes.progress import NO_PROGRESS


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


NEVER = 3600  # s


def slow_after(number, function):
    """A function that takes an hour from its call of that number on."""
    calls = count()

    def slow(*given):
        if next(calls) >= number:
            time.sleep(NEVER)
        return function(*given)

    return slow


def test_a_dry_run_ends_when_its_time_is_over(tmp_path, monkeypatch):
    config = load_config(small_config(tmp_path))
    scenes = slow_after(2, batch_module.draw_valid_scene)
    monkeypatch.setattr(batch_module, "draw_valid_scene", scenes)
    samples = slow_after(3, estimate_module.synthesise)
    monkeypatch.setattr(estimate_module, "synthesise", samples)
    found = plan_build(config, 1, NO_PROGRESS, seconds=5)
    assert found.cut_short
    assert found.checked == 2
    assert found.cost.probes == 2  # the first, with its imports, does not count
    assert found.cost.seconds is not None


def test_a_dry_run_says_what_it_did_not_do(tmp_path, monkeypatch):
    monkeypatch.setattr(estimate_module, "DRY_RUN_S", 0.5)
    for module, name in ((batch_module, "draw_valid_scene"), (estimate_module, "synthesise")):
        monkeypatch.setattr(module, name, slow_after(0, None))
    command = ("generate", small_config(tmp_path), "-o", tmp_path / "set", "--dry-run")
    said = ok(*command).stdout
    assert "0 of 9 checked: 0 drawn again, then 0.5 s were over" in said
    assert "time        not known" in said
    assert '"seconds": null' in ok(*command, "--json").stdout


def test_the_first_of_the_checked_scenes_are_of_all_classes(tmp_path):
    rows = Rows.of(load_config(small_config(tmp_path), ["samples_per_class=100"]))
    for number in (3, 6, 24):
        checked = rows.spread_progressively(24)[:number]
        assert len({rows[row][0].slug for row in checked}) == 3
    assert sorted(rows.spread_progressively(24)) == rows.spread(24)


def test_a_build_of_slow_samples_does_not_wait_for_one_before_it_starts(tmp_path, monkeypatch):
    monkeypatch.setattr(estimate_module, "cores", lambda: 4)
    monkeypatch.setattr(estimate_module, "TRIAL_S", 0.2)
    monkeypatch.setattr(estimate_module, "synthesise", slow_after(0, None))
    assert jobs_that_pay(load_config(small_config(tmp_path))) == 4
