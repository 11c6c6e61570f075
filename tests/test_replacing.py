"""Files that appear when they are whole."""

import os
from pathlib import Path

import pytest

from radhar_cli.replacing import replacing, write_text


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
    path = tmp_path / ("n" * 251)
    with pytest.raises(OSError, match="File name too long") as error:
        write_text(path, "x")
    assert error.value.filename == str(path)
    with pytest.raises(FileNotFoundError) as error, replacing(tmp_path / "a.txt"):
        (tmp_path / "other").read_text()
    assert error.value.filename == str(tmp_path / "other")
