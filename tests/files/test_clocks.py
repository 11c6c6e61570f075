"""Instants in texts are seconds from the first."""

import numpy as np
import pytest

from radhar_cli.files.clocks import seconds_of_texts

INSTANTS = {
    "ISO": ("2026-05-01T12:00:00.9", "2026-05-01T12:00:01.4"),
    "ISO, zone": ("2026-05-01T12:00:00.9+02:00", "2026-05-01T12:00:01.4+02:00"),
    "another zone": ("2026-10-25T02:59:59.9+02:00", "2026-10-25T02:00:00.4+01:00"),
    "UTC": ("2026-05-01 12:00:00.9Z", "2026-05-01 12:00:01.4Z"),
    "slashes": ("2026/05/01 23:59:59.9", "2026/05/02 00:00:00.4"),
    "days first": ("27/10/2026 12:00:00.9", "27/10/2026 12:00:01.4"),
    "months first": ("10/27/2026 12:00:00.9", "10/27/2026 12:00:01.4"),
    "days or months": ("05/06/2026 23:59:59.9", "06/06/2026 00:00:00.4"),
    "months or days": ("05/06/2026 23:59:59.9", "05/07/2026 00:00:00.4"),
    "days first, hyphens": ("27-10-2026 12:00:00.9", "27-10-2026 12:00:01.4"),
    "points": ("01.02.2026 12:00:00.9", "01.02.2026 12:00:01.4"),
    "the end of a month": ("28.02.2026 23:59:59.9", "01.03.2026 00:00:00.4"),
    "clock": ("12:00:00.9", "12:00:01.4"),
    "midnight": ("23:59:59.9", "00:00:00.4"),
    "colon": ("12:00:00:900", "12:00:01:400"),
    "halves of the day": ("11:59:59.9 AM", "12:00:00.4 PM"),
    "midnight, halves": ("11:59:59.9 pm", "12:00:00.4 am"),
    "minutes": ("59:58.9", "59:59.4"),
    "minutes that pass the hour": ("59:59.9", "00:00.4"),
}


@pytest.mark.parametrize("texts", INSTANTS.values(), ids=INSTANTS)
def test_instants_are_seconds_from_the_first(texts: tuple[str, str]) -> None:
    assert seconds_of_texts(texts) == pytest.approx([0, 0.5], abs=1e-9)


@pytest.mark.parametrize("texts", INSTANTS.values(), ids=INSTANTS)
def test_decimal_commas_of_instants(texts: tuple[str, str]) -> None:
    first, second = (text.replace(".9", ",9").replace(".4", ",4") for text in texts)
    assert seconds_of_texts([first, second]) == pytest.approx([0, 0.5], abs=1e-9)


@pytest.mark.parametrize(
    "texts", [(), ("",), ("1.5", "2.5"), ("12:00:00", "later"), ("2026-13-40 12:00:00",)]
)
def test_other_texts_are_no_instants(texts: tuple[str, ...]) -> None:
    assert seconds_of_texts(texts) is None


def test_a_long_column_is_exact() -> None:
    texts = [
        f"{n // 3600 % 24:02d}:{n // 60 % 60:02d}:{n % 60:02d}" for n in range(80_000, 180_000, 700)
    ]
    np.testing.assert_array_equal(seconds_of_texts(texts), np.arange(len(texts)) * 700.0)
