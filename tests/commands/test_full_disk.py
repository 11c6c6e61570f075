"""A full disk is one line that names what could not be written, and leaves nothing half done."""

import resource
from contextlib import contextmanager

import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.small import small_config

from radhar_cli.figures.page import page, write_figure

SHORT = "--set duration_s=1 --set image.size_px=32"
RADAR = " ".join(
    f"--set {one}"
    for one in ("carrier_hz=1e10", "prf_hz=500", "bandwidth_hz=1e9", "adc_rate_hz=1e6")
)
FORM = "--set axes=[receiver,sample,pulse] --set beat=negative"
SCENE = f"simulate small.yaml --activity walking --raw --maps rtm --no-figures {SHORT}"
PROCESS = "process walk/recording.h5 --config small.yaml --maps rtm"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A data set, a recording and a capture."""
    place = tmp_path_factory.mktemp("place")
    small_config(place)
    capture = np.random.default_rng(0).normal(size=(1, 64, 128)) * np.exp(1j)
    np.save(place / "capture.npy", capture.astype("c8"))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        for command in (f"generate small.yaml -o set --jobs 1 {SHORT}", f"{SCENE} -o walk"):
            ok(*command.split())
    return place


@contextmanager
def full_disk(limit):
    """A limit on the size of a file stands for a full disk: writing fails midway, as there."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize(
    ("command", "limit", "file", "written"),
    [
        (PROCESS, 10_000, "/maps.h5", []),
        (SCENE, 10_000, "/scene.h5", []),
        (SCENE, 500_000, "/recording.h5", ["scene.h5", "scene.json", "scene.yaml"]),
        (f"import capture.npy {RADAR} {FORM}", 10_000, "", []),
        ("convert set --to parquet", 10_000, "", []),
    ],
)
def test_full_disk_is_one_line(command, limit, file, written, place, tmp_path, monkeypatch):
    monkeypatch.chdir(place)
    out = tmp_path / "out"
    with full_disk(limit):
        done = radhar(*command.split(), "-o", out)
    said = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert (done.returncode, len(said)) == (1, 1), done.stderr
    assert said[0].startswith(f"radhar: {out}{file}: File too large")
    assert sorted(path.name for path in tmp_path.rglob("*") if path != out) == written


def test_a_figure_on_a_full_disk_is_named_and_the_earlier_one_stays(tmp_path):
    path = tmp_path / "maps.png"
    path.write_text("earlier")
    with full_disk(100), pytest.raises(OSError, match="File too large") as error:
        write_figure(page(2, 2), path, 90)
    assert error.value.filename == str(path)
    assert [(one, one.read_text()) for one in tmp_path.iterdir()] == [(path, "earlier")]


def test_config_init_on_a_full_disk_leaves_no_file(tmp_path):
    out = tmp_path / "new.yaml"
    with full_disk(1000):
        done = radhar("config", "init", out)
    assert (done.returncode, done.stderr) == (1, f"radhar: {out}: File too large\n")
    assert not [*tmp_path.iterdir()]
