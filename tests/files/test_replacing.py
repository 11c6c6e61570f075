"""Files that appear when they are whole."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from helpers.command_line import ROOT

from radhar_cli.dataset.folder import refuse_foreign_files
from radhar_cli.files.replacing import UNFINISHED, replacing, write_text


def interrupted(path: Path) -> None:
    with replacing(path) as unfinished:
        unfinished.write_text("half")
        raise KeyboardInterrupt


def test_what_was_there_stays_until_the_new_file_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "old")
    with pytest.raises(KeyboardInterrupt):
        interrupted(path)
    assert path.read_text() == "old"
    write_text(path, "new")
    assert [(one.name, one.read_text()) for one in tmp_path.iterdir()] == [("a.txt", "new")]


def test_a_folder_or_a_pipe_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    for name in ("folder", "pipe"):
        with pytest.raises(OSError, match="not a regular file") as error:
            write_text(tmp_path / name, "x")
        assert error.value.filename == str(tmp_path / name)
    assert (tmp_path / "pipe").is_fifo()


def test_errors_name_the_file_and_not_the_unfinished_one(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 256)
    with pytest.raises(OSError, match="File name too long") as error:
        write_text(path, "x")
    assert error.value.filename == str(path)
    with pytest.raises(FileNotFoundError) as error, replacing(tmp_path / "a.txt"):
        (tmp_path / "other").read_text()
    assert error.value.filename == str(tmp_path / "other")


def test_two_that_write_the_same_file_at_the_same_time_do_not_mix(tmp_path: Path) -> None:
    """Each has a file of its own; the last one to finish stays."""
    path = tmp_path / "a.txt"
    with replacing(path) as one:
        one.write_text("the first, which is long")
        with replacing(path) as other:
            other.write_text("the second")
        assert path.read_text() == "the second"
    assert path.read_text() == "the first, which is long"
    assert [one.name for one in tmp_path.iterdir()] == ["a.txt"]


def test_what_a_killed_process_left_goes_and_what_another_writes_stays(tmp_path: Path) -> None:
    code = (
        "import os, sys, pathlib\n"
        "from radhar_cli.files.replacing import replacing\n"
        "with replacing(pathlib.Path(sys.argv[1])) as unfinished:\n"
        "    unfinished.write_text('half')\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    path = tmp_path / "a.txt"
    done = subprocess.run([sys.executable, "-c", code, path], cwd=ROOT, check=False)
    assert done.returncode == -9
    assert [one.read_text() for one in tmp_path.iterdir()] == ["half"]
    with replacing(tmp_path / "b.txt") as held:
        held.write_text("whole")
        write_text(path, "new")
    assert {one.name: one.read_text() for one in tmp_path.iterdir()} == {
        "a.txt": "new",
        "b.txt": "whole",
    }


def test_a_folder_with_nothing_but_leftovers_takes_a_scene(tmp_path: Path) -> None:
    (tmp_path / f"{UNFINISHED}1").touch()
    refuse_foreign_files(tmp_path, "scene of radhar's")
