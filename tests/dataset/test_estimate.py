"""The estimate of a build: nothing written, sizes close to the truth, times of its samples."""

import json
import time
from itertools import count

import pytest
from helpers.command_line import ok
from helpers.small import small_config

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset import batch as batch_module
from radhar_cli.dataset import estimate as estimate_module
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset import trial as trial_module
from radhar_cli.dataset.build import build
from radhar_cli.dataset.estimate import (
    EPOCHS,
    START_END,
    Estimate,
    WrittenSamples,
    encode_samples,
    estimate,
    jobs_that_pay,
    plan_build,
    scale_up,
    training_seconds,
)
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.sample import SampleRow, synthesise
from radhar_cli.dataset.trial import DRAW, WRITE, Trial, TrialSample, try_samples
from radhar_cli.dataset.workers import run_within
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.processes.progress import NO_PROGRESS
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.table import plan_images


def test_bytes_are_close_to_those_of_the_build(tmp_path):
    config = load_config(small_config(tmp_path), ["samples_per_class=6", "image.size_px=128"])
    found = estimate(config, jobs=1)
    build(config, tmp_path / "set", 1, BarProgress())
    hdf5 = (tmp_path / "set/dataset.h5").stat().st_size
    pngs = sum(path.stat().st_size for path in (tmp_path / "set/png").rglob("*.png"))
    assert found.samples == 18
    assert 0.7 < found.hdf5_bytes / hdf5 < 1.25  # but for what the file says of itself
    assert 0.9 < found.png_bytes / pngs < 1.1


def trial_of(config, walls, jobs=1, share=1.0, start=0.0):
    """A trial whose samples take given times, a quarter to draw, a half for the echo."""
    plan, row = plan_images(config), Rows.of(config)[0]
    scene, _ = draw_valid_scene(config, *row)
    sample = synthesise(scene, plan, config)
    values = scene_fields.values(scene, scene_fields.fields(config), sample.error_db)
    samples, now = [], start
    for number, wall in enumerate(walls):
        busy = share * wall
        stages = {DRAW: busy / 4, "echo": busy / 2, WRITE: busy / 4}
        row = SampleRow(sample, values)
        samples.append(TrialSample(number % jobs, row, 1000, now, now + wall, 0.5, stages))
        now += wall
    return Trial(0.0, tuple(samples[:jobs]), tuple(samples[jobs:]))


FREE = WrittenSamples(1000.0, 0.0, 0.0)  # samples that cost nothing to write


def config_of(tmp_path, samples_per_class, *more):
    settings = [f"samples_per_class={samples_per_class}", *more]
    return load_config(small_config(tmp_path), settings)


def test_time_is_that_of_samples_between_start_and_end(tmp_path):
    config = config_of(tmp_path, 300, "output.png=false")  # 900 samples
    trial = trial_of(config, [2.0] + [0.1] * 10)
    found = scale_up(config, trial, FREE, 1, before=3.0)
    samples, start, end = 900 * 0.1, 3.0 + 1.9, found.seconds - found.processor_seconds
    assert found.seconds == pytest.approx(samples + start, rel=0.02)  # the end is short
    assert end == pytest.approx(0)
    assert found.seconds_alone == pytest.approx(found.seconds)
    low, high = found.seconds_range
    assert low < found.seconds < high < 1.3 * found.seconds
    two = scale_up(config, trial_of(config, [1.0, 2.0] + [0.1] * 10, jobs=2), FREE, 2, before=3.0)
    assert two.seconds == pytest.approx(samples / 2 + 3.0 + 2.9, rel=0.04)


def test_shares_are_those_of_the_stages(tmp_path):
    config = config_of(tmp_path, 300)
    found = scale_up(config, trial_of(config, [1.0] + [0.1] * 10), FREE, 1, before=10.0)
    assert sum(found.shares.values()) == pytest.approx(100)
    assert list(found.shares) == [DRAW, "echo", WRITE, START_END]
    assert found.shares["echo"] == pytest.approx(2 * found.shares[DRAW])
    assert found.shares[DRAW] == pytest.approx(100 * 22.5 / found.processor_seconds)
    assert found.shares[START_END] == pytest.approx(100 * 10.9 / found.processor_seconds, rel=0.1)


