"""SIGTERM ends a command as Ctrl-C does: what is finished is kept, workers end, status 143."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from helpers.command_line import processes
from helpers.small import SMALL, small_config
from learning.patterns import BASE, same_run, split_tree, trained
from typer.testing import CliRunner

from radhar_cli.cli import main, program
from radhar_cli.commands.tell import report
from radhar_cli.commands.terminal import TrainingView
from radhar_cli.dataset.folder import clean_up

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
TERMINATED = 143


@pytest.fixture(autouse=True)
def handlers():
    """`main` sets handlers for good."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def status(monkeypatch, *arguments):
    """Exit status of the program in this process."""
    monkeypatch.setattr(sys, "argv", ["radhar", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    return ended.value.code


def terminate(*_):
    signal.raise_signal(signal.SIGTERM)


def test_sigterm_of_a_dry_run_keeps_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("radhar_cli.commands.terminal.print_plan", terminate)
    command = ["generate", small_config(tmp_path), "-o", tmp_path / "out", "--dry-run"]
    assert status(monkeypatch, *command) == TERMINATED
    assert capsys.readouterr().err == "terminated: what was not finished is not kept\n"
    assert not (tmp_path / "out").exists()


def test_sigterm_of_train_keeps_the_last_epoch_and_it_resumes(tmp_path, monkeypatch, capsys):
    data = split_tree(tmp_path / "tree")
    (tmp_path / "train.json").write_text(json.dumps({**BASE, "epochs": 2}))
    command = ["train", data, "-o", tmp_path / "run", "--config", tmp_path / "train.json"]
    with monkeypatch.context() as patched:
        patched.setattr(TrainingView, "epoch_done", terminate)
        assert status(patched, *command) == TERMINATED
    expected = capsys.readouterr().err
    assert f"terminated: the last finished epoch in {tmp_path / 'run'} is kept" in expected
    assert "Traceback" not in expected
    again = CliRunner().invoke(program(), [str(word) for word in command])
    assert again.exit_code == 0, again.output
    assert "resuming: 1 of 2 epochs are done" in again.stderr
    trained(data, tmp_path / "whole", epochs=2)
    assert same_run(tmp_path / "run", tmp_path / "whole")


class Swallowing:
    """Gets SIGTERM where Python prints exceptions and goes on, as in HDF5's weak references."""

    def __del__(self):
        terminate()


def swallow_in_assembly(self, name, total, done):
    if name == "assembling":
        Swallowing()


def test_a_signal_that_python_swallows_ends_the_build_all_the_same(tmp_path, monkeypatch, capsys):
    command = ["generate", small_config(tmp_path), "-o", tmp_path / "set", "--jobs", 1]
    with monkeypatch.context() as patched:
        stage = "radhar_cli.commands.terminal.BarProgress.stage"
        patched.setattr(stage, swallow_in_assembly)
        assert status(patched, *command) == TERMINATED
    printed = capsys.readouterr()
    assert (printed.out, "Traceback" in printed.err) == ("", False)
    assert printed.err.strip().splitlines()[-1] == (
        f"terminated: what is finished in {tmp_path / 'set'} is kept; the same command resumes"
    )
    assert not (tmp_path / "set/dataset.h5").exists()
    assert not status(monkeypatch, *command)


def swallow_after(function):
    """That function, and at its end a signal that Python swallows."""

    def swallowing(*given):
        result = function(*given)
        Swallowing()
        return result

    return swallowing


def raise_after(function, number):
    """That function, and at its end a signal."""

    def raising(*given, **named):
        result = function(*given, **named)
        signal.raise_signal(number)
        return result

    return raising


def test_a_signal_in_the_last_moment_of_a_build_says_that_it_is_complete(
    tmp_path, monkeypatch, capsys
):
    command = ["generate", small_config(tmp_path), "-o", tmp_path / "set", "--jobs", 1]
    with monkeypatch.context() as patched:
        patched.setattr("radhar_cli.dataset.build.clean_up", swallow_after(clean_up))
        assert not status(patched, *command)
    printed = capsys.readouterr()
    last = f"terminated after the end: {tmp_path / 'set'} is complete"
    assert printed.err.strip().splitlines()[-1] == last
    assert "9 new" in printed.out
    assert not status(monkeypatch, *command)
    assert "is complete: 9 samples; nothing to do" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("number", "how"), [(signal.SIGTERM, "terminated"), (signal.SIGINT, "interrupted")]
)
def test_a_signal_at_the_end_of_train_says_whether_the_run_is_complete(
    number, how, tmp_path, monkeypatch, capsys
):
    data, run = split_tree(tmp_path / "tree"), tmp_path / "run"
    signal.signal(signal.SIGINT, signal.default_int_handler)
    (tmp_path / "train.json").write_text(json.dumps({**BASE, "epochs": 1}))
    command = ["train", data, "-o", run, "--config", tmp_path / "train.json"]
    summary = "radhar_cli.learning.training.write_run_summary"
    with monkeypatch.context() as patched:  # after the last epoch, before its curves
        patched.setattr(summary, raise_after(lambda *_: None, number))
        assert status(patched, *command) == 128 + number
    assert f"{how}: the last finished epoch in {run} is kept" in capsys.readouterr().err
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with monkeypatch.context() as patched:  # when all is written
        patched.setattr("radhar_cli.commands.train.report", raise_after(report, number))
        assert not status(patched, *command)
    printed = capsys.readouterr()
    assert printed.err.strip().splitlines()[-1] == f"{how} after the end: {run} is complete"
    assert "best epoch 1" in printed.out


def wait_for(done, run):
    while run.poll() is None and not done():
        time.sleep(0.01)


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs /proc")
def test_sigterm_of_generate_ends_its_workers_and_keeps_shards(tmp_path):
    """The workers leave it to their master: batch systems and `timeout` signal all of a group."""
    text = SMALL.replace("samples_per_class: 3", "samples_per_class: 60\nengine: {kind: cube}")
    config, folder = small_config(tmp_path, text), tmp_path / "set"
    command = [sys.executable, "-m", "radhar_cli", "generate", str(config), "-o", str(folder)]
    run = subprocess.Popen(
        [*command, "--jobs", "2", "--batch", "1"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )

    def shards():
        return len(list((folder / ".radhar/shards").glob("*.h5")))

    wait_for(lambda: shards() > 0, run)
    workers = [pid for pid, line in processes(run.pid).items() if b"popen_loky" in line]
    assert len(workers) == 2
    for worker in workers:
        os.kill(worker, signal.SIGTERM)
    seen = shards()
    wait_for(lambda: shards() > seen + 2, run)
    os.kill(run.pid, signal.SIGTERM)
    output = run.communicate()[0]
    assert run.returncode == TERMINATED, output
    assert output.strip().splitlines()[-1] == (
        f"terminated: what is finished in {folder} is kept; the same command resumes"
    )
    assert "Traceback" not in output
    assert shards() > seen
    deadline = time.monotonic() + 60
    while processes(run.pid) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not processes(run.pid)
