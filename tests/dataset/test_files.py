"""Files that appear whole."""

import errno
from pathlib import Path

import pytest

from radhar_cli.dataset.files import write_whole


def test_a_full_disk_names_the_file_and_leaves_nothing(tmp_path, monkeypatch):
    """`write` says no name; without one the program has no line to print."""

    def full(path, data):
        path.touch()
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="No space left") as error:
        write_whole(tmp_path, tmp_path / "report.json", b"{}")
    assert error.value.filename == str(tmp_path / "report.json")
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]
