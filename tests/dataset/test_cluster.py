"""A dask cluster makes the same bytes; lost workers are survived, a lost scheduler is named."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest
from helpers.command_line import ROOT
from helpers.listener import Listener
from helpers.small import fingerprint, small_config

from radhar_cli.config import load_config
from radhar_cli.dataset.build import build, build_part
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.merge import merge
from radhar_cli.dataset.parts import DataSetPart
from radhar_cli.dataset.shards import list_shards

pytest.importorskip("distributed")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
CHANGES = [
    "maps=[rtm, stft]",
    "image.size_px=16",
    "samples_per_class=6",
    "motion.range_m={per_activity: {default: 2, walking: 3}}",
]
Process = subprocess.Popen[str]


def dask(place, *arguments):
    """A dask program in a folder of its own."""
    place.mkdir()
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
        cwd=place,
        # The processor's settings too: workers should round as the build they are compared with.
        env={**os.environ, "PYTHONPATH": str(ROOT), "PATH": "", "OMP_NUM_THREADS": "1"},
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture
def cluster(tmp_path):
    """Address, and the processes: a scheduler and two workers."""
    started = [
        dask(
            tmp_path / "s", "dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"
        )
    ]
    try:
        assert started[0].stderr is not None
        found = (re.search(r"Scheduler at:\s*(tcp://\S+)", line) for line in started[0].stderr)
        address = next(match[1] for match in found if match)
        options = ("--nthreads", "1", "--no-nanny", "--no-dashboard")
        started += [dask(tmp_path / w, "dask_worker", address, *options) for w in ("a", "b")]
        yield address, started
    finally:
        for one in started:
            one.kill()
            one.communicate()


def generate(address, folder, *more):
    """Build in a folder, named from its parent, on a cluster."""
    changes = [x for change in CHANGES for x in ("--set", change)]
    return subprocess.Popen(
        [
            *(sys.executable, "-m", "radhar_cli", "generate", "small.yaml", "-o", folder.name),
            *("--batch", "1", "--cluster", address, *changes, *more),
        ],
        cwd=folder.parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


@pytest.mark.slow
def test_dask_shards_loky_and_one_process_give_the_same_bytes(tmp_path):
    config = load_config(small_config(tmp_path), CHANGES)
    build(config, tmp_path / "alone", 1, Listener())
    build(config, tmp_path / "loky", 2, Listener())
    for number in (2, 1):
        build_part(config, tmp_path / "shards", DataSetPart(2, number), 1, Listener())
    merge(tmp_path / "shards", [], 1, Listener())
    shutil.rmtree(tmp_path / "shards/parts")
    made = generate("local", tmp_path / "dask", "--jobs", "2")
    output, _ = made.communicate(timeout=300)
    assert made.returncode == 0, output
    assert "Pydantic" not in output, output
    prints = [fingerprint(tmp_path / way) for way in ("alone", "loky", "shards", "dask")]
    assert prints[1:] == prints[:-1]
    pngs = [name for name in prints[0] if name.startswith("png/") and name.endswith(".png")]
    assert len(pngs) == 2 * len(Rows.of(config))  # one of each map


def test_a_build_survives_a_killed_worker_and_names_a_killed_scheduler(cluster, tmp_path):
    address, (scheduler, first, _) = cluster
    config = load_config(small_config(tmp_path), CHANGES)
    build(config, tmp_path / "whole", 1, Listener())

    def kill_after(run, shards, victim):
        while run.poll() is None and len(list_shards(tmp_path / "set")) < shards:
            time.sleep(0.001)
        assert run.poll() is None
        victim.kill()
        output, _ = run.communicate(timeout=100)
        return output

    lost = generate(address, tmp_path / "set")
    output = kill_after(lost, 3, first)
    assert (lost.returncode, output) == (0, output), output
    assert fingerprint(tmp_path / "set") == fingerprint(tmp_path / "whole")
    assert not list((tmp_path / "a").glob("*.h5"))

    (tmp_path / "set").rename(tmp_path / "first")
    stopped = generate(address, tmp_path / "set")
    output = kill_after(stopped, 3, scheduler)
    assert (stopped.returncode, "the scheduler is gone" in output) == (1, True), output
    assert "Traceback" not in output, output
    refused = generate(address, tmp_path / "set")
    output, _ = refused.communicate(timeout=100)
    assert (refused.returncode, "no dask scheduler answers" in output) == (2, True), output
    made = build(config, tmp_path / "set", 1, Listener()).new_samples
    assert 0 < made < 18
    assert fingerprint(tmp_path / "set") == fingerprint(tmp_path / "whole")


@pytest.mark.slow
def test_ctrl_c_ends_local_workers_in_one_line(tmp_path):
    """Of the whole group, as a terminal sends it; workers have nothing to say."""
    (tmp_path / "many.yaml").write_text("base: small.yaml\nsamples_per_class: 3000\n")
    small_config(tmp_path)
    command = [sys.executable, "-m", "radhar_cli", "generate", tmp_path / "many.yaml"]
    run = subprocess.Popen(
        [*command, "-o", tmp_path / "set", "--cluster", "local", "--jobs", "2", "--quiet"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=ROOT,
        start_new_session=True,
    )
    while run.poll() is None and not list_shards(tmp_path / "set"):
        time.sleep(0.01)
    os.killpg(run.pid, signal.SIGINT)
    output, _ = run.communicate(timeout=100)
    assert run.returncode == 130, output
    (line,) = [line for line in output.splitlines() if line and "warning" not in line]
    assert line.startswith("interrupted: ")
