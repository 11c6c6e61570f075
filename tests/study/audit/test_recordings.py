"""Tables of recordings: what is read, what is refused, and how samples are found in them."""

import numpy as np
import pytest

from radhar_cli.errors import FolderError
from radhar_cli.study.audit.recordings import (
    as_numbers,
    match_table,
    name_evidence,
    numbered,
    read_table,
)


def table(folder, text):
    path = folder / "table.csv"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "should have a line of names"),
        ("file,person\n", "should have a line of names"),
        ("file,file\na,b\n", "should name each column once"),
        ("file,\na,b\n", "should name each column once"),
        ("file,person\na\n", "row 2 has 1 cells; should have 2"),
        ('file\n"a\n', "is no CSV table"),
    ],
)
def test_a_table_that_is_none(tmp_path, text, message):
    with pytest.raises(FolderError, match=message):
        read_table(table(tmp_path, text))


def test_a_table_that_is_no_text(tmp_path):
    path = tmp_path / "table.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FolderError, match="cannot be read as text"):
        read_table(path)
    with pytest.raises(FolderError, match="no such file"):
        read_table(tmp_path / "none.csv")


@pytest.mark.parametrize("key", ["falling/7", "falling/7.png", "7", "train/falling/7.png"])
def test_samples_are_found_by_any_end_of_their_path(tmp_path, key):
    read = read_table(table(tmp_path, f"file,person\n{key},P1\nother,P2\n"))
    found = match_table(read, ["train/falling/7.png", "train/falling/8.png"])
    assert found.columns == {"person": ["P1", ""]}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("who,person\na,b\n", "one should be file or sample or image or name"),
        ("file,person\na,b\n", "no sample is called so; they are called as 'x/1.png'"),
        ("file,person\n1,b\n1,c\n", "file = '1': stands there twice"),
    ],
)
def test_a_table_of_other_samples(tmp_path, text, message):
    with pytest.raises(FolderError, match=message):
        match_table(read_table(table(tmp_path, text)), ["x/1.png"])


def test_columns_become_numbers():
    assert as_numbers(["1", "2.5", ""]).tolist()[:2] == [1, 2.5]
    assert np.isnan(as_numbers(["1", ""])[1])
    days = as_numbers(["2020-01-31", "2020-02-01", "2020-02-01T10:00"])
    assert np.diff(days).tolist() == [1, 0]
    assert as_numbers(["b", "a", "b"]).tolist() == [1, 0, 1]


def test_numbers_in_names_of_files(tmp_path):
    files = [tmp_path / f"s{n % 2}_rec{n:03d}.png" for n in range(4)]
    first, second = name_evidence(files)
    assert first.values[:, 0].tolist() == [0, 1, 0, 1]
    assert second.values[:, 0].tolist() == [0, 1, 2, 3]
    assert not name_evidence([tmp_path / "a.png", tmp_path / "b.png"])


def test_unknown_persons_are_each_their_own():
    assert len(set(numbered(["p", "", None, "p"]).tolist())) == 3
