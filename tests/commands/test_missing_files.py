"""A file that is missing, a folder or not readable is called that, whatever it should have been."""

import os
from pathlib import Path

import numpy as np
import pytest

from radhar_cli.cli import program
from radhar_cli.errors import RadharError

HEADER = ["carrier_hz=77e9", "bandwidth_hz=1e9", "adc_rate_hz=1e6", "prf_hz=1000"]
SET = [word for one in [*HEADER, "samples=8", "receivers=1"] for word in ("--set", one)]
CAPTURES = [["import", f"x.{suffix}", *SET] for suffix in ("bin", "npy", "npz", "mat", "h5")]
HEADERS = [["import", "good.npy", "--radar", f"x.{suffix}"] for suffix in ("json", "cfg", "yaml")]
OTHERS = [
    ["process", "x.h5", "--config", "c.yaml"],
    ["process", "good.npy", "--config", "x.yaml"],
    ["fit", "x.h5"],
    ["generate", "c.yaml", "--recordings", "x.npz", "--set", "recordings.rows=[-1,1]"],
    ["generate", "c.yaml", "--recordings", "x.csv"],
    ["generate", "c.yaml", "--recordings", "manifest.csv"],
    ["simulate", "x.yaml"],
    ["simulate", "c.yaml", "--motion", "x.bvh"],
    ["simulate", "c.yaml", "--motion", "x.amc"],
    ["convert", "x.h5", "--to", "parquet"],
    ["merge", "x.parts"],
]


@pytest.fixture
def place(tmp_path, monkeypatch):
    np.save(tmp_path / "good.npy", np.ones((8, 40)))
    (tmp_path / "c.yaml").write_text("maps: [stft]\n")
    (tmp_path / "manifest.csv").write_text("file,label\nx.h5,walking\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refusal(words):
    with pytest.raises(RadharError) as error:
        program()([*words, *["-o", "out"] * (words[0] != "merge")], standalone_mode=False)
    assert error.value.status == 2
    return str(error.value)


@pytest.mark.every(4)
@pytest.mark.parametrize("words", [*CAPTURES, *HEADERS, *OTHERS], ids=lambda words: " ".join(words))
def test_a_missing_file_is_missing(words, place):
    assert "no such f" in refusal(words)
    assert "damaged" not in refusal(words)


@pytest.mark.parametrize("words", [*CAPTURES[:6], *HEADERS, *OTHERS[:3], OTHERS[5]], ids=str)
def test_a_folder_is_no_file(words, place):
    for word in ("x.h5", *words):
        if word.startswith("x.") and not Path(word).exists():
            Path(word).mkdir()
    told = refusal(words)
    is_capture = words in CAPTURES[:6] and "is a folder of" in told  # of a file a frame
    right = "should hold those of a capture alone" if is_capture else "should be a regular file"
    assert "is a folder" in told
    assert right in told
    assert "HDF5" not in told


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (OTHERS[5], "x.h5"),
        (["convert", "data", "--to", "parquet"], "data/dataset.h5"),
        (
            ["generate", "c.yaml", "--recordings", "tree", "--set", "recordings.rows=[-1,1]"],
            "tree/a/0.png",
        ),
        (["import", "x_0.bin", *SET], "x_1.bin"),
    ],
    ids=str,
)
def test_a_file_that_may_not_be_read_is_not_called_damaged(words, file, place, monkeypatch):
    named = Path(words[1])
    for path in map(Path, (file, words[1])):
        if path.suffix:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
    if named.suffix == ".bin":
        named.write_bytes(bytes(100))
    allowed = os.access
    monkeypatch.setattr(
        os, "access", lambda path, mode: Path(path).name != Path(file).name and allowed(path, mode)
    )
    assert refusal(words) == f"{file}: Permission denied"
