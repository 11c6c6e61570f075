"""SIGTERM ends a command as Ctrl-C does: what is finished is kept, workers end, status 143."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from command_line import processes
from learning.patterns import BASE, same_run, split_tree, trained
from small import SMALL, small_config
from typer.testing import CliRunner

from radhar_cli.cli import main, program
from radhar_cli.commands.terminal import TrainingView

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


def swallow_at_the_end(*_):
    Swallowing()


@pytest.mark.parametrize(
    ("place", "swallow", "finished"),
    [
        ("radhar_cli.commands.terminal.BarProgress.stage", swallow_in_assembly, False),
        ("radhar_cli.dataset.build.clean_up", swallow_at_the_end, True),
    ],
)
def test_a_signal_that_python_swallows_ends_the_build_all_the_same(
    place, swallow, finished, tmp_path, monkeypatch, capsys
):
    command = ["generate", small_config(tmp_path), "-o", tmp_path / "set", "--jobs", 1]
    with monkeypatch.context() as patched:
        patched.setattr(place, swallow)
        assert status(patched, *command) == TERMINATED
    printed = capsys.readouterr()
    assert (printed.out, "Traceback" in printed.err) == ("", False)
    assert printed.err.strip().splitlines()[-1] == (
        f"terminated: what is finished in {tmp_path / 'set'} is kept; the same command resumes"
    )
    assert (tmp_path / "set/dataset.h5").exists() == finished
    assert not status(monkeypatch, *command)


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
