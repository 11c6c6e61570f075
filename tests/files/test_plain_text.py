"""Text of other programs is read in the encodings that they write."""

import pytest

from radhar_cli.files.plain_text import decode_text

TEXT = "Zeit;Schulter_für;Größe\n0,5;1;2\n" * 20


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"]
)
def test_letters_are_kept(encoding: str) -> None:
    assert decode_text(TEXT.encode(encoding)).lstrip("\ufeff") == TEXT


def test_letters_of_other_alphabets_in_utf_16() -> None:
    text = "время;плечо\n" + "0.5;1.25\n" * 20
    for encoding in ("utf-16-le", "utf-16-be"):
        assert decode_text(text.encode(encoding)) == text


@pytest.mark.parametrize(
    "data", [b"\0" * 100, bytes(range(256)) * 4, b"\1\0\2\0\3\0" * 50, b"text\0text"]
)
def test_numbers_are_no_text(data: bytes) -> None:
    with pytest.raises(ValueError, match="is not a text"):
        decode_text(data)