def test_other_programs_make_it_longer_and_are_told_apart(tmp_path):
    config = config_of(tmp_path, 300)
    idle, busy = (
        scale_up(config, trial_of(config, [0.1 / share] * 11, share=share), FREE, 1, before=1.0)
        for share in (1.0, 0.5)
    )
    assert busy.core_share == pytest.approx(0.5)
    assert busy.seconds == pytest.approx(2 * idle.seconds, rel=0.02)
    assert busy.seconds_alone == pytest.approx(idle.seconds, rel=0.02)
    assert busy.processor_seconds == pytest.approx(idle.processor_seconds)


def test_few_samples_and_unlike_ones_leave_more_doubt(tmp_path):
    config = config_of(tmp_path, 300)
    widths = []
    for walls in ([0.1] * 21, [0.05, 0.15] * 10 + [0.1], [0.05, 0.15, 0.05], [0.1]):
        found = scale_up(config, trial_of(config, walls), FREE, 1, before=0.0)
        low, high = found.seconds_range
        widths.append((high - low) / found.seconds)
    assert widths == sorted(widths)
    assert widths[0] < 0.35
    assert widths[-1] == pytest.approx(1)


def test_bytes_of_a_sample_are_those_of_many(tmp_path):
    config = config_of(tmp_path, 3)
    rows = [sample.row for sample in trial_of(config, [0.1] * 9).samples]
    few, more = (encode_samples(config, rows[:count]) for count in (1, 8))
    assert few.sample_bytes == pytest.approx(more.sample_bytes, rel=0.2)
    assert min(few.sample_seconds, few.shard_seconds, more.sample_seconds) >= 0


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


def test_training_costs_as_many_pixels_as_it_sees(tmp_path):
    """Of the images of its own part of the data set; what a pixel costs is measured elsewhere."""
    small = load_config(small_config(tmp_path))
    once = training_seconds(small)
    assert once > 0
    assert TrainConfig().epochs == EPOCHS
    larger = small.replace({"image.size_px": [96, 48]})
    assert training_seconds(larger) == pytest.approx(2 * once)
    more = small.replace({"samples_per_class": 300})
    assert training_seconds(more) == pytest.approx(300 * 0.67 / 2 * once, rel=0.01)


def test_a_dry_run_ends_when_its_time_is_over(tmp_path, monkeypatch):
    config = load_config(small_config(tmp_path))
    scenes = slow_after(2, batch_module.draw_valid_scene)
    monkeypatch.setattr(batch_module, "draw_valid_scene", scenes)
    monkeypatch.setattr(trial_module, "run", slow_after(3, trial_module.run))
    found = plan_build(config, 1, NO_PROGRESS, seconds=5)
    assert found.cut_short
    assert found.checked == 2
    assert found.cost.probes == 2  # the first, with its imports, does not count
    assert isinstance(found.cost, Estimate)


def test_a_dry_run_stops_adding_samples(tmp_path, monkeypatch):
    config = load_config(small_config(tmp_path), ["samples_per_class=100"])
    monkeypatch.setattr(trial_module, "ENOUGH_S", 0.0)
    assert estimate(config, 1).probes < 3


def test_a_dry_run_says_what_it_did_not_do(tmp_path, monkeypatch):
    monkeypatch.setattr(estimate_module, "DRY_RUN_S", 0.5)
    monkeypatch.setattr(batch_module, "draw_valid_scene", slow_after(0, None))
    monkeypatch.setattr(trial_module, "run", slow_after(0, None))
    command = ("generate", small_config(tmp_path), "-o", tmp_path / "set", "--dry-run")
    said = ok(*command, "--jobs", 1).stdout
    assert "0 of 9 checked: 0 drawn again, then 0.2 s were over" in said
    assert "time        not known: more than" in said
    found = json.loads(ok(*command, "--jobs", 1, "--json").stdout)
    assert found["seconds"] is None
    assert found["seconds_range"][0] > 0
    assert found["seconds_range"][1] is None


def test_processes_of_a_trial_are_those_of_the_build(tmp_path):
    config = load_config(small_config(tmp_path))
    trial = try_samples(config, range(4), 2, 60, NO_PROGRESS)
    assert len({sample.process for sample in trial.first}) == len(trial.first) <= 2
    assert len(trial.first) + len(trial.further) == 6
    assert {DRAW, "echo", WRITE} < trial.samples[0].stages.keys()
    assert all(sample.processor > 0 for sample in trial.samples)


def test_work_of_processes_is_given_up_when_the_time_is_over():
    start, results = time.monotonic(), []
    run_within(time.sleep, [(0,), (NEVER,), (NEVER,)], 2, 5, results.append)
    assert time.monotonic() - start < 30
    assert len(results) <= 1


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
