"""A clock that is not read is named as the file has it, with the clocks that are."""

from pathlib import Path

import pytest

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.errors import CaptureError


@pytest.mark.parametrize("date", ["03-02-26", "03/02/26", "03.02.26"])
@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_a_date_of_two_digits_a_year_is_named(tmp_path: Path, date: str, delimiter: str) -> None:
    clocks = [f"{date} 23:59:{n:02}.000000" for n in range(10, 20)]
    rows = [delimiter.join((clock, "0.5", "0.25")) for clock in clocks]
    path = tmp_path / "clocks.csv"
    path.write_text("\n".join([delimiter.join(("time", "I", "Q")), *rows]))
    read = read_settings(None, ["carrier_hz=24e9", "prf_hz=100"])
    with pytest.raises(CaptureError) as refused:
        import_capture([path], tmp_path / "out.h5", read, "--set")
    assert f"'{clocks[0]}' is no clock that is read; such are 2026-05-01 12" in str(refused.value)
